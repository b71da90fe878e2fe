//! Journal texts, and mails about them.

use super::alarms::{advice, condition_name, headline, observation};
use super::{rounded, span, when};
use sinew_files::number::probability;
use sinew_watch_core::alarm::{Alarm, AlarmKey, AlarmState, Transition, TransitionReason};
use sinew_watch_core::command::{Command, CommandKind};
use sinew_watch_core::incident::{Finding, Incident, IncidentCause, IncidentPhase};
use sinew_watch_core::journal::{BaselineWaits, Event, Maintenance, SessionEnd};

/// Returns the description of an event.
pub fn entry(event: &Event) -> String {
    match event {
        Event::Started { restored: true } => "Monitor restarted from its stored state".into(),
        Event::Started { restored: false } => "Monitor started".into(),
        Event::Back { after_s: Some(s) } => format!("Data resumed after {}", span(*s)),
        Event::Back { after_s: None } => "First data received".into(),
        Event::Silent => "No data are received any more".into(),
        Event::Session { duration_s, end } => {
            let reason = match end {
                SessionEnd::Full => "maximum duration of motion reached",
                SessionEnd::Stood => "robot at rest",
                SessionEnd::Lost => "no data received",
                SessionEnd::Shutdown => "monitor stopped",
                SessionEnd::ClockStep => "step of the host clock",
                SessionEnd::Command => "rope tensioned or replaced",
                SessionEnd::Baseline => "baseline acquired",
            };
            format!(
                "Session with {} of motion recorded (end: {reason})",
                span(*duration_s)
            )
        }
        Event::Baseline { poses } => format!("Baseline acquired from {poses} poses"),
        Event::BaselinePending {
            reason: BaselineWaits::FewPoses,
        } => "Baseline pending: more poses are required; move every joint through its range".into(),
        Event::BaselinePending {
            reason: BaselineWaits::Rejected,
        } => {
            "Baseline pending: the estimator has rejected the motion so far; keep the gripper empty and avoid contacts"
                .into()
        }
        Event::ClockStep { by_s } => {
            format!("Clock of the host stepped by {} s", rounded(*by_s, 3))
        }
        Event::StampsNotTime { rate } => format!(
            "Time stamps of the robot advance by {} s per second (simulation or recording); records are excluded from the trend",
            rounded(*rate, 2)
        ),
        Event::Dropped { messages } => {
            format!(
                "{messages} messages dropped because the queue of the robot was full; check the load of the monitor host"
            )
        }
        Event::Behind { motion_s } => format!(
            "{} of motion not estimated because estimation is slower than real time; use a faster host or fewer robots per monitor",
            span(*motion_s)
        ),
        Event::StoredStateIgnored { reason } => format!("Stored state not used: {reason}; the baseline of the configuration applies, if any"),
        Event::GivenUp { entries, records } => {
            format!(
                "{entries} journal entries and {records} records discarded because they could not be stored; check the store"
            )
        }
        Event::Alarm { transition } => alarm(transition),
        Event::Incident { incident: of } => incident(of),
        Event::Command { command } => operator_entry(command),
        Event::Maintenance { maintenance: of } => maintenance(of),
        Event::Reloaded => "Configuration reloaded".into(),
    }
}

fn of(key: &AlarmKey) -> String {
    let what = condition_name(key.condition);
    match &key.joint {
        Some(joint) => format!("“{what}” of {joint}"),
        None => format!("“{what}”"),
    }
}

fn alarm(transition: &Transition) -> String {
    let step = match (transition.from, transition.to) {
        (AlarmState::Normal, AlarmState::Active) => "raised",
        (_, AlarmState::Active) => "raised again",
        (_, AlarmState::Acknowledged) => "acknowledged",
        (_, AlarmState::Cleared) => "cleared, unacknowledged",
        (_, AlarmState::Latched) => "cleared, latched",
        (_, AlarmState::Normal) => "returned to normal",
    };
    let by = match &transition.reason {
        TransitionReason::Condition { .. } => String::new(),
        TransitionReason::Command { who, what, note } => {
            let note = if note.is_empty() {
                String::new()
            } else {
                format!(" “{note}”")
            };
            format!(" ({who}: {}{note})", verb(what))
        }
        TransitionReason::Superseded { alarm } => format!(" (superseded by {})", of(alarm)),
        TransitionReason::Withdrawn => " (entry of the repair withdrawn)".into(),
        TransitionReason::ShelfEnded => " (shelving ended)".into(),
    };
    format!("Alarm {}: {step}{by}", of(&transition.key))
}

fn incident(incident: &Incident) -> String {
    let Incident { joint, number, .. } = incident;
    let phase = match (incident.phase, incident.finding) {
        (IncidentPhase::Suspected, _) => "opened by a suspected change".into(),
        (IncidentPhase::Confirmed, _) => "change confirmed".into(),
        (IncidentPhase::Acknowledged, _) => "acknowledged".into(),
        (IncidentPhase::Repaired, _) => "repaired, finding not recorded".into(),
        (IncidentPhase::Closed, Some(found)) => format!("closed, finding: {}", finding(found)),
        (IncidentPhase::Closed, None) => "closed".into(),
    };
    let causes = incident.causes.iter().map(|one| {
        let cause = match one.cause {
            IncidentCause::StrandFailure => "strand failure",
            IncidentCause::Slip => "slip of rope or clamp",
            IncidentCause::Encoder => "slip of an encoder",
            IncidentCause::SlipOrEncoder => "slip of rope, clamp or encoder",
            IncidentCause::TransmissionLost => "transmission lost",
            IncidentCause::Retensioned => "unrecorded re-tensioning",
            IncidentCause::NoChange => "no lasting change",
        };
        format!("{cause} {}", probability(one.probability))
    });
    let causes: Vec<String> = causes.collect();
    let sessions = incident.evidence.len();
    format!(
        "Incident {number} of {joint}: {phase} (evidence: {sessions}; probability of the causes: {})",
        causes.join(", ")
    )
}

