//! Response types of the HTTP API: SI units with standard deviations, and texts for people.

use crate::runtime::{LiveSample, RobotState, Slot, TransportView};
use crate::store::JournalEntry;
use crate::words;
use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_trend::{JointTrend, Limit, LimitState};
use sinew_watch_core::alarm::{Alarm, Level};
use sinew_watch_core::command::CommandKind;
use sinew_watch_core::journal::{Correction, Event};
use sinew_watch_core::snapshot::{Freshness, LimitNow, RobotSnapshot, TendonSnapshot};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// `GET /api/v1/fleet`: state of all robots.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fleet {
    /// Version of the program.
    pub version: &'static str,
    /// Description of the demonstration; `null`: real robots.
    pub demo: Option<String>,
    /// Time of the monitor, s since 1970 UTC.
    pub time_utc_s: f64,
    /// State of the store.
    pub store: StoreState,
    /// Transports that the robots' messages pass through.
    pub transports: Vec<TransportView>,
    /// Robots sorted by name; in a `change` event only those that changed.
    pub robots: Vec<RobotRow>,
    /// Robots that are not monitored, with the reason.
    #[serde(rename = "not_watched")]
    pub not_monitored: Vec<NotMonitored>,
    /// Robots removed since the previous event.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gone: Vec<String>,
}

/// State of the store.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum StoreState {
    /// The last transaction was stored.
    Works,
    /// Storing fails: new data are in memory only.
    Failing {
        /// Reason of the failure.
        reason: String,
        /// Number of changes that wait to be stored.
        waiting: usize,
    },
}

/// Summary of a robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotRow {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Robot type, from robot.toml or URDF.
    pub robot_type: String,
    /// Worst level of the robot and its tendons.
    pub level: Level,
    /// Required action as text.
    pub headline: String,
    /// Number of alarms that are not normal.
    pub alarms: usize,
    /// Number of these alarms that are active and not shelved; a latched alarm is active until repair or reset.
    pub active: usize,
    /// Number of these alarms that are neither acknowledged nor shelved.
    pub unacknowledged: usize,
    /// Number that changes whenever an alarm of the robot changes.
    pub changed: u64,
    /// Tendon that has used the largest share of its limit, by its last session; `null`: no limit or no offset.
    pub next: Option<NextTendon>,
    /// Tendons in the order of the joints.
    pub tendons: Vec<TendonRow>,
}

/// Tendon that has used the largest share of its limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NextTendon {
    /// Name of the joint.
    pub joint: String,
    /// Limit with its origin.
    pub limit: LimitNow,
    /// Elongation, m, or strain, ratio, as the limit.
    pub value: Gaussian,
    /// Share of the limit that is used.
    pub share: f64,
    /// State of the limit according to the trend; `null`: no trend yet.
    pub state: Option<LimitState>,
    /// Median of the date on which the limit is exceeded, s since 1970 UTC; `null`: beyond the forecast horizon, exceeded
    /// already, or no forecast.
    pub at_utc_s: Option<f64>,
}

impl NextTendon {
    /// Returns the limit of a tendon of which the largest share is used; `None`: no limit or no offset.
    pub(crate) fn of(tendon: &TendonSnapshot) -> Option<Self> {
        let last = tendon.last.as_ref()?;
        let quantity = |mean: Option<f64>, std: Option<f64>| Some(Gaussian::new(mean?, std?));
        let rows = tendon.limits.iter().filter_map(|limit| {
            let (value, most) = match limit {
                LimitNow::Retension { elongation_m, .. } => (
                    quantity(last.elongation_m, last.elongation_std_m)?,
                    *elongation_m,
                ),
                LimitNow::Replace { strain_ratio, .. } => (
                    quantity(last.strain_ratio, last.strain_std_ratio)?,
                    *strain_ratio,
                ),
            };
            let forecasts = tendon
                .trend
                .as_ref()
                .map(|trend| (trend.last_utc_s, &trend.limits));
            let forecast = forecasts.and_then(|(last_utc_s, limits)| {
                let same = limits.iter().find(|forecast| {
                    matches!(
                        (forecast.limit, limit),
                        (Limit::Retension { .. }, LimitNow::Retension { .. })
                            | (Limit::Replace { .. }, LimitNow::Replace { .. })
                    )
                })?;
                Some((same.state, same.after_s.map(|s| last_utc_s + s)))
            });
            Some(Self {
                joint: tendon.joint.clone(),
                limit: *limit,
                value,
                share: value.mean / most,
                state: forecast.map(|(state, _)| state),
                at_utc_s: forecast.and_then(|(_, at_utc_s)| at_utc_s),
            })
        });
        rows.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}

/// Summary of a tendon.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonRow {
    /// Name of the joint.
    pub joint: String,
    /// Level of the tendon.
    pub level: Level,
}

