//! What the HTTP API says: types of its answers. SI, with standard deviations; words beside them for people.

use crate::runtime::{DoorNow, Seen, Slot};
use crate::store::JournalEntry;
use crate::words;
use serde::{Deserialize, Serialize};
use sinew_trend::JointTrend;
use sinew_watch_core::Record;
use sinew_watch_core::alarm::{Alarm, Level};
use sinew_watch_core::snapshot::{Freshness, RobotSnapshot, TendonSnapshot};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// `GET /api/v1/fleet`: all robots.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fleet {
    /// Version of the program.
    pub version: &'static str,
    /// What the demonstration is; `None`: it is none, these are robots.
    pub demo: Option<String>,
    /// Time of the monitor, s since 1970 UTC.
    pub time_utc_s: f64,
    /// How the store is.
    pub store: StoreState,
    /// The doors that messages come through.
    pub doors: Vec<DoorNow>,
    /// Robots by name; in a `change` event those that changed.
    pub robots: Vec<RobotRow>,
    /// Robots that aren't watched, and why.
    pub not_watched: Vec<NotWatched>,
    /// Robots that went since the event before.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gone: Vec<String>,
}

/// How the store is.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum StoreState {
    /// What is learned is stored.
    Works,
    /// It doesn't: what is learned is in memory alone.
    Failing {
        /// The reason.
        why: String,
        /// Changes that wait.
        waiting: usize,
    },
}

/// A robot in one line.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotRow {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Its type, from robot.toml or URDF.
    pub robot_type: String,
    /// The worst of its tendons and of itself.
    pub level: Level,
    /// What it needs, in words.
    pub headline: String,
    /// Alarms that aren't normal.
    pub alarms: usize,
    /// Of these, those that nobody has seen and no shelf hides.
    pub unacknowledged: usize,
    /// Changes whenever one of its alarms does.
    pub changed: u64,
    /// Its tendons, in the order of joints.
    pub tendons: Vec<TendonRow>,
}

/// A tendon in one sign.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonRow {
    /// Name of the joint.
    pub joint: String,
    /// How it is.
    pub level: Level,
}

/// A robot that isn't watched.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NotWatched {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// The reason.
    pub why: String,
}

/// `GET /api/v1/robots/{robot}`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotNow {
    /// What is known.
    pub robot: Arc<RobotSnapshot>,
    /// The state in words.
    pub sentence: String,
    /// Its tendons in words, in the order of joints.
    pub tendons: Vec<TendonSaid>,
    /// Its alarms in words.
    pub alarms: Vec<AlarmSaid>,
    /// Messages dropped before the estimator, since a queue was full.
    pub messages_dropped: u64,
    /// Changes whenever a trend does.
    pub trends: u64,
}

/// A tendon in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonSaid {
    /// Name of the joint.
    pub joint: String,
    /// The state in words.
    pub sentence: String,
}

/// `GET /api/v1/robots/{robot}/tendons/{joint}`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonNow {
    /// What is known.
    pub tendon: TendonSnapshot,
    /// The state in words.
    pub sentence: String,
    /// Its alarms in words.
    pub alarms: Vec<AlarmSaid>,
    /// Trend of its records; `None`: there are too few.
    pub trend: Option<Arc<JointTrend>>,
}

/// An alarm, and what is said of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlarmSaid {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// The alarm as data.
    pub alarm: Alarm,
    /// What it shows.
    pub level: Level,
    /// Severity, 1 to 1000.
    pub severity: u16,
    /// What is the matter.
    pub title: &'static str,
    /// What was seen.
    pub text: String,
    /// What to do; empty: nothing.
    pub advice: &'static str,
}

/// `GET /api/v1/alarms`: the most severe first.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlarmList {
    /// Alarms that aren't normal.
    pub alarms: Vec<AlarmSaid>,
}

/// `GET /api/v1/journal`: the newest first.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Journal {
    /// Entries, the newest first.
    pub entries: Vec<JournalSaid>,
}

/// An entry of the journal in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JournalSaid {
    /// The entry of the journal.
    #[serde(flatten)]
    pub entry: JournalEntry,
    /// What happened, in words.
    pub text: String,
}

/// Which tendons are due.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DueAsked {
    /// Within so many days from now: 56, and no more than 1095.
    pub within_days: Option<f64>,
}

