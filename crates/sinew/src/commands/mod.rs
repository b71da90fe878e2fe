//! One file per command.

pub(crate) mod baseline;
mod baseline_merge;
pub(crate) mod bench;
#[cfg(feature = "camera")]
mod bench_read_camera;
pub(crate) mod creep;
pub(crate) mod estimate;
mod estimate_each;
pub(crate) mod excitation;
pub(crate) mod external;
pub(crate) mod init;
pub(crate) mod log;
pub(crate) mod robot;
pub(crate) mod rope;
mod session_args;
pub(crate) mod shell;
pub(crate) mod simulate;
mod simulate_control;
pub(crate) mod trend;
