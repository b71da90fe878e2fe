//! The file of results: a line of settings, then a line per recording.

use crate::journal;
use serde::{Deserialize, Serialize};

/// Another simulation or estimator: what older files hold can't go on.
const VERSION: u32 = 6;

/// What all recordings of a file have in common.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Settings {
    format: String,
    version: u32,
    /// Version of the program.
    pub(super) program: String,
    /// Checksum of robots and scenarios.
    pub(super) scenarios: String,
    /// With session C.
    pub(super) steps: bool,
    /// With the motor's torque.
    pub(super) motor_torque: bool,
}

impl Settings {
    pub(super) fn new(scenarios: String, steps: bool, motor_torque: bool) -> Self {
        Self {
            format: "sinew-scenarios".into(),
            version: VERSION,
            program: env!("CARGO_PKG_VERSION").into(),
            scenarios,
            steps,
            motor_torque,
        }
    }
}

impl journal::Settings for Settings {
    const HEAD: &'static str = "{\"format\":\"sinew-scen";
    const HOLDS: &'static str = "scenario results";

    fn difference(&self, wanted: &Self) -> String {
        if self.steps != wanted.steps {
            "with and without session C (--no-steps)".to_string()
        } else if self.motor_torque != wanted.motor_torque {
            "with and without motor torque (--no-motor-torque)".to_string()
        } else if self.program != wanted.program {
            format!("of versions {} and {}", self.program, wanted.program)
        } else if self.version != wanted.version {
            format!("estimator {}, now {}", self.version, wanted.version)
        } else {
            "of another robot, or of other scenarios than this program's".to_string()
        }
    }
}
