//! Keys of rmw_zenoh: names of topics on Zenoh, and tokens that describe publishers.
//!
//! Topic `/arm7/joint_states` of domain 0 has the key `0/arm7/joint_states/TYPE/HASH`, with the type as on DDS. The
//! token of a publisher is `@ros2_lv/0/SESSION/NODE/ENTITY/MP/ENCLAVE/NAMESPACE/NAME/TOPIC/TYPE/HASH/QOS`, with `%`
//! for every `/` of a name.

use crate::error::{Durability, Reliability};
use crate::ros_names::{dds_type, schema_of};

/// Key expression of all tokens in every domain.
pub(super) const TOKENS: &str = "@ros2_lv/**";

/// Returns the domain of a token.
pub(super) fn domain(token: &str) -> Option<u16> {
    token
        .strip_prefix("@ros2_lv/")?
        .split('/')
        .next()?
        .parse()
        .ok()
}

/// Returns the key expression of all tokens in a domain.
pub(super) fn tokens(domain: u16) -> String {
    format!("@ros2_lv/{domain}/**")
}

/// Returns the key expression of the messages of a topic, for any type hash.
pub(super) fn messages(domain: u16, topic: &str, schema: &str) -> String {
    let topic = topic.trim_matches('/');
    format!("{domain}/{topic}/{}/*", dds_type(schema))
}

/// Returns the keys under which publishers keep earlier messages: present ones, and those before Zenoh 1.1.
pub(super) fn kept(domain: u16, topic: &str, schema: &str) -> [String; 2] {
    let messages = messages(domain, topic, schema);
    [format!("{messages}/@adv/pub/**"), messages]
}

/// Returns the key under which a topic is published.
pub(super) fn published(domain: u16, topic: &str, schema: &str) -> Option<String> {
    let topic = topic.trim_matches('/');
    let hash = type_hash(schema)?;
    Some(format!("{domain}/{topic}/{}/{hash}", dds_type(schema)))
}

/// Name of the Sinew node.
const NODE: &str = "sinew";

/// Returns the token of the Sinew node.
pub(super) fn node_token(domain: u16, session: &str) -> String {
    format!("@ros2_lv/{domain}/{session}/0/0/NN/%/%/{NODE}")
}

/// Returns the token of a topic published by Sinew: reliable, volatile, history of ten.
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

/// Returns the SHA-256 of a published type's description (REP 2016).
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

/// Parsed token of a publisher.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Token {
    /// Zenoh identity of the process.
    pub(super) session: String,
    /// Session, node and entity.
    pub(super) id: String,
    /// Node with its namespace, such as `/arm7/driver`.
    pub(super) node: String,
    pub(super) topic: String,
    pub(super) schema: String,
    pub(super) reliability: Option<Reliability>,
    pub(super) durability: Option<Durability>,
}

impl Token {
    /// Parses a token; `None`: not a publisher of a ROS 2 topic.
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
        // Empty means the default of rmw_zenoh: reliable and volatile.
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

    /// Returns the display name of the publisher.
    pub(super) fn named(&self) -> String {
        format!("{} ({})", self.node, self.id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Token declared by `ros2 run demo_nodes_cpp talker` under rmw_zenoh_cpp (its design page).
    const TALKER: &str = "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/::,7:,:,:,,";

    #[test]
    fn token_of_publisher_is_parsed() {
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
    fn token_other_kinds_return_none() {
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
    fn token_of_published_topic_round_trips() {
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
