// Journal entries, the newest first.
import { Fragment, h } from "preact";
import { useState } from "preact/hooks";
import { Missing, Outdated, useAnswer } from "./answer.jsx";
import { get } from "./api.js";
import { dayAndTime, utc } from "./format.js";

const PAGE = 100;
const KINDS = [["", "all entries"], ["alarm", "alarms"], ["command", "operator entries"], ["session", "sessions"], ["baseline", "baselines"]];

export function Journal({ live, robot }) {
  const [kind, setKind] = useState("");
  const [of, setOf] = useState(robot ?? "");
  // Older pages, in the order in which they were loaded, of the selection `key`.
  const [older, setOlder] = useState({ key: null, pages: [], error: "" });
  const key = JSON.stringify([of, kind]);
  const load = before => get(["journal"], { robot: of, event: kind, before, most: PAGE });
  // Loaded again when an alarm has changed.
  const mark = [...live.robots.values()].map(row => `${row.robot}:${row.changed}`).join();
  const answer = useAnswer(key, mark, () => load(null));
  const first = answer.value?.entries ?? [];
  const kept = older.key === key ? older.pages : [];
  // The first page is kept with the older ones. If it is more than a page ago, entries between would be missing: they are
  // loaded again on demand.
  const newest = kept.length > 0 ? kept[0][0].id : -Infinity;
  const isWhole = first.length < PAGE || first.at(-1).id <= newest;
  const pages = isWhole ? kept : [];
  const entries = pages.length > 0 ? [...first.filter(entry => entry.id > newest), ...pages.flat()] : first;
  const last = pages.at(-1) ?? first, more = last.length === PAGE;
  const further = async () => {
    try {
      const { entries: next } = await load(entries.at(-1).id);
      setOlder({ key, pages: [...(pages.length ? pages : [first]), next], error: "" });
    } catch (error) { setOlder({ key, pages, error: error.message }); }
  };
  const names = [...live.robots.keys()].sort((a, b) => a.localeCompare(b, undefined, { numeric: true }));
  return (
    <>
      <h1 tabindex="-1">Journal</h1>
      <p class="filters">
        <label>Robot <select value={of} onChange={event => setOf(event.target.value)}>
          <option value="">all robots</option>
          {names.map(name => <option key={name}>{name}</option>)}
        </select></label>{" "}
        <label>Kind <select value={kind} onChange={event => setKind(event.target.value)}>
          {KINDS.map(([value, name]) => <option key={value} value={value}>{name}</option>)}
        </select></label>
      </p>
      {answer.value === null && <Missing answer={answer} what="journal" />}
      <Outdated answer={answer} />
      {answer.value !== null && entries.length === 0 && <p>No entries</p>}
      <ol class="journal">
        {entries.map(entry => (
          <li key={entry.id}>
            <time title={utc(entry.time_utc_s)}>{dayAndTime(entry.time_utc_s)}</time>
            <a href={`/r/${encodeURIComponent(entry.robot)}`}>{entry.robot}</a>
            {entry.correction?.withdrawn
              ? <span><s>{entry.text}</s> (withdrawn by {entry.correction.who}, {dayAndTime(entry.correction.time_utc_s)})</span>
              : <span>{entry.text}</span>}
          </li>
        ))}
      </ol>
      {older.key === key && older.error && <p class="error" role="alert">{older.error}</p>}
      {more && <button onClick={further}>Older</button>}
    </>
  );
}
