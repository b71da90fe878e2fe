// All robots, the worst first.
import { useMemo, useState } from "preact/hooks";
import { count } from "./format.js";
import { CLASSES, LEVELS, Sign, WORDS, urgency } from "./signs.jsx";

// More robots than this are shown small, all but those that need somebody.
const MANY = 60;

function summary(rows) {
  const of = level => rows.filter(row => row.level === level).length;
  const words = {
    ERROR: n => `${count(n)} need${n === 1 ? "s" : ""} somebody`,
    WARN: n => `${count(n)} to look at`,
    STALE: n => `${count(n)} silent`,
    OK: n => `${count(n)} fine`,
  };
  return ["ERROR", "WARN", "STALE", "OK"].map(level => ({ level, n: of(level), text: words[level](of(level)) })).filter(part => part.n);
}

function Cell({ row, small }) {
  return (
    <li class={`cell ${CLASSES[row.level]} ${small ? "small" : ""}`}>
      <a href={`/r/${encodeURIComponent(row.robot)}`} title={small ? row.headline : undefined}>
        <span class="name"><Sign level={row.level} />{row.robot}</span>
        {!small && <span class="says">{row.headline}</span>}
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
    const fits = row => (!level || row.level === level) &&
      words.every(word => `${row.robot} ${row.robot_type} ${row.headline}`.toLowerCase().includes(word));
    const order = (a, b) => urgency(b.level) - urgency(a.level) || b.unacknowledged - a.unacknowledged ||
      a.robot.localeCompare(b.robot, undefined, { numeric: true });
    return all.filter(fits).sort(order);
  }, [live.fleet, search, level]);
  if (!live.fleet) return <p class="waits">Waits for the monitor …</p>;
  const parts = summary(all);
  const many = all.length > MANY;
  return (
    <>
      <h1 tabindex="-1">{all.length === 1 ? "1 robot" : `${count(all.length)} robots`}</h1>
      <div class="levels" role="group" aria-label="show only">
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
      {(live.fleet.doors ?? []).filter(door => door.shut).map(door => (
        <p key={door.door} class="banner alarm"><strong>{door.door} is shut:</strong> {door.shut}</p>
      ))}
      {(live.fleet.not_watched ?? []).map(robot => (
        <p key={robot.robot} class="banner alarm"><strong>{robot.robot} is not watched:</strong> {robot.why}</p>
      ))}
      <p><a href="/due">Which tendons pass a limit when</a></p>
      <ul class={`cells ${many ? "many" : ""}`}>
        {rows.map(row => <Cell key={row.robot} row={row} small={many && row.level !== "ERROR"} />)}
      </ul>
      {rows.length === 0 && <p>{all.length ? "No robot fits." : "No robot is configured."}</p>}
      <p class="legend" aria-hidden="true">
        {LEVELS.map(l => <span key={l}><Sign level={l} hidden />{WORDS[l]}</span>)}
      </p>
    </>
  );
}
