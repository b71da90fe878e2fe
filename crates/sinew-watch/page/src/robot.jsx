// One robot: what it is at, and its tendons.
import { useEffect, useState } from "preact/hooks";
import { Action } from "./actions.jsx";
import { AlarmList } from "./alarms.jsx";
import { get } from "./api.js";
import { chance, count, day, dayAndTime, plusMinus, rounded, span, temperature, utc } from "./format.js";
import { CLASSES, Sign } from "./signs.jsx";

export const freshness = (freshness, rate_hz) => {
  if (freshness.kind === "never") return "nothing received yet";
  if (freshness.kind === "stale") return `nothing received for ${span(freshness.for_s)}`;
  return `${rounded(rate_hz, 3)} frames per second`;
};

export const learning = (learning) => {
  if (learning.kind === "following") return "follows the tendons since their baseline";
  if (learning.kind === "no-baseline") return "no baseline yet: offsets are against the encoders' zero, and wide. Press “tensioned” after tensioning";
  return `learns a new baseline, with nothing in the gripper: ${span(learning.duration_s)} of motion, ${learning.poses} of ${learning.poses_needed} poses`;
};

// A hose or a cable: offsets hold it already.
export const pull = ({ probability, force_n, is_stated }) => {
  const [x, y, z] = force_n.map(along => plusMinus(along, 1));
  const sure = is_stated ? "as stated" : `${chance(probability)} likely`;
  return `a constant force of ${x}, ${y}, ${z} N along x, y, z of the base, ${sure}: a hose, a cable, a balancer. Offsets hold it`;
};

const WHY = {
  "no-data": "no data", starting: "the estimate begins", "learns-baseline": "learns its baseline",
};
const WHY_NOT = { "too-wide": "too uncertain to tell", "too-short": "moved too little to tell", refused: "the data don't fit the robot" };
export const whyNot = reason => reason ? (reason.kind === "cannot-tell" ? WHY_NOT[reason.why] : WHY[reason.kind]) : "";
export const whyNoOffset = reason => WHY_NOT[reason] ?? "can't tell";

// What the limit is about, as a share of it; null where that is unknown.
function share(limit, elongation_m, strain_ratio) {
  const of = limit.kind === "retension" ? elongation_m : strain_ratio;
  const most = limit.kind === "retension" ? limit.elongation_m : limit.strain_ratio;
  return of && { mean: of.mean / most, half: 1.96 * of.deviation / most };
}

// How far a tendon is on the way to its limit: the number stands beside it in words.
function Gauge({ share, level }) {
  const WIDTH = 120, FULL = 1.25, x = value => Math.min(Math.max(value / FULL, 0), 1) * WIDTH;
  const [low, high] = [x(share.mean - share.half), x(share.mean + share.half)];
  return (
    <svg class={`gauge ${CLASSES[level]}`} viewBox={`0 0 ${WIDTH} 16`} aria-hidden="true">
      <rect class="track" x="0" y="5" width={WIDTH} height="6" rx="3" />
      <rect class="fill" x="0" y="5" width={x(share.mean)} height="6" rx="3" />
      <rect class="doubt" x={low} y="3" width={Math.max(high - low, 1)} height="10" rx="2" />
      <path class="limit" d={`M${x(1)} 0V16`} />
    </svg>
  );
}

