// Maintenance forecast: tendons of all robots by the week of limit exceedance.
import { Fragment, h } from "preact";
import { useState } from "preact/hooks";
import { Missing, Outdated, useAnswer } from "./answer.jsx";
import { get } from "./api.js";
import { chance, count, day, plusMinus, span, utc } from "./format.js";
import { Sign } from "./signs.jsx";
import { limitName } from "./tendon.jsx";
import { WEEK_S, byWeek, weekName } from "./weeks.js";

const WITHIN = [[2, "2 weeks"], [4, "4 weeks"], [8, "8 weeks"], [26, "26 weeks"], [52, "1 year"]];
const DEFAULT_WEEKS = 8;

const tendons = n => n === 1 ? "1 tendon" : `${count(n)} tendons`;
export const VERDICTS = { inspect: "step change: inspect first", watch: "suspected step change" };

// Quantity of the limit at the last session.
export function valueOf(tendon) {
  if (tendon.limit.kind === "replace" && tendon.strain_ratio) return `${plusMinus(tendon.strain_ratio, 100)} %`;
  if (tendon.limit.kind === "retension" && tendon.elongation_m) return `${plusMinus(tendon.elongation_m, 1e3)} mm`;
  return `${plusMinus(tendon.offset_rad, 1e3)} mrad`;
}

const inDays = after_s => after_s < 86400 ? "within a day" : `in ${Math.round(after_s / 86400)} days`;

function when(tendon) {
  const { after_s, at_utc_s } = tendon;
  if (tendon.state === "passed") return `exceeded (probability ${chance(tendon.passed_probability)})`;
  if (after_s === null) return "beyond the forecast horizon";
  return after_s < 0 ? `median ${span(-after_s)} ago` : `${day(at_utc_s)}, ${inDays(after_s)}`;
}

// Date of the work as in the calendar (src/web/calendar.rs): the median, else the lower end of the interval, at the earliest today.
export const dueAt = ({ at_utc_s, at_low_utc_s }, now_utc_s) => Math.max(at_utc_s ?? at_low_utc_s ?? now_utc_s, now_utc_s);

// No interval for an exceeded limit: its date is not estimated.
export function interval(tendon) {
  if (tendon.state === "passed") return null;
  const low = tendon.after_low_s < 0 ? "already exceeded" : day(tendon.at_low_utc_s);
  const high = tendon.at_high_utc_s === null ? "beyond the forecast horizon" : day(tendon.at_high_utc_s);
  return `95 %: ${low} to ${high}`;
}

// Cell with a value and a detail below it.
const Cell = ({ name, below, children }) => (
  <td data-name={name}><span>{children}{below && <small class="at">{below}</small>}</span></td>
);

function Row({ tendon, until }) {
  const { robot, joint, sessions } = tendon;
  return (
    <tr>
      <th scope="row">
        <a href={`/r/${encodeURIComponent(robot)}/${encodeURIComponent(joint)}`}>{robot}, {joint}</a>
        {tendon.rope && <span class="detail">{tendon.rope}</span>}
      </th>
      <Cell name="Action" below={VERDICTS[tendon.verdict]}>{limitName(tendon.limit)}</Cell>
      <Cell name="Last value" below={<time title={utc(tendon.last_utc_s)}>{day(tendon.last_utc_s)}</time>}>
        <span class="whole">{valueOf(tendon)}</span></Cell>
      <Cell name="Limit reached" below={interval(tendon)}>{when(tendon)}</Cell>
      <Cell name={`Reached by ${until}`}>{tendon.until_probability === null ? "not available" : chance(tendon.until_probability)}</Cell>
      <Cell name="Based on" below={`since ${day(tendon.first_utc_s)}`}>{sessions === 1 ? "1 session" : `${count(sessions)} sessions`}</Cell>
    </tr>
  );
}

