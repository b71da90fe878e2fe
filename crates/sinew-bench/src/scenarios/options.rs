//! What to run.

use super::Sessions;
use std::path::PathBuf;

/// What to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Names of scenarios, or files (`.toml`) of one's own.
    pub scenarios: Vec<String>,
    /// Folder of the robot, where that isn't the protocol's or the file's.
    pub robot: Option<PathBuf>,
    /// Recordings per scenario.
    pub n: u64,
    /// Seed of the first; the others follow.
    pub first_seed: u64,
    /// Which sessions are estimated.
    pub sessions: Sessions,
    /// Whether the motor's torque is recorded.
    pub motor_torque: bool,
    /// Threads.
    pub jobs: usize,
    /// Where a line per recording goes, and where a stopped run is taken up again.
    pub out: Option<PathBuf>,
}
