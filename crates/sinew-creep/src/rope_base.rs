//! The rope a fit of the rope law starts from, and what it takes from there.

use super::error::CreepError;
use serde::{Deserialize, Serialize};
use sinew_rope::CatalogueRope;
use sinew_rope::law::Parameters;
use sinew_rope::law::entry::CatalogueEntry;

/// The catalogue rope a fit starts from: breaking load, material, and what the record can't tell.
#[derive(Debug, Clone, PartialEq)]
pub struct RopeBase {
    /// Its entry.
    pub entry: CatalogueEntry,
    pub(super) parameters: Parameters,
}

impl RopeBase {
    /// A base from a catalogue entry.
    ///
    /// # Errors
    /// [`CreepError::IncompleteRope`] naming parameters its law lacks.
    pub fn new(entry: CatalogueEntry) -> Result<Self, CreepError> {
        let parameters = entry
            .parameters()
            .map_err(|missing| CreepError::IncompleteRope {
                rope: entry.name.clone(),
                missing: missing.join(", "),
            })?;
        Ok(Self { entry, parameters })
    }

    /// It as a rope of the catalogue.
    pub(super) fn rope(&self) -> CatalogueRope {
        CatalogueRope {
            entry: self.entry.clone(),
            file: None,
        }
    }

    /// Breaking load, N.
    pub fn breaking_load_n(&self) -> f64 {
        self.parameters.breaking_load_n
    }
}

/// A parameter that a fit takes from the base rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FixedParameter {
    /// Name as the catalogue writes it, unit included.
    pub name: String,
    /// Value it is kept at.
    pub value: f64,
    /// Why the record can't tell it.
    pub why: WhyFixed,
}

/// Why a record can't tell a parameter of the rope law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum WhyFixed {
    /// The load never changes between readings.
    NoChangeOfLoad,
    /// Fewer than three loads, none among them.
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
    /// The base rope has no retraction.
    NoRetraction,
    /// No record above 35 °C.
    NoneWarm,
    /// Can't be told from the rate of flow.
    WithRateOfFlow,
}
