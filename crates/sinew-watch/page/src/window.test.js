import assert from "node:assert/strict";
import { test } from "node:test";
import { Window } from "./window.js";

const sample = (time_s, more) => ({ time_s, motor_minus_joint_rad: 2e-3, offset_rad: { mean: 1e-3, std: 1e-4 }, valid: true, ...more });
const tenths = (from, to, more) => Array.from({ length: to - from }, (_, k) => sample((from + k) / 10, more));

test("window_keeps_last_seconds_in_order", () => {
  const window = new Window(60);
  for (let k = 0; k < 100; k++) window.add(tenths(10 * k, 10 * k + 10));
  const [times, difference] = window.difference();
  assert.ok(times.length === 600 || times.length === 601, times.length);
  assert.equal(times.at(-1), 0);
  assert.ok(times.every((t, i) => i === 0 || t > times[i - 1]) && times[0] >= -60.001);
  assert.equal(difference[0], 2);
  // Interval by hand: 1 ± 1.96 · 0.1 mrad.
  const [, mean, high, low] = window.offset().map(column => column[0]);
  assert.ok(Math.abs(mean - 1) + Math.abs(high - 1.196) + Math.abs(low - 0.804) < 1e-12);
});

test("window_shows_gaps_and_missing_offsets_as_null", () => {
  const window = new Window(60);
  window.add([...tenths(0, 10), ...tenths(30, 40, { offset_rad: null })]);
  const offsets = window.offset()[1];
  assert.deepEqual(offsets.slice(9, 12), [1, null, null]);
  assert.equal(offsets.length, 21);
  window.add([sample(0.1)]);
  assert.equal(window.difference()[0].length, 1);
});

test("window_joins_samples_that_are_not_valid", () => {
  const window = new Window(60);
  window.add([...tenths(0, 10), ...tenths(10, 30, { valid: false }), ...tenths(30, 40), ...tenths(40, 41, { valid: false })]);
  const spans = window.notValid().map(span => span.map(x => Number(x.toFixed(3))));
  assert.deepEqual(spans, [[-3.1, -1.1], [-0.1, 0]]);
});