/// Robot that is not monitored.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NotMonitored {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Reason why it is not monitored.
    pub reason: String,
}

/// `GET /api/v1/robots/{robot}`: state of a robot.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotNow {
    /// State of the robot as data.
    pub robot: Arc<RobotSnapshot>,
    /// State of the robot as text.
    pub sentence: String,
    /// Tendons as text, in the order of the joints.
    pub tendons: Vec<TendonView>,
    /// Alarms with their texts.
    pub alarms: Vec<AlarmView>,
    /// Numbers of the incidents that have a recording.
    pub recordings: Vec<u64>,
    /// Number of messages dropped before the estimator because of a full queue.
    pub messages_dropped: u64,
    /// Number that changes whenever a trend of the robot changes.
    pub trends: u64,
}

/// State of a tendon as text.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonView {
    /// Name of the joint.
    pub joint: String,
    /// State of the tendon as text.
    pub sentence: String,
}

/// `GET /api/v1/robots/{robot}/tendons/{joint}`: state of a tendon.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonNow {
    /// State of the tendon as data.
    pub tendon: TendonSnapshot,
    /// State of the tendon as text.
    pub sentence: String,
    /// Alarms with their texts.
    pub alarms: Vec<AlarmView>,
    /// Trend of the records; `null`: too few records.
    pub trend: Option<Arc<JointTrend>>,
}

/// Alarm with its texts.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlarmView {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Alarm as data.
    pub alarm: Alarm,
    /// Level that the alarm shows.
    pub level: Level,
    /// Severity, 1 to 1000.
    pub severity: u16,
    /// Condition of the alarm, as a heading.
    pub title: &'static str,
    /// Observation with its value and limit.
    pub text: String,
    /// Recommended action; empty: none.
    pub advice: &'static str,
}

/// `GET /api/v1/alarms`: alarms, the most severe first.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlarmList {
    /// Alarms that are not normal.
    pub alarms: Vec<AlarmView>,
}

/// `GET /api/v1/journal`: journal entries, the newest first.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Journal {
    /// Entries, the newest first.
    pub entries: Vec<JournalView>,
}

/// Journal entry with its text.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JournalView {
    /// Journal entry as data.
    #[serde(flatten)]
    pub entry: JournalEntry,
    /// Event as text.
    pub text: String,
    /// Correction or withdrawal of a recorded re-tensioning or replacement; `null`: none.
    pub correction: Option<Correction>,
}

/// Selection of the maintenance forecast.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DueQuery {
    /// Forecast horizon, days from now; default 56, limit 1095.
    pub within_days: Option<f64>,
}

/// Selection of journal entries.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct JournalQuery {
    /// Only entries of this robot.
    pub robot: Option<String>,
    /// Only entries of this kind, such as `alarm` or `session`.
    pub event: Option<String>,
    /// Only entries older than the entry with this number.
    pub before: Option<i64>,
    /// Maximum number of entries; default 100, limit 1000.
    pub most: Option<u64>,
}

/// `GET /api/v1/records`: records in chronological order. The response is written as the records are read.
#[cfg(feature = "schema")]
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Records {
    /// Name and version of the schema of the records.
    pub schema: &'static str,
    /// Value of `before` for the next older records; `null`: there are none in the selection.
    pub older: Option<i64>,
    /// Records in chronological order.
    pub records: Vec<sinew_watch_core::Record>,
}

/// `POST /api/v1/notify/test`: results of the test notifications.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestResults {
    /// Results in the order of the configuration.
    pub results: Vec<TestResult>,
}

/// Result of a test notification.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestResult {
    /// Address of the receiver.
    pub url: String,
    /// Reason of the failure; `null`: delivered.
    pub error: Option<String>,
}

/// Selection of events.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct EventsQuery {
    /// Robots whose states are sent in addition to the fleet, separated by commas.
    pub robot: Option<String>,
    /// Tendons whose live series at 10 Hz are sent as `live` events, as `ROBOT/JOINT`, separated by commas.
    pub live: Option<String>,
}

/// Event `live`: samples of a tendon since the previous event; in the first one those of the last minute, as far as another
/// browser receives them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LiveEvent<'a> {
    /// Name of the robot in the configuration.
    pub robot: &'a str,
    /// Name of the joint.
    pub joint: &'a str,
    /// Samples in chronological order, at 10 Hz.
    pub samples: Vec<LiveSample>,
}

/// Credentials of a login.
#[derive(Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Login {
    /// Token of the page.
    pub token: String,
}

impl std::fmt::Debug for Login {
    /// Formats the credentials without the token.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Login").finish_non_exhaustive()
    }
}

