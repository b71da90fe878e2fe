//! Comparison of analysed tests: ranking of ropes, and shift factors of isotherms.

use super::analysis_report::Tests;
use super::error::{CreepError, Failure, Unusable};
use super::rank::{Rank, rank};
use super::superposition::{Isotherm, Superposition, superpose};
use super::test_file::Source;
use crate::test_file::{Specimen, TestQuantity};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;

/// Ropes in the order of their strain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompareReport {
    /// Raw data files of the tests.
    pub sources: Vec<Source>,
    /// Ropes by increasing strain.
    pub ranks: Vec<Rank>,
    /// Specimens that could not be analysed.
    pub failures: Vec<Failure>,
}

impl JsonDocument for CompareReport {
    const SCHEMA: &'static str = "sinew/creep-compare/2";
}

/// Ranks the ropes of analysed tests.
///
/// `scatter_share`: standard deviation between specimens over the value, for ropes with a single
/// specimen; `None` for that of the other ropes' repeats, otherwise
/// [`SCATTER_GUESS`](super::SCATTER_GUESS).
pub fn compare(tests: &Tests, scatter_share: Option<f64>) -> CompareReport {
    CompareReport {
        sources: tests.sources.clone(),
        ranks: rank(&tests.prepared, &tests.analyses, tests.level, scatter_share),
        failures: tests.failures.clone(),
    }
}

/// Isotherms shifted along the logarithm of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShiftReport {
    /// Raw data files of the tests.
    pub sources: Vec<Source>,
    /// Shift factors and their temperature dependence.
    pub superposition: Superposition,
    /// Specimens that are not an isotherm.
    pub failures: Vec<Failure>,
}

impl JsonDocument for ShiftReport {
    const SCHEMA: &'static str = "sinew/creep-shift/2";
}

/// Shifts the specimens' moduli, or strains if there is no modulus, to the temperature nearest to
/// `reference_c`; each specimen is an isotherm at its mean temperature.
///
/// # Errors
/// Returns [`CreepError::Isotherm`] or [`CreepError::OneTemperature`] as [`superpose`] does.
pub fn shift(
    sources: Vec<Source>,
    specimens: &[Specimen],
    reference_c: f64,
) -> Result<ShiftReport, CreepError> {
    let mut isotherms = Vec::new();
    let mut failures = Vec::new();
    for specimen in specimens {
        match isotherm(specimen) {
            Some(isotherm) => isotherms.push(isotherm),
            None => failures.push(Failure {
                name: None,
                reason: CreepError::Specimen {
                    specimen: specimen.name.clone(),
                    reason: Unusable::NothingToShift,
                },
            }),
        }
    }
    Ok(ShiftReport {
        sources,
        superposition: superpose(&isotherms, reference_c)?,
        failures,
    })
}

fn isotherm(specimen: &Specimen) -> Option<Isotherm> {
    let temperatures: Vec<f64> = specimen
        .column(TestQuantity::Temperature)?
        .iter()
        .copied()
        .filter(|t| t.is_finite())
        .collect();
    let value = specimen
        .column(TestQuantity::Modulus)
        .or_else(|| specimen.column(TestQuantity::Strain))?;
    let (time_s, value) = specimen
        .column(TestQuantity::Time)?
        .iter()
        .zip(value)
        .filter(|(t, v)| **t > 0.0 && **v > 0.0)
        .unzip();
    Some(Isotherm {
        temperature_c: temperatures.iter().sum::<f64>() / temperatures.len() as f64,
        time_s,
        value,
    })
}
