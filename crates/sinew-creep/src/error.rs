//! Errors of the analysis of creep tests.

use super::law::Law;
use serde::{Deserialize, Serialize};
use sinew_files::Located;

/// Error of an invalid file of creep tests.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TestFileError {
    /// Not a table of a creep test.
    #[error("{file}: not a creep test: {reason}")]
    NotATest {
        /// File name as specified by the user.
        file: String,
        /// Content found, and content expected.
        reason: String,
    },
    /// Unreadable file, or invalid cell or header with its location.
    #[error(transparent)]
    File(#[from] Located),
    /// Requested column or sheet not found.
    #[error("{file}: {reason}")]
    Request {
        /// File name as specified by the user.
        file: String,
        /// Requested name, available names, and the nearest match.
        reason: String,
    },
}

impl TestFileError {
    pub(super) fn invalid(file: &str, reason: impl Into<String>) -> Self {
        Self::NotATest {
            file: file.to_owned(),
            reason: reason.into(),
        }
    }
}

/// Error of an analysis or a fit, with its numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum CreepError {
    /// Fewer measurements than numbers to fit.
    #[error("{} needs {needed} measurements, found {readings}", law.name())]
    TooFew {
        /// Creep law that was fitted.
        law: Law,
        /// Number of measurements found.
        readings: usize,
        /// Minimum number of measurements.
        needed: usize,
    },
    /// Planning of a test failed.
    #[error("no plan: {reason}")]
    NoPlan {
        /// Reason of the failure.
        reason: String,
    },
    /// Strain without any change.
    #[error("{specimen}: the strain is constant; check the sensor connection and the column")]
    Flat {
        /// Name of the specimen.
        specimen: String,
    },
    /// Cost that is not finite at any start of the search.
    #[error("{}: no finite cost from any start of the search", law.name())]
    NotFinite {
        /// Creep law that was fitted.
        law: Law,
    },
    /// Measurements of a specimen that are not a creep test.
    #[error("{specimen}: {reason}")]
    Specimen {
        /// Name of the specimen.
        specimen: String,
        /// Reason of the rejection.
        reason: Unusable,
    },
    /// No specimen could be analysed.
    #[error("{}", failures.join("\n"))]
    NothingAnalysed {
        /// Reason of each failure.
        failures: Vec<String>,
    },
    /// Group column that no specimen has.
    #[error("--group {column}: column not found; available: {}", available.join(", "))]
    NoGroupColumn {
        /// Requested column of the group.
        column: String,
        /// Names of the available columns.
        available: Vec<String>,
    },
    /// Rope law without a base rope.
    #[error("the rope law needs a catalogue rope as its base (--rope NAME)")]
    NoRope,
    /// Missing parameters of the catalogue rope.
    #[error("rope '{rope}' has no complete law; missing in its [law]: {missing}")]
    IncompleteRope {
        /// Name of the rope.
        rope: String,
        /// Names of the missing parameters.
        missing: String,
    },
    /// Fit that does not determine a catalogue entry.
    #[error(transparent)]
    NoEntry {
        /// Reason of the rejection.
        #[from]
        reason: NoEntry,
    },
    /// Forecast that the records do not support.
    #[error("{specimen}: no forecast: {reason}")]
    NoForecast {
        /// Name of the specimen or group.
        specimen: String,
        /// Reason why there is no forecast.
        reason: NoForecast,
    },
    /// Isotherm with too few measurements above zero.
    #[error(
        "the isotherm at {temperature_c:.1} °C needs at least three measurements with positive time and value"
    )]
    Isotherm {
        /// Temperature of the isotherm, °C.
        temperature_c: f64,
    },
    /// Isotherms at one temperature only.
    #[error("superposition needs at least two temperatures more than 1 K apart")]
    OneTemperature,
}

