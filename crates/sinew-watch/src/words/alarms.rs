//! Alarms in words.

use super::{plus_minus, rounded, span, when};
use sinew_estimate::{Cause, UnknownCause};
use sinew_model::Gaussian;
use sinew_watch_core::alarm::{
    Alarm, AlarmCause, AlarmState, Condition, JumpKind, LimitOrigin, StoreFault, Trouble,
};

/// A condition in two or three words.
pub(super) fn condition_name(condition: Condition) -> &'static str {
    match condition {
        Condition::ReplaceLimit => "replace the rope",
        Condition::StrandFailed => "a strand has failed",
        Condition::Jump => "it jumped",
        Condition::RetensionLimit => "tension it again",
        Condition::LimitNear => "tension it again soon",
        Condition::Suspicion => "look at it",
        Condition::Data => "the data are wrong",
        Condition::Store => "nothing can be stored",
        Condition::Door => "the monitor can't listen to it",
        Condition::NoData => "nothing is received",
    }
}

/// What is the matter, as a heading.
pub fn title(alarm: &Alarm) -> &'static str {
    match (&alarm.cause, alarm.key.condition) {
        (AlarmCause::Jump { .. }, Condition::Suspicion) => "it may have jumped",
        (AlarmCause::InDoubt { .. }, _) => "the offset stays provisional",
        (_, condition) => condition_name(condition),
    }
}

/// Whether its condition is over.
pub(super) fn is_over(alarm: &Alarm) -> bool {
    matches!(alarm.state, AlarmState::Cleared | AlarmState::Latched)
}

/// What was seen, in a sentence.
pub fn said(alarm: &Alarm) -> String {
    match &alarm.cause {
        AlarmCause::Limit {
            mean,
            deviation,
            limit,
            probability,
            origin,
        } => {
            let is_strain = alarm.key.condition == Condition::ReplaceLimit;
            let (what, factor, unit) = match is_strain {
                true => ("strain", 100.0, "%"),
                false => ("stretch", 1e3, "mm"),
            };
            let value = plus_minus(Gaussian::new(*mean, *deviation), factor);
            let from = match origin {
                LimitOrigin::RobotToml => "robot.toml",
                LimitOrigin::Catalogue => "the rope's catalogue entry",
            };
            let sure = match 100.0 * probability {
                p if p > 99.0 => "over 99 %".into(),
                p => format!("{p:.0} %"),
            };
            let limit = rounded(factor * limit, 3);
            format!(
                "{what} {value} {unit}; the limit of {from} is {limit} {unit}, passed with {sure}."
            )
        }
        AlarmCause::Soon {
            after_low_s,
            after_s,
        } => {
            let day = |s: f64| sinew_files::date::day_of(alarm.raised_utc_s + s);
            let middle = after_s.map_or("perhaps never".into(), |s| {
                format!("likeliest on {}", day(s))
            });
            format!(
                "a limit may be passed on {} at the earliest, {middle}.",
                day(*after_low_s)
            )
        }
        AlarmCause::Jump {
            time_utc_s,
            size_rad,
            deviation_rad,
            what,
            cause,
            stiffness_ratio,
        } => {
            let size = plus_minus(Gaussian::new(*size_rad, *deviation_rad), 1e3);
            let soft = stiffness_ratio.map_or(String::new(), |s| {
                format!(", stiffness {} %", rounded(100.0 * s, 2))
            });
            let if_so = match alarm.key.condition {
                Condition::Suspicion => "if that lasts, ",
                _ => "",
            };
            let what = jump(*what, *cause);
            format!(
                "it changed by {size} mrad at {}{soft}: {if_so}{what}.",
                when(*time_utc_s)
            )
        }
        AlarmCause::InDoubt { for_s } => format!(
            "for {} of motion an offset has been provisional, or the data could not be solved.",
            span(*for_s)
        ),
        AlarmCause::Data { trouble } => format!("{}.", data(trouble)),
        AlarmCause::Store { why, .. } => format!("{why}. The estimate goes on in memory."),
        AlarmCause::Door { door, why } => format!("{door} is shut: {why}. It is tried again."),
        AlarmCause::Silence { since_utc_s } => match since_utc_s {
            Some(since) => format!("the last data came at {}.", when(*since)),
            None => "no data came since the monitor began.".into(),
        },
    }
}

