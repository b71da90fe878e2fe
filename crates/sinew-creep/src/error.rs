//! Why a creep test can't be analysed.

use super::law::Law;
use serde::{Deserialize, Serialize};
use sinew_files::Located;

/// Why a file of creep tests was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TestFileError {
    /// It is no table of a test.
    #[error("{file}: not a creep test: {reason}")]
    NotATest {
        /// File as the user named it.
        file: String,
        /// What was found, and what was expected.
        reason: String,
    },
    /// A file that can't be read, or a cell or header, with its place.
    #[error(transparent)]
    File(#[from] Located),
    /// A column or sheet asked for is not there.
    #[error("{file}: {reason}")]
    Request {
        /// File as the user named it.
        file: String,
        /// What was asked for, what there is, and the nearest match.
        reason: String,
    },
}

impl TestFileError {
    pub(super) fn refused(file: &str, reason: impl Into<String>) -> Self {
        Self::NotATest {
            file: file.to_owned(),
            reason: reason.into(),
        }
    }
}

/// What was wrong, with the numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum CreepError {
    /// Fewer readings than numbers to fit.
    #[error("{} needs {needed} readings, there are {readings}", law.name())]
    TooFew {
        /// The law.
        law: Law,
        /// Readings there are.
        readings: usize,
        /// Readings needed.
        needed: usize,
    },
    /// No test can be planned.
    #[error("no plan: {reason}")]
    NoPlan {
        /// Why.
        reason: String,
    },
    /// The strain doesn't change.
    #[error("{specimen}: the strain doesn't change: not connected, or the wrong column?")]
    Flat {
        /// Name of the specimen.
        specimen: String,
    },
    /// No start of the search had a finite cost.
    #[error("{}: no finite cost from any start of the search", law.name())]
    NotFinite {
        /// The law.
        law: Law,
    },
    /// A specimen's readings don't make a creep test.
    #[error("{specimen}: {reason}")]
    Specimen {
        /// Name of the specimen.
        specimen: String,
        /// What was found.
        reason: Unusable,
    },
    /// No specimen could be analysed.
    #[error("{}", failures.join("\n"))]
    NothingAnalysed {
        /// Why not, one of each.
        failures: Vec<String>,
    },
    /// No specimen has such a column or head line.
    #[error("--group {column}: no such column; there are {}", known.join(", "))]
    NoGroupColumn {
        /// Column asked for.
        column: String,
        /// Columns there are.
        known: Vec<String>,
    },
    /// The rope law without a rope to start from.
    #[error("the rope law needs a catalogue rope to start from (--rope NAME)")]
    NoRope,
    /// The catalogue rope lacks parameters.
    #[error("rope '{rope}' has no complete law; missing in its [law]: {missing}")]
    IncompleteRope {
        /// Rope.
        rope: String,
        /// Parameters that are missing.
        missing: String,
    },
    /// A fit that no catalogue entry can be made of.
    #[error(transparent)]
    NoEntry {
        /// Why.
        #[from]
        reason: NoEntry,
    },
    /// A forecast that the records can't tell.
    #[error("{specimen}: no forecast: {reason}")]
    NoForecast {
        /// Specimen or group.
        specimen: String,
        /// Why.
        reason: NoForecast,
    },
    /// An isotherm with too few readings above zero.
    #[error(
        "the isotherm at {temperature_c:.1} °C needs at least three readings with positive time and value"
    )]
    Isotherm {
        /// Its temperature, °C.
        temperature_c: f64,
    },
    /// Isotherms at one temperature.
    #[error("superposition needs at least two temperatures more than 1 K apart")]
    OneTemperature,
}

