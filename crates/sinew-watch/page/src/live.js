// State of the monitor, updated every second. A slow browser skips updates; a lost connection is shown.
import { useEffect, useState } from "preact/hooks";
import { onLoginRequired } from "./api.js";
import { Stream } from "./stream.js";

// Time without an update after which values count as outdated, ms.
const MAX_AGE_MS = 5000;
// Interval in which a window reports to the worker that it is open, ms.
const REPORT_MS = 10_000;

const state = { fleet: null, robots: new Map(), robot: null, lost: false, received_ms: Date.now(), login: false };
const readers = new Set();
// `series`: tendon whose live series is received, as `ROBOT/JOINT`, with the receiver of its samples.
let wanted = null, series = null, version = 0;

function notify() {
  version += 1;
  for (const reader of readers) reader(version);
}

function received() {
  state.received_ms = Date.now();
  state.lost = false;
}

function receive(kind, data) {
  if (kind === "login") { loginRequired(); return; }
  received();
  if (kind === "live") {
    // Drawn by the chart alone: the page is not rendered ten times a second.
    if (`${data.robot}/${data.joint}` === series?.tendon) series.receive(data.samples);
    return;
  }
  if (kind === "robot") {
    if (data.robot.robot !== wanted) return;
    state.robot = data;
  } else {
    if (kind === "fleet") state.robots = new Map();
    for (const row of data.robots) state.robots.set(row.robot, row);
    for (const name of data.gone ?? []) state.robots.delete(name);
    state.fleet = data;
    // The stream was opened again after a login, perhaps in another window.
    state.login = false;
  }
  notify();
}

function loginRequired() {
  if (state.login) return;
  state.login = true;
  notify();
}
onLoginRequired(loginRequired);

// Stream of this window, where the browser shares none.
function ownStream() {
  const stream = new Stream(receive);
  const list = name => name ? [name] : [];
  return { follow: again => stream.follow(list(wanted), list(series?.tendon), again), leave: () => stream.close() };
}

// Stream shared by all windows; `failed` is called if the browser cannot run it.
function sharedStream(failed) {
  const worker = new SharedWorker("/stream.js", "sinew-watch");
  worker.addEventListener("error", failed);
  worker.port.addEventListener("message", ({ data }) => receive(data.kind, data.data));
  worker.port.start();
  return {
    follow: again => worker.port.postMessage({ kind: again ? "again" : "follow", robot: wanted, live: series?.tendon ?? null }),
    leave: () => worker.port.postMessage({ kind: "leave" }),
  };
}

function open() {
  if (typeof SharedWorker === "undefined") return ownStream();
  try {
    return sharedStream(() => { source = ownStream(); listen(); });
  } catch { return ownStream(); }
}

let source = open();

// Hidden windows receive nothing.
function listen(again = false) {
  if (!document.hidden) source.follow(again);
}
export const reopen = () => listen(true);

// A window that becomes visible again is treated as newly opened.
function resume() {
  received();
  notify();
  listen();
}

addEventListener("pagehide", () => source.leave());
addEventListener("pageshow", event => { if (event.persisted) resume(); });
document.addEventListener("visibilitychange", () => document.hidden ? source.leave() : resume());
setInterval(() => listen(), REPORT_MS);

setInterval(() => {
  const lost = !document.hidden && Date.now() - state.received_ms > MAX_AGE_MS;
  if (lost !== state.lost) { state.lost = lost; notify(); }
}, 1000);

export function loggedIn() {
  state.login = false;
  received();
  listen(true);
  notify();
}

export function loggedOut() {
  source.leave();
  loginRequired();
}

// Subscribes to a robot in addition to the fleet.
export function follow(robot) {
  if (robot !== wanted) state.robot = null;
  wanted = robot;
  listen();
}

// Receives the live series of a tendon until the returned function is called.
export function followSeries(robot, joint, receive) {
  const own = series = { tendon: `${robot}/${joint}`, receive };
  listen();
  return () => {
    if (series !== own) return;
    series = null;
    listen();
  };
}

export function useLive() {
  const [, set] = useState(0);
  useEffect(() => {
    readers.add(set);
    return () => readers.delete(set);
  }, []);
  return state;
}
