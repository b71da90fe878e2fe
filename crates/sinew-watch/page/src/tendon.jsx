// One tendon: trend of its records, events and forecast.
import { Fragment, h } from "preact";
import { useRef, useState } from "preact/hooks";
import { Action } from "./actions.jsx";
import { AlarmList } from "./alarms.jsx";
import { Missing, Outdated, useAnswer } from "./answer.jsx";
import { get } from "./api.js";
import { Chart } from "./chart.jsx";
import { chance, count, day, dayAndTime, plusMinus, rounded, span, utc } from "./format.js";
import { notValid, whyNoOffset, whyNot } from "./robot.jsx";
import { Incidents, Maintenance } from "./incident.jsx";
import { CLASSES, Sign } from "./signs.jsx";
import { Strip } from "./strip.jsx";

const MAX_ROWS = 200;

const days = s => `${Math.max(0, Math.round(s / 86400))} days`;

// Date of limit exceedance, with its interval.
function exceedance(limit, last_utc_s) {
  const on = s => day(last_utc_s + s);
  if (limit.state === "passed") return `Exceeded (probability ${chance(limit.passed_probability)})`;
  if (limit.state === "forecast") {
    const to = limit.after_high_s === null ? "to beyond the forecast horizon" : `to ${on(limit.after_high_s)}`;
    return `${on(limit.after_s)}, in ${days(limit.after_s)}; 95 %: ${on(limit.after_low_s)} ${to}`;
  }
  if (limit.state === "not-before") return `Not before ${on(limit.after_low_s)} (95 %)`;
  if (limit.state === "not-within-horizon") return "Not within the forecast horizon";
  return "Not predictable: too few sessions";
}

export const limitName = limit => limit.kind === "retension"
  ? `Re-tension at ${rounded(1e3 * limit.elongation_m, 3)}\u00a0mm` : `Replace at ${rounded(100 * limit.strain_ratio, 3)}\u00a0% strain`;
const CAUSES = { "strand-failure": "Strand failure (stiffness loss)", slip: "Slip of rope, clamp or encoder (no stiffness loss)", unknown: "Slip or strand failure (ambiguous)" };
const eventName = event => event.kind === "tensioned"
  ? (event.stated ? "Re-tensioned" : "Offset dropped: unrecorded re-tensioning?") : CAUSES[event.cause];

function basis(basis) {
  if (basis.kind === "rope") return `the creep law of ${basis.rope}; ${basis.assumed} of ${basis.parameters} parameters assumed`;
  const models = basis.missing === "pretension" ? "the creep law of its rope at 1 to 8 % of the breaking load" : `the creep laws of all ${basis.ropes} ropes of the catalogue`;
  return `${models}; ${basis.missing} not specified in robot.toml`;
}

// Time ranges of the chart: everything, the last year or month, and each calendar year with records.
function ranges(series) {
  const { first_utc_s, last_utc_s } = series;
  const names = [["all", "All", null, null]];
  if (first_utc_s === null) return names;
  const year = utc_s => new Date(1000 * utc_s).getUTCFullYear();
  if (last_utc_s - first_utc_s > 366 * 86400) names.push(["year", "Last 12 months", last_utc_s - 366 * 86400, null]);
  if (last_utc_s - first_utc_s > 31 * 86400) names.push(["month", "Last 31 days", last_utc_s - 31 * 86400, null]);
  for (let y = year(last_utc_s); year(first_utc_s) < year(last_utc_s) && y >= year(first_utc_s); y--) {
    names.push([String(y), String(y), Date.UTC(y, 0, 1) / 1000, Date.UTC(y + 1, 0, 1) / 1000]);
  }
  return names;
}

const ALL = { name: "all", from: null, to: null };

