// State of the monitor, updated every second. A slow browser skips updates; a lost connection is shown.
import { useEffect, useState } from "preact/hooks";
import { get, RequestError } from "./api.js";

// Time without an update after which values count as outdated, ms.
const MAX_AGE_MS = 5000;

const state = { fleet: null, robots: new Map(), robot: null, lost: false, received_ms: Date.now(), login: false };
const readers = new Set();
let source = null, wanted = null, version = 0;

function notify() {
  version += 1;
  for (const reader of readers) reader(version);
}

function received() {
  state.received_ms = Date.now();
  state.lost = false;
}

function update(fleet, whole) {
  received();
  if (whole) state.robots = new Map();
  for (const row of fleet.robots) state.robots.set(row.robot, row);
  for (const name of fleet.gone ?? []) state.robots.delete(name);
  state.fleet = fleet;
  notify();
}

// A browser opens at most six connections to a host for all tabs, and each visible page keeps one. Hidden pages disconnect,
// otherwise a seventh page would wait forever.
function rest() {
  source?.close();
  source = null;
}

function listen() {
  rest();
  if (document.hidden) return;
  const query = wanted ? `?robot=${encodeURIComponent(wanted)}` : "";
  const own = source = new EventSource(`/api/v1/events${query}`);
  source.addEventListener("fleet", event => update(JSON.parse(event.data), true));
  source.addEventListener("change", event => update(JSON.parse(event.data), false));
  source.addEventListener("robot", event => {
    received();
    state.robot = JSON.parse(event.data);
    notify();
  });
  source.addEventListener("error", async () => {
    // The browser reports no reason: the login has expired, or the monitor has stopped.
    try { await get(["fleet"]); }
    catch (error) { if (error instanceof RequestError && error.status === 401) { state.login = true; notify(); } }
    if (own === source && own.readyState === EventSource.CLOSED) setTimeout(() => { if (own === source) listen(); }, 2000);
  });
}

// A page that becomes visible again is treated as newly opened.
function resume() {
  received();
  notify();
  listen();
}

addEventListener("pagehide", rest);
addEventListener("pageshow", event => { if (event.persisted) resume(); });
document.addEventListener("visibilitychange", () => document.hidden ? rest() : resume());

setInterval(() => {
  const lost = !document.hidden && Date.now() - state.received_ms > MAX_AGE_MS;
  if (lost !== state.lost) { state.lost = lost; notify(); }
}, 1000);

export function loggedIn() {
  state.login = false;
  listen();
  notify();
}

// Subscribes to a robot in addition to the fleet.
export function follow(robot) {
  if (robot === wanted && source) return;
  wanted = robot;
  state.robot = null;
  listen();
}

export function useLive() {
  const [, set] = useState(0);
  useEffect(() => {
    readers.add(set);
    return () => readers.delete(set);
  }, []);
  return state;
}
