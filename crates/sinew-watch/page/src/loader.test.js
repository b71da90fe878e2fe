import assert from "node:assert/strict";
import test from "node:test";
import { Loader } from "./loader.js";

const settled = () => new Promise(resolve => setImmediate(resolve));

test("Loader keeps an answer that arrives after a change, and loads once more", async () => {
  const pending = [], states = [];
  const loader = new Loader(() => new Promise(resolve => pending.push(resolve)), state => states.push(state.value));
  loader.load();
  // Three changes before the first answer.
  for (let k = 0; k < 3; k++) loader.load();
  assert.equal(pending.length, 1);
  pending[0]("first");
  await settled();
  assert.deepEqual(states, ["first"]);
  assert.equal(pending.length, 2);
  pending[1]("second");
  await settled();
  assert.deepEqual(states, ["first", "second"]);
  assert.equal(pending.length, 2);
});

test("Loader repeats a failed request, and keeps the last answer with the error", async context => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const answers = ["first", new Error("unreachable"), "third"], states = [];
  const loader = new Loader(async () => {
    const answer = answers.shift();
    if (answer instanceof Error) throw answer;
    return answer;
  }, state => states.push([state.value, state.error?.message ?? null]));
  await loader.load();
  await loader.load();
  assert.deepEqual(states, [["first", null], ["first", "unreachable"]]);
  context.mock.timers.tick(2000);
  await settled();
  assert.deepEqual(states.at(-1), ["third", null]);
  // A page that was left asks no more.
  loader.end();
  answers.push(new Error("later"));
  await loader.load();
  assert.equal(states.length, 3);
});