// Records over time, reduced by the monitor to what can be drawn, and loaded again for a selected time range.
function Trend({ robot, joint, trend, mark }) {
  const [range, setRange] = useState(ALL);
  const key = JSON.stringify([robot, joint, range]);
  const answer = useAnswer(key, mark, () =>
    get(["robots", robot, "tendons", joint, "series"], { from_utc_s: range.from, to_utc_s: range.to }));
  // Until another range is loaded, the present one remains.
  const shown = useRef(null);
  if (answer.value) shown.current = { series: answer.value, range };
  if (!shown.current) return <Missing answer={answer} what="records" />;
  const { series } = shown.current;
  if (series.first_utc_s === null) return <p>No records. A session is recorded after 10 min of motion, or after 1 min at rest.</p>;
  const names = ranges(series);
  const choose = name => {
    const [, , from, to] = names.find(([key]) => key === name);
    setRange({ name, from, to });
  };
  const isPast = shown.current.range.to !== null && shown.current.range.to < series.last_utc_s;
  return (
    <>
      <Outdated answer={answer} />
      {!answer.value && answer.error && <Missing answer={answer} />}
      <p class="filters">
        <label>Time range <select value={range.name} onChange={event => choose(event.target.value)}>
          {names.map(([value, name]) => <option key={value} value={value}>{name}</option>)}
          {range.name === "zoom" && <option value="zoom">{day(range.from)} to {day(range.to)}</option>}
        </select></label>{" "}
        <small>{!answer.value && !answer.error ? "Loading …" : <>{count(series.records)} records{series.inconclusive > 0 && `, ${count(series.inconclusive)} inconclusive`}
          {series.interval_s && `; minimum, maximum and last of every ${span(series.interval_s)}`}</>}</small>
      </p>
      {series.points.length === 0 ? <p>No records in this time range</p>
        : <Chart series={series} trend={trend} isPast={isPast} joint={joint}
          zoom={(from, to) => { if (series.interval_s) setRange({ name: "zoom", from, to }); }} reset={() => setRange(ALL)} />}
    </>
  );
}

// Table of the records, the newest first; older ones on demand.
function Records({ robot, joint, mark }) {
  const [open, setOpen] = useState(false);
  return (
    <details onToggle={event => setOpen(event.currentTarget.open)}>
      <summary>Table of records</summary>
      {open && <RecordTable robot={robot} joint={joint} mark={mark} />}
    </details>
  );
}

function RecordTable({ robot, joint, mark }) {
  const [before, setBefore] = useState([null]);
  const page = before.at(-1);
  // The newest page is loaded again with new records.
  const answer = useAnswer(page, page === null ? mark : "", () => get(["records"], { robot, joint, most: MAX_ROWS, before: page }));
  if (!answer.value) return <Missing answer={answer} what="records" />;
  const { records, older } = answer.value;
  const newest = records.slice().reverse();
  return (
    <>
      <Outdated answer={answer} />
      <div class="scroll"><table>
        <thead><tr><th scope="col">Start</th><th scope="col">Offset (mrad)</th><th scope="col">Elongation (mm)</th><th scope="col">Stiffness (%)</th><th scope="col">Temperature (°C)</th><th scope="col">Poses</th></tr></thead>
        <tbody>
          {newest.map(record => (
            <tr key={record.time_utc_s}>
              <th scope="row"><time title={utc(record.time_utc_s)}>{dayAndTime(record.time_utc_s)}</time></th>
              <td>{record.offset_rad === null ? whyNoOffset(record.reason) : plusMinus({ mean: record.offset_rad, std: record.offset_std_rad }, 1e3)}</td>
              <td>{record.elongation_m === null ? "–" : plusMinus({ mean: record.elongation_m, std: record.elongation_std_m }, 1e3)}</td>
              <td>{record.stiffness_ratio === null ? "–" : plusMinus({ mean: record.stiffness_ratio, std: record.stiffness_std_ratio }, 100)}</td>
              <td>{record.temperature_c === null ? "–" : rounded(record.temperature_c, 3)}</td>
              <td>{record.poses}</td>
            </tr>
          ))}
        </tbody>
      </table></div>
      <p class="actions">
        {older !== null && <button onClick={() => setBefore([...before, older])}>Older</button>}
        {before.length > 1 && <button onClick={() => setBefore(before.slice(0, -1))}>Newer</button>}
      </p>
    </>
  );
}

