// Incident of a tendon: phase, probabilities of the causes, evidence, finding and recording; and its recorded maintenance.
import { Fragment, h } from "preact";
import { Action, FINDINGS } from "./actions.jsx";
import { chance, dayAndTime, plusMinus, utc } from "./format.js";

const PHASES = {
  suspected: "Change suspected",
  confirmed: "Change confirmed: inspect the tendon",
  acknowledged: "Change confirmed and acknowledged",
  repaired: "Repaired; the finding is not recorded",
  closed: "Closed",
};

const CAUSES = {
  "strand-failure": "Strand failure",
  slip: "Slip of rope or clamp",
  encoder: "Slip of an encoder",
  "slip-or-encoder": "Slip of rope, clamp or encoder",
  "transmission-lost": "Transmission lost",
  retensioned: "Unrecorded re-tensioning",
  "no-change": "No lasting change",
};

const value = (x, scale) => x ? plusMinus(x, scale) : "–";

// One incident; `joint` is of the robot `robot`.
function Incident({ robot, joint, incident, recordings }) {
  const { number, phase, opened_utc_s, closed_utc_s, causes, evidence, finding, note } = incident;
  return (
    <>
      <p><strong>Incident {number}: {PHASES[phase]}.</strong> Opened <time title={utc(opened_utc_s)}>{dayAndTime(opened_utc_s)}</time>
        {closed_utc_s !== null && <>, closed <time title={utc(closed_utc_s)}>{dayAndTime(closed_utc_s)}</time></>}.
        {finding && ` Finding: ${FINDINGS[finding]}.`}{note && ` Note: ${note}`}</p>
      {causes.length > 0 && (
        <table class="facts"><tbody>
          {causes.map(({ cause, probability }) => (
            <tr key={cause}><th scope="row">{CAUSES[cause]}</th><td>probability {chance(probability)}</td></tr>
          ))}
        </tbody></table>
      )}
      {evidence.length > 0 && (
        <details>
          <summary>Evidence of {evidence.length} {evidence.length === 1 ? "session" : "sessions"}</summary>
          <div class="scroll"><table>
            <thead><tr><th scope="col">Time</th><th scope="col">Offset (mrad)</th><th scope="col">Stiffness (%)</th><th scope="col">Probability of a change</th></tr></thead>
            <tbody>
              {evidence.map(item => (
                <tr key={item.time_utc_s}>
                  <th scope="row"><time title={utc(item.time_utc_s)}>{dayAndTime(item.time_utc_s)}</time></th>
                  <td>{value(item.offset_rad, 1e3)}</td>
                  <td>{value(item.stiffness_ratio, 100)}</td>
                  <td>{chance(item.probability)}</td>
                </tr>
              ))}
            </tbody>
          </table></div>
        </details>
      )}
      {recordings.includes(number) && (
        <p><a download href={`/api/v1/robots/${encodeURIComponent(robot)}/incidents/${number}/recording.mcap`}>Recording around the change: MCAP</a></p>
      )}
      {phase !== "closed" && <p class="actions"><Action kind="finding" robot={robot} joint={joint} /></p>}
    </>
  );
}

// Incidents of a tendon, the newest first; none: nothing.
export function Incidents({ robot, joint, incidents, recordings }) {
  const own = incidents.filter(incident => incident.joint === joint).sort((a, b) => b.number - a.number);
  if (own.length === 0) return null;
  const [newest, ...earlier] = own;
  return (
    <section>
      <h2>Incident</h2>
      <Incident robot={robot} joint={joint} incident={newest} recordings={recordings} />
      {earlier.length > 0 && (
        <details>
          <summary>{earlier.length} earlier</summary>
          {earlier.map(incident => <Incident key={incident.number} robot={robot} joint={joint} incident={incident} recordings={recordings} />)}
        </details>
      )}
    </section>
  );
}

// Recorded re-tensionings and replacements of a tendon, the newest first; none: nothing. A withdrawn entry is struck through.
export function Maintenance({ robot, joint, joints, entries, withdrawable }) {
  const own = entries.filter(entry => entry.joints.includes(joint)).reverse();
  if (own.length === 0) return null;
  return (
    <section>
      <h2>Recorded maintenance</h2>
      <ul class="events">
        {own.map(entry => {
          const { number, time_utc_s, replaced, who, correction } = entry;
          const withdrawn = correction?.withdrawn;
          const text = <><time title={utc(time_utc_s)}>{dayAndTime(time_utc_s)}</time> {replaced ? "Replaced" : "Re-tensioned"} ({entry.joints.join(", ")}; recorded by {who})</>;
          return (
            <li key={number}>
              {withdrawn ? <s>{text}</s> : text}
              {correction && <> {withdrawn ? "withdrawn" : "corrected"} by {correction.who}, <time title={utc(correction.time_utc_s)}>{dayAndTime(correction.time_utc_s)}</time></>}
              {!withdrawn && (
                <span class="actions">
                  <Action kind="correct" robot={robot} joints={number === withdrawable ? joints : entry.joints} joint={joint} entry={entry} />
                  {number === withdrawable && <Action kind="withdraw" robot={robot} joint={joint} entry={entry} />}
                </span>
              )}
            </li>
          );
        })}
      </ul>
    </section>
  );
}