/// Reason why measurements are not a creep test, with the remedy.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Unusable {
    /// Missing column of times.
    #[error("no time")]
    NoTime,
    /// Missing column of elongation or strain.
    #[error("no elongation or strain")]
    NoStrain,
    /// Elongation without a gauge length.
    #[error(
        "an elongation needs the gauge length: set --gauge-length, or write 'L0 (mm)' above the header"
    )]
    NoGaugeLength,
    /// Invalid gauge length.
    #[error("gauge length {length_m} m is invalid; it must be positive")]
    GaugeLength {
        /// Gauge length found, m.
        length_m: f64,
    },
    /// Too few measurements.
    #[error("{readings} usable measurements; a creep test needs {needed}")]
    TooFewReadings {
        /// Number of usable measurements.
        readings: usize,
        /// Minimum number of measurements.
        needed: usize,
    },
    /// Implausibly large strain of a fibre, rope or plastic.
    #[error(
        "strain reaches {strain_ratio:.3} m/m, {:.0} %: if the column is in percent or an elongation, set strain=COLUMN:% or elongation=COLUMN:mm",
        100.0 * strain_ratio
    )]
    StrainTooLarge {
        /// Largest strain found, m/m.
        strain_ratio: f64,
    },
    /// No force above zero.
    #[error("the force never rises above zero; check its sign")]
    ForceNeverPositive,
    /// No plateau of the force.
    #[error(
        "the force has no constant level: not a creep test, or force and elongation are swapped"
    )]
    NoLevel,
    /// Variable force with constant strain.
    #[error(
        "the force changes by {:.1} % and the strain by {:.4} %: force and elongation are probably swapped",
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
    /// No measurement under load.
    #[error("no measurement under load")]
    NoReading,
    /// Rope law without tensions.
    #[error(
        "the rope law needs the tension in newtons; the record has no force (--column force=…:N)"
    )]
    NoTension,
    /// Tension above the breaking load of the base rope.
    #[error(
        "a force of {tension_n:.1} N exceeds the breaking load of {breaking_load_n:.0} N; check the base rope"
    )]
    Breaks {
        /// Largest tension, N.
        tension_n: f64,
        /// Breaking load of the base rope, N.
        breaking_load_n: f64,
    },
    /// Temperature outside the range of the rope law.
    #[error("{temperature_c:.1} °C is outside the range of the rope law (−100 to 200 °C)")]
    Temperature {
        /// Temperature of the record, °C.
        temperature_c: f64,
    },
    /// Missing temperature, or neither modulus nor strain to shift.
    #[error("no temperature, or neither modulus nor strain")]
    NothingToShift,
}

/// Reason why records do not support a forecast.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum NoForecast {
    /// No stage under load.
    #[error("the record contains no load")]
    NoLoad,
    /// Load specified, but none recorded.
    #[error("a load in N is specified, but the record has no force (--column force=…:N)")]
    NoForce,
    /// Temperature specified, but none recorded.
    #[error("a temperature is specified, but the record has none (--temperature)")]
    NoTemperature,
    /// Load outside the range of the records.
    #[error(
        "{load_n} N is outside the tested range ({low_n:.1} to {high_n:.1} N); fit tests under several loads together (--joint group), or use the rope law alone (--law rope --rope NAME)"
    )]
    Load {
        /// Requested load, N.
        load_n: f64,
        /// Smallest load of the supported range, N.
        low_n: f64,
        /// Largest load of the supported range, N.
        high_n: f64,
    },
    /// Temperature outside the range of the records.
    #[error(
        "{temperature_c} °C is outside the tested range ({low_c:.1} to {high_c:.1} °C); fit tests at several temperatures together (--joint group), or use the rope law alone (--law rope --rope NAME)"
    )]
    Temperature {
        /// Requested temperature, °C.
        temperature_c: f64,
        /// Lowest temperature of the records, °C.
        low_c: f64,
        /// Highest temperature of the records, °C.
        high_c: f64,
    },
}

/// Reason why a fit does not determine a catalogue entry.
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
        /// Number of fitted ropes.
        fitted: usize,
    },
    /// Rope law not among the fits.
    #[error("the rope law was not fitted")]
    NoRopeLaw,
    /// Another law, no draws, or several amplitudes.
    #[error(
        "a catalogue entry needs a fit of the rope law with intervals, and one amplitude for all specimens"
    )]
    NotARopeFit,
}

/// Specimen or group that could not be analysed or fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Failure {
    /// Specimen or group that was fitted; `None` if the reason names it.
    pub name: Option<String>,
    /// Reason of the failure.
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