export function Tendon({ robot, joint, live }) {
  const of = live.robot?.robot?.robot === robot ? live.robot : null;
  const present = of?.robot.tendons.find(tendon => tendon.joint === joint);
  // Loaded again when new data have been stored.
  const mark = `${present?.last?.time_utc_s} ${present?.tensioned_utc_s} ${of?.trends}`;
  const key = JSON.stringify([robot, joint]);
  const answer = useAnswer(key, mark, () => get(["robots", robot, "tendons", joint]));
  const now = answer.value;
  const tendon = present ?? now?.tendon;
  if (!tendon || !now) return <Missing answer={answer} title={`${joint} of ${robot}`} what={`${joint} of ${robot}`} />;
  const trend = now.trend;
  const text = of ? of.tendons.find(view => view.joint === joint)?.sentence : now.sentence;
  const alarms = (of ?? now).alarms.filter(view => view.alarm.key.joint === joint);
  const old = live.lost || (of && of.robot.freshness.kind !== "fresh");
  return (
    <>
      <p class="crumbs"><a href="/">Robots</a> › <a href={`/r/${encodeURIComponent(robot)}`}>{robot}</a> ›</p>
      <h1 tabindex="-1">{joint} <small>of {robot}</small></h1>
      <Outdated answer={answer} />
      <ul class="headlines"><li class={CLASSES[tendon.level]}><Sign level={tendon.level} />{text}</li></ul>
      {alarms.length > 0 && <section aria-label="alarms"><AlarmList alarms={alarms} named={false} /></section>}
      <Incidents robot={robot} joint={joint} incidents={of?.robot.incidents ?? []} recordings={of?.recordings ?? []} />
      <section>
        <h2>Live</h2>
        <Strip robot={robot} joint={joint} tendon={tendon} isSilent={old} />
      </section>
      <section>
        <h2>Trend</h2>
        <Trend robot={robot} joint={joint} trend={trend} mark={mark} />
      </section>
      <section>
        <table class="facts"><tbody>
          <tr><th scope="row">Offset</th><td class={tendon.offset_rad && !old ? "" : "none"}>
            {tendon.offset_rad && !old ? `${plusMinus(tendon.offset_rad, 1e3)} mrad` : whyNot(tendon.reason) || "No data"}</td></tr>
          <tr><th scope="row">Validity</th><td>{live.lost ? "Not valid: disconnected" : notValid(tendon) || "Valid"}</td></tr>
          {tendon.elongation_m && !old && <tr><th scope="row">Elongation</th><td>{plusMinus(tendon.elongation_m, 1e3)} mm</td></tr>}
          {tendon.strain_ratio && !old && <tr><th scope="row">Total strain</th><td>{plusMinus(tendon.strain_ratio, 100)} %</td></tr>}
          <tr><th scope="row">Last tensioned</th><td>{tendon.tensioned_utc_s ? dayAndTime(tendon.tensioned_utc_s) : "Not recorded"}</td></tr>
          {trend?.limits.map(limit => (
            <tr key={limit.kind}><th scope="row">{limitName(limit)}</th><td>{exceedance(limit, trend.last_utc_s)}</td></tr>
          ))}
          {tendon.limits.length === 0 && <tr><th scope="row">Limit</th><td>No limit configured; set retension_at_mm or replace_at_strain_percent in robot.toml</td></tr>}
          {trend && <tr><th scope="row">Forecast based on</th><td>{trend.sessions} sessions and {basis(trend.basis)}</td></tr>}
        </tbody></table>
        <p class="actions">
          <Action kind="tensioned" robot={robot} joints={[joint]} joint={joint} />
          <Action kind="replaced" robot={robot} joints={[joint]} joint={joint} />
          <Action kind="note" robot={robot} joint={joint} />
        </p>
      </section>
      <Maintenance robot={robot} joint={joint} joints={of?.robot.tendons.map(one => one.joint) ?? [joint]} entries={of?.robot.maintenance ?? []} withdrawable={of?.robot.withdrawable} />
      {trend?.events.length > 0 && (
        <section>
          <h2>Events</h2>
          <ul class="events">
            {trend.events.slice().reverse().map(event => (
              <li key={event.time_utc_s}><time title={utc(event.time_utc_s)}>{day(event.time_utc_s)}</time> {eventName(event)}
                {event.size_rad && `: ${plusMinus(event.size_rad, 1e3)} mrad`}</li>
            ))}
          </ul>
        </section>
      )}
      <p><a href={`/compare?${new URLSearchParams({ tendon: `${robot}/${joint}` })}`}>Compare with other tendons</a></p>
      <Records key={key} robot={robot} joint={joint} mark={mark} />
      <p><a download href={`/api/v1/records.csv?robot=${encodeURIComponent(robot)}&joint=${encodeURIComponent(joint)}`}>Export records of this tendon: CSV</a></p>
    </>
  );
}
