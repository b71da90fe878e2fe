//! What there is to watch, for somebody who doesn't know yet.

use crate::trouble::{Durability, Reliability, Trouble};
use serde::{Deserialize, Serialize};
use sinew_log::TopicInfo;
use sinew_log::live::RobotFound;

/// Who publishes a topic.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PublisherFound {
    /// Its identity on the network.
    pub id: String,
    /// Name of its process or node, where it says one.
    pub name: Option<String>,
    /// Whether it sends lost messages again; `None`: it doesn't say.
    pub reliability: Option<Reliability>,
    /// Whether who comes late gets what it published before; `None`: it doesn't say.
    pub durability: Option<Durability>,
}

/// A topic of a network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TopicFound {
    /// Name, type, rate and use. Messages are counted of topics that are read only.
    #[serde(flatten)]
    pub topic: TopicInfo,
    /// Who publishes it.
    pub publishers: Vec<PublisherFound>,
}

/// What was found behind one door, such as a domain of DDS.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DomainFound {
    /// Which, such as `dds:0`.
    pub door: String,
    /// For how long it was listened to, s.
    pub listened_s: f64,
    /// Its topics by name.
    pub topics: Vec<TopicFound>,
    /// What looks like a robot.
    pub robots: Vec<RobotFound>,
    /// What kept messages away.
    pub troubles: Vec<Trouble>,
}
