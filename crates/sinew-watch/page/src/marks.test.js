import assert from "node:assert/strict";
import { test } from "node:test";
import { marksOf } from "./marks.js";

const incident = (number, joint, phase) => ({ event: "incident", incident: { number, joint, phase, opened_utc_s: 40 } });
const alarm = (joint, from, to) => ({ event: "alarm", key: { joint, condition: "step-change" }, from, to });
const entries = [
  { id: 9, robot: "a", time_utc_s: 90, event: incident(1, "elbow", "closed"), text: "closed" },
  { id: 8, robot: "a", time_utc_s: 80, event: { event: "command", what: { kind: "tensioned", joints: ["elbow", "wrist"] } }, text: "tensioned" },
  { id: 7, robot: "a", time_utc_s: 70, event: { event: "command", what: { kind: "note" } }, text: "a note" },
  { id: 6, robot: "b", time_utc_s: 60, event: alarm("elbow", "normal", "active"), text: "of another robot" },
  { id: 5, robot: "a", time_utc_s: 55, event: alarm("elbow", "active", "acknowledged"), text: "no new alarm" },
  { id: 4, robot: "a", time_utc_s: 50, event: alarm("elbow", "normal", "active"), text: "alarm" },
  { id: 3, robot: "a", time_utc_s: 45, event: alarm(null, "normal", "active"), text: "of the robot" },
  { id: 2, robot: "a", time_utc_s: 41, event: incident(1, "elbow", "suspected"), text: "suspected" },
];

test("marks_are_events_of_selected_tendons_in_order", () => {
  const marks = marksOf(entries, ["a/wrist", "a/elbow"]).map(({ kind, of, time_utc_s, text }) => [time_utc_s, kind, of, text]);
  assert.deepEqual(marks, [
    [40, "incident", 1, "closed"], [50, "alarm", 1, "alarm"], [80, "tensioned", 1, "tensioned"], [80, "tensioned", 0, "tensioned"],
  ]);
  assert.deepEqual(marksOf(entries, []), []);
});
