// Incident of a tendon: phase, probabilities of the causes, evidence and finding.
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
function Incident({ robot, joint, incident }) {
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
      {phase !== "closed" && <p class="actions"><Action kind="finding" robot={robot} joint={joint} /></p>}
    </>
  );
}

// Incidents of a tendon, the newest first; none: nothing.
export function Incidents({ robot, joint, incidents }) {
  const own = incidents.filter(incident => incident.joint === joint).sort((a, b) => b.number - a.number);
  if (own.length === 0) return null;
  const [newest, ...earlier] = own;
  return (
    <section>
      <h2>Incident</h2>
      <Incident robot={robot} joint={joint} incident={newest} />
      {earlier.length > 0 && (
        <details>
          <summary>{earlier.length} earlier</summary>
          {earlier.map(incident => <Incident key={incident.number} robot={robot} joint={joint} incident={incident} />)}
        </details>
      )}
    </section>
  );
}
