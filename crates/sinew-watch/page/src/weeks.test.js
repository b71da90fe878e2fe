import assert from "node:assert/strict";
import test from "node:test";
import { byWeek, weekName } from "./weeks.js";

const NOW = 1.79e9, DAY = 86400;
const due = (joint, state, days) =>
  ({ joint, state, after_s: days === null ? null : days * DAY, at_utc_s: days === null ? null : NOW + days * DAY });

test("byWeek groups tendons by the week of the median and keeps all", () => {
  const list = {
    time_utc_s: NOW,
    until_utc_s: NOW + 28 * DAY,
    due: [
      due("a", "passed", -3), due("b", "forecast", -2), due("c", "forecast", 6.9), due("d", "forecast", 7), due("e", "forecast", 27.9),
      due("f", "forecast", 28.1), due("g", "not-before", null),
    ],
  };
  const found = byWeek(list).map(([what, tendons]) => [what, tendons.map(tendon => tendon.joint).join("")]);
  assert.deepEqual(found, [["passed", "a"], [0, "bc"], [1, "d"], [3, "e"], ["perhaps", "fg"]]);
  assert.deepEqual(byWeek({ ...list, due: [] }), []);
  assert.deepEqual([0, 1, 2].map(weekName), ["This week", "Next week", "In 2 weeks"]);
});
