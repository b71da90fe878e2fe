//! The file of sessions: a line of settings, then a line per session.

use super::ChainRequest;
use crate::journal;
use serde::{Deserialize, Serialize};
use sinew_model::robot::Robot;

/// Another simulation or estimator: what older files hold can't go on.
const VERSION: u32 = 6;

/// What all sessions of a file have in common.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Settings {
    format: String,
    version: u32,
    /// Version of the program.
    program: String,
    /// Robot.
    robot: String,
    /// Checksum of what URDF and robot.toml say of it.
    #[serde(default)]
    description: String,
    /// Joints watched: the strand fails in one of them.
    joints: Vec<String>,
    /// Check or work.
    session: super::SessionKind,
    /// Whether each session starts from the last one's posterior.
    chained: bool,
}

impl Settings {
    pub(super) fn new(robot: &Robot, joints: &[String], request: &ChainRequest) -> Self {
        let said = (
            &robot.arm,
            &robot.transmissions,
            &robot.limits,
            &robot.tolerances,
        );
        Self {
            format: "sinew-sessions".into(),
            version: VERSION,
            program: env!("CARGO_PKG_VERSION").into(),
            robot: robot.name.clone(),
            description: journal::checksum(&format!("{said:?}")),
            joints: joints.to_vec(),
            session: request.kind,
            chained: request.chained,
        }
    }
}

impl journal::Settings for Settings {
    const HEAD: &'static str = "{\"format\":\"sinew-sess";
    const HOLDS: &'static str = "simulated sessions";

    fn difference(&self, wanted: &Self) -> String {
        if self.session != wanted.session {
            format!("{} sessions (--session)", self.session.name())
        } else if self.chained != wanted.chained {
            "with and without --chained".to_string()
        } else if self.robot != wanted.robot {
            format!("robot '{}'", self.robot)
        } else if self.joints != wanted.joints {
            format!("joints {} (--joints)", self.joints.join(", "))
        } else if self.program != wanted.program {
            format!("versions {} and {}", self.program, wanted.program)
        } else if self.version != wanted.version {
            format!("estimator {}, now {}", self.version, wanted.version)
        } else {
            format!("another description of robot '{}'", self.robot)
        }
    }
}
