//! `JointState` and `DynamicJointState` payloads: names and offsets of the values.
//!
//! A publisher repeats the same names in the same order in nearly every message.
//! A message is therefore parsed once into a [`Layout`]; while the bytes that are
//! not values stay the same, the following messages are compared with `memcmp`
//! and their values copied from known offsets.

use super::cdr::{Cdr, DecodeError, ENCAPSULATION};

/// Stamp of the header, the only bytes before the values that change.
const STAMP: std::ops::Range<usize> = ENCAPSULATION..ENCAPSULATION + 8;
/// Messages longer than this are decoded each time: keeping them costs memory.
const CACHED_BYTES_LIMIT: usize = 64 << 10;

/// Message types whose values are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageKind {
    /// Message type `sensor_msgs/msg/JointState`.
    JointState,
    /// Message type `control_msgs/msg/DynamicJointState`.
    DynamicJointState,
}

impl MessageKind {
    /// The schema's name.
    pub fn schema(self) -> &'static str {
        match self {
            MessageKind::JointState => "sensor_msgs/msg/JointState",
            MessageKind::DynamicJointState => "control_msgs/msg/DynamicJointState",
        }
    }

    /// Message type of a schema name; `None`: unsupported.
    pub fn of_schema(name: &str) -> Option<MessageKind> {
        match name {
            "sensor_msgs/msg/JointState" | "sensor_msgs/JointState" => {
                Some(MessageKind::JointState)
            }
            "control_msgs/msg/DynamicJointState" | "control_msgs/DynamicJointState" => {
                Some(MessageKind::DynamicJointState)
            }
            _ => None,
        }
    }
}

/// Field of a joint in a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field<'a> {
    /// Position of the joint.
    Position,
    /// The joint's velocity.
    Velocity,
    /// The joint's effort.
    Effort,
    /// An interface by its name.
    Interface(&'a [u8]),
}

/// Value in a payload.
#[derive(Debug, Clone, Copy)]
pub struct Entry<'a> {
    /// Joint's name as recorded.
    pub joint: &'a [u8],
    /// Field of the joint.
    pub field: Field<'a>,
    /// Offset in the payload, bytes; the value has eight bytes.
    pub at: usize,
}

/// A payload taken apart.
#[derive(Debug)]
pub struct Parsed<'a> {
    big_endian: bool,
    /// Joints named, in the message's order.
    pub names: Vec<&'a [u8]>,
    /// Values with their joints.
    pub entries: Vec<Entry<'a>>,
    /// Byte ranges that hold values, ascending.
    values: Vec<(usize, usize)>,
    end: usize,
    /// Fewer values than names somewhere.
    pub short: bool,
}

/// Parses a payload.
///
/// # Errors
/// Returns a [`DecodeError`] if the payload is not plain CDR or is truncated.
pub fn parse(kind: MessageKind, data: &[u8]) -> Result<Parsed<'_>, DecodeError> {
    let mut cdr = Cdr::new(data)?;
    // Header: seconds, nanoseconds, frame.
    cdr.u32()?;
    cdr.u32()?;
    cdr.string()?;
    let count = cdr.u32()?;
    let mut names = Vec::new();
    for _ in 0..count {
        names.push(cdr.string()?);
    }
    let mut parsed = Parsed {
        big_endian: cdr.is_big_endian(),
        names,
        entries: Vec::new(),
        values: Vec::new(),
        end: 0,
        short: false,
    };
    match kind {
        MessageKind::JointState => {
            for field in [Field::Position, Field::Velocity, Field::Effort] {
                let (at, count) = cdr.doubles()?;
                parsed.values.push((at, at + 8 * count));
                // An empty sequence means "not published"; a shorter one is a fault.
                parsed.short |= count != 0 && count < parsed.names.len();
                for (index, joint) in parsed.names.iter().take(count).enumerate() {
                    parsed.entries.push(Entry {
                        joint,
                        field,
                        at: at + 8 * index,
                    });
                }
            }
        }
        MessageKind::DynamicJointState => {
            let count = cdr.u32()? as usize;
            parsed.short |= count < parsed.names.len();
            let mut interfaces = Vec::new();
            for index in 0..count {
                interfaces.clear();
                let named = cdr.u32()?;
                for _ in 0..named {
                    interfaces.push(cdr.string()?);
                }
                let (at, values) = cdr.doubles()?;
                parsed.values.push((at, at + 8 * values));
                parsed.short |= values < interfaces.len();
                let Some(joint) = parsed.names.get(index) else {
                    continue;
                };
                for (value, interface) in interfaces.iter().take(values).enumerate() {
                    parsed.entries.push(Entry {
                        joint,
                        field: Field::Interface(interface),
                        at: at + 8 * value,
                    });
                }
            }
        }
    }
    parsed.end = cdr.at();
    Ok(parsed)
}

