// Identical alarms of several robots with one cause, such as a disconnected transport.
const MIN_GROUP = 4;

// Groups of alarms with the same condition, text and state, in the order of their first alarm.
export function similar(alarms) {
  const groups = new Map();
  for (const view of alarms) {
    const { key, state, acknowledged } = view.alarm;
    const same = JSON.stringify([view.level, key.condition, view.title, view.text, state, acknowledged]);
    if (!groups.has(same)) groups.set(same, []);
    groups.get(same).push(view);
  }
  return [...groups.values()].flatMap(group => (group.length < MIN_GROUP ? group.map(view => [view]) : [group]));
}
