// Action buttons with their dialogs. An entry is shown once it is stored.
import { Fragment, h } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { command, mayOperate } from "./api.js";

const WHO = "sinew-who";

const SHELVES = [["1 hour", 3600], ["8 hours", 8 * 3600], ["1 day", 86400], ["7 days", 7 * 86400]];

// Findings of an inspection.
export const FINDINGS = {
  "strand-failure": "Strand or rope failed",
  slip: "Rope slipped",
  "clamp-slip": "Clamp slipped",
  "encoder-moved": "Encoder moved or homed again",
  nothing: "Nothing found",
  other: "Other (describe in the note)",
};

const KINDS = {
  tensioned: {
    past: "re-tensioned", button: "Record re-tensioning", title: "Record re-tensioning", does: "Save",
    explains: "Offsets are measured from now on. Move the arm as usual with an empty gripper until the new baseline is acquired.",
  },
  replaced: {
    past: "replaced", button: "Record replacement", title: "Record replacement", does: "Save",
    explains: "The age of the rope restarts at zero. Move the arm with an empty gripper until the new baseline is acquired.",
  },
  finding: {
    button: "Record finding", title: "Record finding", does: "Save",
    explains: "States what the inspection of the tendon found. A finding that needs no repair closes the incident.",
  },
  withdraw: {
    button: "Withdraw", title: "Withdraw entry", does: "Withdraw",
    explains: "Estimate, trend and alarms continue as if the work had not been recorded. The entry remains in the journal, struck through.",
  },
  correct: {
    button: "Correct", title: "Correct entry", does: "Save",
    explains: "The date lies between the last session before the entry and the entry. With other tendons, a new baseline is acquired: move the arm with an empty gripper.",
  },
  note: { button: "Add note", title: "Add note", does: "Save", note: true },
  acknowledge: {
    button: "Acknowledge", title: "Acknowledge", does: "Acknowledge",
    explains: "Shows other operators that the alarm is being handled. It remains until its condition clears.",
  },
  shelve: {
    button: "Shelve", title: "Shelve", does: "Shelve",
    explains: "Hides the alarm for a limited time. Errors remain visible in /diagnostics.",
  },
  unshelve: { button: "Unshelve", title: "Unshelve", does: "Unshelve" },
  reset: {
    button: "Reset", title: "Reset", does: "Reset", note: true,
    explains: "The condition has cleared without re-tensioning or replacement. State the reason in the note.",
  },
};

// Time as the value of a date input, in local time, and back.
const toInput = utc_s => new Date(1000 * (utc_s - 60 * new Date(1000 * utc_s).getTimezoneOffset())).toISOString().slice(0, 19);
const fromInput = text => new Date(text).getTime() / 1000;

// `joints`: selectable joints; `joint`: preselected joint; `alarm`: key of an alarm; `entry`: recorded maintenance.
export function Action({ kind, robot, joints, joint, alarm, entry }) {
  const [open, setOpen] = useState(false);
  const [confirmed, setConfirmed] = useState("");
  const { button } = KINDS[kind];
  if (!mayOperate()) return null;
  return (
    <>
      <button class="action" onClick={() => setOpen(true)}>{button}</button>
      {open && <Ask kind={kind} robot={robot} joints={joints} joint={joint} alarm={alarm} entry={entry} close={() => setOpen(false)} done={setConfirmed} />}
      <span class="confirmed" role="status">{confirmed}</span>
    </>
  );
}