/// Confirmation that a request was executed and stored.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Done {
    /// Always `true` in this response.
    pub done: bool,
}

/// Body of an error response.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ErrorBody {
    /// Reason as text.
    pub error: String,
}

impl AlarmView {
    /// Adds the texts to an alarm.
    pub fn of(robot: &str, alarm: &Alarm) -> Self {
        Self {
            robot: robot.into(),
            level: alarm.level(),
            severity: alarm.severity(),
            title: words::title(alarm),
            text: words::observation(alarm),
            advice: words::advice(alarm).unwrap_or(""),
            alarm: alarm.clone(),
        }
    }
}

impl JournalView {
    /// Adds the text to an entry, and its correction from the snapshot of the robot.
    pub fn of(entry: JournalEntry, robot: Option<&RobotSnapshot>) -> Self {
        /// Tolerance of the time of an entry that is compared with its copy, s: a numerical bound.
        const SAME_TIME_S: f64 = 1e-3;
        let time_utc_s = entry.entry.time_utc_s;
        let all = robot.map_or(&[][..], |robot| &robot.maintenance);
        let is_work = matches!(
            &entry.entry.event,
            Event::Command { command } if matches!(
                command.what,
                CommandKind::Tensioned { .. } | CommandKind::Replaced { .. }
            )
        );
        let own = all
            .iter()
            .find(|own| (own.recorded_utc_s - time_utc_s).abs() < SAME_TIME_S);
        Self {
            text: words::entry(&entry.entry.event),
            correction: own
                .filter(|_| is_work)
                .and_then(|own| own.correction.clone()),
            entry,
        }
    }
}

impl RobotRow {
    /// Summarises the snapshot of a robot.
    pub fn of(robot: &RobotSnapshot) -> Self {
        let is_open = |a: &&Alarm| !a.acknowledged && a.shelved_until_utc_s.is_none();
        Self {
            robot: robot.robot.clone(),
            robot_type: robot.robot_type.clone(),
            level: robot.level,
            headline: headline(robot),
            alarms: robot.alarms.len(),
            active: (robot.alarms.iter())
                .filter(|a| a.is_active() && a.shelved_until_utc_s.is_none())
                .count(),
            unacknowledged: robot.alarms.iter().filter(is_open).count(),
            changed: mark(&robot.alarms),
            next: (robot.tendons.iter().filter_map(NextTendon::of))
                .max_by(|a, b| a.share.total_cmp(&b.share)),
            tendons: (robot.tendons.iter())
                .map(|tendon| TendonRow {
                    joint: tendon.joint.clone(),
                    level: tendon.level,
                })
                .collect(),
        }
    }
}

/// Returns the headline without the duration of a data gap: it would change every second, and a changed row is sent
/// again.
fn headline(robot: &RobotSnapshot) -> String {
    match robot.freshness {
        Freshness::Stale { .. } if robot.alarms.is_empty() => "no data".into(),
        _ => words::robot(robot),
    }
}

/// Returns a number that changes with the value.
fn mark<T: Serialize>(of: &T) -> u64 {
    use std::hash::{DefaultHasher, Hasher as _};
    let mut hasher = DefaultHasher::new();
    hasher.write(&serde_json::to_vec(of).unwrap_or_default());
    // Numbers of JavaScript have 53 bits of precision.
    hasher.finish() >> 11
}

impl RobotNow {
    /// Adds the texts to the snapshot of a robot.
    pub fn of(robot: Arc<RobotSnapshot>, slot: &Slot) -> Self {
        let tendons = robot.tendons.iter().map(|tendon| TendonView {
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
                .map(|a| AlarmView::of(&robot.robot, a))
                .collect(),
            recordings: slot.recordings(),
            messages_dropped: slot.dropped.load(Ordering::Relaxed),
            trends: mark(&ends.collect::<Vec<_>>()),
            robot,
        }
    }
}

impl TendonNow {
    /// Returns the tendon of a joint; `None`: the robot has no such tendon.
    pub fn of(robot: &RobotSnapshot, joint: &str) -> Option<Self> {
        let tendon = robot.tendons.iter().find(|tendon| tendon.joint == joint)?;
        let own = robot
            .alarms
            .iter()
            .filter(|a| a.key.joint.as_deref() == Some(joint));
        Some(Self {
            sentence: words::tendon(tendon, &robot.alarms),
            alarms: own.map(|a| AlarmView::of(&robot.robot, a)).collect(),
            trend: tendon.trend.clone(),
            tendon: tendon.clone(),
        })
    }
}

impl RobotState {
    /// Returns the snapshot of a monitored robot.
    pub fn snapshot(self) -> Option<Arc<RobotSnapshot>> {
        match self {
            Self::Monitored(snapshot) => Some(snapshot),
            _ => None,
        }
    }
}
