// One event stream for all windows: a browser opens at most six connections to a host for all of them together.
import { Stream } from "./stream.js";

// Time without a message of a window after which it counts as closed, ms: windows report every 10 s, and a browser may
// slow the timers of a window that is covered to one per minute.
const CLOSED_MS = 150_000;

const windows = new Map();
const stream = new Stream((kind, data) => {
  for (const [port, { live }] of windows) {
    if (kind !== "live" || live === `${data.robot}/${data.joint}`) port.postMessage({ kind, data });
  }
});

function update(again = false) {
  for (const [port, { at_ms }] of windows) if (Date.now() - at_ms > CLOSED_MS) windows.delete(port);
  if (windows.size === 0) stream.close();
  else {
    const all = [...windows.values()], of = name => all.map(one => one[name]).filter(Boolean);
    stream.follow(of("robot"), of("live"), again);
  }
}

self.addEventListener("connect", event => {
  const [port] = event.ports;
  // { kind: "follow", robot, live }, { kind: "again", robot, live } after a login, or { kind: "leave" }.
  port.addEventListener("message", ({ data }) => {
    const isNew = !windows.has(port);
    if (data.kind === "leave") windows.delete(port);
    else windows.set(port, { robot: data.robot, live: data.live, at_ms: Date.now() });
    const whole = stream.whole();
    if (isNew && data.kind !== "leave" && whole) port.postMessage({ kind: "fleet", data: whole });
    update(data.kind === "again");
  });
  port.start();
});
