// One robot: its state and its tendons.
import { Fragment, h } from "preact";
import { Action } from "./actions.jsx";
import { AlarmList } from "./alarms.jsx";
import { Missing, useAnswer } from "./answer.jsx";
import { get } from "./api.js";
import { chance, count, day, dayAndTime, plusMinus, rounded, span, temperature, utc } from "./format.js";
import { CLASSES, Sign } from "./signs.jsx";

export const freshness = (freshness, rate_hz) => {
  if (freshness.kind === "never") return "No data received yet";
  if (freshness.kind === "stale") return `No data for ${span(freshness.for_s)}`;
  return `${rounded(rate_hz, 3)} frames per second`;
};

export const learning = (learning) => {
  if (learning.kind === "following") return "Acquired; tendons are tracked";
  if (learning.kind === "no-baseline") return "None: offsets relative to the encoder zero, wide intervals; select “Record re-tensioning” after tensioning";
  return `Acquiring (${learning.poses} of ${learning.poses_needed} poses, ${span(learning.duration_s)}); keep gripper empty`;
};

// Constant external force, for example of a hose or cable; included in the offsets.
export const pull = ({ probability, force_n, is_specified }) => {
  const [x, y, z] = force_n.map(along => plusMinus(along, 1));
  const origin = is_specified ? "specified" : `probability ${chance(probability)}`;
  return `(${x}, ${y}, ${z}) N in the base frame (${origin}); included in the offsets`;
};

const REASONS = {
  "no-data": "No data", starting: "Starting", "baseline-acquisition": "Acquiring baseline",
};
const INCONCLUSIVE = { "too-wide": "Inconclusive: interval too wide", "too-short": "Inconclusive: insufficient motion", rejected: "Inconclusive: data inconsistent with robot.toml" };
export const whyNot = reason => reason ? (reason.kind === "inconclusive" ? INCONCLUSIVE[reason.reason] : REASONS[reason.kind]) : "";
const PROVISIONAL = {
  starting: () => "converging",
  step: ({ probability }) => `suspected step change (probability ${chance(probability)})`,
  "change-near-end": () => "a change that may be an ongoing contact",
  rejected: ({ share }) => `${chance(share)} of the data are outliers`,
  "not-solved": () => "newest data inconsistent with the model",
};
// Reason for which the present offset of a tendon is not valid, and since when; empty: it is valid.
export function notValid({ validity, provisional, reason }) {
  if (validity.kind === "valid") return "";
  const why = provisional ? PROVISIONAL[provisional.reason](provisional) : whyNot(reason) || "no data";
  return `Not valid: ${why[0].toLowerCase()}${why.slice(1)}, for ${span(validity.for_s)}`;
}

export const whyNoOffset = reason => INCONCLUSIVE[reason] ?? "Inconclusive: not separable";

// Quantity of the limit as a share of it; null if not available.
function share(limit, elongation_m, strain_ratio) {
  const of = limit.kind === "retension" ? elongation_m : strain_ratio;
  const most = limit.kind === "retension" ? limit.elongation_m : limit.strain_ratio;
  return of && { mean: of.mean / most, half: 1.96 * of.std / most };
}

// Gauge of the used share of a limit; the value is shown as text next to it.
function Gauge({ share, level }) {
  const WIDTH = 120, FULL = 1.25, x = value => Math.min(Math.max(value / FULL, 0), 1) * WIDTH;
  const [low, high] = [x(share.mean - share.half), x(share.mean + share.half)];
  return (
    <svg class={`gauge ${CLASSES[level]}`} viewBox={`0 0 ${WIDTH} 16`} aria-hidden="true">
      <rect class="track" x="0" y="5" width={WIDTH} height="6" rx="3" />
      <rect class="fill" x="0" y="5" width={x(share.mean)} height="6" rx="3" />
      <rect class="interval" x={low} y="3" width={Math.max(high - low, 1)} height="10" rx="2" />
      <path class="limit" d={`M${x(1)} 0V16`} />
    </svg>
  );
}

