//! Alarm texts: titles, observations and recommended actions.

use super::{exceedance, plus_minus, rounded, span, when};
use sinew_estimate::{Cause, UnknownCause};
use sinew_model::Gaussian;
use sinew_trend::Limit;
use sinew_watch_core::alarm::{
    Alarm, AlarmCause, AlarmState, Condition, DataFault, LimitOrigin, StepKind, StoreFault,
};

/// Returns the condition in two or three words.
pub(super) fn condition_name(condition: Condition) -> &'static str {
    match condition {
        Condition::ReplaceLimit => "Replace rope",
        Condition::TransmissionLost => "Transmission lost",
        Condition::StrandFailure => "Strand failure",
        Condition::StepChange => "Step change",
        Condition::RetensionLimit => "Re-tension",
        Condition::LimitNear => "Maintenance due soon",
        Condition::SuspectedStep => "Inspection advised",
        Condition::Data => "Invalid data",
        Condition::Store => "Storage failure",
        Condition::Transport => "Transport disconnected",
        Condition::NoData => "No data",
    }
}

/// Returns the condition of an alarm as a heading.
pub fn title(alarm: &Alarm) -> &'static str {
    match (&alarm.cause, alarm.key.condition) {
        (AlarmCause::StepChange { what, .. }, Condition::SuspectedStep) => match what {
            StepKind::StrandFailure => "Suspected strand failure",
            StepKind::SlipOrStrandFailure => "Suspected strand failure or slip",
            StepKind::Retensioned => "Suspected re-tensioning",
            _ => "Suspected step change",
        },
        (AlarmCause::Provisional { .. }, _) => "Estimate provisional",
        (_, condition) => condition_name(condition),
    }
}

/// Returns the heading of an alarm with its tendon, and with the fault where the heading does not name it.
pub(super) fn headline(alarm: &Alarm) -> String {
    let what = match &alarm.cause {
        AlarmCause::Data { trouble } => {
            let fault = data(trouble);
            let mut rest = fault.chars();
            // Names of topics remain as they are.
            let first = rest.next().map(|c| c.to_lowercase().to_string());
            format!(
                "{}: {}{}",
                title(alarm),
                first.unwrap_or_default(),
                rest.as_str()
            )
        }
        _ => title(alarm).to_owned(),
    };
    match &alarm.key.joint {
        Some(joint) => format!("{joint}: {what}"),
        None => what,
    }
}

/// Whether the condition of the alarm has ended.
pub(super) fn has_ended(alarm: &Alarm) -> bool {
    matches!(alarm.state, AlarmState::Cleared | AlarmState::Latched)
}

/// Returns the observation as a sentence.
pub fn observation(alarm: &Alarm) -> String {
    match &alarm.cause {
        AlarmCause::Limit {
            mean,
            std,
            limit,
            probability,
            origin,
        } => {
            let is_strain = alarm.key.condition == Condition::ReplaceLimit;
            let (what, factor, unit) = match is_strain {
                true => ("Strain", 100.0, "%"),
                false => ("Elongation", 1e3, "mm"),
            };
            let value = plus_minus(Gaussian::new(*mean, *std), factor);
            let from = match origin {
                LimitOrigin::RobotToml => "robot.toml",
                LimitOrigin::Catalogue => "the rope catalogue",
            };
            let probability = match *probability {
                p if p > 0.99 => "> 0.99".into(),
                p => format!("{p:.2}"),
            };
            let limit = rounded(factor * limit, 3);
            format!(
                "{what} {value} {unit} exceeds the limit of {limit} {unit} from {from} (probability {probability})."
            )
        }
        AlarmCause::Soon {
            limit,
            at_low_utc_s,
            at_utc_s,
            at_high_utc_s,
        } => {
            let what = match limit {
                Some(Limit::Retension { .. }) => "the re-tensioning limit",
                Some(Limit::Replace { .. }) => "the replacement limit",
                None => "a limit",
            };
            let dates = exceedance([*at_utc_s, *at_low_utc_s, *at_high_utc_s]);
            format!("Predicted exceedance of {what}: {dates}.")
        }
        AlarmCause::StepChange {
            time_utc_s,
            what: StepKind::TransmissionLost,
            ..
        } => format!(
            "No torque transmitted since {}: tendon torn or off its pulley, or motor side detached.",
            when(*time_utc_s)
        ),
        AlarmCause::StepChange {
            time_utc_s,
            size_rad,
            std_rad,
            what,
            cause,
            stiffness_ratio,
        } => {
            let size = plus_minus(Gaussian::new(*size_rad, *std_rad), 1e3);
            let soft = stiffness_ratio.map_or(String::new(), |s| {
                format!(", stiffness change {} %", rounded(100.0 * s, 2))
            });
            let condition = match alarm.key.condition {
                Condition::SuspectedStep => "probable cause, if confirmed",
                _ => "probable cause",
            };
            let what = step_cause(*what, *cause);
            format!(
                "Step change of {size} mrad at {}{soft}; {condition}: {what}.",
                when(*time_utc_s)
            )
        }
        AlarmCause::Provisional { for_s } => format!(
            "The estimate has been provisional, or the data inconsistent with the model, for {} of motion.",
            span(*for_s)
        ),
        AlarmCause::Data { trouble: fault } => format!("{}.", data(fault)),
        AlarmCause::Store { reason, .. } => {
            format!(
                "Records cannot be stored: {reason}. Estimation continues, with the records in memory."
            )
        }
        AlarmCause::Transport { transport, reason } => {
            format!("Transport {transport} is disconnected: {reason}. The monitor is reconnecting.")
        }
        AlarmCause::Silence { since_utc_s } => match since_utc_s {
            Some(since) => format!("The last data were received at {}.", when(*since)),
            None => "No data have been received since the start of the monitor.".into(),
        },
    }
}

