//! Scenario of the protocol: arm, motion, draws.

use super::PlanError;
use super::texts::{ROBOT, ROBOT_FILE, URDF};
use crate::{Scenario, SimulateError};
use sinew_model::robot::{Robot, RobotFile};
use toml::Table;

/// Scenario, ready to be recorded with any seed.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Name of the plan.
    pub name: String,
    /// Description, if it differs from that of the protocol.
    pub about: Option<String>,
    /// Complete scenario text, as read by `sinew simulate`.
    pub text: String,
    /// Scenario parsed from that text.
    pub scenario: Scenario,
    /// Robot description used by the estimator.
    pub robot: Robot,
    /// Simulated robot before the random errors; equal to the described robot except for a tilted axis.
    pub simulated: Robot,
    /// Whether the payload is unspecified for the estimator.
    pub payload_unknown: bool,
    /// Inputs that it depends on besides the program: another robot, a file.
    pub based_on: String,
}

impl Plan {
    /// Creates a plan from `table` with the robot of the protocol, which equals its description before the random
    /// errors.
    pub(super) fn shipped(table: &Table, name: &str) -> Result<Self, PlanError> {
        let robot = RobotFile::parse(ROBOT, ROBOT_FILE)?.build(URDF)?;
        Self::of(table, name, robot)
    }

    /// Creates a plan from a user's scenario; `file` is its name in messages.
    ///
    /// # Errors
    /// [`PlanError::Simulate`] where it is none, [`PlanError::Text`] without the sessions A, B and C.
    pub fn own(
        scenario: Scenario,
        text: &str,
        file: &str,
        robot: Robot,
    ) -> Result<Self, PlanError> {
        let plan = Self::with(scenario, text.into(), file, robot)?;
        let based_on = format!("{text}{:?}", plan.robot);
        Ok(Self { based_on, ..plan })
    }

    pub(super) fn of(table: &Table, name: &str, robot: Robot) -> Result<Self, PlanError> {
        let text = toml::to_string(table).map_err(|e| PlanError::Text {
            name: name.into(),
            reason: e.to_string(),
        })?;
        let scenario =
            Scenario::from_toml(&text, &format!("scenario {name}")).map_err(SimulateError::from)?;
        Self::with(scenario, text, name, robot)
    }

    fn with(scenario: Scenario, text: String, name: &str, robot: Robot) -> Result<Self, PlanError> {
        if scenario.sessions.len() != 3 {
            return Err(PlanError::Text {
                name: name.into(),
                reason: "requires three [[sessions]]: A for the baseline, B to assess, C with possible slips".into(),
            });
        }
        Ok(Self {
            name: scenario.name.clone(),
            about: None,
            text,
            payload_unknown: !scenario.payloads.is_empty(),
            scenario,
            simulated: robot.clone(),
            robot,
            based_on: String::new(),
        })
    }
}
