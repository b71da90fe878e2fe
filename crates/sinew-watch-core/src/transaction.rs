//! What has to be stored before it is spoken of.

use crate::alarm::AlarmsStored;
use crate::journal::Entry;
use crate::record::Record;
use serde::{Deserialize, Serialize};
use sinew_estimate::baseline::Baseline;
use sinew_model::Gaussian;
use std::sync::Arc;

/// What belongs together: records, what they taught, the alarms they changed, and how. Stored as a whole or
/// not at all; the monitor speaks of it after [`committed`](crate::Monitor::committed).
#[derive(Debug, Clone)]
pub struct Transaction {
    /// Number, rising.
    pub id: u64,
    /// Robot.
    pub robot: String,
    /// Records of a session that ended.
    pub records: Vec<Record>,
    /// What is known now; `None`: as before.
    pub belief: Option<Arc<Belief>>,
    /// The alarms that aren't normal now; `None`: as before.
    pub alarms: Option<AlarmsStored>,
    /// Entries of the journal.
    pub journal: Vec<Entry>,
}

/// What a robot's monitor goes on from after a restart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Belief {
    /// Version of this form.
    pub version: u32,
    /// The chain's last posterior; `None`: nothing learned yet.
    pub baseline: Option<Baseline>,
    /// Whether a new baseline is to be learned, since a rope was tensioned.
    pub learns_baseline: bool,
    /// Tendons, in the order of the robot's elastic joints.
    pub tendons: Vec<TendonBelief>,
}

impl Belief {
    /// Version written.
    pub const VERSION: u32 = 1;
}

/// What is kept of a tendon beside the posterior.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TendonBelief {
    /// Joint.
    pub joint: String,
    /// When it was last tensioned, s since 1970 UTC; `None`: nobody said.
    pub tensioned_utc_s: Option<f64>,
    /// Its offset when the present baseline began, rad: other tendons' tensionings begin baselines too.
    pub carried_rad: Gaussian,
    /// Elongation from before it was last tensioned, since the rope was new, m.
    pub before_m: Gaussian,
    /// Offset at the end of the last session that could tell, rad, since it was tensioned.
    pub last_rad: Option<Gaussian>,
    /// A sudden change that waits for another session.
    pub suspected: Option<Suspected>,
}

/// A sudden change that waits for another session.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Suspected {
    /// When, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Offset before, rad.
    pub before_rad: Gaussian,
    /// By how much it changed, rad.
    pub size_rad: Gaussian,
    /// What it may be.
    pub what: crate::alarm::JumpKind,
    /// Change of the stiffness, as a fraction.
    pub stiffness_ratio: Option<f64>,
    /// Number of the session it was seen in.
    pub session: u64,
}
