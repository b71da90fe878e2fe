//! Result of a session: one record per tendon, schema `sinew-record/2`.

use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;

/// Result of one session for one tendon. Database, Arrow and CSV use the same column names.
///
/// Values are in SI units; each estimate has a standard deviation (`…_std_…`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Record {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Robot name in URDF and robot.toml; robots of one type share the posterior of the type.
    pub robot_type: String,
    /// Name of the joint.
    pub joint: String,
    /// Start of the session by the monitor's clock, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Duration of motion in the session, s.
    pub duration_s: f64,
    /// Offset since the last tensioning, rad; `None`: inconclusive, with the cause in `reason`.
    pub offset_rad: Option<f64>,
    /// Standard deviation of the offset, rad.
    #[serde(alias = "offset_deviation_rad")]
    pub offset_std_rad: Option<f64>,
    /// Elongation since the last tensioning, m; `None` without an offset or tendon geometry.
    pub elongation_m: Option<f64>,
    /// Standard deviation of the elongation, m.
    #[serde(alias = "elongation_deviation_m")]
    pub elongation_std_m: Option<f64>,
    /// Total strain since the rope was new, ratio; includes elongation from before the last tensioning.
    pub strain_ratio: Option<f64>,
    /// Standard deviation of the strain, ratio.
    #[serde(alias = "strain_deviation_ratio")]
    pub strain_std_ratio: Option<f64>,
    /// Mean temperature of the session, °C; `None`: not recorded.
    pub temperature_c: Option<f64>,
    /// Stiffness relative to nominal, minus 1.
    pub stiffness_ratio: Option<f64>,
    /// Standard deviation of the relative stiffness.
    #[serde(alias = "stiffness_deviation_ratio")]
    pub stiffness_std_ratio: Option<f64>,
    /// Reference of the offset: name of the last tensioning; `None`: encoder zero.
    pub baseline: Option<String>,
    /// Source of the frames: `dds:0/arm7`, `mcap:run.mcap`.
    pub source: String,
    /// Clock of the time stamps in this record.
    pub clock: Clock,
    /// Whether an offset was provisional at the end of the session.
    #[serde(alias = "in_doubt")]
    pub provisional: bool,
    /// Reason for a missing offset.
    #[serde(alias = "why")]
    pub reason: Option<NoOffset>,
    /// Number of distinct poses in the session.
    pub poses: u64,
    /// Number of frames used.
    pub frames: u64,
    /// Number of frames lost, rejected or incomplete.
    pub frames_lost: u64,
    /// Version of the program that made the record.
    pub sinew_version: String,
}

impl Record {
    /// Name and version of the schema.
    pub const SCHEMA: &'static str = "sinew-record/2";

    /// Returns the offset with its standard deviation, rad.
    pub fn offset(&self) -> Option<Gaussian> {
        Some(Gaussian::new(self.offset_rad?, self.offset_std_rad?))
    }
}

/// Clock of a record's time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// Civil clock of the monitor.
    Utc,
    /// Time stamps not in real time: a simulation or a replayed recording. Excluded from the trend.
    Stamp,
    /// Civil clock that stepped within the session: the date may be wrong. Excluded from the trend.
    Stepped,
}

impl Clock {
    /// Returns the name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Utc => "utc",
            Self::Stamp => "stamp",
            Self::Stepped => "stepped",
        }
    }
}

/// Reason for which a session has no offset of a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum NoOffset {
    /// The interval is too wide to distinguish an elongation from zero.
    TooWide,
    /// The duration of motion is too short.
    TooShort,
    /// The estimator rejected the data.
    #[serde(alias = "refused")]
    Rejected,
}

impl NoOffset {
    /// Returns the name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::TooWide => "too-wide",
            Self::TooShort => "too-short",
            Self::Rejected => "rejected",
        }
    }
}
