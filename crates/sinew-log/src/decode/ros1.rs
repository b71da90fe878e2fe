//! Conversion of ROS 1 messages to the CDR of ROS 2, so that one decoder reads both.
//!
//! ROS 1 writes little-endian values without alignment, strings without a closing zero, and a sequence number
//! before the stamp of a header.

use super::cdr::{DecodeError, ENCAPSULATION};

/// Encoding that MCAP files name for messages of ROS 1.
pub(crate) const ROS1: &str = "ros1";

/// Message types of ROS 1 whose values are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ros1Kind {
    /// Message type `sensor_msgs/JointState`.
    JointState,
    /// Message type `std_msgs/String`, of a robot description.
    String,
}

impl Ros1Kind {
    /// Message type of a schema name; `None`: unsupported.
    pub(crate) fn of_schema(name: &str) -> Option<Self> {
        match name {
            "sensor_msgs/JointState" | "sensor_msgs/msg/JointState" => Some(Self::JointState),
            "std_msgs/String" | "std_msgs/msg/String" => Some(Self::String),
            _ => None,
        }
    }

    /// Converts a payload; `cdr` is replaced, and is empty after an error.
    ///
    /// # Errors
    /// Returns [`DecodeError::Short`] if the payload ends before the last value.
    pub(crate) fn to_cdr(self, payload: &[u8], cdr: &mut Vec<u8>) -> Result<(), DecodeError> {
        cdr.clear();
        cdr.extend_from_slice(&[0, 1, 0, 0]);
        let mut from = Ros1 { payload, at: 0 };
        let converted = match self {
            Self::String => from.string(cdr),
            Self::JointState => from.joint_state(cdr),
        };
        converted.inspect_err(|_| cdr.clear())
    }
}

/// Position in a payload of ROS 1.
struct Ros1<'a> {
    payload: &'a [u8],
    at: usize,
}

impl<'a> Ros1<'a> {
    fn take(&mut self, bytes: u64) -> Result<&'a [u8], DecodeError> {
        let rest = &self.payload[self.at..];
        let length = usize::try_from(bytes).ok().filter(|n| *n <= rest.len());
        let length = length.ok_or(DecodeError::Short {
            at: self.payload.len(),
            wanted: bytes.saturating_sub(rest.len() as u64),
        })?;
        self.at += length;
        Ok(&rest[..length])
    }

    fn u32(&mut self) -> Result<u32, DecodeError> {
        let bytes = self.take(4)?;
        Ok(bytes.first_chunk().map_or(0, |b| u32::from_le_bytes(*b)))
    }

    fn string(&mut self, cdr: &mut Vec<u8>) -> Result<(), DecodeError> {
        let length = self.u32()?;
        let text = self.take(u64::from(length))?;
        align(cdr, 4);
        cdr.extend_from_slice(&length.saturating_add(1).to_le_bytes());
        cdr.extend_from_slice(text);
        cdr.push(0);
        Ok(())
    }

    fn joint_state(&mut self, cdr: &mut Vec<u8>) -> Result<(), DecodeError> {
        let _sequence_number = self.u32()?;
        cdr.extend_from_slice(self.take(8)?);
        self.string(cdr)?;
        let names = self.u32()?;
        align(cdr, 4);
        cdr.extend_from_slice(&names.to_le_bytes());
        for _ in 0..names {
            self.string(cdr)?;
        }
        for _position_velocity_effort in 0..3 {
            let count = self.u32()?;
            let values = self.take(8 * u64::from(count))?;
            align(cdr, 4);
            cdr.extend_from_slice(&count.to_le_bytes());
            if count > 0 {
                align(cdr, 8);
                cdr.extend_from_slice(values);
            }
        }
        Ok(())
    }
}

/// Fills up to a multiple of `to` bytes after the encapsulation header.
fn align(cdr: &mut Vec<u8>, to: usize) {
    let past = (cdr.len() - ENCAPSULATION) % to;
    cdr.resize(cdr.len() + (to - past) % to, 0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decode::{Cdr, Field, MessageKind, parse, stamp_ns};

    fn text(text: &str) -> Vec<u8> {
        [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
    }

    #[test]
    fn ros1_joint_state_becomes_cdr() {
        let mut payload = Vec::new();
        for word in [7_u32, 12, 500] {
            payload.extend(word.to_le_bytes());
        }
        payload.extend(text("base"));
        payload.extend(2_u32.to_le_bytes());
        payload.extend([text("pan"), text("a")].concat());
        for values in [&[1.5, -2.0][..], &[], &[3.0, 4.0]] {
            payload.extend((values.len() as u32).to_le_bytes());
            payload.extend(values.iter().flat_map(|v: &f64| v.to_le_bytes()));
        }
        let mut cdr = vec![9; 3];
        Ros1Kind::JointState
            .to_cdr(&payload, &mut cdr)
            .expect("converted");
        assert_eq!(stamp_ns(&cdr), Some(12_000_000_500));
        let parsed = parse(MessageKind::JointState, &cdr).expect("CDR");
        assert_eq!(parsed.names, [&b"pan"[..], b"a"]);
        let values: Vec<(Field<'_>, f64)> = parsed
            .entries
            .iter()
            .map(|entry| {
                let bytes = cdr[entry.at..].first_chunk().expect("eight bytes");
                (entry.field, f64::from_le_bytes(*bytes))
            })
            .collect();
        let (position, effort) = (Field::Position, Field::Effort);
        assert_eq!(
            values,
            [
                (position, 1.5),
                (position, -2.0),
                (effort, 3.0),
                (effort, 4.0)
            ]
        );
        // Cut anywhere, it is an error and no panic; a wrong length is not allocated for.
        for end in 0..payload.len() {
            let error = Ros1Kind::JointState.to_cdr(&payload[..end], &mut cdr);
            assert!(error.is_err() && cdr.is_empty(), "{end}");
        }
        payload[12..16].fill(0xff);
        assert!(Ros1Kind::JointState.to_cdr(&payload, &mut cdr).is_err());
    }

    #[test]
    fn ros1_string_becomes_cdr() {
        let mut cdr = Vec::new();
        Ros1Kind::String
            .to_cdr(&text("<robot/>"), &mut cdr)
            .expect("converted");
        assert_eq!(
            Cdr::new(&cdr).and_then(|mut cdr| cdr.string()),
            Ok(&b"<robot/>"[..])
        );
    }
}
