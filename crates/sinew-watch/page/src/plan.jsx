// Month plan for printing: maintenance of all robots by date, as in the calendar (.ics).
import { h } from "preact";
import { Missing, Outdated, useAnswer } from "./answer.jsx";
import { get } from "./api.js";
import { dueAt, interval, others, valueOf, VERDICTS } from "./due.jsx";
import { count, day, dayAndTime } from "./format.js";
import { limitName } from "./tendon.jsx";

const DAYS = 31;

// Groups of tendons with their date: exceeded limits, dates within the month, and dates that are only possible.
function groups(list) {
  const rows = list.due.map(tendon => ({ tendon, at_utc_s: dueAt(tendon, list.time_utc_s) }));
  rows.sort((a, b) => a.at_utc_s - b.at_utc_s || a.tendon.robot.localeCompare(b.tendon.robot, undefined, { numeric: true }));
  const isPassed = ({ tendon }) => tendon.state === "passed", isLater = ({ tendon, at_utc_s }) => tendon.at_utc_s === null || at_utc_s > list.until_utc_s;
  return [
    ["Limit exceeded: due now", rows.filter(isPassed)],
    ["Due by date", rows.filter(row => !isPassed(row) && !isLater(row))],
    [`Possible by ${day(list.until_utc_s)}, median later`, rows.filter(row => !isPassed(row) && isLater(row))],
  ].filter(([, rows]) => rows.length > 0);
}

function Row({ tendon, at_utc_s }) {
  const { robot, joint, rope, limit, verdict, state } = tendon;
  // Without a median, the date is the lower end of the interval.
  const isLow = tendon.at_utc_s === null && state !== "passed";
  return (
    <tr>
      <th scope="row"><span class="whole">{day(at_utc_s)}</span>{isLow && <small class="at">at the earliest</small>}<small class="at">{interval(tendon)}</small></th>
      <td data-name="Tendon"><span><a href={`/r/${encodeURIComponent(robot)}/${encodeURIComponent(joint)}`}>{robot}, {joint}</a>{rope && <small class="at">{rope}</small>}</span></td>
      <td data-name="Action"><span>{limitName(limit)}{VERDICTS[verdict] && <small class="at">{VERDICTS[verdict]}</small>}</span></td>
      <td data-name="Last value"><span class="whole">{valueOf(tendon)}</span></td>
      <td data-name="Done (date, name)" class="done"><i class="box" /></td>
    </tr>
  );
}

export function Plan({ live }) {
  const mark = Math.floor((live.fleet?.time_utc_s ?? 0) / 60);
  const answer = useAnswer("plan", mark, () => get(["due"], { within_days: DAYS }));
  const list = answer.value;
  if (!list) return <Missing answer={answer} title="Month plan" what="month plan" />;
  const until = day(list.until_utc_s), parts = groups(list);
  const unmonitored = live.fleet?.not_watched?.length ?? 0;
  return (
    <div class="plan">
      <p class="crumbs"><a href="/">Robots</a> › <a href="/due">Maintenance</a> ›</p>
      <h1 tabindex="-1">Month plan: {day(list.time_utc_s)} to {until}</h1>
      <p class="subtitle">{list.due.length === 1 ? "1 tendon" : `${count(list.due.length)} tendons`} of all monitored robots; as of {dayAndTime(list.time_utc_s)}</p>
      <p class="actions">
        <button class="main" disabled={parts.length === 0} onClick={() => print()}>Print</button>
        <a download href={`/api/v1/due.ics?within_days=${DAYS}`}>Calendar (.ics)</a>
      </p>
      <Outdated answer={answer} />
      {parts.length === 0 ? <p><strong>No maintenance due by {until}.</strong></p> : (
        <table class="tendons due">
          <thead><tr><th scope="col">Date</th><th scope="col">Tendon</th><th scope="col">Action</th><th scope="col">Last value</th><th scope="col">Done (date, name)</th></tr></thead>
          {parts.map(([title, rows]) => (
            <tbody key={title}>
              <tr class="week"><th scope="rowgroup" colspan="5"><h2>{title}</h2></th></tr>
              {rows.map(row => <Row key={`${row.tendon.robot}/${row.tendon.joint}`} {...row} />)}
            </tbody>
          ))}
        </table>
      )}
      {others(list, until).map(sentence => <p key={sentence}>{sentence}</p>)}
      {unmonitored > 0 && <p>{unmonitored === 1 ? "1 robot" : `${count(unmonitored)} robots`} not monitored and not included</p>}
      <p class="criterion">Dates are medians of the forecast with their 95 % intervals, or lower ends of intervals (“at the earliest”); intervals of values are 95 %. Forecasts assume unchanged use and no failures.</p>
    </div>
  );
}
