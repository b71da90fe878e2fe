//! Topics as they were met: how many messages, how often.

use super::names::Names;
use super::survey::{NAMED_MESSAGES, Survey, Topic, is_description};
use super::{TOPICS_MOST, TopicId};
use crate::sources::{TopicInfo, TopicUse};
use std::collections::BTreeMap;

/// A topic or channel, and how often it was met.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    pub(crate) topic: String,
    schema: String,
    interfaces: Vec<String>,
    is_description: bool,
    messages: u64,
    first_ns: u64,
    last_ns: u64,
}

impl Seen {
    pub(crate) fn describe(&mut self, topic: &Topic) {
        self.topic.clone_from(&topic.name);
        self.schema.clone_from(&topic.schema);
        self.interfaces = topic.interfaces();
        self.is_description = is_description(topic);
    }

    pub(crate) fn is_description(&self) -> bool {
        self.is_description
    }

    pub(crate) fn messages(&self) -> u64 {
        self.messages
    }

    #[inline]
    pub(crate) fn message(&mut self, received_ns: u64) {
        if self.messages == 0 {
            self.first_ns = received_ns;
        }
        self.first_ns = self.first_ns.min(received_ns);
        self.last_ns = self.last_ns.max(received_ns);
        self.messages += 1;
    }
}

/// Announced topics and their content.
#[derive(Debug, Default)]
pub(crate) struct Announced {
    pub(crate) survey: Survey,
    /// At the topics' numbers.
    pub(crate) seen: Vec<Seen>,
}

impl Announced {
    /// Number of a topic, and whether it is new; `None`: the maximum number is reached.
    pub(crate) fn topic(&mut self, name: &str, schema: &str) -> Option<(TopicId, bool)> {
        let is_same = |topic: &Topic| topic.name == name && topic.schema == schema;
        let existing = self.survey.topics.iter().find(|(_, topic)| is_same(topic));
        if let Some((id, _)) = existing {
            return Some((TopicId(*id), false));
        }
        let id = self.seen.len();
        if id >= TOPICS_MOST {
            return None;
        }
        let topic = Topic::live(name, schema);
        let mut seen = Seen::default();
        seen.describe(&topic);
        self.seen.push(seen);
        self.survey.topics.insert(id as u16, topic);
        Some((TopicId(id as u16), true))
    }

    /// A message; `None`: of no topic that was announced.
    pub(crate) fn message(
        &mut self,
        TopicId(id): TopicId,
        cdr: &[u8],
        received_ns: i64,
    ) -> Option<&Seen> {
        let seen = self.seen.get_mut(usize::from(id))?;
        seen.message(u64::try_from(received_ns).unwrap_or(0));
        if !seen.is_description && seen.messages <= NAMED_MESSAGES {
            self.survey.message(id, received_ns, cdr);
            if let Some(topic) = self.survey.topics.get(&id) {
                seen.describe(topic);
            }
        }
        Some(seen)
    }
}

/// Topics by name, with their roles; several channels may have one topic.
pub(crate) fn topics_of(seen: &[Seen], names: &Names) -> Vec<TopicInfo> {
    let mut topics: BTreeMap<&str, Seen> = BTreeMap::new();
    for seen in seen.iter().filter(|seen| !seen.topic.is_empty()) {
        let all = topics.entry(&seen.topic).or_default();
        if seen.messages > 0 {
            all.message(seen.first_ns);
            all.message(seen.last_ns);
            all.messages = all.messages + seen.messages - 2;
        }
        all.schema.clone_from(&seen.schema);
        all.is_description = seen.is_description;
        all.interfaces.extend_from_slice(&seen.interfaces);
    }
    let info = |(name, all): (&str, Seen)| TopicInfo {
        name: name.to_owned(),
        kind: all.schema,
        messages: all.messages,
        rate_hz: (all.messages > 1 && all.last_ns > all.first_ns)
            .then(|| (all.messages - 1) as f64 * 1e9 / (all.last_ns - all.first_ns) as f64),
        interfaces: all.interfaces,
        role: names
            .role(name)
            .or(all.is_description.then_some(TopicUse::RobotDescription)),
    };
    topics.into_iter().map(info).collect()
}