fn step_cause(what: StepKind, cause: Option<Cause>) -> &'static str {
    match (what, cause) {
        (_, Some(Cause::MotorEncoder)) => "slip of the motor encoder, not of the rope",
        (_, Some(Cause::JointEncoder)) => "slip of the joint encoder, not of the rope",
        (StepKind::Slip, Some(Cause::Rope)) => "slip of rope or clamp without stiffness loss",
        (StepKind::Slip, Some(Cause::Unknown(UnknownCause::Both))) => {
            "re-homed encoder, or slip of the clamp (both encoder signals stepped)"
        }
        (StepKind::Slip, _) => "slip of rope, clamp or encoder without stiffness loss",
        (StepKind::TransmissionLost, _) => {
            "no torque transmitted: tendon torn or off its pulley, or motor side detached"
        }
        (StepKind::StrandFailure, _) => "strand failure (stiffness loss)",
        (StepKind::SlipOrStrandFailure, _) => {
            "slip or strand failure (stiffness change inconclusive)"
        }
        (StepKind::WhileOff, _) => {
            "slip of rope or clamp, or re-homed encoder, while no data were received"
        }
        (StepKind::Retensioned, _) => "unrecorded re-tensioning (the offset decreased)",
    }
}

fn side(motor: bool) -> &'static str {
    match motor {
        true => "motor",
        false => "joint",
    }
}

fn data(fault: &DataFault) -> String {
    let percent = super::percent;
    match fault {
        DataFault::NotFinite { share } => {
            format!(
                "{} of the frames have non-finite positions",
                percent(*share)
            )
        }
        DataFault::Lost { share } => format!("{} of the frames were lost", percent(*share)),
        DataFault::Dead { motor } => format!(
            "The {} position is constant while the {} position changes",
            side(*motor),
            side(!*motor)
        ),
        DataFault::OneSignal => "Motor position and joint position are identical".into(),
        DataFault::FarApart { apart_rad } => format!(
            "Motor position and joint position differ by {} rad",
            rounded(*apart_rad, 2)
        ),
        DataFault::Swapped { with } => {
            format!(
                "The motor position follows the joint position of {with}: two channels are swapped"
            )
        }
        DataFault::NonMonotonicTime { share } => {
            format!(
                "The time stamps do not increase in {} of the frames",
                percent(*share)
            )
        }
        DataFault::Qos {
            topic,
            offered,
            requested,
        } => format!(
            "{topic}: no data are received because the quality of service is incompatible: offered {offered}, requested {requested}"
        ),
        DataFault::Decode { topic, reason } => format!("{topic}: not used: {reason}"),
        DataFault::Missing { joint, motor } => {
            format!("The {} position of {joint} is missing", side(*motor))
        }
        DataFault::Rejected { reason } => format!("The estimator rejected the data: {reason}"),
    }
}

/// Returns the reason why a topic with messages of another type is not used.
pub fn unsupported_type(found: &str) -> String {
    format!("unsupported type {found}")
}

/// Returns the reason why a message that is too long is not used.
pub fn message_too_long(bytes: impl std::fmt::Display, most: impl std::fmt::Display) -> String {
    format!("message of {bytes} bytes discarded, limit {most} bytes")
}

/// Returns the reason why none of several matching topics is used; `key` selects one of them.
pub fn ambiguous_topics(candidates: &str, key: &str) -> String {
    format!("several topics match: {candidates}; set {key}")
}

