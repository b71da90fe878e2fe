//! Nuisance parameters, estimated jointly with the offsets.

use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_model::arm::JointKind;
use sinew_model::offset::StateEntry;
use sinew_model::robot::Robot;

/// Prior and posterior of a nuisance parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NuisanceChange {
    /// Name of the joint, tendon or body; none for the payload.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Name of the parameter.
    pub name: String,
    /// Unit of the parameter; empty for a ratio.
    pub unit: String,
    /// Distribution before the recording.
    pub prior: Gaussian,
    /// Distribution after the recording.
    pub posterior: Gaussian,
    /// Whether the data changed it: the standard deviation decreased by more than 20 %, or the mean moved by more than
    /// one prior standard deviation.
    pub moved: bool,
}

/// Returns the name of the joint or tendon on an axis to which an entry belongs.
pub(crate) fn owner<'a>(entry: &StateEntry, robot: &'a Robot, axis: usize) -> &'a str {
    match entry.is_of_joint {
        true => robot.axis_name(axis),
        false => robot.tendon_name(axis),
    }
}

impl NuisanceChange {
    /// Creates the change of an entry of a robot's state.
    pub(crate) fn new(
        entry: &StateEntry,
        robot: &Robot,
        [prior, posterior]: [Gaussian; 2],
    ) -> Self {
        let slides = |i| robot.arm.joint_kind(i) == Some(JointKind::Prismatic);
        let unit = match entry.joint.is_some_and(slides) {
            true => entry.unit.replace("N·m", "N").replace("rad", "m"),
            false => entry.unit.into(),
        };
        Self {
            joint: entry.joint.map(|i| owner(entry, robot, i).to_owned()),
            name: entry.name.into(),
            unit,
            prior,
            posterior,
            moved: posterior.std < 0.8 * prior.std
                || (posterior.mean - prior.mean).abs() > prior.std,
        }
    }
}
