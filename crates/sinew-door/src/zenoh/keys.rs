//! Keys of rmw_zenoh: what a topic is called on Zenoh, and what a token says of who publishes it.
//!
//! A topic `/arm7/joint_states` of domain 0 is `0/arm7/joint_states/TYPE/HASH`, with the type as on DDS. A publisher's
//! token is `@ros2_lv/0/SESSION/NODE/ENTITY/MP/ENCLAVE/NAMESPACE/NAME/TOPIC/TYPE/HASH/QOS`, with `%` for every `/` of a name.

use crate::ros_names::{dds_type, schema_of};
use crate::trouble::{Durability, Reliability};

/// Tokens of everybody in every domain.
pub(super) const TOKENS: &str = "@ros2_lv/**";

/// The domain of a token.
pub(super) fn domain(token: &str) -> Option<u16> {
    token
        .strip_prefix("@ros2_lv/")?
        .split('/')
        .next()?
        .parse()
        .ok()
}

/// Tokens of everybody in a domain.
pub(super) fn tokens(domain: u16) -> String {
    format!("@ros2_lv/{domain}/**")
}

/// A topic's messages, whatever the hash of its type.
pub(super) fn messages(domain: u16, topic: &str, schema: &str) -> String {
    let topic = topic.trim_matches('/');
    format!("{domain}/{topic}/{}/*", dds_type(schema))
}

/// Where the publishers of a topic keep what they published before: those of today, and those before Zenoh 1.1.
pub(super) fn kept(domain: u16, topic: &str, schema: &str) -> [String; 2] {
    let messages = messages(domain, topic, schema);
    [format!("{messages}/@adv/pub/**"), messages]
}

/// The key that a topic is published under.
pub(super) fn published(domain: u16, topic: &str, schema: &str) -> Option<String> {
    let topic = topic.trim_matches('/');
    let hash = type_hash(schema)?;
    Some(format!("{domain}/{topic}/{}/{hash}", dds_type(schema)))
}

/// The name of Sinew's node.
const NODE: &str = "sinew";

/// The token of Sinew's node.
pub(super) fn node_token(domain: u16, session: &str) -> String {
    format!("@ros2_lv/{domain}/{session}/0/0/NN/%/%/{NODE}")
}

/// The token of a topic that Sinew publishes, reliable, volatile, the last ten kept.
pub(super) fn publisher_token(
    domain: u16,
    session: &str,
    entity: usize,
    topic: &str,
    schema: &str,
) -> Option<String> {
    let (topic, kind) = (topic.replace('/', "%"), dds_type(schema));
    let hash = type_hash(schema)?;
    Some(format!(
        "@ros2_lv/{domain}/{session}/0/{entity}/MP/%/%/{NODE}/{topic}/{kind}/{hash}/::,10:,:,:,,"
    ))
}

/// SHA-256 of the type's description (REP 2016), of what is published.
fn type_hash(schema: &str) -> Option<&'static str> {
    match schema {
        "diagnostic_msgs/msg/DiagnosticArray" => {
            Some("RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e")
        }
        "control_msgs/msg/DynamicJointState" => {
            Some("RIHS01_18024c98a62697680f581108eeed40b28fb4542fa0ac5a8e36f56c62b6813d26")
        }
        _ => None,
    }
}

/// A publisher's token, read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Token {
    /// Zenoh's identity of the process.
    pub(super) session: String,
    /// Session, node and entity.
    pub(super) id: String,
    /// The node with its namespace, such as `/arm7/driver`.
    pub(super) node: String,
    pub(super) topic: String,
    pub(super) schema: String,
    pub(super) reliability: Option<Reliability>,
    pub(super) durability: Option<Durability>,
}

