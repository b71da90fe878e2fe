//! Faults of a transport and their end.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Fault or event of a topic, a publisher or a transport.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum TransportFault {
    /// The policy of a publisher is incompatible with the requested one; no message is received from it.
    Incompatible {
        /// Name of the topic.
        topic: String,
        /// Name of the publisher.
        publisher: String,
        /// Policy that the publisher offers.
        offered: Policy,
        /// Policy that is requested.
        requested: Policy,
    },
    /// A topic with an expected name has another type.
    WrongType {
        /// Name of the topic.
        topic: String,
        /// Type of the topic.
        found: String,
    },
    /// The encoding of messages of a topic is unsupported.
    Unreadable {
        /// Name of the topic.
        topic: String,
        /// Number of unreadable messages so far.
        messages: u64,
        /// Reason for the last message.
        reason: String,
    },
    /// A message exceeds the maximum length.
    TooLong {
        /// Name of the topic.
        topic: String,
        /// Length of the message, bytes.
        bytes: u64,
        /// Maximum length, bytes.
        most: u64,
    },
    /// A publisher appeared or returned.
    PublisherFound {
        /// Name of the topic.
        topic: String,
        /// Name of the publisher.
        publisher: String,
    },
    /// A publisher disappeared.
    PublisherLost {
        /// Name of the topic.
        topic: String,
        /// Name of the publisher.
        publisher: String,
        /// Kind of the loss.
        how: PublisherLoss,
    },
    /// A topic has a publisher, but no message is received.
    Quiet {
        /// Name of the topic.
        topic: String,
        /// Time without messages, s.
        for_s: f64,
    },
    /// The transport is disconnected; nothing is received until it is connected again.
    #[serde(rename = "shut")]
    Disconnected {
        /// Name of the transport, such as `dds:0`.
        transport: String,
        /// Reason of the disconnection.
        reason: String,
    },
    /// The transport is connected, for the first time or again.
    #[serde(rename = "open")]
    Connected {
        /// Name of the transport, such as `dds:0`.
        transport: String,
    },
    /// The transport was restarted because the civil clock, by which its library numbers samples, stepped back.
    ClockWentBack {
        /// Size of the step, s.
        by_s: f64,
    },
    /// A growing recording continues in another file.
    NextFile {
        /// Path of the file.
        file: String,
    },
    /// A growing recording was replaced by another of the same name.
    Replaced {
        /// Path of the file.
        file: String,
    },
    /// A growing recording is damaged: the rest of the file is skipped.
    Damaged {
        /// Path of the file.
        file: String,
        /// Position of the damage, bytes from the start of the file.
        offset: u64,
        /// Reason why the record is unreadable.
        reason: String,
    },
}

/// Kind of the loss of a publisher.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "how", rename_all = "kebab-case")]
pub enum PublisherLoss {
    /// The publisher signed off.
    #[serde(rename = "left")]
    SignedOff,
    /// No message or heartbeat was received for some time.
    Silent {
        /// Time without a sign of life, s.
        for_s: f64,
    },
}

/// Reliability policy: whether lost messages are sent again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reliability {
    /// PublisherLoss messages are not sent again.
    BestEffort,
    /// PublisherLoss messages are sent again.
    Reliable,
}

/// Durability policy: whether late subscribers receive earlier messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Durability {
    /// Late subscribers receive no earlier messages.
    Volatile,
    /// Earlier messages are kept while the publisher lives.
    TransientLocal,
    /// Earlier messages are kept while the host of the publisher runs.
    Transient,
    /// Earlier messages are kept on disk.
    Persistent,
}

/// Policy on one side of a topic.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "policy", rename_all = "kebab-case")]
pub enum Policy {
    /// Reliability policy of the side.
    Reliability {
        /// Value of the policy.
        is: Reliability,
    },
    /// Durability policy of the side.
    Durability {
        /// Value of the policy.
        is: Durability,
    },
    /// Other policy, named as in its standard.
    Other {
        /// Name of the policy, such as `ownership`.
        name: String,
        /// Value of the policy, such as `exclusive`.
        value: String,
    },
}

impl fmt::Display for Policy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Policy::Reliability { is } => f.write_str(match is {
                Reliability::BestEffort => "reliability best effort",
                Reliability::Reliable => "reliability reliable",
            }),
            Policy::Durability { is } => f.write_str(match is {
                Durability::Volatile => "durability volatile",
                Durability::TransientLocal => "durability transient local",
                Durability::Transient => "durability transient",
                Durability::Persistent => "durability persistent",
            }),
            Policy::Other { name, value } => write!(f, "{name} {value}"),
        }
    }
}

impl fmt::Display for TransportFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TransportFault::Incompatible {
                topic,
                publisher,
                offered,
                requested,
            } => write!(
                f,
                "{topic}: no data from publisher {publisher}: incompatible policy, offered {offered}, requested {requested}"
            ),
            TransportFault::WrongType { topic, found } => {
                write!(f, "{topic}: unsupported type {found}")
            }
            TransportFault::Unreadable {
                topic,
                messages,
                reason,
            } => write!(f, "{topic}: {messages} unreadable messages: {reason}"),
            TransportFault::TooLong { topic, bytes, most } => write!(
                f,
                "{topic}: message of {bytes} bytes discarded, limit {most} bytes"
            ),
            TransportFault::PublisherFound { topic, publisher } => {
                write!(f, "{topic}: publisher {publisher} connected")
            }
            TransportFault::PublisherLost {
                topic,
                publisher,
                how,
            } => match how {
                PublisherLoss::SignedOff => {
                    write!(f, "{topic}: publisher {publisher} disconnected")
                }
                PublisherLoss::Silent { for_s } => write!(
                    f,
                    "{topic}: publisher {publisher} lost: no sign of life for {for_s:.1} s"
                ),
            },
            TransportFault::Quiet { topic, for_s } => write!(
                f,
                "{topic}: no data for {for_s} s although a publisher exists: check the publisher, the firewall and the policies"
            ),
            TransportFault::Disconnected { transport, reason } => {
                write!(f, "{transport}: disconnected: {reason}")
            }
            TransportFault::Connected { transport } => write!(f, "{transport}: connected"),
            TransportFault::ClockWentBack { by_s } => write!(
                f,
                "clock of the host stepped back by {by_s:.1} s; transport restarted"
            ),
            TransportFault::NextFile { file } => write!(f, "continues in {file}"),
            TransportFault::Replaced { file } => {
                write!(f, "{file} replaced; reading from its start")
            }
            TransportFault::Damaged {
                file,
                offset,
                reason,
            } => {
                write!(
                    f,
                    "{file}: damaged at byte {offset}, rest skipped: {reason}"
                )
            }
        }
    }
}
