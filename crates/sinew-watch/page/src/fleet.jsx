// All robots, the most urgent first.
import { Fragment, h } from "preact";
import { useMemo, useState } from "preact/hooks";
import { useAnswer } from "./answer.jsx";
import { get } from "./api.js";
import { count, day, plusMinus } from "./format.js";
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

// Time range and number of intervals of the small curve of a robot.
const SPARK_S = 90 * 86400, SPARK_INTERVALS = 30;
// Interval in which it is loaded again, s.
const SPARK_EVERY_S = 6 * 3600;

// Offsets of the last 90 days, without axes: the value is shown beside it.
function Spark({ robot, joint, now_utc_s }) {
  const from = SPARK_EVERY_S * Math.floor(now_utc_s / SPARK_EVERY_S) - SPARK_S;
  const answer = useAnswer(`${robot}/${joint}`, from, () =>
    get(["robots", robot, "tendons", joint, "series"], { from_utc_s: from, intervals: SPARK_INTERVALS }));
  const points = (answer.value?.points ?? []).filter(point => point.offset_rad !== null);
  if (points.length < 2) return <span class="spark" />;
  const WIDTH = 80, HEIGHT = 20;
  const offsets = points.map(point => point.offset_rad), [low, high] = [Math.min(...offsets), Math.max(...offsets)];
  const [first, last] = [points[0].time_utc_s, points.at(-1).time_utc_s];
  const x = t => 1 + (WIDTH - 2) * (t - first) / (last - first || 1), y = rad => HEIGHT - 2 - (HEIGHT - 4) * (rad - low) / (high - low || 1);
  const path = points.map((point, i) => `${i ? "L" : "M"}${x(point.time_utc_s).toFixed(1)} ${y(point.offset_rad).toFixed(1)}`).join("");
  return <svg class="spark" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} aria-hidden="true"><path d={path} /></svg>;
}

// In place of the date on which the limit is reached.
const DATES = {
  passed: ": exceeded", forecast: ": median date has passed", "not-before": ", date beyond the forecast horizon",
  "not-within-horizon": ", not reached within the forecast horizon", "too-few-sessions": ", too few sessions for a date", null: ", no forecast yet",
};

// Tendon nearest to its limit: value, share of the limit, course and date.
function Next({ row, now_utc_s }) {
  const { joint, limit, value, share, state, at_utc_s } = row.next;
  const isStrain = limit.kind === "replace";
  // The share has the relative uncertainty of the value.
  const used = plusMinus({ mean: share, std: Math.abs(share * value.std / value.mean) }, 100);
  const date = at_utc_s !== null && at_utc_s > now_utc_s ? `, limit about ${day(at_utc_s)}` : DATES[state] ?? "";
  return (
    <span class="next">
      <span>{joint}: {`${plusMinus(value, isStrain ? 100 : 1e3)}\u00a0${isStrain ? "%" : "mm"}`}</span>
      <Spark robot={row.robot} joint={joint} now_utc_s={now_utc_s} />
      <span>{used} % of limit{date}</span>
    </span>
  );
}

function Cell({ row, small, now_utc_s }) {
  return (
    <li class={`cell ${CLASSES[row.level]} ${small ? "small" : ""}`}>
      <a href={`/r/${encodeURIComponent(row.robot)}`} title={small ? row.headline : undefined}>
        <span class="name"><Sign level={row.level} />{row.robot}</span>
        {!small && <span class="detail">{row.headline}</span>}
        {!small && !row.next && <span class="next"><span>{row.tendons.length ? "No limit configured, or no session yet" : "No tendon"}</span></span>}
        {!small && row.next && <Next row={row} now_utc_s={now_utc_s} />}
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
        {rows.map(row => <Cell key={row.robot} row={row} small={many && row.level !== "ERROR"} now_utc_s={live.fleet.time_utc_s} />)}
      </ul>
      {rows.length === 0 && <p>{all.length ? "No matching robot" : "No robot configured"}</p>}
      <p class="legend" aria-hidden="true">
        {LEVELS.map(l => <span key={l}><Sign level={l} hidden />{WORDS[l]}</span>)}
      </p>
    </>
  );
}
