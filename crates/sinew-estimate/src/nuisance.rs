//! What is estimated along with the offsets.

use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_model::arm::JointKind;
use sinew_model::offset::StateEntry;
use sinew_model::robot::Robot;

/// A nuisance parameter before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NuisanceChange {
    /// Joint or body; `None` for the payload.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// What it is.
    pub name: String,
    /// Its unit; empty for a ratio.
    pub unit: String,
    /// Believed before the recording.
    pub prior: Gaussian,
    /// Believed after.
    pub posterior: Gaussian,
    /// Whether the data moved it: surer by a fifth, or by more than a standard deviation off.
    pub moved: bool,
}

impl NuisanceChange {
    /// Of an entry of the state of a robot.
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
            joint: entry.joint.map(|i| robot.tendon_name(i).to_owned()),
            name: entry.name.into(),
            unit,
            prior,
            posterior,
            moved: posterior.deviation < 0.8 * prior.deviation
                || (posterior.mean - prior.mean).abs() > prior.deviation,
        }
    }
}