function Ask({ kind, robot, joints = [], joint, alarm, entry, close, done }) {
  const { title, does, explains, note: always } = KINDS[kind];
  const dialog = useRef(null);
  const [who, setWho] = useState(() => localStorage.getItem(WHO) ?? "");
  const [note, setNote] = useState("");
  // Nothing is preselected where there is a choice: which tendon was worked on is known only to the person who did it.
  const [meant, setMeant] = useState(() => new Set(kind === "correct" ? entry.joints : joints.length === 1 ? joints : []));
  const [date, setDate] = useState(() => entry ? toInput(entry.time_utc_s) : "");
  const [shelf, setShelf] = useState(SHELVES[1][1]);
  const [finding, setFinding] = useState("");
  const noteNeeded = always || finding === "other";
  const [error, setError] = useState("");
  const [busy, setBusy] = useState(false);
  useEffect(() => { dialog.current.showModal(); }, []);
  const isWork = kind === "tensioned" || kind === "replaced";
  const choose = (isWork || kind === "correct") && joints.length > 1;
  const named = joints.filter(name => meant.has(name)).join(", ");
  const toggle = name => setMeant(old => {
    const next = new Set(old);
    if (!next.delete(name)) next.add(name);
    return next;
  });
  const what = () => {
    if (isWork) return { kind, joints: joints.filter(name => meant.has(name)) };
    if (kind === "note") return { kind };
    if (kind === "withdraw") return { kind, entry: entry.number };
    if (kind === "correct") {
      // The input has whole seconds; an unchanged date is exact.
      const time_utc_s = date === toInput(entry.time_utc_s) ? entry.time_utc_s : fromInput(date);
      return { kind, entry: entry.number, joints: joints.filter(name => meant.has(name)), time_utc_s };
    }
    if (kind === "finding") return { kind, joint, finding };
    return kind === "shelve" ? { kind, alarm, for_s: shelf } : { kind, alarm };
  };
  const submit = async event => {
    event.preventDefault();
    if ((isWork || kind === "correct") && meant.size === 0) { setError("Select at least one tendon."); return; }
    setBusy(true);
    try {
      localStorage.setItem(WHO, who);
      await command(robot, who.trim(), note.trim(), what());
      if (isWork) done(`Recorded: ${KINDS[kind].past} ${named} of ${robot}.`);
      dialog.current.close();
    } catch (failure) {
      setError(failure.message);
      setBusy(false);
    }
  };
  const of = joint ? `${joint} of ${robot}` : robot;
  return (
    <dialog ref={dialog} onClose={close} aria-labelledby="ask">
      <form onSubmit={submit}>
        <h2 id="ask">{title}</h2>
        <p class="of">{of}</p>
        {explains && <p>{explains}</p>}
        {choose && (
          <fieldset>
            <legend>Tendons</legend>
            <label><input type="checkbox" checked={meant.size === joints.length}
              onChange={() => setMeant(new Set(meant.size === joints.length ? [] : joints))} /> <em>all {joints.length}</em></label>
            {joints.map(name => (
              <label key={name}><input type="checkbox" checked={meant.has(name)} onChange={() => toggle(name)} /> {name}</label>
            ))}
          </fieldset>
        )}
        {kind === "correct" && (
          <label>Date of the work (local time) <input type="datetime-local" step="1" required value={date} onInput={event => setDate(event.target.value)} /></label>
        )}
        {kind === "shelve" && (
          <label>Duration <select value={shelf} onChange={event => setShelf(Number(event.target.value))}>
            {SHELVES.map(([name, s]) => <option key={s} value={s}>{name}</option>)}
          </select></label>
        )}
        {kind === "finding" && (
          <label>Finding <select value={finding} required onChange={event => setFinding(event.target.value)}>
            <option value="">Select …</option>
            {Object.entries(FINDINGS).map(([name, text]) => <option key={name} value={name}>{text}</option>)}
          </select></label>
        )}
        <label>Name <input value={who} required maxlength="100" autocomplete="name" onInput={event => setWho(event.target.value)} /></label>
        <label>{noteNeeded ? "Note" : "Note (optional)"}
          <textarea rows="3" value={note} required={noteNeeded} maxlength="2000" onInput={event => setNote(event.target.value)} /></label>
        {error && <p class="error" role="alert">{error}</p>}
        <p class="buttons">
          <button type="button" onClick={() => dialog.current.close()}>Cancel</button>
          <button class="main" disabled={busy}>{busy ? "Saving …" : isWork && named ? `${does}: ${named}` : does}</button>
        </p>
      </form>
    </dialog>
  );
}

// Actions available for an alarm in its present state.
export function AlarmActions({ view }) {
  const { alarm, robot } = view;
  const hasCleared = alarm.state === "latched" || alarm.state === "cleared";
  return (
    <span class="actions">
      {!alarm.acknowledged && <Action kind="acknowledge" robot={robot} joint={alarm.key.joint} alarm={alarm.key} />}
      {alarm.shelved_until_utc_s === null
        ? <Action kind="shelve" robot={robot} joint={alarm.key.joint} alarm={alarm.key} />
        : <Action kind="unshelve" robot={robot} joint={alarm.key.joint} alarm={alarm.key} />}
      {hasCleared && <Action kind="reset" robot={robot} joint={alarm.key.joint} alarm={alarm.key} />}
    </span>
  );
}
