// Annotations of a chart of several tendons, from the journals of their robots.

// Kinds of journal entries from which annotations are made.
export const MARKED = ["command", "incident", "alarm"];

export const MARKS = {
  tensioned: { letter: "T", name: "re-tensioned" },
  replaced: { letter: "R", name: "rope replaced" },
  incident: { letter: "I", name: "incident" },
  alarm: { letter: "A", name: "alarm raised" },
};

// Annotation of a journal entry; null: none. The entries of an incident are one annotation with the same `id`.
function markOf({ id, robot, time_utc_s, event }) {
  if (event.event === "command") {
    const { kind, joints } = event.what;
    return kind === "tensioned" || kind === "replaced" ? { id, kind, joints, time_utc_s } : null;
  }
  if (event.event === "incident") {
    const { joint, number, opened_utc_s } = event.incident;
    return { id: `${robot}/${number}`, kind: "incident", joints: [joint], time_utc_s: opened_utc_s };
  }
  const { key, from } = event;
  return from === "normal" && key.joint ? { id, kind: "alarm", joints: [key.joint], time_utc_s } : null;
}

// Annotations of the tendons (`ROBOT/JOINT`) in chronological order, each with the index of its tendon. `entries`: the newest first,
// whose text is that of an incident.
export function marksOf(entries, tendons) {
  const marks = new Map();
  for (const entry of entries) {
    const mark = markOf(entry);
    for (const joint of mark?.joints ?? []) {
      const of = tendons.indexOf(`${entry.robot}/${joint}`), id = `${mark.id} ${of}`;
      if (of >= 0 && !marks.has(id)) marks.set(id, { id, kind: mark.kind, time_utc_s: mark.time_utc_s, of, text: entry.text });
    }
  }
  return [...marks.values()].sort((a, b) => a.time_utc_s - b.time_utc_s);
}
