// Which tendons of all robots pass a limit when, by week.
import { useEffect, useState } from "preact/hooks";
import { get } from "./api.js";
import { chance, count, day, plusMinus, span, utc } from "./format.js";
import { Sign } from "./signs.jsx";
import { limitName } from "./tendon.jsx";
import { WEEK_S, byWeek, weekName } from "./weeks.js";

const WITHIN = [[2, "2 weeks"], [4, "4 weeks"], [8, "8 weeks"], [26, "half a year"], [52, "a year"]];
const USUAL = 8;

const tendons = n => n === 1 ? "1 tendon" : `${count(n)} tendons`;
const VERDICTS = { inspect: "it jumped: look at it first", watch: "a jump is suspected" };

// What counts for the limit, as it was at the last session.
function valueOf(tendon) {
  if (tendon.limit.kind === "replace" && tendon.strain_ratio) return `${plusMinus(tendon.strain_ratio, 100)} %`;
  if (tendon.limit.kind === "retension" && tendon.elongation_m) return `${plusMinus(tendon.elongation_m, 1e3)} mm`;
  return `${plusMinus(tendon.offset_rad, 1e3)} mrad`;
}

const inDays = after_s => after_s < 86400 ? "within a day" : `in ${Math.round(after_s / 86400)} days`;

function when(tendon) {
  const { after_s, at_utc_s } = tendon;
  if (tendon.state === "passed") return `passed, ${chance(tendon.passed_probability)} sure`;
  if (after_s === null) return "perhaps never";
  return after_s < 0 ? `likely passed ${span(-after_s)} ago` : `${day(at_utc_s)}, ${inDays(after_s)}`;
}

// When a limit was passed that is, isn't known.
function interval(tendon) {
  if (tendon.state === "passed") return null;
  const low = tendon.after_low_s < 0 ? "passed already" : day(tendon.at_low_utc_s);
  const high = tendon.at_high_utc_s === null ? "perhaps never" : day(tendon.at_high_utc_s);
  return `95 %: ${low} to ${high}`;
}

// A cell: what it says, and what that rests on below it.
const Cell = ({ name, below, children }) => (
  <td data-name={name}><span>{children}{below && <small class="at">{below}</small>}</span></td>
);

function Row({ tendon, until }) {
  const { robot, joint, sessions } = tendon;
  return (
    <tr>
      <th scope="row">
        <a href={`/r/${encodeURIComponent(robot)}/${encodeURIComponent(joint)}`}>{robot}, {joint}</a>
        {tendon.rope && <span class="says">{tendon.rope}</span>}
      </th>
      <Cell name="to do" below={VERDICTS[tendon.verdict]}>{limitName(tendon.limit)}</Cell>
      <Cell name="last known" below={<time title={utc(tendon.last_utc_s)}>{day(tendon.last_utc_s)}</time>}>
        <span class="whole">{valueOf(tendon)}</span></Cell>
      <Cell name="passes its limit" below={interval(tendon)}>{when(tendon)}</Cell>
      <Cell name={`passed by ${until}`}>{tendon.until_probability === null ? "not known" : chance(tendon.until_probability)}</Cell>
      <Cell name="rests on" below={`since ${day(tendon.first_utc_s)}`}>{sessions === 1 ? "1 session" : `${count(sessions)} sessions`}</Cell>
    </tr>
  );
}

function Group({ what, list, until, rows }) {
  const from = list.time_utc_s + WEEK_S * what;
  const title = what === "passed" ? "Limit passed" : what === "perhaps" ? `Perhaps by ${until}, likely later` : weekName(what);
  return (
    <tbody>
      <tr class="week"><th scope="rowgroup" colspan="6"><h2>{what === "passed" && <Sign level="ERROR" />}{title}{" "}
        {Number.isInteger(what) && <small>{day(from)} to {day(Math.min(from + WEEK_S, list.until_utc_s))}</small>}</h2></th></tr>
      {rows.map(tendon => <Row key={`${tendon.robot}/${tendon.joint}`} tendon={tendon} until={until} />)}
    </tbody>
  );
}

