//! The file of years: a line of settings, then a line per robot.

use super::YearRequest;
use super::surrogate::SessionErrors;
use crate::journal;
use serde::{Deserialize, Serialize};
use sinew_model::robot::Robot;

/// Other numbers or names: what older files hold can't go on.
const VERSION: u32 = 3;

/// What all years of a file have in common.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Settings {
    format: String,
    version: u32,
    /// Version of the program.
    program: String,
    robot: String,
    /// Joints watched.
    joints: Vec<String>,
    errors: SessionErrors,
}

impl Settings {
    pub(super) fn new(robot: &Robot, request: &YearRequest) -> Self {
        Self {
            format: "sinew-years".into(),
            version: VERSION,
            program: env!("CARGO_PKG_VERSION").into(),
            robot: robot.name.clone(),
            joints: request.joints.clone(),
            errors: request.errors,
        }
    }
}

impl journal::Settings for Settings {
    const HEAD: &'static str = "{\"format\":\"sinew-year";
    const HOLDS: &'static str = "simulated years";

    fn difference(&self, wanted: &Self) -> String {
        if self.robot != wanted.robot {
            format!("robot '{}'", self.robot)
        } else if self.joints != wanted.joints {
            format!("joints {} (--joints)", self.joints.join(", "))
        } else if self.program != wanted.program {
            format!("versions {} and {}", self.program, wanted.program)
        } else if self.version != wanted.version {
            format!("format {}, now {}", self.version, wanted.version)
        } else {
            "errors of other sessions (--session)".to_string()
        }
    }
}