/// Which entries of the journal.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct JournalAsked {
    /// Of this robot.
    pub robot: Option<String>,
    /// Of this kind, such as `alarm` or `session`.
    pub event: Option<String>,
    /// Older than the entry of this number.
    pub before: Option<i64>,
    /// So many at most: 100, and no more than 1000.
    pub most: Option<u64>,
}

/// `GET /api/v1/records`: in the order of time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Records {
    /// Name and version of their schema.
    pub schema: &'static str,
    /// Records in the order of time.
    pub records: Vec<Record>,
}

/// Which events are asked for.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct EventsAsked {
    /// This robot's beside the fleet's.
    pub robot: Option<String>,
}

/// What a login needs.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Login {
    /// The token of the page.
    pub token: String,
}

/// It was done, and is stored.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Done {
    /// Always true.
    pub done: bool,
}

/// Why something was refused.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Refusal {
    /// The reason in words.
    pub error: String,
}

impl AlarmSaid {
    /// Puts it in words.
    pub fn of(robot: &str, alarm: &Alarm) -> Self {
        Self {
            robot: robot.into(),
            level: alarm.level(),
            severity: alarm.key.condition.severity(),
            title: words::title(alarm),
            text: words::said(alarm),
            advice: words::advice(alarm).unwrap_or(""),
            alarm: alarm.clone(),
        }
    }
}

impl RobotRow {
    /// In one line.
    pub fn of(robot: &RobotSnapshot) -> Self {
        let is_open = |a: &&Alarm| !a.acknowledged && a.shelved_until_utc_s.is_none();
        Self {
            robot: robot.robot.clone(),
            robot_type: robot.robot_type.clone(),
            level: robot.level,
            headline: headline(robot),
            alarms: robot.alarms.len(),
            unacknowledged: robot.alarms.iter().filter(is_open).count(),
            changed: mark(&robot.alarms),
            tendons: (robot.tendons.iter())
                .map(|tendon| TendonRow {
                    joint: tendon.joint.clone(),
                    level: tendon.level,
                })
                .collect(),
        }
    }
}

/// Without how long nothing came: that changes every second, and a row that changes is sent anew.
fn headline(robot: &RobotSnapshot) -> String {
    match robot.freshness {
        Freshness::Stale { .. } if robot.alarms.is_empty() => "nothing is received".into(),
        _ => words::robot(robot),
    }
}

/// A number that changes with what it is of.
fn mark<T: Serialize>(of: &T) -> u64 {
    use std::hash::{DefaultHasher, Hasher as _};
    let mut hasher = DefaultHasher::new();
    hasher.write(&serde_json::to_vec(of).unwrap_or_default());
    // JavaScript's numbers hold 53 bits.
    hasher.finish() >> 11
}

impl RobotNow {
    /// Puts it in words.
    pub fn of(robot: Arc<RobotSnapshot>, slot: &Slot) -> Self {
        let tendons = robot.tendons.iter().map(|tendon| TendonSaid {
            joint: tendon.joint.clone(),
            sentence: words::tendon(tendon, &robot.alarms),
        });
        let ends = robot.tendons.iter().map(|t| {
            t.trend
                .as_deref()
                .map(|t| (t.last_utc_s, t.sessions, t.forecast.len()))
        });
        Self {
            sentence: words::robot(&robot),
            tendons: tendons.collect(),
            alarms: robot
                .alarms
                .iter()
                .map(|a| AlarmSaid::of(&robot.robot, a))
                .collect(),
            messages_dropped: slot.dropped.load(Ordering::Relaxed),
            trends: mark(&ends.collect::<Vec<_>>()),
            robot,
        }
    }
}

impl TendonNow {
    /// Of a joint of a robot; `None`: it has no such tendon.
    pub fn of(robot: &RobotSnapshot, joint: &str) -> Option<Self> {
        let tendon = robot.tendons.iter().find(|tendon| tendon.joint == joint)?;
        let own = robot
            .alarms
            .iter()
            .filter(|a| a.key.joint.as_deref() == Some(joint));
        Some(Self {
            sentence: words::tendon(tendon, &robot.alarms),
            alarms: own.map(|a| AlarmSaid::of(&robot.robot, a)).collect(),
            trend: tendon.trend.clone(),
            tendon: tendon.clone(),
        })
    }
}

impl Seen {
    /// The snapshot of a robot that is watched.
    pub fn watched(self) -> Option<Arc<RobotSnapshot>> {
        match self {
            Self::Watched(snapshot) => Some(snapshot),
            _ => None,
        }
    }
}