fn jump(what: JumpKind, cause: Option<Cause>) -> &'static str {
    match (what, cause) {
        (_, Some(Cause::MotorEncoder)) => "the motor encoder's reading jumped, not the rope",
        (_, Some(Cause::JointEncoder)) => "the joint encoder's reading jumped, not the rope",
        (JumpKind::Slip, Some(Cause::Rope)) => "rope or clamp slipped; it is as stiff as before",
        (JumpKind::Slip, Some(Cause::Unknown(UnknownCause::Both))) => {
            "both readings jumped: an encoder homed anew, or a clamp slipped"
        }
        (JumpKind::Slip, _) => "rope, clamp or encoder slipped; it is as stiff as before",
        (JumpKind::StrandFailure, _) => "it is softer, too: a strand has failed",
        (JumpKind::SlipOrStrandFailure, _) => {
            "something slipped or a strand failed; the stiffness doesn't tell"
        }
        (JumpKind::WhileOff, _) => {
            "it changed while nothing was heard: rope, clamp, or an encoder homed anew"
        }
        (JumpKind::Retensioned, _) => "the offset went: it was tensioned, and nobody said so",
    }
}

fn side(motor: bool) -> &'static str {
    match motor {
        true => "motor",
        false => "joint",
    }
}

fn data(trouble: &Trouble) -> String {
    let percent = super::percent;
    match trouble {
        Trouble::NotFinite { share } => {
            format!(
                "{} of the frames hold positions that are no numbers",
                percent(*share)
            )
        }
        Trouble::Lost { share } => format!("{} of the frames are lost", percent(*share)),
        Trouble::Dead { motor } => format!(
            "the {} position never changes while others do",
            side(*motor)
        ),
        Trouble::OneSignal => {
            "motor and joint position are the same all the time: one encoder or one topic for both?"
                .into()
        }
        Trouble::FarApart { apart_rad } => format!(
            "motor and joint position are {} rad apart: degrees, or a missing gear ratio?",
            rounded(*apart_rad, 2)
        ),
        Trouble::Swapped { with } => {
            format!("the motor position follows {with}: two channels are swapped")
        }
        Trouble::StampsStand { share } => {
            format!("the stamps of {} of the frames don't rise", percent(*share))
        }
        Trouble::Qos {
            topic,
            offered,
            requested,
        } => format!(
            "{topic}: a publisher offers {offered}, {requested} is asked for, so nothing comes of it"
        ),
        Trouble::Decode { topic, why } => format!("{topic}: nothing is taken of it: {why}"),
        Trouble::Missing { joint, motor } => {
            format!("the {} position of {joint} is never there", side(*motor))
        }
        Trouble::Refused { why } => format!("the estimator refuses them: {why}"),
    }
}

/// What to do; `None`: nothing, or it goes without saying.
pub fn advice(alarm: &Alarm) -> Option<&'static str> {
    Some(match (&alarm.cause, alarm.key.condition) {
        (_, Condition::ReplaceLimit) => "Replace the rope, then press “replaced”.",
        (_, Condition::StrandFailed) => "Take the arm out of work and look at the rope.",
        (
            AlarmCause::Jump {
                cause: Some(Cause::MotorEncoder | Cause::JointEncoder),
                ..
            },
            _,
        ) => "Look at the encoder, not at the rope.",
        (
            AlarmCause::Jump {
                what: JumpKind::Retensioned,
                ..
            },
            _,
        ) => "If it was tensioned, press “tensioned”.",
        (_, Condition::Jump) => "Look at rope, clamps and encoder.",
        (_, Condition::RetensionLimit) => "Tension the rope, then press “tensioned”.",
        (AlarmCause::Jump { .. }, Condition::Suspicion) => "The next session tells.",
        (AlarmCause::InDoubt { .. }, _) => {
            "Is something in the gripper, or is the arm held? If neither, let it work through more poses, or wait for the session's end."
        }
        (
            AlarmCause::Data {
                trouble: Trouble::Qos { .. },
            },
            _,
        ) => "Change the publisher's quality of service.",
        (AlarmCause::Store { fault, .. }, _) => match fault {
            StoreFault::Full => "Make room on the disk.",
            StoreFault::ReadOnly => {
                "Let the monitor's user write in the folder of [store] dir; is its disk mounted for reading alone?"
            }
            StoreFault::Disk => "Look at the disk: the system's log names its faults.",
            StoreFault::Damaged => {
                "Move watch.db away, keep it, and start the monitor again: `sqlite3 FILE .recover` may save its records."
            }
            StoreFault::Other => "Look at the monitor's log.",
        },
        (_, Condition::Door) => {
            "Look at the monitor's network and configuration, not at the robot: `sinew watch --check FILE`."
        }
        (_, Condition::NoData) => "Is the robot on, and its driver running?",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_watch_core::alarm::AlarmKey;

    #[test]
    fn what_to_do_about_a_store_follows_what_is_wrong_with_it() {
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
                why: "the store can't be written".into(),
            },
            shelved_until_utc_s: None,
            shelved_for_s: None,
        };
        let advice = |fault| advice(&alarm(fault)).unwrap();
        assert!(advice(StoreFault::Full).contains("room on the disk"));
        assert!(!advice(StoreFault::ReadOnly).contains("room"));
        assert!(advice(StoreFault::ReadOnly).contains("mounted for reading alone"));
    }
}
