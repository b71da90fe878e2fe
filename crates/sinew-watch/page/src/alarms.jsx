// Alarms of all robots, the most severe first.
import { Fragment, h } from "preact";
import { useState } from "preact/hooks";
import { AlarmActions } from "./actions.jsx";
import { Missing, Outdated, useAnswer } from "./answer.jsx";
import { similar } from "./similar.js";
import { get, mayOperate, testNotifications } from "./api.js";
import { count, dayAndTime, utc } from "./format.js";
import { CLASSES, Sign } from "./signs.jsx";

const STATES = {
  active: "active", acknowledged: "active, acknowledged", cleared: "cleared, unacknowledged", latched: "active, latched until repair or reset",
};

// Alarm with its text, recommended action and buttons.
export function AlarmLine({ view, named = true }) {
  const { alarm } = view;
  const of = alarm.key.joint ? `/r/${encodeURIComponent(view.robot)}/${encodeURIComponent(alarm.key.joint)}` : `/r/${encodeURIComponent(view.robot)}`;
  const shelved = alarm.shelved_until_utc_s;
  return (
    <li class={`${CLASSES[view.level]} ${alarm.acknowledged ? "seen" : ""}`}>
      <Sign level={view.level} />
      <div>
        <p class="title">{named && <><a href={of}>{view.robot}{alarm.key.joint && `, ${alarm.key.joint}`}</a>: </>}{view.title}</p>
        <p>{view.text}{view.advice && <> <strong>{view.advice}</strong></>}</p>
        <p class="state">
          {STATES[alarm.state]}{alarm.state === "latched" && alarm.acknowledged && ", acknowledged"} · severity {view.severity} ·
          since <time title={utc(alarm.raised_utc_s)}>{dayAndTime(alarm.raised_utc_s)}</time>
          {shelved !== null && <> · shelved until {dayAndTime(shelved)}</>}
        </p>
        <AlarmActions view={view} />
      </div>
    </li>
  );
}

const keyOf = view => `${view.robot}/${view.alarm.key.joint}/${view.alarm.key.condition}`;

// Group of similar alarms of several robots; single alarms on demand.
function Similar({ group }) {
  const [open, setOpen] = useState(false);
  const [first] = group;
  const three = group.slice(0, 3).map(view => [view.robot, view.alarm.key.joint].filter(Boolean).join(" "));
  return (
    <li class={`${CLASSES[first.level]} ${first.alarm.acknowledged ? "seen" : ""}`}>
      <Sign level={first.level} />
      <div>
        <p class="title">{count(group.length)} similar: {first.title}</p>
        <p>{first.text}{first.advice && <> <strong>{first.advice}</strong></>}</p>
        <details onToggle={event => setOpen(event.currentTarget.open)}>
          <summary>{three.join(", ")} and {count(group.length - 3)} more</summary>
          {open && <ul class="alarms">{group.map(view => <AlarmLine key={keyOf(view)} view={view} />)}</ul>}
        </details>
      </div>
    </li>
  );
}

// `named`: whether each alarm shows its robot.
export function AlarmList({ alarms, named = true }) {
  const groups = named ? similar(alarms) : alarms.map(view => [view]);
  return (
    <ul class="alarms">
      {groups.map(group => (group.length > 1
        ? <Similar key={`similar ${keyOf(group[0])}`} group={group} />
        : <AlarmLine key={keyOf(group[0])} view={group[0]} named={named} />))}
    </ul>
  );
}

// Sends a test notification to every configured receiver, and shows the results.
function TestNotifications() {
  const [said, setSaid] = useState("");
  const [busy, setBusy] = useState(false);
  const send = async () => {
    setBusy(true);
    try {
      const { results } = await testNotifications();
      setSaid(results.map(({ url, error }) => `${url}: ${error ?? "delivered"}`).join("; "));
    } catch (error) { setSaid(error.message); }
    setBusy(false);
  };
  return (
    <p class="actions"><button class="action" disabled={busy} onClick={send}>{busy ? "Sending …" : "Test notifications"}</button>{" "}
      <span role="status">{said}</span></p>
  );
}

export function Alarms({ live }) {
  // Loaded again when the alarms of a robot have changed.
  const mark = [...live.robots.values()].map(row => `${row.robot}:${row.changed}`).join();
  const answer = useAnswer("alarms", mark, () => get(["alarms"]));
  if (!answer.value) return <Missing answer={answer} title="Alarms" what="alarms" />;
  const { alarms } = answer.value;
  const shelved = alarms.filter(view => view.alarm.shelved_until_utc_s !== null);
  const open = alarms.filter(view => view.alarm.shelved_until_utc_s === null);
  return (
    <>
      <h1 tabindex="-1">{open.length === 0 ? "No alarms" : open.length === 1 ? "1 alarm" : `${open.length} alarms`}</h1>
      <Outdated answer={answer} />
      <AlarmList alarms={open} />
      {shelved.length > 0 && <><h2>Shelved</h2><AlarmList alarms={shelved} /></>}
      <p><a href="/journal">Older alarms: see Journal</a></p>
      {mayOperate() && <TestNotifications />}
    </>
  );
}
