// Journal entries, the newest first.
import { useEffect, useState } from "preact/hooks";
import { get } from "./api.js";
import { dayAndTime, utc } from "./format.js";

const PAGE = 100;
const KINDS = [["", "all entries"], ["alarm", "alarms"], ["command", "operator entries"], ["session", "sessions"], ["baseline", "baselines"]];

export function Journal({ live, robot }) {
  const [entries, setEntries] = useState(null);
  const [kind, setKind] = useState("");
  const [of, setOf] = useState(robot ?? "");
  const [more, setMore] = useState(false);
  const load = async before => {
    const got = await get(["journal"], { robot: of, event: kind, before, most: PAGE });
    setMore(got.entries.length === PAGE);
    return got.entries;
  };
  useEffect(() => {
    let stale = false;
    load(null).then(first => { if (!stale) setEntries(first); }).catch(() => {});
    return () => { stale = true; };
  }, [kind, of]);
  const older = async () => {
    const next = await load(entries.at(-1).id);
    setEntries([...entries, ...next]);
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
      {entries?.length === 0 && <p>No entries</p>}
      <ol class="journal">
        {(entries ?? []).map(entry => (
          <li key={entry.id}>
            <time title={utc(entry.time_utc_s)}>{dayAndTime(entry.time_utc_s)}</time>
            <a href={`/r/${encodeURIComponent(entry.robot)}`}>{entry.robot}</a>
            <span>{entry.text}</span>
          </li>
        ))}
      </ol>
      {more && <button onClick={older}>Older</button>}
    </>
  );
}