/// Returns the reason why the topic selected by `key` is not used: it is not found.
pub fn topic_not_found(wanted: &str, key: &str, others: &str) -> String {
    format!("topic {wanted} of {key} not found; topics with joint states: {others}; correct {key}")
}

/// Returns the recommended action; `None`: none.
pub fn advice(alarm: &Alarm) -> Option<&'static str> {
    Some(match (&alarm.cause, alarm.key.condition) {
        (_, Condition::TransmissionLost) => {
            "Stop the arm, inspect the tendon, and replace it or put it back on its pulley."
        }
        (_, Condition::ReplaceLimit) => "Replace the rope, then select “Record replacement”.",
        (_, Condition::StrandFailure) => "Take the arm out of operation and inspect the rope.",
        (
            AlarmCause::StepChange {
                cause: Some(Cause::MotorEncoder | Cause::JointEncoder),
                ..
            },
            _,
        ) => "Inspect the encoder and its coupling.",
        (
            AlarmCause::StepChange {
                what: StepKind::Retensioned,
                ..
            },
            _,
        ) => "If the tendon was re-tensioned, select “Record re-tensioning”.",
        (_, Condition::StepChange) => "Inspect rope, clamps and encoders.",
        (_, Condition::RetensionLimit) => {
            "Re-tension the tendon, then select “Record re-tensioning”."
        }
        (_, Condition::LimitNear) => "Schedule the maintenance of the tendon before this date.",
        (AlarmCause::StepChange { .. }, Condition::SuspectedStep) => {
            "Inspect the tendon and record the finding, or wait: further sessions confirm or refute the change."
        }
        (AlarmCause::Provisional { .. }, _) => {
            "Check the gripper for a payload and the arm for contacts; otherwise move through more poses, or wait for the end of the session."
        }
        (AlarmCause::Data { trouble: fault }, _) => data_advice(fault),
        (AlarmCause::Store { fault, .. }, _) => match fault {
            StoreFault::Full => "Free disk space.",
            StoreFault::ReadOnly => {
                "Grant the user of the monitor write access to the folder of [store] dir; check whether its disk is mounted read-only."
            }
            StoreFault::Disk => "Check the disk; the system log contains the error.",
            StoreFault::Damaged => {
                "Move watch.db to another folder and restart the monitor; recover its records with `sqlite3 FILE .recover`."
            }
            StoreFault::Other => "Check the log of the monitor: `journalctl -u sinew-watch`.",
        },
        (_, Condition::Transport) => {
            "Check the network and the configuration of the monitor with `sinew watch --check FILE`; the robot may be in order."
        }
        (_, Condition::NoData) => {
            "Check that the robot is switched on and that its driver is running."
        }
        _ => return None,
    })
}

/// Returns the recommended action for a fault of the data.
fn data_advice(fault: &DataFault) -> &'static str {
    match fault {
        DataFault::NotFinite { .. } => "Check the driver and the encoders of the robot.",
        DataFault::Lost { .. } => "Check the network and the load of the robot's computer.",
        DataFault::Dead { .. } => "Check the encoder and its cable.",
        DataFault::OneSignal => {
            "Check that the two positions come from two encoders, and the mapping of the topics."
        }
        DataFault::FarApart { .. } => {
            "Check the unit of the positions (rad), the gear ratio, and the mapping of the topics."
        }
        DataFault::Swapped { .. } => "Correct the mapping of the channels to the joints.",
        DataFault::NonMonotonicTime { .. } => {
            "Check the clock of the driver; messages need the time stamp of the measurement."
        }
        DataFault::Qos { .. } => {
            "Set the quality of service of the publisher to the requested policy."
        }
        DataFault::Decode { .. } => {
            "Select another topic with joint_topic or motor_topic, or correct the publisher."
        }
        DataFault::Missing { .. } => {
            "Check that the driver publishes this position, and the name of the joint in robot.toml and in the mapping file."
        }
        DataFault::Rejected { .. } => {
            "Check that robot.toml and the mapping file describe this robot."
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_watch_core::alarm::AlarmKey;

    #[test]
    fn advice_matches_store_fault() {
        let alarm = |fault| Alarm {
            key: AlarmKey {
                joint: None,
                condition: Condition::Store,
            },
            state: AlarmState::Active,
            acknowledged: false,
            raised_utc_s: 0.0,
            cause: AlarmCause::Store {
                fault,
                reason: "the store is read-only".into(),
            },
            shelved_until_utc_s: None,
            shelved_for_s: None,
        };
        let advice = |fault| advice(&alarm(fault)).unwrap();
        assert!(advice(StoreFault::Full).contains("disk space"));
        assert!(!advice(StoreFault::ReadOnly).contains("space"));
        assert!(advice(StoreFault::ReadOnly).contains("mounted read-only"));
    }
}