/// Returns the finding of an inspection.
fn finding(finding: Finding) -> &'static str {
    match finding {
        Finding::StrandFailure => "strand failure",
        Finding::Slip => "slip of the rope",
        Finding::ClampSlip => "slip of a clamp",
        Finding::EncoderMoved => "encoder moved",
        Finding::Nothing => "nothing found",
        Finding::Other => "other, see note",
    }
}

fn verb(what: &CommandKind) -> String {
    match what {
        CommandKind::Tensioned { .. } => "re-tensioned".into(),
        CommandKind::Replaced { .. } => "replaced".into(),
        CommandKind::Withdraw { entry } => format!("withdrew entry {entry}"),
        CommandKind::Correct { entry, .. } => format!("corrected entry {entry}"),
        CommandKind::Acknowledge { .. } => "acknowledged".into(),
        CommandKind::Shelve { for_s, .. } => format!("shelved for {}", span(*for_s)),
        CommandKind::Unshelve { .. } => "unshelved".into(),
        CommandKind::Reset { .. } => "reset".into(),
        CommandKind::Finding { finding: of, .. } => format!("finding: {}", finding(*of)),
        CommandKind::Note => "note".into(),
    }
}

/// Returns the ropes of joints.
fn ropes(joints: &[String]) -> String {
    match joints {
        // Recorded by an earlier version.
        [] => "all ropes".to_owned(),
        [one] => format!("rope of {one}"),
        many => format!("ropes of {}", many.join(", ")),
    }
}

/// Returns the description of a corrected or withdrawn entry.
fn maintenance(entry: &Maintenance) -> String {
    let work = match entry.replaced {
        true => "replaced",
        false => "re-tensioned",
    };
    let Maintenance {
        number,
        who,
        recorded_utc_s,
        time_utc_s,
        ..
    } = entry;
    let is_withdrawn = entry.is_withdrawn();
    let by = entry.correction.as_ref().map_or("–", |by| by.who.as_str());
    let recorded = format!("Entry {number} of {} by {who}", when(*recorded_utc_s));
    match is_withdrawn {
        true => format!(
            "{recorded} withdrawn by {by}: {} not {work}",
            ropes(&entry.joints)
        ),
        false => format!(
            "{recorded} corrected by {by}: {} {work} at {}",
            ropes(&entry.joints),
            when(*time_utc_s)
        ),
    }
}

fn operator_entry(command: &Command) -> String {
    let Command { who, note, what } = command;
    let action = match what {
        CommandKind::Tensioned { joints: of } => format!("{} re-tensioned", ropes(of)),
        CommandKind::Replaced { joints: of } => format!("{} replaced", ropes(of)),
        CommandKind::Withdraw { .. } | CommandKind::Correct { .. } => verb(what),
        CommandKind::Acknowledge { alarm } => format!("acknowledged alarm {}", of(alarm)),
        CommandKind::Shelve { alarm, for_s } => {
            format!("shelved alarm {} for {}", of(alarm), span(*for_s))
        }
        CommandKind::Unshelve { alarm } => format!("unshelved alarm {}", of(alarm)),
        CommandKind::Reset { alarm } => format!("reset alarm {}", of(alarm)),
        CommandKind::Finding { joint, finding: of } => {
            format!("finding at {joint}: {}", finding(*of))
        }
        CommandKind::Note => return format!("{who}: {note}"),
    };
    match note.is_empty() {
        true => format!("{who}: {action}"),
        false => format!("{who}: {action}. “{note}”"),
    }
}

/// Returns subject and body of a mail about an alarm transition; `page` is the address of the page, to which a link is
/// added.
pub fn mail(robot: &str, transition: &Transition, page: Option<&str>) -> [String; 2] {
    let AlarmKey { joint, condition } = &transition.key;
    let is_active = transition.to.is_active();
    let (mut title, mut body) = (condition_name(*condition).to_owned(), String::new());
    if let Some(joint) = joint {
        title = format!("{joint}: {title}");
    }
    if let TransitionReason::Condition { cause } = &transition.reason {
        let raised = Alarm {
            key: transition.key.clone(),
            state: transition.to,
            acknowledged: false,
            raised_utc_s: transition.time_utc_s,
            cause: cause.clone(),
            shelved_until_utc_s: None,
            shelved_for_s: None,
        };
        title = headline(&raised);
        if is_active {
            let advice = advice(&raised).map_or(String::new(), |advice| format!("{advice}\n"));
            body = format!("{}\n{advice}\n", observation(&raised));
        }
    }
    let state = match transition.to {
        AlarmState::Acknowledged => " (acknowledged)",
        _ if is_active => "",
        _ => " (ended)",
    };
    body += &format!(
        "{robot}: {}, {}\n",
        alarm(transition),
        when(transition.time_utc_s)
    );
    if let Some(page) = page {
        let names = std::iter::once(robot).chain(joint.as_deref());
        let names: String = names.map(|name| format!("/{}", escaped(name))).collect();
        body += &format!("{page}/r{names}\n");
    }
    [format!("{robot}: {title}{state}"), body]
}

/// Escapes a name as a part of a URL.
fn escaped(name: &str) -> String {
    let escape = |b: u8| match b {
        b if b.is_ascii_alphanumeric() || b"-_.~".contains(&b) => char::from(b).to_string(),
        b => format!("%{b:02X}"),
    };
    name.bytes().map(escape).collect()
}
