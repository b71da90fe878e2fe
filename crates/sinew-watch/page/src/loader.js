// Request whose answer is kept while it is loaded again, and that is repeated after a failure.

// Pauses between attempts after failures, ms: doubled each time.
const FIRST_PAUSE_MS = 2000, MAX_PAUSE_MS = 30_000;

export class Loader {
  #ask; #notify; #busy = false; #again = false; #ended = false; #pause_ms = FIRST_PAUSE_MS; #timer = null;
  state = { value: null, error: null, at_ms: null };

  // `ask` returns the promise of an answer; `notify` receives the state after each attempt.
  constructor(ask, notify) { this.#ask = ask; this.#notify = notify; }

  // Loads, or loads once more when the present request is answered: its answer is never discarded, otherwise frequent
  // changes would leave the page without any.
  async load() {
    clearTimeout(this.#timer);
    if (this.#busy) { this.#again = true; return; }
    this.#busy = true;
    do {
      this.#again = false;
      try {
        const value = await this.#ask();
        this.#pause_ms = FIRST_PAUSE_MS;
        this.state = { value, error: null, at_ms: Date.now() };
      } catch (error) {
        this.state = { ...this.state, error };
        if (!this.#ended && !this.#again) {
          this.#timer = setTimeout(() => this.load(), this.#pause_ms);
          this.#pause_ms = Math.min(2 * this.#pause_ms, MAX_PAUSE_MS);
        }
      }
      if (this.#ended) return;
      this.#notify(this.state);
    } while (this.#again);
    this.#busy = false;
  }

  end() {
    this.#ended = true;
    clearTimeout(this.#timer);
  }
}
