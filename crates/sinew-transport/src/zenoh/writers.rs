//! Writers of the two kinds of published messages, numbered and time-stamped as rmw_zenoh does.

use super::keys;
use crate::outbox::Sealed;
use crate::received::Clock;
use std::collections::BTreeMap;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::{Session, Wait as _};

/// Published topic with its token.
struct Writer {
    publisher: Publisher<'static>,
    /// Token that announces the publisher.
    _token: LivelinessToken,
    identity: [u8; 16],
    last: i64,
}

/// Writers of a session, created at their first use.
pub(super) struct Writers {
    domain: u16,
    clock: Clock,
    node: Option<LivelinessToken>,
    all: BTreeMap<String, Writer>,
}

impl Writers {
    pub(super) fn new(domain: u16, clock: Clock) -> Self {
        Writers {
            domain,
            clock,
            node: None,
            all: BTreeMap::new(),
        }
    }

    pub(super) fn write(&mut self, session: &Session, sealed: Sealed) -> Result<(), String> {
        if !self.all.contains_key(&sealed.topic) {
            let writer = self.declare(session, &sealed)?;
            self.all.insert(sealed.topic.clone(), writer);
        }
        let writer = self.all.get_mut(&sealed.topic).ok_or("writer not found")?;
        writer.last += 1;
        let attachment = attachment(writer.last, self.clock.now().utc_ns, writer.identity);
        let put = writer.publisher.put(sealed.cdr).attachment(attachment);
        put.wait().map_err(|e| e.to_string())
    }

    fn declare(&mut self, session: &Session, sealed: &Sealed) -> Result<Writer, String> {
        let message = |error: zenoh::Error| error.to_string();
        let session_id = session.zid();
        if self.node.is_none() {
            let token = keys::node_token(self.domain, &session_id.to_string());
            let declared = session.liveliness().declare_token(token);
            self.node = Some(declared.wait().map_err(message)?);
        }
        let entity = self.all.len() + 1;
        let (topic, schema) = (&sealed.topic, sealed.schema);
        let without_hash = || format!("type hash of {schema} not available");
        let key = keys::published(self.domain, topic, schema).ok_or_else(without_hash)?;
        let token =
            keys::publisher_token(self.domain, &session_id.to_string(), entity, topic, schema);
        let token = token.ok_or_else(without_hash)?;
        let publisher = session.declare_publisher(key).wait().map_err(message)?;
        let token = session.liveliness().declare_token(token);
        let mut identity = session_id.to_le_bytes();
        identity[15] ^= entity as u8;
        Ok(Writer {
            publisher,
            _token: token.wait().map_err(message)?,
            identity,
            last: 0,
        })
    }
}

/// Returns the attachment of rmw_zenoh to a message: number, time of sending in ns, and identity of the publisher
/// with its length.
fn attachment(number: i64, utc_ns: i64, identity: [u8; 16]) -> Vec<u8> {
    let mut out = Vec::with_capacity(33);
    out.extend(number.to_le_bytes());
    out.extend(utc_ns.to_le_bytes());
    out.push(identity.len() as u8);
    out.extend(identity);
    out
}

#[cfg(test)]
mod tests {
    use super::attachment;

    #[test]
    fn attachment_has_number_time_and_identity() {
        let bytes = attachment(7, -1, [9; 16]);
        assert_eq!(bytes.len(), 33);
        assert_eq!(bytes[..8], [7, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(bytes[8..16], [255; 8]);
        assert_eq!(bytes[16..], [&[16], &[9; 16][..]].concat());
    }
}
