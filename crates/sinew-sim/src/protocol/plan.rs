//! A scenario of the protocol: arm, motion, what is drawn.

use super::PlanError;
use super::texts::{ROBOT, ROBOT_FILE, URDF};
use crate::{Scenario, SimulateError};
use sinew_model::robot::{Robot, RobotFile};
use toml::Table;

/// A scenario, ready to be recorded with any seed.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Its name.
    pub name: String,
    /// What it is about, where that isn't the protocol's.
    pub about: Option<String>,
    /// The whole scenario as `sinew simulate` reads it.
    pub text: String,
    /// The same, read.
    pub scenario: Scenario,
    /// The robot as the estimator knows it.
    pub robot: Robot,
    /// The robot that is simulated, before anything is drawn: the same but for a tilted axis.
    pub simulated: Robot,
    /// Whether the gripper may hold something, as far as the estimator is told.
    pub payload_unknown: bool,
    /// What it depends on beside the program: another robot, a file.
    pub rests_on: String,
}

impl Plan {
    /// `table` with the protocol's robot, which is as it is described before anything is drawn.
    pub(super) fn shipped(table: &Table, name: &str) -> Result<Self, PlanError> {
        let robot = RobotFile::parse(ROBOT, ROBOT_FILE)?.build(URDF)?;
        Self::of(table, name, robot)
    }

    /// A scenario of one's own; `file` is what messages call it.
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
        let rests_on = format!("{text}{:?}", plan.robot);
        Ok(Self { rests_on, ..plan })
    }

    pub(super) fn of(table: &Table, name: &str, robot: Robot) -> Result<Self, PlanError> {
        let text = toml::to_string(table).map_err(|e| PlanError::Text {
            name: name.into(),
            why: e.to_string(),
        })?;
        let scenario =
            Scenario::from_toml(&text, &format!("scenario {name}")).map_err(SimulateError::from)?;
        Self::with(scenario, text, name, robot)
    }

    fn with(scenario: Scenario, text: String, name: &str, robot: Robot) -> Result<Self, PlanError> {
        if scenario.sessions.len() != 3 {
            return Err(PlanError::Text {
                name: name.into(),
                why: "needs three [[sessions]]: A teaches the baseline, B is judged, in C something may slip".into(),
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
            rests_on: String::new(),
        })
    }
}
