//! What is estimated along with the offsets.

use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_model::offset::StateEntry;

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
    /// Of an entry of the state, whose `joints` have names.
    pub(crate) fn new(
        entry: &StateEntry,
        joints: &[String],
        [prior, posterior]: [Gaussian; 2],
    ) -> Self {
        Self {
            joint: entry.joint.map(|i| joints[i].clone()),
            name: entry.name.into(),
            unit: entry.unit.into(),
            prior,
            posterior,
            moved: posterior.deviation < 0.8 * prior.deviation
                || (posterior.mean - prior.mean).abs() > prior.deviation,
        }
    }
}
