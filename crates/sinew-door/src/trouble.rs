//! What goes wrong at a door, and what is right again.

use serde::{Deserialize, Serialize};
use std::fmt;

/// What a door has to say of a topic, a publisher or itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Trouble {
    /// A publisher's policy can't match what is asked for, so nothing of it comes.
    Incompatible {
        /// The topic's name.
        topic: String,
        /// Name of the publisher.
        publisher: String,
        /// What the publisher offers.
        offered: Policy,
        /// What is asked for.
        requested: Policy,
    },
    /// A topic of a name that is expected has another type.
    WrongType {
        /// The topic's name.
        topic: String,
        /// The type it has.
        found: String,
    },
    /// Messages of a topic can't be read by their framing: another encoding, or too long.
    Unreadable {
        /// The topic's name.
        topic: String,
        /// How many so far.
        messages: u64,
        /// Why, of the last one.
        why: String,
    },
    /// A message is longer than a message may be.
    TooLong {
        /// The topic's name.
        topic: String,
        /// Length of the message, bytes.
        bytes: u64,
        /// The most there may be.
        most: u64,
    },
    /// A publisher came, or is back.
    PublisherFound {
        /// The topic's name.
        topic: String,
        /// Name of the publisher.
        publisher: String,
    },
    /// A publisher is gone.
    PublisherLost {
        /// The topic's name.
        topic: String,
        /// Name of the publisher.
        publisher: String,
        /// How the publisher went.
        how: Lost,
    },
    /// Somebody publishes a topic, and nothing of it comes.
    Quiet {
        /// The topic's name.
        topic: String,
        /// For so long, s.
        for_s: f64,
    },
    /// The door is shut: nothing comes until it says otherwise.
    Shut {
        /// The door's name, such as `dds:0`.
        door: String,
        /// The reason.
        why: String,
    },
    /// The door is open, again or for the first time.
    Open {
        /// The door's name, such as `dds:0`.
        door: String,
    },
    /// The door started anew, since the civil clock went back and its library counts by it.
    ClockWentBack {
        /// By so much, s.
        by_s: f64,
    },
    /// A growing recording goes on in another file.
    NextFile {
        /// Path of the file.
        file: String,
    },
    /// A growing recording was replaced by another of its name.
    Replaced {
        /// Path of the file.
        file: String,
    },
    /// A growing recording is damaged: the rest of the file is left out.
    Damaged {
        /// Path of the file.
        file: String,
        /// Byte from which on.
        offset: u64,
        /// The reason.
        why: String,
    },
}

/// How a publisher went.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "how", rename_all = "kebab-case")]
pub enum Lost {
    /// It said so.
    Left,
    /// Nothing was heard of it for so long.
    Silent {
        /// For so long, s.
        for_s: f64,
    },
}

/// Whether lost messages are sent again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reliability {
    /// Lost messages are not sent again.
    BestEffort,
    /// Lost messages are sent again.
    Reliable,
}

/// Whether who comes late gets what was published before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Durability {
    /// Who comes late gets nothing.
    Volatile,
    /// Yes, while the publisher lives.
    TransientLocal,
    /// Yes, while the publisher's computer runs.
    Transient,
    /// Who comes late gets all that was kept on disk.
    Persistent,
}

/// A policy on one side of a topic.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "policy", rename_all = "kebab-case")]
pub enum Policy {
    /// Whether lost messages are sent again.
    Reliability {
        /// The value of the policy.
        is: Reliability,
    },
    /// Whether who comes late gets what was published before.
    Durability {
        /// The value of the policy.
        is: Durability,
    },
    /// Another one, in the words of its standard.
    Other {
        /// Such as `ownership`.
        name: String,
        /// Such as `exclusive`.
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

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Trouble::Incompatible {
                topic,
                publisher,
                offered,
                requested,
            } => write!(
                f,
                "{topic}: nothing comes of publisher {publisher}: it offers {offered}, {requested} is asked for"
            ),
            Trouble::WrongType { topic, found } => {
                write!(f, "{topic}: its type is {found}, which is not read")
            }
            Trouble::Unreadable {
                topic,
                messages,
                why,
            } => write!(f, "{topic}: {messages} messages can't be read: {why}"),
            Trouble::TooLong { topic, bytes, most } => write!(
                f,
                "{topic}: a message has {bytes} bytes; at most {most} are taken"
            ),
            Trouble::PublisherFound { topic, publisher } => {
                write!(f, "{topic}: publisher {publisher} is there")
            }
            Trouble::PublisherLost {
                topic,
                publisher,
                how,
            } => match how {
                Lost::Left => write!(f, "{topic}: publisher {publisher} left"),
                Lost::Silent { for_s } => write!(
                    f,
                    "{topic}: publisher {publisher} is gone: nothing was heard of it for {for_s:.1} s"
                ),
            },
            Trouble::Quiet { topic, for_s } => write!(
                f,
                "{topic}: somebody publishes it, and nothing came for {for_s} s: it is silent, or a firewall or policy keeps it away"
            ),
            Trouble::Shut { door, why } => write!(f, "{door}: nothing comes: {why}"),
            Trouble::Open { door } => write!(f, "{door}: open"),
            Trouble::ClockWentBack { by_s } => write!(
                f,
                "the computer's clock went back by {by_s:.1} s; listening starts anew"
            ),
            Trouble::NextFile { file } => write!(f, "goes on in {file}"),
            Trouble::Replaced { file } => write!(f, "{file} was replaced; read from its start"),
            Trouble::Damaged { file, offset, why } => {
                write!(f, "{file}: damaged from byte {offset} on, and left: {why}")
            }
        }
    }
}
