// One tendon: trend of its records, events and forecast.
import { useEffect, useState } from "preact/hooks";
import { Action } from "./actions.jsx";
import { AlarmList } from "./alarms.jsx";
import { get } from "./api.js";
import { Chart } from "./chart.jsx";
import { chance, day, dayAndTime, plusMinus, rounded, utc } from "./format.js";
import { whyNoOffset, whyNot } from "./robot.jsx";
import { CLASSES, Sign } from "./signs.jsx";

// Maximum number of records in the chart: one year of hourly sessions.
const MAX_RECORDS = 9000;
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

export function Tendon({ robot, joint, live }) {
  const [records, setRecords] = useState(null);
  const [now, setNow] = useState(null);
  const [missing, setMissing] = useState("");
  const of = live.robot?.robot?.robot === robot ? live.robot : null;
  const tendon = of?.robot.tendons.find(tendon => tendon.joint === joint) ?? now?.tendon;
  // Loaded again when new data have been stored.
  const mark = `${tendon?.last?.time_utc_s} ${tendon?.tensioned_utc_s} ${of?.trends}`;
  useEffect(() => {
    let stale = false;
    const both = [get(["robots", robot, "tendons", joint]), get(["records"], { robot, joint, most: MAX_RECORDS })];
    Promise.all(both).then(([now, records]) => { if (!stale) { setNow(now); setRecords(records.records); } })
      .catch(error => { if (!stale) setMissing(error.message); });
    return () => { stale = true; };
  }, [robot, joint, mark]);
  if (missing) return <><h1 tabindex="-1">{joint} of {robot}</h1><p class="error">{missing}</p></>;
  if (!tendon || !now) return <p class="loading">Loading {joint} of {robot} …</p>;
  const trend = now.trend;
  const text = of ? of.tendons.find(view => view.joint === joint)?.sentence : now.sentence;
  const alarms = (of ?? now).alarms.filter(view => view.alarm.key.joint === joint);
  const old = live.lost || (of && of.robot.freshness.kind !== "fresh");
  const newest = records.slice(-MAX_ROWS).reverse();
  return (
    <>
      <p class="crumbs"><a href="/">Robots</a> › <a href={`/r/${encodeURIComponent(robot)}`}>{robot}</a> ›</p>
      <h1 tabindex="-1">{joint} <small>of {robot}</small></h1>
      <ul class="headlines"><li class={CLASSES[tendon.level]}><Sign level={tendon.level} />{text}</li></ul>
      {alarms.length > 0 && <section aria-label="alarms"><AlarmList alarms={alarms} named={false} /></section>}
      <section>
        <h2>Trend</h2>
        {records.length === 0
          ? <p>No records. A session is recorded after 10 min of motion, or after 1 min at rest.</p>
          : <Chart records={records} trend={trend} joint={joint} />}
      </section>
      <section>
        <table class="facts"><tbody>
          <tr><th scope="row">Offset</th><td class={tendon.offset_rad && !old ? "" : "none"}>
            {tendon.offset_rad && !old ? `${plusMinus(tendon.offset_rad, 1e3)} mrad${tendon.provisional ? ", provisional" : ""}` : whyNot(tendon.reason) || "No data"}</td></tr>
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
      {newest.length > 0 && (
        <details>
          <summary>Table of the last {newest.length} of {records.length} records</summary>
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
        </details>
      )}
      <p><a download href={`/api/v1/records.csv?robot=${encodeURIComponent(robot)}&joint=${encodeURIComponent(joint)}`}>Export records of this tendon: CSV</a></p>
    </>
  );
}
