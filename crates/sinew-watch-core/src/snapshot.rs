//! Current state of a robot as published by its monitor.

use crate::alarm::{Alarm, Level, LimitOrigin};
use crate::incident::Incident;
use crate::journal::Maintenance;
use crate::record::{Clock, NoOffset, Record};
use serde::{Deserialize, Serialize};
use sinew_estimate::online::Provisional;
use sinew_model::Gaussian;
use sinew_model::offset::ForceEstimate;
use sinew_trend::{FirstPassage, JointTrend};
use std::sync::Arc;

/// Current state of a robot. Records, alarms and journal are those that are stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotSnapshot {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Name of the robot in robot.toml.
    pub robot_type: String,
    /// Source of the frames.
    pub source: String,
    /// Time of this snapshot, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Most urgent level of the robot and its tendons.
    pub level: Level,
    /// Freshness of the received data.
    pub freshness: Freshness,
    /// Frame rate over the last seconds, Hz.
    pub rate_hz: f64,
    /// Number of frames received since the monitor started.
    pub frames: u64,
    /// Number of frames lost, rejected or incomplete since the monitor started.
    pub frames_lost: u64,
    /// Operating mode of the estimator.
    pub learning: Learning,
    /// Current session; `None`: the robot is at rest, or no data are received.
    pub session: Option<SessionNow>,
    /// Clock of the records made now.
    pub clock: Clock,
    /// Temperature of the last frame with a temperature, °C.
    pub temperature_c: Option<f64>,
    /// Constant external force at the tool, e.g. of a hose, N; estimated jointly with the offsets. `None`: none
    /// detected.
    pub external_force: Option<ForceEstimate>,
    /// Tendons of the robot, in the order of its joints.
    pub tendons: Vec<TendonSnapshot>,
    /// Alarms of the robot and its tendons, in descending order of severity.
    pub alarms: Vec<Alarm>,
    /// Incidents of the tendons, the oldest first: all open ones, and the last closed ones.
    #[serde(default)]
    pub incidents: Vec<Incident>,
    /// Recorded re-tensionings and replacements, the oldest first, with their corrections.
    #[serde(default)]
    pub maintenance: Vec<Maintenance>,
    /// Number of the entry in `maintenance` that can be withdrawn or assigned to other joints; of the others, only the
    /// date can be corrected.
    #[serde(default)]
    pub withdrawable: Option<u64>,
    /// Number of transactions waiting to be stored.
    pub waiting_to_be_stored: usize,
}

/// Freshness of the received data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Freshness {
    /// No data since the monitor started.
    Never,
    /// Data are being received.
    Fresh,
    /// The last data are too old.
    Stale {
        /// Time since the last data, s.
        for_s: f64,
    },
}

/// Operating mode of the estimator.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Learning {
    /// Tendons are tracked relative to their baseline.
    Following,
    /// No baseline: offsets refer to the encoder zero and have wide intervals.
    NoBaseline,
    /// Baseline acquisition after a re-tensioning, from motion with an empty gripper.
    Baseline {
        /// Duration of motion so far, s.
        duration_s: f64,
        /// Number of distinct poses so far.
        poses: u64,
        /// Required number of distinct poses.
        poses_needed: u64,
    },
}

/// Session in progress.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionNow {
    /// Start of the session, s since 1970 UTC.
    pub start_utc_s: f64,
    /// Duration of motion so far, s.
    pub duration_s: f64,
}

/// Current state of a tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonSnapshot {
    /// Name of the joint.
    pub joint: String,
    /// Most urgent level of the tendon's alarms.
    pub level: Level,
    /// Offset from the online estimator, rad; `None`: not available, with the cause in `reason`.
    pub offset_rad: Option<Gaussian>,
    /// Validity of the offset.
    pub validity: Validity,
    /// Reason for which the offset is provisional, with times in s since 1970 UTC; `None`: settled or not available.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub provisional: Option<Provisional>,
    /// Contribution of an unknown temperature, now or at the tensioning, to the standard deviation of `offset_rad`,
    /// rad; `None`: the temperature is recorded, or there is no offset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unknown_temperature_rad: Option<f64>,
    /// Elongation since the last tensioning, m; `None` without an offset or tendon geometry.
    pub elongation_m: Option<Gaussian>,
    /// Total strain since the rope was new, ratio.
    pub strain_ratio: Option<Gaussian>,
    /// Reason for a missing offset.
    pub reason: Option<NoEstimateReason>,
    /// Time of the last tensioning, s since 1970 UTC; `None`: not recorded.
    pub tensioned_utc_s: Option<f64>,
    /// Last stored record. It may be old; its `time_utc_s` gives the start of its session.
    pub last: Option<Record>,
    /// Limits of the tendon with their origin.
    pub limits: Vec<LimitNow>,
    /// Name of the rope in robot.toml.
    pub rope: Option<String>,
    /// Trend of the records, without the time series; `None`: not computed yet.
    #[serde(skip)]
    pub trend: Option<Arc<JointTrend>>,
    /// First-passage times of the limits, as distributions.
    #[serde(skip)]
    pub passages: Arc<[FirstPassage]>,
}

/// Validity of the present offset: the flag that a control loop reads before it uses the value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Validity {
    /// The offset is available and not provisional.
    Valid,
    /// The offset is provisional or not available; the reason is in `provisional` or `reason`.
    NotValid {
        /// Time since the offset was last valid, or since the start of the monitor, s.
        for_s: f64,
    },
}

/// Present values of a tendon for a live chart.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LiveTendon {
    /// Motor position minus joint position in the coordinate of the joint, `theta − q`, rad: the offset and the deflection
    /// under load.
    pub motor_minus_joint_rad: f64,
    /// Offset from the online estimator, rad; `None`: not available.
    pub offset_rad: Option<Gaussian>,
    /// Whether the offset is valid.
    pub valid: bool,
}

/// Reason for which there is currently no offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum NoEstimateReason {
    /// No data are received.
    NoData,
    /// No estimate from the newest data yet.
    Starting,
    /// The estimate is inconclusive: elongation is not distinguishable from zero.
    Inconclusive {
        /// Reason for the inconclusive estimate.
        reason: NoOffset,
    },
    /// A new baseline is being acquired.
    BaselineAcquisition,
}

/// Limit of a tendon with its origin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum LimitNow {
    /// Elongation at which the tendon is re-tensioned.
    Retension {
        /// Limit of the elongation since the last tensioning, m.
        elongation_m: f64,
        /// Origin of the limit.
        origin: LimitOrigin,
    },
    /// Strain at which the rope is replaced.
    Replace {
        /// Limit of the total strain, ratio.
        strain_ratio: f64,
        /// Origin of the limit.
        origin: LimitOrigin,
    },
}
