//! What doors say is wrong, as the monitor's alarms know it.

use sinew_door::Trouble as Door;
use sinew_log::TopicUse;
use sinew_log::live::Live;
use sinew_watch_core::alarm::Trouble;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// What isn't said again within this time is over.
const OVER_AFTER: Duration = Duration::from_secs(60);
/// Publishers and topics that are remembered.
const MOST: usize = 64;

/// Whose trouble: a topic, and a publisher where it is one's.
type Whose = (String, String);

/// What is wrong now.
#[derive(Debug, Default)]
pub(super) struct Troubles {
    all: BTreeMap<Whose, (Trouble, Instant)>,
    told: Vec<Trouble>,
}

impl Troubles {
    /// Takes what a door says; a line for the log, where it is worth one.
    pub(super) fn take(&mut self, said: &Door) -> Option<String> {
        let decode = |topic: &str, why: String| {
            let topic = topic.to_owned();
            Some(Trouble::Decode { topic, why })
        };
        let (whose, trouble) = match said {
            Door::Incompatible {
                topic,
                publisher,
                offered,
                requested,
            } => {
                let trouble = Trouble::Qos {
                    topic: topic.clone(),
                    offered: offered.to_string(),
                    requested: requested.to_string(),
                };
                ((topic.clone(), publisher.clone()), Some(trouble))
            }
            Door::WrongType { topic, found } => {
                let why = format!("its type is {found}, which isn't read");
                ((topic.clone(), String::new()), decode(topic, why))
            }
            Door::Unreadable { topic, why, .. } => {
                ((topic.clone(), String::new()), decode(topic, why.clone()))
            }
            Door::TooLong { topic, bytes, most } => {
                let why = format!("a message has {bytes} bytes; at most {most} are taken");
                ((topic.clone(), String::new()), decode(topic, why))
            }
            Door::Damaged { file, why, .. } => {
                ((file.clone(), String::new()), decode(file, why.clone()))
            }
            Door::PublisherLost {
                topic, publisher, ..
            } => {
                self.all.remove(&(topic.clone(), publisher.clone()));
                return None;
            }
            // Of every robot behind it: the monitor says it once.
            Door::PublisherFound { .. } | Door::Open { .. } | Door::Shut { .. } => return None,
            other => return Some(other.to_string()),
        };
        let trouble = trouble?;
        let known = self
            .all
            .get(&whose)
            .is_some_and(|(known, _)| *known == trouble);
        if known || self.all.len() < MOST {
            self.all.insert(whose, (trouble, Instant::now()));
        }
        (!known).then(|| said.to_string())
    }

    /// What is wrong now, where that has changed. A policy that doesn't match stays until its publisher goes.
    pub(super) fn changed(&mut self, live: &Live) -> Option<&[Trouble]> {
        self.all.retain(|_, (trouble, said)| {
            matches!(trouble, Trouble::Qos { .. }) || said.elapsed() < OVER_AFTER
        });
        let ambiguous = live.choice().ambiguous.iter().map(|ambiguity| {
            let (side, key) = side(ambiguity.side);
            let several = ambiguity.candidates.join(", ");
            Trouble::Decode {
                topic: side.into(),
                why: format!("several topics could be it: {several}; name one in {key}"),
            }
        });
        let missed = live.missed().into_iter().map(|missed| {
            let (side, key) = side(missed.side);
            let (wanted, others) = (missed.wanted, missed.others.join(", "));
            Trouble::Decode {
                topic: side.into(),
                why: format!(
                    "{key} asks for {wanted}, and no such topic came; with joint states there are {others}; name one in {key}"
                ),
            }
        });
        let all = self.all.values().map(|(trouble, _)| trouble.clone());
        let now: Vec<Trouble> = all.chain(ambiguous).chain(missed).collect();
        if now == self.told {
            return None;
        }
        self.told = now;
        Some(&self.told)
    }
}

/// A side in words, and the key that names its topic.
fn side(side: TopicUse) -> (&'static str, &'static str) {
    match side {
        TopicUse::MotorSide => ("motor side", "motor_topic"),
        _ => ("joint side", "joint_topic"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_door_that_opens_is_no_line_for_each_robot_behind_it() {
        let mut troubles = Troubles::default();
        let door = || "dds:0".to_owned();
        assert_eq!(troubles.take(&Door::Open { door: door() }), None);
        let why = "no network".into();
        assert_eq!(troubles.take(&Door::Shut { door: door(), why }), None);
        let wrong = Door::WrongType {
            topic: "/joint_states".into(),
            found: "a/msg/B".into(),
        };
        assert!(troubles.take(&wrong).is_some());
    }
}