/// Changes values in place: `value` receives each value with its joint and field and returns its replacement.
///
/// # Errors
/// Returns [`DecodeError`] if the payload is not plain CDR or is truncated; nothing is changed then.
pub fn rewrite(
    kind: MessageKind,
    data: &mut [u8],
    mut value: impl FnMut(&Entry<'_>, f64) -> f64,
) -> Result<(), DecodeError> {
    let parsed = parse(kind, data)?;
    let is_big_endian = parsed.big_endian;
    let mut changed = Vec::with_capacity(parsed.entries.len());
    for entry in &parsed.entries {
        let Some(bytes) = data[entry.at..].first_chunk::<8>() else {
            continue;
        };
        let before = match is_big_endian {
            true => f64::from_be_bytes(*bytes),
            false => f64::from_le_bytes(*bytes),
        };
        changed.push((entry.at, value(entry, before)));
    }
    for (at, value) in changed {
        let bytes = match is_big_endian {
            true => value.to_be_bytes(),
            false => value.to_le_bytes(),
        };
        data[at..at + 8].copy_from_slice(&bytes);
    }
    Ok(())
}

/// Offsets of the values of a message, valid while its other bytes stay the same.
#[derive(Debug)]
pub struct Layout {
    template: Vec<u8>,
    /// Byte ranges that must equal the template.
    fixed: Vec<(usize, usize)>,
    /// Offset in the payload and column of the row.
    picks: Vec<(usize, usize)>,
    big_endian: bool,
    /// Fewer values than names somewhere.
    pub short: bool,
}

impl Layout {
    /// Creates the layout of messages with the same names as this one.
    ///
    /// `column_of` returns the column of a value; the first value of a column is kept.
    pub fn new<'a>(
        data: &[u8],
        parsed: &Parsed<'a>,
        width: usize,
        mut column_of: impl FnMut(&Entry<'a>) -> Option<usize>,
    ) -> Layout {
        let mut taken = vec![false; width];
        let mut picks = Vec::new();
        for entry in &parsed.entries {
            if let Some(column) = column_of(entry)
                && !std::mem::replace(&mut taken[column], true)
            {
                picks.push((entry.at, column));
            }
        }
        let mut fixed = vec![(0, STAMP.start)];
        let mut from = STAMP.end;
        for &(start, end) in &parsed.values {
            if start > from {
                fixed.push((from, start));
            }
            from = end;
        }
        if parsed.end > from {
            fixed.push((from, parsed.end));
        }
        Layout {
            template: data.to_vec(),
            fixed,
            picks,
            big_endian: parsed.big_endian,
            short: parsed.short,
        }
    }

    /// Columns of the row that the message fills.
    pub fn columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.picks.iter().map(|(_, column)| *column)
    }

    /// Whether the layout is small enough to be stored.
    pub fn is_cacheable(&self) -> bool {
        self.template.len() <= CACHED_BYTES_LIMIT
    }

    /// Whether any value of the message is wanted.
    pub fn is_empty(&self) -> bool {
        self.picks.is_empty()
    }

    /// Whether the message has this layout.
    #[inline]
    pub fn fits(&self, data: &[u8]) -> bool {
        data.len() == self.template.len()
            && self
                .fixed
                .iter()
                .all(|&(start, end)| data[start..end] == self.template[start..end])
    }

    /// Copies the values into a row. The message must fit.
    #[inline]
    pub fn copy(&self, data: &[u8], row: &mut [f64]) {
        for &(at, column) in &self.picks {
            let Some(bytes) = data[at..].first_chunk::<8>() else {
                continue;
            };
            row[column] = if self.big_endian {
                f64::from_be_bytes(*bytes)
            } else {
                f64::from_le_bytes(*bytes)
            };
        }
    }
}