impl Token {
    /// `None`: the token of something else than a publisher of a topic of ROS 2.
    pub(super) fn read(key: &str) -> Option<Token> {
        let parts: Vec<&str> = key.split('/').collect();
        let [
            "@ros2_lv",
            _domain,
            session,
            node_id,
            entity,
            "MP",
            _enclave,
            namespace,
            name,
            topic,
            kind,
            _hash,
            qos,
        ] = parts[..]
        else {
            return None;
        };
        let whole = |mangled: &str| mangled.replace('%', "/");
        let topic = whole(topic);
        if topic.len() < 2 || !topic.starts_with('/') {
            return None;
        }
        let mut policies = qos.split(':');
        // Empty is rmw_zenoh's default: reliable and volatile.
        let reliability = match policies.next() {
            Some("" | "1") => Some(Reliability::Reliable),
            Some("2") => Some(Reliability::BestEffort),
            _ => None,
        };
        let durability = match policies.next() {
            Some("1") => Some(Durability::TransientLocal),
            Some("" | "2") => Some(Durability::Volatile),
            _ => None,
        };
        Some(Token {
            session: session.to_owned(),
            id: format!("{session}/{node_id}/{entity}"),
            node: format!("{}/{name}", whole(namespace).trim_end_matches('/')),
            topic,
            schema: schema_of(kind)?,
            reliability,
            durability,
        })
    }

    /// The publisher in words.
    pub(super) fn named(&self) -> String {
        format!("{} ({})", self.node, self.id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `ros2 run demo_nodes_cpp talker` and a state publisher of rmw_zenoh_cpp declare them (its design page).
    const TALKER: &str = "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/::,7:,:,:,,";

    #[test]
    fn a_publishers_token_is_read() {
        let token = Token::read(TALKER).unwrap();
        assert_eq!(token.topic, "/chatter");
        assert_eq!(token.schema, "std_msgs/msg/String");
        assert_eq!(token.node, "/talker");
        assert_eq!(token.id, "aac3178e146ba6f1fc6e6a4085e77f21/0/10");
        assert_eq!(token.reliability, Some(Reliability::Reliable));
        assert_eq!(token.durability, Some(Durability::Volatile));
        let described = TALKER
            .replace(
                "%/%/talker/%chatter",
                "%/%arm7/driver/%arm7%robot_description",
            )
            .replace("/::,7:", "/2:1:,1:");
        let token = Token::read(&described).unwrap();
        assert_eq!(
            (token.topic.as_str(), token.node.as_str()),
            ("/arm7/robot_description", "/arm7/driver")
        );
        assert_eq!(token.reliability, Some(Reliability::BestEffort));
        assert_eq!(token.durability, Some(Durability::TransientLocal));
    }

    #[test]
    fn other_tokens_and_strangers_are_none() {
        let subscriber = TALKER.replace("/MP/", "/MS/");
        let service = TALKER.replace("::msg::", "::srv::");
        let short = TALKER.rsplit_once('/').unwrap().0;
        let long = format!("{TALKER}/more");
        let nameless = TALKER.replace("%chatter", "%");
        let node = node_token(2, "aac3");
        for key in [
            &subscriber,
            &service,
            short,
            &long,
            &nameless,
            &node,
            "",
            "@ros2_lv",
        ] {
            assert_eq!(Token::read(key), None, "{key}");
        }
    }

    #[test]
    fn what_is_published_reads_back() {
        let (topic, schema) = ("/arm7/sinew/tendons", "control_msgs/msg/DynamicJointState");
        let key = publisher_token(3, "ab", 2, topic, schema).unwrap();
        let token = Token::read(&key).unwrap();
        assert_eq!(
            (token.topic.as_str(), token.schema.as_str()),
            (topic, schema)
        );
        assert_eq!(
            (token.node.as_str(), token.id.as_str()),
            ("/sinew", "ab/0/2")
        );
        let published = published(3, topic, schema).unwrap();
        let (all, _hash) = published.rsplit_once('/').unwrap();
        assert_eq!(messages(3, topic, schema), format!("{all}/*"));
    }
}
