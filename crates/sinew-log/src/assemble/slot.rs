//! Sample of a stream.

use super::key::Key;

/// Row of a stream at one time stamp.
#[derive(Debug)]
pub(crate) struct Slot {
    pub(crate) key: Key,
    /// Whether the stream was damaged just before this sample.
    pub(crate) after_damage: bool,
    /// The recorder's clock at this sample, ns; `None` for rows of a table.
    pub(crate) received_ns: Option<i64>,
    /// Number of the sample in the order of insertion.
    pub(crate) order: u64,
    pub(crate) values: Vec<f64>,
}