function Tendon({ robot, tendon, text, old }) {
  const last = tendon.last;
  const lastOffset = last && last.offset_rad !== null ? { mean: last.offset_rad, std: last.offset_std_rad } : null;
  const limit = tendon.limits.find(limit => limit.kind === "retension") ?? tendon.limits[0];
  const gaussian = (mean, std) => mean === null || mean === undefined ? null : { mean, std };
  const way = limit && last && share(limit, gaussian(last.elongation_m, last.elongation_std_m), gaussian(last.strain_ratio, last.strain_std_ratio));
  return (
    <tr class={CLASSES[tendon.level]}>
      <th scope="row">
        <Sign level={tendon.level} />
        <a href={`/r/${encodeURIComponent(robot)}/${encodeURIComponent(tendon.joint)}`}>{tendon.joint}</a>
        <span class="detail">{text}</span>
      </th>
      <td data-name="Offset" class={tendon.offset_rad && !old ? "" : "none"}>
        {tendon.offset_rad && !old ? <>{plusMinus(tendon.offset_rad, 1e3)} <small>mrad</small>{notValid(tendon) && <small class="at">{notValid(tendon)}</small>}</> : whyNot(tendon.reason) || "No data"}
      </td>
      <td data-name="Last session">
        {last ? <>{lastOffset ? <>{plusMinus(lastOffset, 1e3)} <small>mrad</small></> : whyNoOffset(last.reason)}
          <small class="at"><time title={utc(last.time_utc_s)}>{dayAndTime(last.time_utc_s)}</time></small></> : "None"}
      </td>
      <td data-name="Limit used (%)">
        {way ? <><Gauge share={way} level={tendon.level} /><small class="at">{rounded(100 * way.mean, 2)} ± {rounded(100 * way.half, 2)} %</small></>
          : limit ? "–" : "No limit configured"}
      </td>
      <td data-name="Last tensioned">{tendon.tensioned_utc_s ? day(tendon.tensioned_utc_s) : "Not recorded"}</td>
    </tr>
  );
}

export function Robot({ name, live }) {
  const answer = useAnswer(name, "", () => get(["robots", name]));
  const now = live.robot?.robot?.robot === name ? live.robot : answer.value;
  if (!now) return <Missing answer={answer} title={name} what={name} />;
  const robot = now.robot;
  const joints = robot.tendons.map(tendon => tendon.joint);
  const old = live.lost || robot.freshness.kind !== "fresh";
  return (
    <>
      <p class="crumbs"><a href="/">Robots</a> ›</p>
      <h1 tabindex="-1">{name} <small>{robot.robot_type}</small></h1>
      <ul class="headlines"><li class={CLASSES[robot.level]}><Sign level={robot.level} />{now.sentence}</li></ul>
      {now.alarms.length > 0 && <section aria-label="alarms"><AlarmList alarms={now.alarms} named={false} /></section>}
      <section>
        <h2>Tendons</h2>
        <table class={`tendons ${old ? "old" : ""}`}>
          <thead><tr>
            <th scope="col">Joint</th><th scope="col">Offset</th><th scope="col">Last session</th><th scope="col">Limit used (%)</th><th scope="col">Last tensioned</th>
          </tr></thead>
          <tbody>
            {robot.tendons.map((tendon, i) => <Tendon key={tendon.joint} robot={name} tendon={tendon} text={now.tendons[i]?.sentence} old={old} />)}
          </tbody>
        </table>
        <p class="actions">
          <Action kind="tensioned" robot={name} joints={joints} />
          <Action kind="replaced" robot={name} joints={joints} />
          <Action kind="note" robot={name} />
          <a href={`/journal/${encodeURIComponent(name)}`}>Journal</a>
        </p>
      </section>
      <section>
        <h2>Data</h2>
        <table class="facts"><tbody>
          <tr><th scope="row">Last message</th><td class={robot.freshness.kind === "fresh" ? "" : "none"}>{freshness(robot.freshness, robot.rate_hz)}</td></tr>
          <tr><th scope="row">Source</th><td>{robot.source}</td></tr>
          <tr><th scope="row">Baseline</th><td>{learning(robot.learning)}</td></tr>
          <tr><th scope="row">Session</th><td>{robot.session
            ? `${span(robot.session.duration_s)} of motion since ${dayAndTime(robot.session.start_utc_s)}` : "None (at rest or no data)"}</td></tr>
          {robot.external_force && <tr><th scope="row">External force</th><td>{pull(robot.external_force)}</td></tr>}
          <tr><th scope="row">Temperature</th><td>{temperature(robot)}</td></tr>
          <tr><th scope="row">Frames</th><td>{count(robot.frames)}, {count(robot.frames_lost)} lost or rejected</td></tr>
          <tr><th scope="row">Clock</th><td>{robot.clock === "utc" ? "Host" : robot.clock === "stamp"
            ? "Robot time is not real time; records excluded from trend" : "Clock step; records of this session excluded from trend"}</td></tr>
        </tbody></table>
      </section>
    </>
  );
}
