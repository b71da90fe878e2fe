//! Base rope of a fit of the rope law, and the parameters fixed at its values.

use super::error::CreepError;
use serde::{Deserialize, Serialize};
use sinew_rope::CatalogueRope;
use sinew_rope::law::Parameters;
use sinew_rope::law::entry::CatalogueEntry;

/// Catalogue rope on which a fit is based: breaking load, material, and parameters not identifiable
/// from the record.
#[derive(Debug, Clone, PartialEq)]
pub struct RopeBase {
    /// Catalogue entry of the rope.
    pub entry: CatalogueEntry,
    pub(super) parameters: Parameters,
}

impl RopeBase {
    /// Creates a base from a catalogue entry.
    ///
    /// # Errors
    /// Returns [`CreepError::IncompleteRope`] with the missing parameters of its law.
    pub fn new(entry: CatalogueEntry) -> Result<Self, CreepError> {
        let parameters = entry
            .parameters()
            .map_err(|missing| CreepError::IncompleteRope {
                rope: entry.name.clone(),
                missing: missing.join(", "),
            })?;
        Ok(Self { entry, parameters })
    }

    /// Base rope as a rope of the catalogue.
    pub(super) fn rope(&self) -> CatalogueRope {
        CatalogueRope {
            entry: self.entry.clone(),
            file: None,
        }
    }

    /// Breaking load of the rope, N.
    pub fn breaking_load_n(&self) -> f64 {
        self.parameters.breaking_load_n
    }
}

/// Parameter fixed at the base rope's value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FixedParameter {
    /// Name as in the catalogue, with its unit.
    pub name: String,
    /// Value at which it is fixed.
    pub value: f64,
    /// Reason why it is not identifiable.
    pub reason: NotIdentifiableReason,
}

/// Reason why a parameter of the rope law is not identifiable from a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum NotIdentifiableReason {
    /// No change of the load between measurements.
    NoChangeOfLoad,
    /// Fewer than three loads, including zero.
    FewerThanThreeLoads,
    /// Fewer than five loads.
    FewerThanFiveLoads,
    /// One load only.
    OneLoad,
    /// One temperature only.
    OneTemperature,
    /// Fewer than three temperatures.
    FewerThanThreeTemperatures,
    /// Too little flow at these loads, times and temperatures.
    TooLittleFlow,
    /// Base rope without retraction.
    NoRetraction,
    /// No record above 35 °C.
    NoneWarm,
    /// Indistinguishable from the rate of flow.
    WithRateOfFlow,
}
