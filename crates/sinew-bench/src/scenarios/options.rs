//! Options of a run.

use super::Sessions;
use std::path::PathBuf;

/// Options of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Names of scenarios, or files (`.toml`) of one's own.
    pub scenarios: Vec<String>,
    /// Folder of the robot, if not that of the protocol or the file.
    pub robot: Option<PathBuf>,
    /// Recordings per scenario.
    pub n: u64,
    /// Seed of the first; the others follow.
    pub first_seed: u64,
    /// Sessions that are estimated.
    pub sessions: Sessions,
    /// Whether the motor's torque is recorded.
    pub motor_torque: bool,
    /// Number of threads.
    pub jobs: usize,
    /// File with a line per recording, from which a stopped run resumes.
    pub out: Option<PathBuf>,
}