// Those whose median lies in the time asked for, and those of which the lower end alone does. Where there is none: why.
function title(list, groups) {
  if (groups.length === 0) {
    if (list.not_due > 0) return list.cannot_tell > 0 ? "No tendon is known to be due" : "No tendon is due";
    if (list.cannot_tell > 0) return "Nothing can be told yet";
    return list.without_limit > 0 ? "No tendon has a limit" : "No robot is watched";
  }
  const of = holds => groups.reduce((sum, [what, rows]) => sum + (holds(what) ? rows.length : 0), 0);
  const likely = of(what => what !== "perhaps"), perhaps = of(what => what === "perhaps");
  if (likely === 0) return `${tendons(perhaps)} may be due`;
  return `${tendons(likely)} ${likely === 1 ? "is" : "are"} due${perhaps === 0 ? "" : `, ${count(perhaps)} more may be`}`;
}

// Those that aren't listed, and why.
function others(list, until) {
  const { not_due, cannot_tell, without_limit } = list;
  return [
    not_due > 0 && `${tendons(not_due)} will hardly have passed a limit by ${until}: the chance is below 2.5 % for each.`,
    cannot_tell > 0 && `Of ${tendons(cannot_tell)} it can't be told yet: there are too few sessions for a forecast.`,
    without_limit > 0 && `${tendons(without_limit)} ${without_limit === 1 ? "has" : "have"} no limit: robot.toml needs retension_at_mm or replace_at_strain_percent.`,
  ].filter(Boolean);
}

export function Due({ live }) {
  const [weeks, setWeeks] = useState(USUAL);
  const [list, setList] = useState(null);
  const [missing, setMissing] = useState("");
  // Trends are of days: asked for anew once a minute of the monitor's time.
  const mark = Math.floor((live.fleet?.time_utc_s ?? 0) / 60);
  useEffect(() => {
    let over = false;
    get(["due"], { within_days: 7 * weeks }).then(got => { if (!over) { setList(got); setMissing(""); } })
      .catch(error => { if (!over) setMissing(error.message); });
    return () => { over = true; };
  }, [weeks, mark]);
  if (!list) return missing ? <><h1 tabindex="-1">Due</h1><p class="refused">{missing}</p></> : <p class="waits">Waits for the monitor …</p>;
  const until = day(list.until_utc_s);
  const groups = byWeek(list);
  const notWatched = live.fleet?.not_watched?.length ?? 0;
  return (
    <>
      <p class="crumbs"><a href="/">Robots</a> ›</p>
      <h1 tabindex="-1">{title(list, groups)}</h1>
      <p class="filters"><label>Within <select value={weeks} onChange={event => setWeeks(Number(event.target.value))}>
        {WITHIN.map(([value, name]) => <option key={value} value={value}>{name}</option>)}
      </select></label>, by {until}</p>
      {missing && <p class="refused">{missing}</p>}
      {groups.length > 0 && (
        <table class="tendons due">
          <thead><tr>
            <th scope="col">tendon</th><th scope="col">to do</th><th scope="col">last known</th><th scope="col">passes its limit</th>
            <th scope="col">passed by {until}</th><th scope="col">rests on</th>
          </tr></thead>
          {groups.map(([what, rows]) => <Group key={what} what={what} list={list} until={until} rows={rows} />)}
        </table>
      )}
      {others(list, until).map(sentence => <p key={sentence}>{sentence}</p>)}
      {notWatched > 0 && <p>{notWatched === 1 ? "1 robot isn't watched and isn't" : `${count(notWatched)} robots aren't watched and aren't`} counted.</p>}
      <p class="criterion">A tendon is due when its limit is passed, or when the lower end of its 95 % interval lies by {until}. Weeks are those of the
        median. Forecasts suppose that robots are used as before and that nothing fails.</p>
    </>
  );
}
