// Buttons, and the dialogs behind them. What somebody says is shown as said once it is stored.
import { useEffect, useRef, useState } from "preact/hooks";
import { command } from "./api.js";

const WHO = "sinew-who";

const SHELVES = [["1 hour", 3600], ["8 hours", 8 * 3600], ["1 day", 86400], ["7 days", 7 * 86400]];

const KINDS = {
  tensioned: {
    button: "tensioned", title: "Ropes were tensioned", does: "Tensioned",
    explains: "Offsets count from now on. Let the arm move as usual with nothing in the gripper: the new baseline is learned from that.",
  },
  replaced: {
    button: "replaced", title: "Ropes were replaced", does: "Replaced",
    explains: "The rope's life begins anew, and its baseline is learned anew with nothing in the gripper.",
  },
  note: { button: "note", title: "A note for the journal", does: "Write it down", note: true },
  acknowledge: {
    button: "acknowledge", title: "Acknowledge", does: "I have seen it",
    explains: "Others see that somebody knows. The alarm stays until its condition is over.",
  },
  shelve: {
    button: "shelve", title: "Shelve", does: "Shelve it",
    explains: "It is out of sight for a while, never for good. Errors stay visible in /diagnostics.",
  },
  unshelve: { button: "unshelve", title: "Unshelve", does: "Unshelve it" },
  reset: {
    button: "reset", title: "Reset", does: "Reset it", note: true,
    explains: "Its condition is over, and nobody tensioned or replaced the rope. Say why it is fine.",
  },
};

// `joints`: those to choose from; `joint`: the one meant; `alarm`: the key of an alarm.
export function Action({ kind, robot, joints, joint, alarm }) {
  const [open, setOpen] = useState(false);
  const { button } = KINDS[kind];
  return (
    <>
      <button class="action" onClick={() => setOpen(true)}>{button}</button>
      {open && <Ask kind={kind} robot={robot} joints={joints} joint={joint} alarm={alarm} close={() => setOpen(false)} />}
    </>
  );
}

function Ask({ kind, robot, joints = [], joint, alarm, close }) {
  const { title, does, explains, note: noteNeeded } = KINDS[kind];
  const dialog = useRef(null);
  const [who, setWho] = useState(() => localStorage.getItem(WHO) ?? "");
  const [note, setNote] = useState("");
  const [meant, setMeant] = useState(() => new Set(joint ? [joint] : joints));
  const [shelf, setShelf] = useState(SHELVES[1][1]);
  const [error, setError] = useState("");
  const [busy, setBusy] = useState(false);
  useEffect(() => { dialog.current.showModal(); }, []);
  const choose = joints.length > 0 && (kind === "tensioned" || kind === "replaced");
  const toggle = name => setMeant(old => {
    const next = new Set(old);
    if (!next.delete(name)) next.add(name);
    return next;
  });
  const what = () => {
    if (kind === "tensioned" || kind === "replaced") {
      return { kind, joints: meant.size === joints.length ? [] : [...meant] };
    }
    if (kind === "note") return { kind };
    return kind === "shelve" ? { kind, alarm, for_s: shelf } : { kind, alarm };
  };
  const submit = async event => {
    event.preventDefault();
    if (choose && meant.size === 0) { setError("choose at least one tendon"); return; }
    setBusy(true);
    try {
      localStorage.setItem(WHO, who);
      await command(robot, who.trim(), note.trim(), what());
      dialog.current.close();
    } catch (refused) {
      setError(refused.message);
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
            <legend>Which tendons?</legend>
            {joints.map(name => (
              <label key={name}><input type="checkbox" checked={meant.has(name)} onChange={() => toggle(name)} /> {name}</label>
            ))}
          </fieldset>
        )}
        {kind === "shelve" && (
          <label>For <select value={shelf} onChange={event => setShelf(Number(event.target.value))}>
            {SHELVES.map(([name, s]) => <option key={s} value={s}>{name}</option>)}
          </select></label>
        )}
        <label>Your name <input value={who} required maxlength="100" autocomplete="name" onInput={event => setWho(event.target.value)} /></label>
        <label>{noteNeeded ? "Note" : "Note (if you like)"}
          <textarea rows="3" value={note} required={noteNeeded} maxlength="2000" onInput={event => setNote(event.target.value)} /></label>
        {error && <p class="refused" role="alert">{error}</p>}
        <p class="buttons">
          <button type="button" onClick={() => dialog.current.close()}>Cancel</button>
          <button class="main" disabled={busy}>{busy ? "Is stored …" : does}</button>
        </p>
      </form>
    </dialog>
  );
}

// What can be done about an alarm now.
export function AlarmActions({ said }) {
  const { alarm, robot } = said;
  const over = alarm.state === "latched" || alarm.state === "cleared";
  return (
    <span class="actions">
      {!alarm.acknowledged && <Action kind="acknowledge" robot={robot} joint={alarm.key.joint} alarm={alarm.key} />}
      {alarm.shelved_until_utc_s === null
        ? <Action kind="shelve" robot={robot} joint={alarm.key.joint} alarm={alarm.key} />
        : <Action kind="unshelve" robot={robot} joint={alarm.key.joint} alarm={alarm.key} />}
      {over && <Action kind="reset" robot={robot} joint={alarm.key.joint} alarm={alarm.key} />}
    </span>
  );
}
