//! One file per command.

pub(crate) mod baseline;
pub(crate) mod bench;
pub(crate) mod creep;
pub(crate) mod estimate;
pub(crate) mod log;
pub(crate) mod paper;
pub(crate) mod robot;
pub(crate) mod rope;
pub(crate) mod simulate;
