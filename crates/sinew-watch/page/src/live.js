// What the monitor says every second. A browser that is slow skips ticks; one that is cut off says so.
import { useEffect, useState } from "preact/hooks";
import { get, Refused } from "./api.js";

// Without a word for so long the numbers are old, ms.
const SILENT_MS = 5000;

const state = { fleet: null, robots: new Map(), robot: null, lost: false, heard: Date.now(), login: false };
const readers = new Set();
let source = null, wanted = null, told = 0;

function tell() {
  told += 1;
  for (const reader of readers) reader(told);
}

function hear() {
  state.heard = Date.now();
  state.lost = false;
}

function take(fleet, whole) {
  hear();
  if (whole) state.robots = new Map();
  for (const row of fleet.robots) state.robots.set(row.robot, row);
  for (const name of fleet.gone ?? []) state.robots.delete(name);
  state.fleet = fleet;
  tell();
}

// A browser opens six connections to a monitor, for all its tabs together, and a page that listens holds one. So a page that
// nobody sees listens to nothing: else the seventh waits without end.
function rest() {
  source?.close();
  source = null;
}

function listen() {
  rest();
  if (document.hidden) return;
  const query = wanted ? `?robot=${encodeURIComponent(wanted)}` : "";
  const own = source = new EventSource(`/api/v1/events${query}`);
  source.addEventListener("fleet", event => take(JSON.parse(event.data), true));
  source.addEventListener("change", event => take(JSON.parse(event.data), false));
  source.addEventListener("robot", event => {
    hear();
    state.robot = JSON.parse(event.data);
    tell();
  });
  source.addEventListener("error", async () => {
    // A browser doesn't say why: a login that has ended, or a monitor that has.
    try { await get(["fleet"]); }
    catch (error) { if (error instanceof Refused && error.status === 401) { state.login = true; tell(); } }
    if (own === source && own.readyState === EventSource.CLOSED) setTimeout(() => { if (own === source) listen(); }, 2000);
  });
}

// What is seen again has the time of a page that has just begun.
function resume() {
  hear();
  tell();
  listen();
}

addEventListener("pagehide", rest);
addEventListener("pageshow", event => { if (event.persisted) resume(); });
document.addEventListener("visibilitychange", () => document.hidden ? rest() : resume());

setInterval(() => {
  const lost = !document.hidden && Date.now() - state.heard > SILENT_MS;
  if (lost !== state.lost) { state.lost = lost; tell(); }
}, 1000);

export function loggedIn() {
  state.login = false;
  listen();
  tell();
}

// Listens to a robot beside the fleet.
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
