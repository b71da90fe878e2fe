//! Configuration of a monitor and its stored state.

use crate::alarm::{AlarmsStored, Condition, Delays};
use crate::history::History;
use crate::transaction::MonitorState;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{SessionError, SessionOptions};
use sinew_model::robot::Robot;
use sinew_rope::{Catalogue, CatalogueError};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Configuration of a monitor; [`Monitor::reload`](crate::Monitor::reload) replaces it at run time.
#[derive(Debug, Clone)]
pub struct MonitorConfig {
    /// Name of the robot in the configuration, unique among robots of one type.
    pub name: String,
    /// Source of the frames: `dds:0/arm7`, `mcap:run.mcap`.
    pub source: String,
    /// Robot model; frames contain its joints in its order.
    pub robot: Arc<Robot>,
    /// Rope catalogue: limits of the manufacturers and creep laws for the trend.
    pub catalogue: Arc<Catalogue>,
    /// Options of the session estimates.
    pub estimate: SessionOptions,
    /// Baseline used if no state is stored: the output of `sinew baseline`.
    pub baseline: Option<Baseline>,
    /// Clock of the robot's time stamps.
    pub clock: ClockChoice,
    /// Time limits of sessions and segments.
    pub times: Times,
    /// Thresholds and delays of the alarms.
    pub alarms: AlarmOptions,
}

impl MonitorConfig {
    /// Creates a configuration with default options.
    pub fn new(name: &str, source: &str, robot: Arc<Robot>, catalogue: Arc<Catalogue>) -> Self {
        Self {
            name: name.into(),
            source: source.into(),
            robot,
            catalogue,
            estimate: SessionOptions::default(),
            baseline: None,
            clock: ClockChoice::default(),
            times: Times::default(),
            alarms: AlarmOptions::default(),
        }
    }
}

impl MonitorConfig {
    /// Rejects invalid time limits.
    pub(super) fn check(&self) -> Result<(), MonitorError> {
        let times = self.times;
        let all = [
            ("stale_after_s", times.stale_after_s),
            ("session_motion_s", times.session_motion_s),
            ("session_pause_s", times.session_pause_s),
            ("stretch_s", times.stretch_s),
            ("gap_s", times.gap_s),
        ];
        let error = |key, value_s, must| MonitorError::Time { key, value_s, must };
        for (key, value_s) in all {
            if !(value_s > 0.0 && value_s.is_finite()) {
                return Err(error(key, value_s, "above 0 s"));
            }
        }
        if !(MIN_SEGMENT_S..=MAX_SEGMENT_S).contains(&times.stretch_s) {
            return Err(error("stretch_s", times.stretch_s, "20 to 120 s"));
        }
        Ok(())
    }
}

/// Range of the segment length, s: shorter segments have too few poses, longer ones lose more data in a crash.
const MIN_SEGMENT_S: f64 = 20.0;
const MAX_SEGMENT_S: f64 = 120.0;

/// Clock of the robot's time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ClockChoice {
    /// Robot in real time; other rates are detected.
    #[default]
    Real,
    /// Simulation or recording; records are excluded from the trend.
    Stamp,
    /// Robot in real time with an accelerated civil clock: a demonstration of months in minutes.
    Fast {
        /// Rate of the civil clock relative to real time, s/s.
        civil_rate: f64,
    },
}

impl ClockChoice {
    /// Returns the rate of the civil clock relative to real time, s/s.
    pub(super) fn civil_rate(self) -> f64 {
        match self {
            Self::Real | Self::Stamp => 1.0,
            Self::Fast { civil_rate } => civil_rate,
        }
    }
}

/// Time limits of sessions and segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// Time without a frame after which data are stale, s.
    pub stale_after_s: f64,
    /// Maximum duration of motion in a session, s.
    pub session_motion_s: f64,
    /// Time at rest, or without a frame, after which a session ends, s.
    pub session_pause_s: f64,
    /// Length of the segments in which a session is estimated, s: the maximum loss in a crash, apart from results that
    /// are not stored yet.
    pub stretch_s: f64,
    /// Maximum gap of the time stamps without re-initialisation of the filters, s.
    pub gap_s: f64,
}

impl Default for Times {
    fn default() -> Self {
        Self {
            stale_after_s: 5.0,
            session_motion_s: 600.0,
            session_pause_s: 60.0,
            stretch_s: 50.0,
            gap_s: sinew_log::OpenOptions::default().gap_s,
        }
    }
}

/// Thresholds and delays of the alarms.
#[derive(Debug, Clone, PartialEq)]
pub struct AlarmOptions {
    /// Delays that differ from [`Delays::of`].
    pub delays: BTreeMap<Condition, Delays>,
    /// Share of the limit below which its alarm is cleared, if an exceedance is less probable than not.
    pub clear_below: f64,
    /// Warning time of a limit, s: the alarm is raised if the limit may be exceeded within it.
    pub near_s: f64,
    /// Duration of motion with a provisional offset after which an alarm is raised, s.
    pub provisional_s: f64,
}

impl Default for AlarmOptions {
    fn default() -> Self {
        Self {
            delays: BTreeMap::new(),
            clear_below: 0.8,
            near_s: 14.0 * 86_400.0,
            provisional_s: 600.0,
        }
    }
}

impl AlarmOptions {
    /// Returns the delays of a condition.
    pub fn delays(&self, condition: Condition) -> Delays {
        let own = self.delays.get(&condition).copied();
        own.unwrap_or_else(|| Delays::of(condition))
    }
}

/// Stored data of a robot.
#[derive(Debug, Clone, Default)]
pub struct Stored {
    /// Last stored state.
    pub state: Option<MonitorState>,
    /// Alarms that were not normal.
    pub alarms: AlarmsStored,
    /// Stored records of all tendons.
    pub history: History,
    /// Number of the last transaction; 0: none.
    pub last_id: u64,
}

/// Error in the creation or reconfiguration of a monitor.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MonitorError {
    /// A rope of the robot is missing in the catalogue.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The baseline does not belong to the robot.
    #[error(transparent)]
    Baseline(#[from] SessionError),
    /// A time limit is invalid.
    #[error("{key} = {value_s} s is invalid; expected {must}")]
    Time {
        /// Key in the configuration.
        key: &'static str,
        /// Value in the configuration, s.
        value_s: f64,
        /// Permitted range of the value.
        must: &'static str,
    },
    /// The robot has no tendon.
    #[error("the robot has no elastic joint; set stiffness_nm_per_rad in robot.toml")]
    NoTendon,
    /// The change requires a restart of the monitor.
    #[error(
        "joints, stiffness or masses of the robot have changed, which requires a restart of its monitor"
    )]
    AnotherRobot,
}
