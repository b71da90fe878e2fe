// Alarms that say the same of several robots: one cause, such as a door that is shut.
const LEAST = 4;

// Lists of alarms, in the order in which the first of each came: of one condition, in the same words and the same state.
export function alike(alarms) {
  const groups = new Map();
  for (const said of alarms) {
    const { key, state, acknowledged } = said.alarm;
    const same = JSON.stringify([said.level, key.condition, said.title, said.text, state, acknowledged]);
    if (!groups.has(same)) groups.set(same, []);
    groups.get(same).push(said);
  }
  return [...groups.values()].flatMap(group => (group.length < LEAST ? group.map(said => [said]) : [group]));
}
