//! Channels of ROS 1 in an MCAP file, as `mcap convert` writes them.

use super::messages::{Item, Summary};
use crate::decode::{ROS1, Ros1Kind};
use std::collections::BTreeMap;

/// Channels whose messages are encoded as in ROS 1, and the latest message as CDR.
#[derive(Default)]
pub(super) struct Ros1Channels {
    schemas: BTreeMap<u16, String>,
    kinds: BTreeMap<u16, Ros1Kind>,
    converted: Option<Vec<u8>>,
    /// Memory of the last converted message.
    spare: Vec<u8>,
}

impl Ros1Channels {
    /// Adds the channels that a summary announces.
    pub(super) fn announce(&mut self, summary: &Summary) {
        for (id, topic) in &summary.topics {
            if topic.encoding == ROS1 {
                self.add(*id, Ros1Kind::of_schema(&topic.schema));
            }
        }
    }

    /// Whether no channel is of ROS 1.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.kinds.is_empty()
    }

    fn add(&mut self, channel: u16, kind: Option<Ros1Kind>) {
        if let Some(kind) = kind {
            self.kinds.insert(channel, kind);
        }
    }

    /// Notes a definition, or converts the payload of a message; one that cannot be decoded becomes empty.
    pub(super) fn see(&mut self, item: &Item, payload: &[u8]) {
        if let Some(cdr) = self.converted.take() {
            self.spare = cdr;
        }
        match item {
            Item::Schema { id, name } => {
                self.schemas.insert(*id, name.clone());
            }
            Item::Channel(channel) if channel.message_encoding == ROS1 => {
                let schema = self.schemas.get(&channel.schema_id);
                self.add(
                    channel.id,
                    schema.and_then(|name| Ros1Kind::of_schema(name)),
                );
            }
            Item::Message { channel, .. } => {
                if let Some(kind) = self.kinds.get(channel) {
                    let mut cdr = std::mem::take(&mut self.spare);
                    // The reader counts an empty payload as undecodable.
                    let _error = kind.to_cdr(payload, &mut cdr);
                    self.converted = Some(cdr);
                }
            }
            Item::Channel(_) | Item::Damage | Item::End => {}
        }
    }

    /// The latest message as CDR, if it is of ROS 1.
    pub(super) fn converted(&self) -> Option<&[u8]> {
        self.converted.as_deref()
    }
}
