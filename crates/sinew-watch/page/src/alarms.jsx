// Alarms of all robots, the most severe first.
import { useEffect, useState } from "preact/hooks";
import { AlarmActions } from "./actions.jsx";
import { alike } from "./alike.js";
import { get } from "./api.js";
import { count, dayAndTime, utc } from "./format.js";
import { CLASSES, Sign } from "./signs.jsx";

const STATES = {
  active: "active", acknowledged: "active, acknowledged", cleared: "over, nobody has seen it", latched: "over, waits for somebody",
};

// An alarm as a sentence, with what to do and the buttons.
export function AlarmLine({ said, named = true }) {
  const { alarm } = said;
  const of = alarm.key.joint ? `/r/${encodeURIComponent(said.robot)}/${encodeURIComponent(alarm.key.joint)}` : `/r/${encodeURIComponent(said.robot)}`;
  const shelved = alarm.shelved_until_utc_s;
  return (
    <li class={`${CLASSES[said.level]} ${alarm.acknowledged ? "seen" : ""}`}>
      <Sign level={said.level} />
      <div>
        <p class="title">{named && <><a href={of}>{said.robot}{alarm.key.joint && `, ${alarm.key.joint}`}</a>: </>}{said.title}</p>
        <p>{said.text}{said.advice && <> <strong>{said.advice}</strong></>}</p>
        <p class="state">
          {STATES[alarm.state]}{alarm.state === "latched" && alarm.acknowledged && ", acknowledged"} · severity {said.severity} ·
          since <time title={utc(alarm.raised_utc_s)}>{dayAndTime(alarm.raised_utc_s)}</time>
          {shelved !== null && <> · shelved until {dayAndTime(shelved)}</>}
        </p>
        <AlarmActions said={said} />
      </div>
    </li>
  );
}

const keyOf = said => `${said.robot}/${said.alarm.key.joint}/${said.alarm.key.condition}`;

// What is said of many, once; each of them on demand.
function Alike({ group }) {
  const [open, setOpen] = useState(false);
  const [first] = group;
  const three = group.slice(0, 3).map(said => [said.robot, said.alarm.key.joint].filter(Boolean).join(" "));
  return (
    <li class={`${CLASSES[first.level]} ${first.alarm.acknowledged ? "seen" : ""}`}>
      <Sign level={first.level} />
      <div>
        <p class="title">{count(group.length)} alike: {first.title}</p>
        <p>{first.text}{first.advice && <> <strong>{first.advice}</strong></>}</p>
        <details onToggle={event => setOpen(event.currentTarget.open)}>
          <summary>{three.join(", ")} and {count(group.length - 3)} more</summary>
          {open && <ul class="alarms">{group.map(said => <AlarmLine key={keyOf(said)} said={said} />)}</ul>}
        </details>
      </div>
    </li>
  );
}

// `named`: alarms of several robots.
export function AlarmList({ alarms, named = true }) {
  const groups = named ? alike(alarms) : alarms.map(said => [said]);
  return (
    <ul class="alarms">
      {groups.map(group => (group.length > 1
        ? <Alike key={`alike ${keyOf(group[0])}`} group={group} />
        : <AlarmLine key={keyOf(group[0])} said={group[0]} named={named} />))}
    </ul>
  );
}

export function Alarms({ live }) {
  const [alarms, setAlarms] = useState(null);
  // Asked for anew when the fleet says that some robot's alarms have changed.
  const mark = [...live.robots.values()].map(row => `${row.robot}:${row.alarms}:${row.unacknowledged}:${row.changed}`).join();
  useEffect(() => {
    let over = false;
    get(["alarms"]).then(got => { if (!over) setAlarms(got.alarms); }).catch(() => {});
    return () => { over = true; };
  }, [mark]);
  if (!alarms) return <p class="waits">Waits for the monitor …</p>;
  const shelved = alarms.filter(said => said.alarm.shelved_until_utc_s !== null);
  const open = alarms.filter(said => said.alarm.shelved_until_utc_s === null);
  return (
    <>
      <h1 tabindex="-1">{open.length === 0 ? "No alarms" : open.length === 1 ? "1 alarm" : `${open.length} alarms`}</h1>
      <AlarmList alarms={open} />
      {shelved.length > 0 && <><h2>Shelved</h2><AlarmList alarms={shelved} /></>}
      <p><a href="/journal">What happened before stands in the journal.</a></p>
    </>
  );
}