function Group({ what, list, until, rows }) {
  const from = list.time_utc_s + WEEK_S * what;
  const title = what === "passed" ? "Limit exceeded" : what === "perhaps" ? `Possible by ${until}, median later` : weekName(what);
  return (
    <tbody>
      <tr class="week"><th scope="rowgroup" colspan="6"><h2>{what === "passed" && <Sign level="ERROR" />}{title}{" "}
        {Number.isInteger(what) && <small>{day(from)} to {day(Math.min(from + WEEK_S, list.until_utc_s))}</small>}</h2></th></tr>
      {rows.map(tendon => <Row key={`${tendon.robot}/${tendon.joint}`} tendon={tendon} until={until} />)}
    </tbody>
  );
}

// Numbers of tendons with the median, or only the lower end of the interval, within the time range; else the reason for none.
function title(list, groups) {
  if (groups.length === 0) {
    if (list.not_due > 0) return "No maintenance due";
    if (list.inconclusive > 0) return "Insufficient data";
    return list.without_limit > 0 ? "No limit configured" : "No robot monitored";
  }
  const of = holds => groups.reduce((sum, [what, rows]) => sum + (holds(what) ? rows.length : 0), 0);
  const likely = of(what => what !== "perhaps"), perhaps = of(what => what === "perhaps");
  if (likely === 0) return `${tendons(perhaps)} possibly due`;
  return `${tendons(likely)} due${perhaps === 0 ? "" : `, ${count(perhaps)} more possibly due`}`;
}

// Tendons that are not listed, with the reason.
export function others(list, until) {
  const { not_due, inconclusive, without_limit } = list;
  return [
    not_due > 0 && `${tendons(not_due)}: probability of exceeding a limit by ${until} below 2.5 %`,
    inconclusive > 0 && `${tendons(inconclusive)}: too few sessions for a forecast`,
    without_limit > 0 && `${tendons(without_limit)}: no limit configured; set retension_at_mm or replace_at_strain_percent in robot.toml`,
  ].filter(Boolean);
}

export function Due({ live }) {
  const [weeks, setWeeks] = useState(DEFAULT_WEEKS);
  // Trends change daily: loaded again once a minute of the monitor's time.
  const mark = Math.floor((live.fleet?.time_utc_s ?? 0) / 60);
  const answer = useAnswer(weeks, mark, () => get(["due"], { within_days: 7 * weeks }));
  const list = answer.value;
  if (!list) return <Missing answer={answer} title="Maintenance forecast" what="maintenance forecast" />;
  const until = day(list.until_utc_s);
  const groups = byWeek(list);
  const unmonitored = live.fleet?.not_watched?.length ?? 0;
  return (
    <>
      <p class="crumbs"><a href="/">Robots</a> ›</p>
      <h1 tabindex="-1">{title(list, groups)}</h1>
      <p class="filters"><label>Time range <select value={weeks} onChange={event => setWeeks(Number(event.target.value))}>
        {WITHIN.map(([value, name]) => <option key={value} value={value}>{name}</option>)}
      </select></label>, until {until} <span class="actions">
        <a download href={`/api/v1/due.ics?within_days=${7 * weeks}`}>Calendar (.ics)</a>
        <a href="/plan">Month plan for printing</a></span></p>
      <Outdated answer={answer} />
      {groups.length > 0 && (
        <table class="tendons due">
          <thead><tr>
            <th scope="col">Tendon</th><th scope="col">Action</th><th scope="col">Last value</th><th scope="col">Limit reached</th>
            <th scope="col">Reached by {until}</th><th scope="col">Based on</th>
          </tr></thead>
          {groups.map(([what, rows]) => <Group key={what} what={what} list={list} until={until} rows={rows} />)}
        </table>
      )}
      {others(list, until).map(sentence => <p key={sentence}>{sentence}</p>)}
      {unmonitored > 0 && <p>{unmonitored === 1 ? "1 robot" : `${count(unmonitored)} robots`} not monitored and not included</p>}
      <p class="criterion">A tendon is due if its limit is exceeded, or if the lower end of its 95 % interval is before {until}. Weeks refer to the
        median. Forecasts assume unchanged use and no failures.</p>
    </>
  );
}
