// All robots, the most urgent first.
import { useMemo, useState } from "preact/hooks";
import { count } from "./format.js";
import { CLASSES, LEVELS, Sign, WORDS, urgency } from "./signs.jsx";

// Number of robots above which only those with action required are shown in full size.
const MANY = 60;

function summary(rows) {
  const of = level => rows.filter(row => row.level === level).length;
  const words = {
    ERROR: n => `${count(n)} action required`,
    WARN: n => `${count(n)} warning${n === 1 ? "" : "s"}`,
    STALE: n => `${count(n)} without data`,
    OK: n => `${count(n)} OK`,
  };
  return ["ERROR", "WARN", "STALE", "OK"].map(level => ({ level, n: of(level), text: words[level](of(level)) })).filter(part => part.n);
}

function Cell({ row, small }) {
  return (
    <li class={`cell ${CLASSES[row.level]} ${small ? "small" : ""}`}>
      <a href={`/r/${encodeURIComponent(row.robot)}`} title={small ? row.headline : undefined}>
        <span class="name"><Sign level={row.level} />{row.robot}</span>
        {!small && <span class="detail">{row.headline}</span>}
        {!small && (
          <span class="joints" aria-hidden="true">
            {row.tendons.map(tendon => <i key={tendon.joint} class={CLASSES[tendon.level]} title={`${tendon.joint}: ${WORDS[tendon.level]}`} />)}
          </span>
        )}
      </a>
    </li>
  );
}

export function Fleet({ live }) {
  const [search, setSearch] = useState("");
  const [level, setLevel] = useState(null);
  const all = [...live.robots.values()];
  const rows = useMemo(() => {
    const words = search.toLowerCase().split(/\s+/).filter(Boolean);
    const matches = row => (!level || row.level === level) &&
      words.every(word => `${row.robot} ${row.robot_type} ${row.headline}`.toLowerCase().includes(word));
    const order = (a, b) => urgency(b.level) - urgency(a.level) || b.unacknowledged - a.unacknowledged ||
      a.robot.localeCompare(b.robot, undefined, { numeric: true });
    return all.filter(matches).sort(order);
  }, [live.fleet, search, level]);
  if (!live.fleet) return <p class="loading">Connecting to monitor …</p>;
  const parts = summary(all);
  const many = all.length > MANY;
  return (
    <>
      <h1 tabindex="-1">{all.length === 1 ? "1 robot" : `${count(all.length)} robots`}</h1>
      <div class="levels" role="group" aria-label="filter by level">
        {parts.map(part => (
          <button key={part.level} class={`level ${CLASSES[part.level]}`} aria-pressed={level === part.level}
            onClick={() => setLevel(level === part.level ? null : part.level)}>
            <Sign level={part.level} hidden />{part.text}
          </button>
        ))}
      </div>
      {all.length > 8 && (
        <label class="search">Find <input type="search" value={search} placeholder="robot, type, joint, alarm"
          onInput={event => setSearch(event.target.value)} /></label>
      )}
      {(live.fleet.transports ?? []).filter(transport => transport.shut).map(transport => (
        <p key={transport.transport} class="banner alarm"><strong>Transport {transport.transport} disconnected:</strong> {transport.shut}</p>
      ))}
      {(live.fleet.not_watched ?? []).map(robot => (
        <p key={robot.robot} class="banner alarm"><strong>{robot.robot} not monitored:</strong> {robot.reason}</p>
      ))}
      <p><a href="/due">Maintenance forecast</a></p>
      <ul class={`cells ${many ? "many" : ""}`}>
        {rows.map(row => <Cell key={row.robot} row={row} small={many && row.level !== "ERROR"} />)}
      </ul>
      {rows.length === 0 && <p>{all.length ? "No matching robot" : "No robot configured"}</p>}
      <p class="legend" aria-hidden="true">
        {LEVELS.map(l => <span key={l}><Sign level={l} hidden />{WORDS[l]}</span>)}
      </p>
    </>
  );
}
