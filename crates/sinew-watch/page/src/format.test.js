// node --test: the same cases as crates/sinew-files/src/number.rs.
import assert from "node:assert/strict";
import test from "node:test";
import { chance, count, plusMinus, rounded, span, temperature } from "./format.js";

test("plusMinus shows two digits of the interval", () => {
  const of = (mean, std) => plusMinus({ mean, std });
  assert.equal(of(10.0234, 0.1321), "10.02 ± 0.26");
  assert.equal(of(-0.00003, 0.0042), "0.0000 ± 0.0082");
  assert.equal(of(-1234.6, 56.7), "−1235 ± 111");
  assert.equal(plusMinus(null), "–");
  assert.equal(plusMinus({ mean: 0.0100234, std: 0.0001321 }, 1e3), "10.02 ± 0.26");
  assert.equal(rounded(0.25678, 2), "0.26");
  assert.equal(rounded(NaN, 2), "–");
});

test("chance is never 0 or 100 %", () => {
  assert.deepEqual([1, 0.996, 0.4251, 0.001, 0, NaN].map(chance), ["> 99 %", "> 99 %", "43 %", "< 1 %", "< 1 %", "–"]);
});

test("spans and counts", () => {
  assert.equal(span(45), "45 s");
  assert.equal(span(600), "10 min");
  assert.equal(span(3 * 86400), "3 days");
  assert.equal(span(30 * 3600), "30 h");
  assert.equal(count(1234567), "1\u202f234\u202f567");
});

test("temperature reports its contribution to the interval", () => {
  const tendons = [{ joint: "yaw", unknown_temperature_rad: 0.0004 }, { joint: "pitch", unknown_temperature_rad: 0.001 }, { joint: "wrist" }];
  assert.equal(temperature({ temperature_c: 22.04, tendons: [{ joint: "yaw" }] }), "22.0 °C");
  assert.equal(temperature({ temperature_c: null, tendons: [] }), "not recorded");
  assert.match(temperature({ temperature_c: null, tendons }), /^not recorded; contributes ± 2.0 mrad to the interval at pitch/);
  assert.match(temperature({ temperature_c: 22.04, tendons }), /^22.0 °C; not recorded at tensioning; contributes ± 2.0 mrad/);
});