function Tendon({ robot, tendon, said, old }) {
  const last = tendon.last;
  const lastOffset = last && last.offset_rad !== null ? { mean: last.offset_rad, deviation: last.offset_deviation_rad } : null;
  const limit = tendon.limits.find(limit => limit.kind === "retension") ?? tendon.limits[0];
  const known = (mean, deviation) => mean === null || mean === undefined ? null : { mean, deviation };
  const way = limit && last && share(limit, known(last.elongation_m, last.elongation_deviation_m), known(last.strain_ratio, last.strain_deviation_ratio));
  return (
    <tr class={CLASSES[tendon.level]}>
      <th scope="row">
        <Sign level={tendon.level} />
        <a href={`/r/${encodeURIComponent(robot)}/${encodeURIComponent(tendon.joint)}`}>{tendon.joint}</a>
        <span class="says">{said}</span>
      </th>
      <td data-name="now" class={tendon.offset_rad && !old ? "" : "none"}>
        {tendon.offset_rad && !old ? <>{plusMinus(tendon.offset_rad, 1e3)} <small>mrad{tendon.provisional && ", provisional"}</small></> : whyNot(tendon.reason) || "no data"}
      </td>
      <td data-name="last record">
        {last ? <>{lastOffset ? <>{plusMinus(lastOffset, 1e3)} <small>mrad</small></> : whyNoOffset(last.reason)}
          <small class="at"><time title={utc(last.time_utc_s)}>{dayAndTime(last.time_utc_s)}</time></small></> : "none yet"}
      </td>
      <td data-name="of its limit">
        {way ? <><Gauge share={way} level={tendon.level} /><small class="at">{rounded(100 * way.mean, 2)} ± {rounded(100 * way.half, 2)} %</small></>
          : limit ? "–" : "no limit in robot.toml"}
      </td>
      <td data-name="tensioned">{tendon.tensioned_utc_s ? day(tendon.tensioned_utc_s) : "nobody said"}</td>
    </tr>
  );
}

export function Robot({ name, live }) {
  const [missing, setMissing] = useState("");
  const now = live.robot?.robot?.robot === name ? live.robot : null;
  useEffect(() => { get(["robots", name]).catch(error => setMissing(error.message)); }, [name]);
  if (!now) return missing ? <><h1 tabindex="-1">{name}</h1><p class="refused">{missing}</p></> : <p class="waits">Waits for {name} …</p>;
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
            <th scope="col">joint</th><th scope="col">offset now</th><th scope="col">last record</th><th scope="col">of its limit</th><th scope="col">tensioned</th>
          </tr></thead>
          <tbody>
            {robot.tendons.map((tendon, i) => <Tendon key={tendon.joint} robot={name} tendon={tendon} said={now.tendons[i]?.sentence} old={old} />)}
          </tbody>
        </table>
        <p class="actions">
          <Action kind="tensioned" robot={name} joints={joints} />
          <Action kind="replaced" robot={name} joints={joints} />
          <Action kind="note" robot={name} />
          <a href={`/journal/${encodeURIComponent(name)}`}>its journal</a>
        </p>
      </section>
      <section>
        <h2>Data</h2>
        <table class="facts"><tbody>
          <tr><th scope="row">heard</th><td class={robot.freshness.kind === "fresh" ? "" : "none"}>{freshness(robot.freshness, robot.rate_hz)}</td></tr>
          <tr><th scope="row">from</th><td>{robot.source}</td></tr>
          <tr><th scope="row">learning</th><td>{learning(robot.learning)}</td></tr>
          <tr><th scope="row">session</th><td>{robot.session
            ? `in motion for ${span(robot.session.duration_s)}, since ${dayAndTime(robot.session.start_utc_s)}` : "none: it stands, or nothing is heard"}</td></tr>
          {robot.external_force && <tr><th scope="row">pulls at the tool</th><td>{pull(robot.external_force)}</td></tr>}
          <tr><th scope="row">temperature</th><td>{temperature(robot)}</td></tr>
          <tr><th scope="row">frames</th><td>{count(robot.frames)}, {count(robot.frames_lost)} lost or refused</td></tr>
          <tr><th scope="row">dates</th><td>{robot.clock === "utc" ? "by this computer's clock" : robot.clock === "stamp"
            ? "the robot's stamps don't run with time: its records are no part of a trend" : "the clock has stepped: the records of this session are no part of a trend"}</td></tr>
        </tbody></table>
      </section>
    </>
  );
}