/// Why a specimen's readings don't make a creep test, and what to do.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Unusable {
    /// No column of times.
    #[error("no time")]
    NoTime,
    /// No column of elongation or strain.
    #[error("no elongation or strain")]
    NoStrain,
    /// An elongation without the length it belongs to.
    #[error(
        "an elongation needs the gauge length: say it (--gauge-length-mm) or write 'L0 (mm)' above the header"
    )]
    NoGaugeLength,
    /// A gauge length that can't be.
    #[error("gauge length {length_m} m; it must be positive")]
    GaugeLength {
        /// Length found, m.
        length_m: f64,
    },
    /// Too few readings.
    #[error("{readings} usable readings; a creep test needs {needed}")]
    TooFewReadings {
        /// Readings there are.
        readings: usize,
        /// Readings needed.
        needed: usize,
    },
    /// A strain that no fibre, rope or plastic reaches.
    #[error(
        "strain reaches {strain_ratio:.3} m/m, {:.0} %: is the column in percent or an elongation? say strain=COLUMN:% or elongation=COLUMN:mm",
        100.0 * strain_ratio
    )]
    StrainTooLarge {
        /// Largest strain, m/m.
        strain_ratio: f64,
    },
    /// No force above zero.
    #[error("the force never rises above zero: is its sign right?")]
    ForceNeverPositive,
    /// No plateau of the force.
    #[error("the force holds no level: not a creep test, or force and elongation are swapped")]
    NoLevel,
    /// The force creeps and the strain stays.
    #[error(
        "the force changes by {:.1} % and the strain by {:.4} %: force and elongation look swapped",
        100.0 * force_change_share, 100.0 * strain_change_share
    )]
    Swapped {
        /// Change of the force over its last value.
        force_change_share: f64,
        /// Change of the strain over its last value.
        strain_change_share: f64,
    },
    /// No stage under load.
    #[error("no stage under load")]
    NoStage,
    /// No reading under load.
    #[error("no reading under load")]
    NoReading,
    /// The rope law without tensions.
    #[error(
        "the rope law needs the tension in newtons; the record has no force (--column force=…:N)"
    )]
    NoTension,
    /// A tension that breaks the base rope.
    #[error(
        "a force of {tension_n:.1} N breaks a rope of {breaking_load_n:.0} N breaking load: the wrong base rope?"
    )]
    Breaks {
        /// Largest tension, N.
        tension_n: f64,
        /// Breaking load of the base rope, N.
        breaking_load_n: f64,
    },
    /// A temperature outside the rope law's range.
    #[error("{temperature_c:.1} °C: the rope law takes −100 to 200 °C")]
    Temperature {
        /// Temperature, °C.
        temperature_c: f64,
    },
    /// No temperature, or neither modulus nor strain to shift.
    #[error("no temperature, or neither modulus nor strain")]
    NothingToShift,
}

/// Why records don't tell a forecast.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum NoForecast {
    /// No stage under load.
    #[error("the record holds no load")]
    NoLoad,
    /// A load is stated, and none is recorded.
    #[error("a load in N is stated, and the record has no force (--column force=…:N)")]
    NoForce,
    /// A temperature is stated, and none is recorded.
    #[error("a temperature is stated, and the record has none (--temperature-c)")]
    NoTemperature,
    /// A load beyond those of the records.
    #[error(
        "{load_n} N lies beyond the {low_n:.1} to {high_n:.1} N that can be told from; tests under several loads, fitted together (--joint group), or the rope law alone (--law rope --rope NAME) tell more"
    )]
    Load {
        /// Asked for, N.
        load_n: f64,
        /// Least load that can be told, N.
        low_n: f64,
        /// Largest, N.
        high_n: f64,
    },
    /// A temperature beyond those of the records.
    #[error(
        "{temperature_c} °C lies beyond the {low_c:.1} to {high_c:.1} °C of the records; tests at several temperatures, fitted together (--joint group), or the rope law alone (--law rope --rope NAME) tell more"
    )]
    Temperature {
        /// Asked for, °C.
        temperature_c: f64,
        /// Lowest of the records, °C.
        low_c: f64,
        /// Highest, °C.
        high_c: f64,
    },
}

/// Why no catalogue entry can be made of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum NoEntry {
    /// Several amplitudes for one rope.
    #[error("one rope needs one amplitude: --joint group")]
    SeveralAmplitudes,
    /// Several ropes for one file.
    #[error(
        "one file for one rope, but {fitted} were fitted; --joint group fits specimens together"
    )]
    SeveralRopes {
        /// Ropes fitted.
        fitted: usize,
    },
    /// The rope law is not among the fits.
    #[error("the rope law was not fitted")]
    NoRopeLaw,
    /// Another law, no draws, or several amplitudes.
    #[error(
        "a catalogue entry needs a fit of the rope law with intervals, and one amplitude for all specimens"
    )]
    NotARopeFit,
}

/// What couldn't be analysed or fitted, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Failure {
    /// Specimen or group that was fitted; `None` where the reason names it.
    pub name: Option<String>,
    /// Why.
    pub reason: CreepError,
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.name {
            Some(name) => write!(f, "{name}: {}", self.reason),
            None => self.reason.fmt(f),
        }
    }
}
