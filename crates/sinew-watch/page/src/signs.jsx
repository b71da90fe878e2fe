// Icon for every level, so that colour is never the only distinction; shapes as in reports (crates/sinew-figure/src/page.rs).
import { Fragment, h } from "preact";

const SHAPES = {
  OK: "M2 8.5 6 12.5 14 3.5",
  WARN: "M8 2 15 14H1zM8 6.5v3.5M8 12v.1",
  ERROR: "M5 1h6l4 4v6l-4 4H5l-4-4V5zM8 4.5v4M8 11.5v.1",
  STALE: "M8 1.5a6.5 6.5 0 1 1-6.5 6.5M8 4.5V8l2.5 2",
};
export const CLASSES = { OK: "good", WARN: "watch", ERROR: "alarm", STALE: "stale" };
export const WORDS = { OK: "OK", WARN: "Warning", ERROR: "Action required", STALE: "No data" };
// Most urgent first.
export const LEVELS = ["ERROR", "STALE", "WARN", "OK"];
export const urgency = level => LEVELS.length - LEVELS.indexOf(level);

// The word is read by screen readers.
export function Sign({ level, hidden = false }) {
  return (
    <>
      <svg class={`sign ${CLASSES[level]}`} viewBox="0 0 16 16" aria-hidden="true"><path d={SHAPES[level]} /></svg>
      {!hidden && <span class="visually-hidden">{WORDS[level]}: </span>}
    </>
  );
}
