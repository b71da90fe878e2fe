import assert from "node:assert/strict";
import test from "node:test";
import { similar } from "./similar.js";

const view = (robot, text, acknowledged = false) =>
  ({ robot, level: "error", title: "No data", text, alarm: { key: { condition: "no-data" }, state: "active", acknowledged } });

test("similar groups alarms of one cause and keeps all", () => {
  const lost = ["a", "b", "c", "d"].map(robot => view(robot, "transport disconnected"));
  const alarms = [lost[0], view("x", "no data"), ...lost.slice(1), view("e", "transport disconnected", true)];
  const groups = similar(alarms).map(group => group.map(one => one.robot));
  assert.deepEqual(groups, [["a", "b", "c", "d"], ["x"], ["e"]]);
  // Few alarms are not grouped.
  assert.deepEqual(similar(lost.slice(1)).map(group => group.length), [1, 1, 1]);
});
