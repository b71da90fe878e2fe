//! Quality of service: requested and offered policies, and the reason for a mismatch.

use crate::error::{Durability, Policy, Reliability};
use rustdds::{Duration, QosPolicies, QosPolicyBuilder, policy, qos::QosPolicyId};

/// Maximum number of messages that a reader keeps until the transport takes them.
const MAX_KEPT_MESSAGES: i32 = 1_000;
/// Maximum time that a reliable writer may block.
const MAX_BLOCKING_TIME: Duration = Duration::from_millis(100);

/// Returns the policies requested for a subscribed topic.
///
/// Best effort and volatile matches every publisher. A robot description is published once, possibly long before:
/// transient local requests it again.
pub(super) fn reader(is_description: bool) -> QosPolicies {
    if is_description {
        return QosPolicyBuilder::new()
            .reliability(policy::Reliability::Reliable {
                max_blocking_time: MAX_BLOCKING_TIME,
            })
            .durability(policy::Durability::TransientLocal)
            .history(policy::History::KeepLast { depth: 1 })
            .build();
    }
    QosPolicyBuilder::new()
        .reliability(policy::Reliability::BestEffort)
        .durability(policy::Durability::Volatile)
        .history(policy::History::KeepLast {
            depth: MAX_KEPT_MESSAGES,
        })
        .resource_limits(policy::ResourceLimits {
            max_samples: MAX_KEPT_MESSAGES,
            max_instances: 1,
            max_samples_per_instance: MAX_KEPT_MESSAGES,
        })
        .build()
}

/// Returns the policies offered for a published topic: the defaults of ROS 2.
pub(super) fn writer() -> QosPolicies {
    QosPolicyBuilder::new()
        .reliability(policy::Reliability::Reliable {
            max_blocking_time: MAX_BLOCKING_TIME,
        })
        .durability(policy::Durability::Volatile)
        .history(policy::History::KeepLast { depth: 10 })
        .build()
}

pub(super) fn reliability(qos: &QosPolicies) -> Option<Reliability> {
    qos.reliability().map(|reliability| match reliability {
        policy::Reliability::BestEffort => Reliability::BestEffort,
        policy::Reliability::Reliable { .. } => Reliability::Reliable,
    })
}

pub(super) fn durability(qos: &QosPolicies) -> Option<Durability> {
    qos.durability().map(|durability| match durability {
        policy::Durability::Volatile => Durability::Volatile,
        policy::Durability::TransientLocal => Durability::TransientLocal,
        policy::Durability::Transient => Durability::Transient,
        policy::Durability::Persistent => Durability::Persistent,
    })
}

/// Returns the conflicting policy, as offered and as requested.
pub(super) fn conflict(offered: &QosPolicies, requested: &QosPolicies) -> (Policy, Policy) {
    let Some(policy) = offered.compliance_failure_wrt(requested) else {
        let unknown = |qos: &QosPolicies| other("policies", format!("{qos:?}"));
        return (unknown(offered), unknown(requested));
    };
    let named = |qos: &QosPolicies, is_offered: bool| name(policy, qos, is_offered);
    (named(offered, true), named(requested, false))
}

fn other(name: &str, value: impl Into<String>) -> Policy {
    Policy::Other {
        name: name.to_owned(),
        value: value.into(),
    }
}

/// Describes one policy of a side; unspecified values are the default of the standard.
fn name(policy: QosPolicyId, qos: &QosPolicies, is_offered: bool) -> Policy {
    let seconds = |duration: Duration| match duration == Duration::INFINITE {
        true => "infinite".to_owned(),
        false => format!("{} s", duration.to_nanoseconds() as f64 * 1e-9),
    };
    match policy {
        QosPolicyId::Reliability => Policy::Reliability {
            is: reliability(qos).unwrap_or(match is_offered {
                true => Reliability::Reliable,
                false => Reliability::BestEffort,
            }),
        },
        QosPolicyId::Durability => Policy::Durability {
            is: durability(qos).unwrap_or(Durability::Volatile),
        },
        QosPolicyId::Ownership => other(
            "ownership",
            match qos.ownership() {
                Some(policy::Ownership::Exclusive { .. }) => "exclusive",
                _ => "shared",
            },
        ),
        QosPolicyId::Deadline => {
            let deadline = qos.deadline().map_or(Duration::INFINITE, |d| d.0);
            other("deadline", seconds(deadline))
        }
        QosPolicyId::LatencyBudget => {
            let budget = qos.latency_budget().map_or(Duration::ZERO, |b| b.duration);
            other("latency budget", seconds(budget))
        }
        QosPolicyId::Liveliness => {
            let (kind, lease) = match qos.liveliness() {
                Some(policy::Liveliness::ManualByParticipant { lease_duration }) => {
                    ("manual by participant", lease_duration)
                }
                Some(policy::Liveliness::ManualByTopic { lease_duration }) => {
                    ("manual by topic", lease_duration)
                }
                Some(policy::Liveliness::Automatic { lease_duration }) => {
                    ("automatic", lease_duration)
                }
                None => ("automatic", Duration::INFINITE),
            };
            other("liveliness", format!("{kind}, lease {}", seconds(lease)))
        }
        QosPolicyId::DestinationOrder => other(
            "destination order",
            match qos.destination_order() {
                Some(policy::DestinationOrder::BySourceTimeStamp) => "by source timestamp",
                _ => "by reception timestamp",
            },
        ),
        QosPolicyId::Representation => {
            let represented = qos.data_representation();
            let value = match is_offered {
                true => vec![policy::DataRepresentation::offered_representation(
                    represented.as_ref(),
                )],
                false => policy::DataRepresentation::accepted_representations(represented.as_ref()),
            };
            let words = value.iter().map(|id| match *id {
                policy::XCDR_DATA_REPRESENTATION => "XCDR1".to_owned(),
                policy::XCDR2_DATA_REPRESENTATION => "XCDR2".to_owned(),
                policy::XML_DATA_REPRESENTATION => "XML".to_owned(),
                id => format!("number {id}"),
            });
            other("data representation", Vec::from_iter(words).join(" or "))
        }
        policy => other(&format!("{policy:?}").to_lowercase(), format!("{qos:?}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn qos_matches_publishers_and_conflict_names_both_sides() {
        let reliabilities = [
            policy::Reliability::BestEffort,
            policy::Reliability::Reliable {
                max_blocking_time: MAX_BLOCKING_TIME,
            },
        ];
        let durabilities = [
            policy::Durability::Volatile,
            policy::Durability::TransientLocal,
        ];
        for reliability in reliabilities {
            for durability in durabilities {
                let offered = QosPolicyBuilder::new()
                    .reliability(reliability)
                    .durability(durability)
                    .build();
                assert_eq!(offered.compliance_failure_wrt(&reader(false)), None);
            }
        }
        let volatile = QosPolicyBuilder::new()
            .reliability(reliabilities[1])
            .durability(policy::Durability::Volatile)
            .build();
        let (offered, requested) = conflict(&volatile, &reader(true));
        assert_eq!(offered.to_string(), "durability volatile");
        assert_eq!(requested.to_string(), "durability transient local");
        let exclusive = QosPolicyBuilder::new()
            .ownership(policy::Ownership::Exclusive { strength: 3 })
            .build();
        let (offered, requested) = conflict(&exclusive, &reader(false));
        assert_eq!(
            (offered.to_string(), requested.to_string()),
            (
                "ownership exclusive".to_owned(),
                "ownership shared".to_owned()
            )
        );
    }
}
