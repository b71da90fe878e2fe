//! Raw payloads: received bytes go into the queues without being decoded or copied twice.

use crate::received::Received;
use crate::route::Targets;
use rustdds::RepresentationIdentifier;
use rustdds::bytes::Bytes;
use rustdds::no_key::{Decode, DeserializerAdapter, SerializerAdapter};

/// Outcome of a payload, which is forwarded during decoding.
#[derive(Debug)]
pub(super) enum Forwarded {
    /// Put into the queues.
    Message,
    /// Discarded: longer than the maximum length; its length, bytes.
    TooLong(u64),
}

/// Data representation that is not supported.
#[derive(Debug, thiserror::Error)]
#[error("data representation {0:?} is unsupported; expected plain CDR")]
pub(super) struct Unread(RepresentationIdentifier);

/// (De)serialiser that keeps payloads as bytes.
pub(super) struct Raw;

impl DeserializerAdapter<Forwarded> for Raw {
    type Error = Unread;
    type Decoded = Forwarded;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[
            RepresentationIdentifier::CDR_LE,
            RepresentationIdentifier::CDR_BE,
        ]
    }

    fn transform_decoded(decoded: Forwarded) -> Forwarded {
        decoded
    }
}

/// Decoder that puts a payload into queues.
#[derive(Debug, Clone, Copy)]
pub(super) struct Forward<'q> {
    pub(super) targets: &'q Targets,
    pub(super) received: Received,
    pub(super) most: usize,
}

impl<'de> Decode<'de, Forwarded> for Forward<'_> {
    type Error = Unread;

    fn decode_bytes(
        self,
        payload: &'de [u8],
        encoding: RepresentationIdentifier,
    ) -> Result<Forwarded, Unread> {
        let head = match encoding {
            RepresentationIdentifier::CDR_LE => [0, 1, 0, 0],
            RepresentationIdentifier::CDR_BE => [0, 0, 0, 0],
            other => return Err(Unread(other)),
        };
        if payload.len() > self.most {
            return Ok(Forwarded::TooLong(payload.len() as u64));
        }
        let parts: [&[u8]; 2] = [&head, payload];
        let source_ns = self.received.monotonic_ns;
        self.targets.message(self.received, source_ns, &parts);
        Ok(Forwarded::Message)
    }
}

impl SerializerAdapter<Bytes> for Raw {
    type Error = std::convert::Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(payload: &Bytes) -> Result<Bytes, Self::Error> {
        Ok(payload.clone())
    }
}
