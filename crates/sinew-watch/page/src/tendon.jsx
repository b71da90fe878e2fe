// One tendon: months of records, what happened, and the days to come.
import { useEffect, useState } from "preact/hooks";
import { Action } from "./actions.jsx";
import { AlarmList } from "./alarms.jsx";
import { get } from "./api.js";
import { Chart } from "./chart.jsx";
import { chance, day, dayAndTime, plusMinus, rounded, utc } from "./format.js";
import { whyNoOffset, whyNot } from "./robot.jsx";
import { CLASSES, Sign } from "./signs.jsx";

// The newest records that are drawn: a year of a session an hour.
const MOST = 9000;
const SHOWN = 200;

const days = s => `${Math.max(0, Math.round(s / 86400))} days`;

// The day a limit is passed, with its interval.
function passage(limit, last_utc_s) {
  const on = s => day(last_utc_s + s);
  if (limit.state === "passed") return `passed, ${chance(limit.passed_probability)} sure`;
  if (limit.state === "forecast") {
    const to = limit.after_high_s === null ? "perhaps never" : `to ${on(limit.after_high_s)}`;
    return `${on(limit.after_s)}, in ${days(limit.after_s)}; 95 %: ${on(limit.after_low_s)} ${to}`;
  }
  if (limit.state === "not-before") return `not before ${on(limit.after_low_s)}, perhaps never`;
  if (limit.state === "not-within-horizon") return "not as far as the forecast reaches";
  return "too few sessions to tell";
}

export const limitName = limit => limit.kind === "retension"
  ? `tension again at ${rounded(1e3 * limit.elongation_m, 3)}\u00a0mm` : `replace at ${rounded(100 * limit.strain_ratio, 3)}\u00a0% strain`;
const CAUSES = { "strand-failure": "a strand has failed: it is softer too", slip: "rope, clamp or encoder slipped: it is as stiff as before", unknown: "a strand failed or something slipped" };
const eventName = event => event.kind === "tensioned"
  ? (event.stated ? "tensioned" : "the offset fell: tensioned, and nobody said so?") : `jumped: ${CAUSES[event.cause]}`;

function basis(basis) {
  if (basis.kind === "rope") return `the law of ${basis.rope}; ${basis.guesses} of its ${basis.parameters} parameters are starting guesses`;
  const laws = basis.missing === "pretension" ? "the law of its rope under 1 to 8 % of the breaking load" : `the laws of all ${basis.ropes} ropes of the catalogue`;
  return `${laws}: robot.toml lacks the ${basis.missing} here`;
}

