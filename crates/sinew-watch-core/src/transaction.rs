//! Transactions that must be stored before they are published.

use crate::alarm::{Alarm, AlarmsStored, StepKind};
use crate::history::History;
use crate::incident::Incidents;
use crate::journal::{Entry, Maintenance};
use crate::record::Record;
use serde::{Deserialize, Serialize};
use sinew_estimate::Cause;
use sinew_estimate::baseline::Baseline;
use sinew_model::Gaussian;
use std::sync::Arc;

/// Records, the state they produced, the alarms they changed and the journal entries, stored as a whole or not at all.
/// The monitor publishes them after [`committed`](crate::Monitor::committed).
#[derive(Debug, Clone)]
pub struct Transaction {
    /// Number of the transaction, strictly increasing.
    pub id: u64,
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Records of a completed session.
    pub records: Vec<Record>,
    /// Time from which the robot's stored records are replaced by `records`, s since 1970 UTC; `None`: none are replaced.
    pub replaced_from_utc_s: Option<f64>,
    /// State of the monitor; `None`: unchanged.
    pub state: Option<Arc<MonitorState>>,
    /// Alarms that are not normal; `None`: unchanged.
    pub alarms: Option<AlarmsStored>,
    /// New entries of the journal.
    pub journal: Vec<Entry>,
}

/// Persistent state from which the monitor of a robot resumes after a restart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MonitorState {
    /// Version of the stored format.
    pub version: u32,
    /// Posterior of the last session; `None`: no estimate yet.
    pub baseline: Option<Baseline>,
    /// End of the data that the posterior is based on, s since 1970 UTC; `None`: a baseline from a file, or no estimate
    /// yet.
    pub end_utc_s: Option<f64>,
    /// Baseline being acquired after a re-tensioning; `None`: none.
    pub learns: Option<BaselineAcquisition>,
    /// Number of sessions so far.
    pub sessions: u64,
    /// State of each tendon, in the order of the robot's elastic joints.
    pub tendons: Vec<TendonState>,
    /// Incidents of the tendons.
    #[serde(default)]
    pub incidents: Incidents,
    /// Recorded re-tensionings and replacements, the oldest first.
    #[serde(default)]
    pub maintenance: Vec<Maintenance>,
    /// State without the last of them; `None`: it cannot be withdrawn.
    #[serde(default)]
    pub without: Option<Box<Without>>,
}

/// State of a monitor that did not receive the last recorded re-tensioning or replacement, from which it continues if the
/// entry is withdrawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Without {
    /// Number of the entry.
    pub entry: u64,
    /// Start of the first session whose records are replaced, s since 1970 UTC: of the oldest one that was not estimated at
    /// the time of the entry; without one, the time of the entry.
    pub since_utc_s: f64,
    /// State without the entry, by all sessions until now.
    pub state: Arc<MonitorState>,
    /// States of the tendons at the time of the entry.
    pub tendons: Vec<TendonState>,
    /// Alarms that the entry ended.
    pub alarms: Vec<Alarm>,
    /// Step changes confirmed since, with their tendon index.
    pub steps: Vec<(usize, PendingEvent)>,
    /// Rows of the trend of the day of that session and later ones, at the time of the entry.
    pub day: History,
    /// Records of that session and later ones.
    pub records: Vec<Record>,
}

impl MonitorState {
    /// Version of the format that this program writes. Version 1 has no incidents, and no evidence of suspected changes;
    /// version 2 has no maintenance.
    pub const VERSION: u32 = 3;
}

/// Progress of a baseline acquisition.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct BaselineAcquisition {
    /// Names of the joints whose ropes were re-tensioned; the offsets of the others keep their reference.
    pub joints: Vec<String>,
    /// Duration of motion acquired so far, s.
    pub duration_s: f64,
    /// Distinct poses so far, concatenated joint positions, rad.
    pub poses_rad: Vec<f64>,
}

/// State of a tendon in addition to the posterior.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TendonState {
    /// Name of the joint.
    pub joint: String,
    /// Reference of the offset: the last tensioning, or a baseline from a file; `None`: encoder zero.
    pub since: Option<String>,
    /// Times of all tensionings since the rope was new, s since 1970 UTC; empty: none recorded.
    pub tensioned_utc_s: Vec<f64>,
    /// Time of the last replacement, s since 1970 UTC; `None`: not recorded.
    pub replaced_utc_s: Option<f64>,
    /// Elongation between installation of the rope and the last tensioning, m.
    pub before_m: Gaussian,
    /// Offset since the last tensioning, at the end of the last conclusive session, rad.
    pub last_rad: Option<Gaussian>,
    /// End of that session, s since 1970 UTC.
    pub last_utc_s: Option<f64>,
    /// Start of that session, s since 1970 UTC; the offset may hold for any time in it.
    #[serde(default)]
    pub last_from_utc_s: Option<f64>,
    /// Stiffness relative to nominal, minus 1, in that session.
    #[serde(default)]
    pub last_stiffness_ratio: Option<Gaussian>,
    /// Suspected step change, open until later sessions confirm or refute it, or an operator closes it.
    pub suspected: Option<PendingEvent>,
}

/// Suspected step change and the evidence of later sessions for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PendingEvent {
    /// Time of the step change, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Offset before the step change, rad.
    pub before_rad: Gaussian,
    /// Size of the step change, rad.
    pub size_rad: Gaussian,
    /// Probable kind of the step change.
    pub what: StepKind,
    /// Part that slipped, if the data identify it.
    pub cause: Option<Cause>,
    /// Simultaneous relative change of stiffness; `None`: none detected.
    pub stiffness_ratio: Option<f64>,
    /// Standard deviation of `stiffness_ratio`.
    #[serde(default)]
    pub stiffness_std_ratio: f64,
    /// Stiffness relative to nominal, minus 1, before the step change.
    pub stiffness_before_ratio: f64,
    /// Standard deviation of `stiffness_before_ratio`.
    #[serde(default)]
    pub stiffness_before_std_ratio: f64,
    /// Number of the session in which the step change was detected.
    pub session: u64,
    /// Offsets of later sessions, rad.
    #[serde(default)]
    pub later_rad: LevelSums,
    /// Stiffness of later sessions, relative to nominal, minus 1.
    #[serde(default)]
    pub later_stiffness: LevelSums,
}

/// Sums over measurements `y = a + c·g + e` of a constant level `a` under creep `c·g`, with `c ~ N(0, 1)`, the creep
/// `g` expected until the measurement, and independent errors `e` of precision `w = 1/σ²`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LevelSums {
    /// Sum of the weights: Σ w.
    pub weight: f64,
    /// Σ w g.
    pub weight_creep: f64,
    /// Σ w g².
    pub weight_creep2: f64,
    /// Σ w y.
    pub weight_value: f64,
    /// Σ w g y.
    pub weight_creep_value: f64,
}
