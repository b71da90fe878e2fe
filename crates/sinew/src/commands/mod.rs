//! One file per command.

pub(crate) mod baseline;
mod baseline_merge;
pub(crate) mod bench;
#[cfg(feature = "camera")]
mod bench_read_camera;
mod beside;
pub(crate) mod creep;
pub(crate) mod estimate;
mod estimate_each;
pub(crate) mod excitation;
pub(crate) mod fleet;
pub(crate) mod init;
pub(crate) mod log;
pub(crate) mod paper;
pub(crate) mod robot;
pub(crate) mod rope;
pub(crate) mod scenarios;
mod session_args;
pub(crate) mod shell;
pub(crate) mod simulate;
pub(crate) mod trend;
pub(crate) mod watch;
