//! Faults reported by transports, converted to data faults of alarms.

use crate::words;
use sinew_log::TopicUse;
use sinew_log::live::Live;
use sinew_transport::TransportFault;
use sinew_watch_core::alarm::DataFault;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Time after which a fault that is not reported again has ended.
const MAX_FAULT_AGE: Duration = Duration::from_secs(60);
/// Maximum number of remembered publishers and topics.
const MAX_TOPICS: usize = 64;

/// Key of a fault: topic, and publisher if the fault concerns one.
type FaultKey = (String, String);

/// Present faults of a robot's topics.
#[derive(Debug, Default)]
pub(super) struct TopicFaults {
    all: BTreeMap<FaultKey, (DataFault, Instant)>,
    reported: Vec<DataFault>,
}

impl TopicFaults {
    /// Processes a report of a transport; returns a log line where appropriate.
    pub(super) fn ingest(&mut self, report: &TransportFault) -> Option<String> {
        let decode = |topic: &str, reason: String| {
            let topic = topic.to_owned();
            Some(DataFault::Decode { topic, reason })
        };
        let (key, fault) = match report {
            TransportFault::Incompatible {
                topic,
                publisher,
                offered,
                requested,
            } => {
                let fault = DataFault::Qos {
                    topic: topic.clone(),
                    offered: offered.to_string(),
                    requested: requested.to_string(),
                };
                ((topic.clone(), publisher.clone()), Some(fault))
            }
            TransportFault::WrongType { topic, found } => {
                let reason = words::unsupported_type(found);
                ((topic.clone(), String::new()), decode(topic, reason))
            }
            TransportFault::Unreadable { topic, reason, .. } => (
                (topic.clone(), String::new()),
                decode(topic, reason.clone()),
            ),
            TransportFault::TooLong { topic, bytes, most } => {
                let reason = words::message_too_long(bytes, most);
                ((topic.clone(), String::new()), decode(topic, reason))
            }
            TransportFault::Damaged { file, reason, .. } => {
                ((file.clone(), String::new()), decode(file, reason.clone()))
            }
            TransportFault::PublisherLost {
                topic, publisher, ..
            } => {
                self.all.remove(&(topic.clone(), publisher.clone()));
                return None;
            }
            // Concerns every robot behind the transport: the monitor logs it once.
            TransportFault::PublisherFound { .. }
            | TransportFault::Connected { .. }
            | TransportFault::Disconnected { .. } => {
                return None;
            }
            other => return Some(other.to_string()),
        };
        let fault = fault?;
        let is_known = self
            .all
            .get(&key)
            .is_some_and(|(existing, _)| *existing == fault);
        if is_known || self.all.len() < MAX_TOPICS {
            self.all.insert(key, (fault, Instant::now()));
        }
        (!is_known).then(|| report.to_string())
    }

    /// Returns the present faults if they have changed. An incompatible policy persists until its publisher
    /// disappears.
    pub(super) fn changed(&mut self, live: &Live) -> Option<&[DataFault]> {
        self.all.retain(|_, (fault, reported_at)| {
            matches!(fault, DataFault::Qos { .. }) || reported_at.elapsed() < MAX_FAULT_AGE
        });
        let ambiguous = live.choice().ambiguous.iter().map(|ambiguity| {
            let (side, key) = side(ambiguity.side);
            let several = ambiguity.candidates.join(", ");
            DataFault::Decode {
                topic: side.into(),
                reason: words::ambiguous_topics(&several, key),
            }
        });
        let missed = live.missed().into_iter().map(|missed| {
            let (side, key) = side(missed.side);
            DataFault::Decode {
                topic: side.into(),
                reason: words::topic_not_found(&missed.wanted, key, &missed.others.join(", ")),
            }
        });
        let all = self.all.values().map(|(fault, _)| fault.clone());
        let now: Vec<DataFault> = all.chain(ambiguous).chain(missed).collect();
        if now == self.reported {
            return None;
        }
        self.reported = now;
        Some(&self.reported)
    }
}

/// Returns the name of a side, and the key that selects its topic.
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
    fn transport_state_is_not_logged_per_robot() {
        let mut faults = TopicFaults::default();
        let transport = || "dds:0".to_owned();
        assert_eq!(
            faults.ingest(&TransportFault::Connected {
                transport: transport()
            }),
            None
        );
        let reason = "no network".into();
        assert_eq!(
            faults.ingest(&TransportFault::Disconnected {
                transport: transport(),
                reason
            }),
            None
        );
        let wrong = TransportFault::WrongType {
            topic: "/joint_states".into(),
            found: "a/msg/B".into(),
        };
        assert!(faults.ingest(&wrong).is_some());
    }
}
