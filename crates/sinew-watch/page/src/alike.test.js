import assert from "node:assert/strict";
import test from "node:test";
import { alike } from "./alike.js";

const said = (robot, text, acknowledged = false) =>
  ({ robot, level: "error", title: "it isn't heard", text, alarm: { key: { condition: "not_heard" }, state: "active", acknowledged } });

test("one cause is one entry, and nothing is lost", () => {
  const shut = ["a", "b", "c", "d"].map(robot => said(robot, "the door is shut"));
  const alarms = [shut[0], said("x", "no data"), ...shut.slice(1), said("e", "the door is shut", true)];
  const groups = alike(alarms).map(group => group.map(one => one.robot));
  assert.deepEqual(groups, [["a", "b", "c", "d"], ["x"], ["e"]]);
  // A few stand for themselves.
  assert.deepEqual(alike(shut.slice(1)).map(group => group.length), [1, 1, 1]);
});
