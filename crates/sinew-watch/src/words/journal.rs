//! Entries of the journal in words.

use super::alarms::condition_name;
use super::{rounded, span};
use sinew_watch_core::alarm::{AlarmKey, AlarmState, Transition, TransitionWhy};
use sinew_watch_core::command::{Command, What};
use sinew_watch_core::journal::{BaselineWaits, Event, SessionEnd};

/// What happened, in a sentence.
pub fn entry(event: &Event) -> String {
    match event {
        Event::Started { restored: true } => {
            "the monitor began again, from what it had stored".into()
        }
        Event::Started { restored: false } => "the monitor began".into(),
        Event::Back { after_s: Some(s) } => format!("data came again, after {}", span(*s)),
        Event::Back { after_s: None } => "the first data came".into(),
        Event::Silent => "data stopped".into(),
        Event::Session { duration_s, end } => {
            let why = match end {
                SessionEnd::Full => "it was long enough",
                SessionEnd::Stood => "the robot stood",
                SessionEnd::Lost => "data stopped",
                SessionEnd::Shutdown => "the monitor stopped",
                SessionEnd::ClockStep => "the clock stepped",
                SessionEnd::Command => "somebody tensioned or replaced a rope",
                SessionEnd::Baseline => "it was the motion a baseline needed",
            };
            format!(
                "a session of {} of motion was recorded: {why}",
                span(*duration_s)
            )
        }
        Event::Baseline { poses } => format!("a new baseline was learned from {poses} poses"),
        Event::BaselineWaits {
            why: BaselineWaits::FewPoses,
        } => "the new baseline waits for more poses".into(),
        Event::BaselineWaits {
            why: BaselineWaits::Refused,
        } => "the new baseline waits: the estimator refused the motion so far".into(),
        Event::ClockStep { by_s } => {
            format!("this computer's clock stepped by {} s", rounded(*by_s, 3))
        }
        Event::StampsNotTime { rate } => format!(
            "the robot's stamps run at {} of time: a simulation or a recording, no part of a trend",
            rounded(*rate, 2)
        ),
        Event::Dropped { messages } => {
            format!("{messages} messages were dropped: the queue was full")
        }
        Event::Behind { motion_s } => format!(
            "{} of motion were not estimated: estimates take longer than the motion",
            span(*motion_s)
        ),
        Event::BeliefLeft { why } => format!("what was stored is left alone: {why}"),
        Event::GivenUp { entries, records } => format!(
            "{entries} older entries and {records} records were given up: they could not be stored for too long"
        ),
        Event::Alarm { transition } => alarm(transition),
        Event::Command { command } => told(command),
        Event::Reloaded => "the configuration was read again".into(),
    }
}

fn of(key: &AlarmKey) -> String {
    let what = condition_name(key.condition);
    match &key.joint {
        Some(joint) => format!("{joint}, {what}"),
        None => what.into(),
    }
}

fn alarm(transition: &Transition) -> String {
    let step = match (transition.from, transition.to) {
        (AlarmState::Normal, AlarmState::Active) => "raised",
        (_, AlarmState::Active) => "raised again",
        (_, AlarmState::Acknowledged) => "acknowledged",
        (_, AlarmState::Cleared) => "over, nobody has seen it",
        (_, AlarmState::Latched) => "over, waits for somebody",
        (_, AlarmState::Normal) => "cleared",
    };
    let by = match &transition.why {
        TransitionWhy::Condition { .. } => String::new(),
        TransitionWhy::Command { who, what, note } => {
            let note = if note.is_empty() {
                String::new()
            } else {
                format!(" “{note}”")
            };
            format!(" ({who}: {}{note})", verb(what))
        }
        TransitionWhy::ShelfEnded => " (its shelf ended)".into(),
    };
    format!("alarm {}: {step}{by}", of(&transition.key))
}

fn verb(what: &What) -> String {
    match what {
        What::Tensioned { .. } => "tensioned".into(),
        What::Replaced { .. } => "replaced".into(),
        What::Acknowledge { .. } => "seen".into(),
        What::Shelve { for_s, .. } => format!("shelved for {}", span(*for_s)),
        What::Unshelve { .. } => "unshelved".into(),
        What::Reset { .. } => "reset".into(),
        What::Note => "note".into(),
    }
}

fn told(command: &Command) -> String {
    let Command { who, note, what } = command;
    let joints = |joints: &Vec<String>| match &joints[..] {
        [] => "all ropes were".to_owned(),
        [one] => format!("the rope of {one} was"),
        many => format!("the ropes of {} were", many.join(", ")),
    };
    let did = match what {
        What::Tensioned { joints: of } => format!("{} tensioned", joints(of)),
        What::Replaced { joints: of } => format!("{} replaced", joints(of)),
        What::Acknowledge { alarm } => format!("has seen the alarm {}", of(alarm)),
        What::Shelve { alarm, for_s } => {
            format!("shelved the alarm {} for {}", of(alarm), span(*for_s))
        }
        What::Unshelve { alarm } => format!("unshelved the alarm {}", of(alarm)),
        What::Reset { alarm } => format!("reset the alarm {}", of(alarm)),
        What::Note => return format!("{who}: {note}"),
    };
    match note.is_empty() {
        true => format!("{who}: {did}"),
        false => format!("{who}: {did}. “{note}”"),
    }
}