export function Tendon({ robot, joint, live }) {
  const [records, setRecords] = useState(null);
  const [now, setNow] = useState(null);
  const [missing, setMissing] = useState("");
  const of = live.robot?.robot?.robot === robot ? live.robot : null;
  const tendon = of?.robot.tendons.find(tendon => tendon.joint === joint) ?? now?.tendon;
  // Whatever is stored anew is shown anew.
  const mark = `${tendon?.last?.time_utc_s} ${tendon?.tensioned_utc_s} ${of?.trends}`;
  useEffect(() => {
    let over = false;
    const both = [get(["robots", robot, "tendons", joint]), get(["records"], { robot, joint, most: MOST })];
    Promise.all(both).then(([now, records]) => { if (!over) { setNow(now); setRecords(records.records); } })
      .catch(error => { if (!over) setMissing(error.message); });
    return () => { over = true; };
  }, [robot, joint, mark]);
  if (missing) return <><h1 tabindex="-1">{joint} of {robot}</h1><p class="refused">{missing}</p></>;
  if (!tendon || !now) return <p class="waits">Waits for {joint} of {robot} …</p>;
  const trend = now.trend;
  const said = of ? of.tendons.find(said => said.joint === joint)?.sentence : now.sentence;
  const alarms = (of ?? now).alarms.filter(said => said.alarm.key.joint === joint);
  const old = live.lost || (of && of.robot.freshness.kind !== "fresh");
  const newest = records.slice(-SHOWN).reverse();
  return (
    <>
      <p class="crumbs"><a href="/">Robots</a> › <a href={`/r/${encodeURIComponent(robot)}`}>{robot}</a> ›</p>
      <h1 tabindex="-1">{joint} <small>of {robot}</small></h1>
      <ul class="headlines"><li class={CLASSES[tendon.level]}><Sign level={tendon.level} />{said}</li></ul>
      {alarms.length > 0 && <section aria-label="alarms"><AlarmList alarms={alarms} named={false} /></section>}
      <section>
        <h2>Months</h2>
        {records.length === 0
          ? <p>No records yet. A session is recorded when ten minutes of motion are full, or the robot has stood for a minute.</p>
          : <Chart records={records} trend={trend} joint={joint} />}
      </section>
      <section>
        <table class="facts"><tbody>
          <tr><th scope="row">offset now</th><td class={tendon.offset_rad && !old ? "" : "none"}>
            {tendon.offset_rad && !old ? `${plusMinus(tendon.offset_rad, 1e3)} mrad${tendon.provisional ? ", provisional" : ""}` : whyNot(tendon.reason) || "no data"}</td></tr>
          {tendon.elongation_m && !old && <tr><th scope="row">stretch now</th><td>{plusMinus(tendon.elongation_m, 1e3)} mm</td></tr>}
          {tendon.strain_ratio && !old && <tr><th scope="row">strain since it was new</th><td>{plusMinus(tendon.strain_ratio, 100)} %</td></tr>}
          <tr><th scope="row">tensioned</th><td>{tendon.tensioned_utc_s ? dayAndTime(tendon.tensioned_utc_s) : "nobody said when"}</td></tr>
          {trend?.limits.map(limit => (
            <tr key={limit.kind}><th scope="row">{limitName(limit)}</th><td>{passage(limit, trend.last_utc_s)}</td></tr>
          ))}
          {tendon.limits.length === 0 && <tr><th scope="row">limit</th><td>none in robot.toml: add retension_at_mm or replace_at_strain_percent</td></tr>}
          {trend && <tr><th scope="row">forecast rests on</th><td>{trend.sessions} sessions and {basis(trend.basis)}</td></tr>}
        </tbody></table>
        <p class="actions">
          <Action kind="tensioned" robot={robot} joints={[joint]} joint={joint} />
          <Action kind="replaced" robot={robot} joints={[joint]} joint={joint} />
          <Action kind="note" robot={robot} joint={joint} />
        </p>
      </section>
      {trend?.events.length > 0 && (
        <section>
          <h2>What happened</h2>
          <ul class="events">
            {trend.events.slice().reverse().map(event => (
              <li key={event.time_utc_s}><time title={utc(event.time_utc_s)}>{day(event.time_utc_s)}</time> {eventName(event)}
                {event.size_rad && `, by ${plusMinus(event.size_rad, 1e3)} mrad`}</li>
            ))}
          </ul>
        </section>
      )}
      {newest.length > 0 && (
        <details>
          <summary>The last {newest.length} of {records.length} records as a table</summary>
          <div class="scroll"><table>
            <thead><tr><th scope="col">began</th><th scope="col">offset, mrad</th><th scope="col">stretch, mm</th><th scope="col">stiffness, %</th><th scope="col">°C</th><th scope="col">poses</th></tr></thead>
            <tbody>
              {newest.map(record => (
                <tr key={record.time_utc_s}>
                  <th scope="row"><time title={utc(record.time_utc_s)}>{dayAndTime(record.time_utc_s)}</time></th>
                  <td>{record.offset_rad === null ? whyNoOffset(record.reason) : plusMinus({ mean: record.offset_rad, deviation: record.offset_deviation_rad }, 1e3)}</td>
                  <td>{record.elongation_m === null ? "–" : plusMinus({ mean: record.elongation_m, deviation: record.elongation_deviation_m }, 1e3)}</td>
                  <td>{record.stiffness_ratio === null ? "–" : plusMinus({ mean: record.stiffness_ratio, deviation: record.stiffness_deviation_ratio }, 100)}</td>
                  <td>{record.temperature_c === null ? "–" : rounded(record.temperature_c, 3)}</td>
                  <td>{record.poses}</td>
                </tr>
              ))}
            </tbody>
          </table></div>
        </details>
      )}
      <p><a download href={`/api/v1/records.csv?robot=${encodeURIComponent(robot)}&joint=${encodeURIComponent(joint)}`}>Its records as CSV</a></p>
    </>
  );
}
