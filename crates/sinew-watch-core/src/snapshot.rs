//! What a robot's monitor says now.

use crate::alarm::{Alarm, Level, LimitOrigin};
use crate::record::{Clock, NoOffset, Record};
use serde::{Deserialize, Serialize};
use sinew_estimate::online::Provisional;
use sinew_model::Gaussian;
use sinew_model::offset::ForceEstimate;
use sinew_trend::{JointTrend, PassageTimes};
use std::sync::Arc;

/// What is known of a robot now. Records, alarms and journal are those that are stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotSnapshot {
    /// Name in the configuration.
    pub robot: String,
    /// Name in robot.toml.
    pub robot_type: String,
    /// Where its frames come from.
    pub source: String,
    /// When this was said, s since 1970 UTC.
    pub time_utc_s: f64,
    /// The worst of its tendons and of itself.
    pub level: Level,
    /// Whether data come.
    pub freshness: Freshness,
    /// Frames of a second, over the last seconds.
    pub rate_hz: f64,
    /// Frames received since the monitor began.
    pub frames: u64,
    /// Frames that were lost, refused or incomplete since then.
    pub frames_lost: u64,
    /// What the estimator is at.
    pub learning: Learning,
    /// The session under way; `None`: the robot stands, or nothing comes.
    pub session: Option<SessionNow>,
    /// Which clock records are of now.
    pub clock: Clock,
    /// Temperature of the last frame that had one, °C.
    pub temperature_c: Option<f64>,
    /// A constant force from outside that pulls at the tool, such as a hose: offsets hold it. `None`: none is seen.
    pub external_force: Option<ForceEstimate>,
    /// Its tendons, in the order of joints.
    pub tendons: Vec<TendonSnapshot>,
    /// Alarms of the robot and its tendons, the most severe first.
    pub alarms: Vec<Alarm>,
    /// Transactions that wait for the store.
    pub waiting_to_be_stored: usize,
}

/// Whether data come.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Freshness {
    /// None came since the monitor began.
    Never,
    /// Data come.
    Fresh,
    /// The last came so long ago.
    Stale {
        /// For so long, s.
        for_s: f64,
    },
}

/// What the estimator is at.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Learning {
    /// It follows the tendons since their baseline.
    Following,
    /// There is no baseline: offsets are against the encoders' zero, and wide.
    NoBaseline,
    /// A rope was tensioned: it learns the new baseline from motion with nothing in the gripper.
    Baseline {
        /// Motion so far, s.
        duration_s: f64,
        /// Distinct poses so far.
        poses: u64,
        /// Distinct poses it needs.
        poses_needed: u64,
    },
}

/// A session under way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionNow {
    /// When it began, s since 1970 UTC.
    pub start_utc_s: f64,
    /// Motion so far, s.
    pub duration_s: f64,
}

/// What is known of a tendon now.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonSnapshot {
    /// Name of the joint.
    pub joint: String,
    /// The worst of its alarms.
    pub level: Level,
    /// Offset now, rad, from the online estimate; `None`: it is not known now, and `reason` says why.
    pub offset_rad: Option<Gaussian>,
    /// Why the offset is provisional, with times in s since 1970 UTC; `None`: it is settled, or not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub provisional: Option<Provisional>,
    /// What a temperature that isn't known, now or when it was tensioned, adds to the deviation of `offset_rad`, rad; `None`: it is known,
    /// or there is no offset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unknown_temperature_rad: Option<f64>,
    /// Elongation now since it was tensioned, m; `None` without an offset or tendon geometry.
    pub elongation_m: Option<Gaussian>,
    /// Strain now since the rope was new, as a fraction.
    pub strain_ratio: Option<Gaussian>,
    /// Why there is no offset now.
    pub reason: Option<NotNow>,
    /// When it was last tensioned, s since 1970 UTC.
    pub tensioned_utc_s: Option<f64>,
    /// The last record that is stored. It may be old: it says when it was made.
    pub last: Option<Record>,
    /// Limits, with where they come from.
    pub limits: Vec<LimitNow>,
    /// Its rope, as robot.toml names it.
    pub rope: Option<String>,
    /// The trend of its records, without the series; `None`: none was computed yet.
    #[serde(skip)]
    pub trend: Option<Arc<JointTrend>>,
    /// When the trend passes its limits, as distributions.
    #[serde(skip)]
    pub passages: Arc<[PassageTimes]>,
}

/// Why there is no offset now.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum NotNow {
    /// No data come.
    NoData,
    /// No window of the newest data has been solved yet.
    Starting,
    /// It can't tell stretch from nothing.
    CannotTell {
        /// The reason.
        why: NoOffset,
    },
    /// A new baseline is learned first.
    LearnsBaseline,
}

/// A limit of a tendon, with where it comes from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum LimitNow {
    /// Tension again at this elongation.
    Retension {
        /// Elongation since the last tensioning, m.
        elongation_m: f64,
        /// Where it comes from.
        origin: LimitOrigin,
    },
    /// Replace at this strain.
    Replace {
        /// As a fraction.
        strain_ratio: f64,
        /// Where it comes from.
        origin: LimitOrigin,
    },
}
