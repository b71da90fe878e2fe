//! The order of samples.

/// Order of samples: the epoch grows with every clock jump.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Key {
    pub(crate) epoch: u32,
    pub(crate) time_ns: i64,
}
