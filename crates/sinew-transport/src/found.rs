//! Results of discovery: topics, publishers and robots of a network.

use crate::error::{Durability, Reliability, TransportFault};
use serde::{Deserialize, Serialize};
use sinew_log::TopicInfo;
use sinew_log::live::RobotFound;

/// Publisher of a topic.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PublisherFound {
    /// Identity of the publisher on the network.
    pub id: String,
    /// Name of the process or node, if announced.
    pub name: Option<String>,
    /// Reliability offered by the publisher; `None`: not announced.
    pub reliability: Option<Reliability>,
    /// Durability offered by the publisher; `None`: not announced.
    pub durability: Option<Durability>,
}

/// Topic of a network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TopicFound {
    /// Name, type, rate and role. Messages are counted only for topics that are received.
    #[serde(flatten)]
    pub topic: TopicInfo,
    /// Publishers of the topic.
    pub publishers: Vec<PublisherFound>,
}

/// Result of discovery on one transport, such as a DDS domain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DomainFound {
    /// Name of the transport, such as `dds:0`.
    pub transport: String,
    /// Duration of listening, s.
    pub listened_s: f64,
    /// Topics, sorted by name.
    pub topics: Vec<TopicFound>,
    /// Robots recognised by their topics.
    pub robots: Vec<RobotFound>,
    /// Faults that prevented the reception of messages.
    #[serde(rename = "troubles")]
    pub faults: Vec<TransportFault>,
}
