//! What is kept of a session: one record per tendon, `sinew-record/1`.

use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;

/// What one session said of one tendon. The same names stand in the database, in Arrow and in CSV.
///
/// SI, and a standard deviation (`…_deviation_…`) beside what is estimated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Record {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Name in its URDF and robot.toml: robots of one type share what is learned of the type.
    pub robot_type: String,
    /// Name of the joint.
    pub joint: String,
    /// Start of the session, s since 1970 UTC, by the monitor's clock.
    pub time_utc_s: f64,
    /// Time of it in which the robot moved, s.
    pub duration_s: f64,
    /// Offset since the tendon was last tensioned, rad; `None`: it can't be told, and `reason` says why.
    pub offset_rad: Option<f64>,
    /// Its standard deviation, rad.
    pub offset_deviation_rad: Option<f64>,
    /// Elongation since then, m; `None` without an offset or tendon geometry.
    pub elongation_m: Option<f64>,
    /// Its standard deviation, m.
    pub elongation_deviation_m: Option<f64>,
    /// Strain since the rope was new: elongation from before the last tensioning counts too.
    pub strain_ratio: Option<f64>,
    /// Its standard deviation.
    pub strain_deviation_ratio: Option<f64>,
    /// Mean temperature, °C; `None`: not recorded.
    pub temperature_c: Option<f64>,
    /// Stiffness over nominal, less 1.
    pub stiffness_ratio: Option<f64>,
    /// Its standard deviation.
    pub stiffness_deviation_ratio: Option<f64>,
    /// What the offset counts from: name of the tendon's last tensioning; `None`: the encoders' zero.
    pub baseline: Option<String>,
    /// Where the frames came from: `dds:0/arm7`, `mcap:run.mcap`.
    pub source: String,
    /// Which clock its dates are of.
    pub clock: Clock,
    /// Whether an offset was provisional at the end.
    pub in_doubt: bool,
    /// Why there is no offset.
    pub reason: Option<NoOffset>,
    /// Number of distinct poses.
    pub poses: u64,
    /// Frames that were used.
    pub frames: u64,
    /// Frames that were lost, refused or incomplete.
    pub frames_lost: u64,
    /// Version of the program.
    pub sinew_version: String,
}

impl Record {
    /// Name and version of the schema.
    pub const SCHEMA: &'static str = "sinew-record/1";

    /// The offset with its standard deviation, rad.
    pub fn offset(&self) -> Option<Gaussian> {
        Some(Gaussian::new(self.offset_rad?, self.offset_deviation_rad?))
    }
}

/// Which clock a record's date is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// The monitor's civil clock.
    Utc,
    /// The robot's stamps do not run with time: a simulation, or a recording played. No part of a trend.
    Stamp,
    /// The civil clock stepped within the session: the date may be wrong. No part of a trend.
    Stepped,
}

impl Clock {
    /// Its word in a file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Utc => "utc",
            Self::Stamp => "stamp",
            Self::Stepped => "stepped",
        }
    }
}

/// Why a session has no offset of a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum NoOffset {
    /// The interval is too wide to tell stretch from nothing.
    TooWide,
    /// The arm moved for too short a time.
    TooShort,
    /// The estimator refused the data.
    Refused,
}

impl NoOffset {
    /// Its word in a file.
    pub fn word(self) -> &'static str {
        match self {
            Self::TooWide => "too-wide",
            Self::TooShort => "too-short",
            Self::Refused => "refused",
        }
    }
}
