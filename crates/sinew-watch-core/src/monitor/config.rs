//! What a monitor is told once, and what the store kept for it.

use super::history::History;
use crate::alarm::{AlarmsStored, Condition, Delays};
use crate::transaction::Belief;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{SessionError, SessionOptions};
use sinew_model::robot::Robot;
use sinew_rope::{Catalogue, CatalogueError};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a monitor is told once; [`Monitor::reload`](crate::Monitor::reload) takes another one while it runs.
#[derive(Debug, Clone)]
pub struct MonitorConfig {
    /// Name in the configuration: which one of its type.
    pub name: String,
    /// Where its frames come from: `dds:0/arm7`, `mcap:run.mcap`.
    pub source: String,
    /// The robot. Frames have its joints, in its order.
    pub robot: Arc<Robot>,
    /// Ropes: limits their makers state, and what the trend expects of them.
    pub catalogue: Arc<Catalogue>,
    /// How sessions are estimated.
    pub estimate: SessionOptions,
    /// A baseline learned before, where nothing is stored: what `sinew baseline` wrote.
    pub baseline: Option<Baseline>,
    /// Whose time the stamps are.
    pub clock: ClockChoice,
    /// When things begin and end.
    pub times: Times,
    /// When alarms are raised and cleared.
    pub alarms: AlarmOptions,
}

impl MonitorConfig {
    /// Everything as usual.
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
    /// Refuses times that can't be.
    pub(super) fn check(&self) -> Result<(), MonitorError> {
        let times = self.times;
        let all = [
            ("stale_after_s", times.stale_after_s),
            ("session_motion_s", times.session_motion_s),
            ("session_pause_s", times.session_pause_s),
            ("stretch_s", times.stretch_s),
            ("gap_s", times.gap_s),
        ];
        let refuse = |key, value_s, must| MonitorError::Time { key, value_s, must };
        for (key, value_s) in all {
            if !(value_s > 0.0 && value_s.is_finite()) {
                return Err(refuse(key, value_s, "above 0 s"));
            }
        }
        if !(LEAST_STRETCH_S..=MOST_STRETCH_S).contains(&times.stretch_s) {
            return Err(refuse("stretch_s", times.stretch_s, "20 to 120 s"));
        }
        Ok(())
    }
}

/// A stretch of fewer poses teaches little, one of more is lost at a crash, s.
const LEAST_STRETCH_S: f64 = 20.0;
const MOST_STRETCH_S: f64 = 120.0;

/// Whose time the stamps are.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ClockChoice {
    /// A robot's, in real time; found out if they run otherwise.
    #[default]
    Real,
    /// A simulation's, or a recording's: no part of a trend.
    Stamp,
    /// A robot's, in real time, while the civil clock runs faster: a demonstration of months in minutes.
    Fast {
        /// Civil seconds in one.
        civil_rate: f64,
    },
}

/// When things begin and end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// Without a frame for so long, nothing is known now, s.
    pub stale_after_s: f64,
    /// A session ends after so much motion, s.
    pub session_motion_s: f64,
    /// It ends after so long a stand, and after so long without a frame, s.
    pub session_pause_s: f64,
    /// A session is estimated in stretches of this length, s: what a crash loses at most, beside what is being
    /// computed and stored.
    pub stretch_s: f64,
    /// A pause of the stamps longer than this starts the filters anew, s.
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

/// When alarms are raised and cleared.
#[derive(Debug, Clone, PartialEq)]
pub struct AlarmOptions {
    /// Delays that differ from [`Delays::of`].
    pub delays: BTreeMap<Condition, Delays>,
    /// A limit's alarm is cleared below this share of the limit, if it is likelier kept than passed.
    pub clear_below: f64,
    /// A limit is near if it may be passed within this time, s.
    pub near_s: f64,
    /// Doubt is worth an alarm after so much motion, s.
    pub doubt_s: f64,
}

impl Default for AlarmOptions {
    fn default() -> Self {
        Self {
            delays: BTreeMap::new(),
            clear_below: 0.8,
            near_s: 14.0 * 86_400.0,
            doubt_s: 600.0,
        }
    }
}

impl AlarmOptions {
    /// Delays of a condition.
    pub fn delays(&self, condition: Condition) -> Delays {
        let own = self.delays.get(&condition).copied();
        own.unwrap_or_else(|| Delays::of(condition))
    }
}

/// What the store kept of a robot.
#[derive(Debug, Clone, Default)]
pub struct Stored {
    /// The last belief that was stored.
    pub belief: Option<Belief>,
    /// The alarms that weren't normal.
    pub alarms: AlarmsStored,
    /// The records that were stored.
    pub history: History,
    /// Number of the last transaction; 0: none.
    pub last_id: u64,
}

/// Why there is no monitor.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MonitorError {
    /// A rope the robot names.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The baseline doesn't belong to the robot.
    #[error(transparent)]
    Baseline(#[from] SessionError),
    /// A time that can't be.
    #[error("{key} = {value_s} s: must be {must}")]
    Time {
        /// Key in the configuration.
        key: &'static str,
        /// The value that was given, s.
        value_s: f64,
        /// What it must be.
        must: &'static str,
    },
    /// The robot has no tendon to watch.
    #[error(
        "the robot has no elastic joint; give stiffness_nm_per_rad in robot.toml, else there is nothing to watch"
    )]
    NoTendon,
    /// What can't be changed while it runs.
    #[error(
        "joints, stiffness and masses can't change while the monitor runs; start it again for that robot"
    )]
    AnotherRobot,
}
