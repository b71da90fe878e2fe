// Event stream of the monitor with the merged state of the fleet; in a SharedWorker for all windows of a browser.
import { get, RequestError } from "./api.js";

// Pause before a stream that the browser has given up is opened again, ms.
const PAUSE_MS = 2000;

export class Stream {
  #send; #source = null; #query = ""; #rows = new Map(); #fleet = null;

  // `send` receives the kind of an event with its data: "fleet" (all robots), "change", "robot", "live", "login".
  constructor(send) { this.#send = send; }

  // All robots as last received; null before.
  whole() { return this.#fleet && { ...this.#fleet, robots: [...this.#rows.values()], gone: [] }; }

  close() {
    this.#source?.close();
    this.#source = null;
  }

  // Receives the states of these robots and the live series of these tendons in addition to the fleet.
  follow(robots, live, again = false) {
    const list = names => [...new Set(names)].sort().join(",");
    const query = new URLSearchParams({ robot: list(robots), live: list(live) }).toString();
    if (!again && this.#source && query === this.#query) return;
    this.close();
    this.#query = query;
    const own = this.#source = new EventSource(`/api/v1/events?${query}`);
    own.addEventListener("fleet", event => this.#merge("fleet", JSON.parse(event.data)));
    own.addEventListener("change", event => this.#merge("change", JSON.parse(event.data)));
    for (const kind of ["robot", "live"]) own.addEventListener(kind, event => this.#send(kind, JSON.parse(event.data)));
    own.addEventListener("error", async () => {
      // The browser reports no reason: the login has ended, or the monitor has stopped.
      try { await get(["fleet"]); }
      catch (error) { if (error instanceof RequestError && error.status === 401) this.#send("login", null); }
      if (own !== this.#source || own.readyState !== EventSource.CLOSED) return;
      setTimeout(() => { if (own === this.#source) this.follow(robots, live, true); }, PAUSE_MS);
    });
  }

  #merge(kind, fleet) {
    if (kind === "fleet") this.#rows = new Map();
    for (const row of fleet.robots) this.#rows.set(row.robot, row);
    for (const name of fleet.gone ?? []) this.#rows.delete(name);
    this.#fleet = fleet;
    this.#send(kind, fleet);
  }
}
