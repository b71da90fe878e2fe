//! What has to be stored before it is spoken of.

use crate::alarm::{AlarmsStored, JumpKind};
use crate::journal::Entry;
use crate::record::Record;
use serde::{Deserialize, Serialize};
use sinew_estimate::Cause;
use sinew_estimate::baseline::Baseline;
use sinew_model::Gaussian;
use std::sync::Arc;

/// What belongs together: records, what they taught, the alarms they changed, and how. Stored as a whole or
/// not at all; the monitor speaks of it after [`committed`](crate::Monitor::committed).
#[derive(Debug, Clone)]
pub struct Transaction {
    /// Number that rises from one to the next.
    pub id: u64,
    /// Name of the robot in the configuration.
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
    /// When what it rests on ended, s since 1970 UTC; `None`: a baseline from a file, or nothing learned.
    pub end_utc_s: Option<f64>,
    /// A new baseline that is to be learned, since a rope was tensioned.
    pub learns: Option<LearnsBaseline>,
    /// Sessions so far.
    pub sessions: u64,
    /// Tendons, in the order of the robot's elastic joints.
    pub tendons: Vec<TendonBelief>,
}

impl Belief {
    /// Version that this program writes.
    pub const VERSION: u32 = 1;
}

/// A baseline on its way.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LearnsBaseline {
    /// Joints whose ropes were tensioned; the others' offsets go on counting from before.
    pub joints: Vec<String>,
    /// Motion it rests on so far, s.
    pub duration_s: f64,
    /// Distinct poses so far, one after the other, rad.
    pub poses_rad: Vec<f64>,
}

/// What is kept of a tendon beside the posterior.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TendonBelief {
    /// Name of the joint.
    pub joint: String,
    /// What its offset counts from: the last tensioning, or a baseline from a file; `None`: the encoders' zero.
    pub since: Option<String>,
    /// When it was tensioned since its rope is new, s since 1970 UTC; empty: nobody said.
    pub tensioned_utc_s: Vec<f64>,
    /// When its rope was replaced, s since 1970 UTC; `None`: nobody said.
    pub replaced_utc_s: Option<f64>,
    /// Elongation from before it was last tensioned, since the rope was new, m.
    pub before_m: Gaussian,
    /// Offset at the end of the last session that could tell, rad, since it was tensioned.
    pub last_rad: Option<Gaussian>,
    /// When that was, s since 1970 UTC.
    pub last_utc_s: Option<f64>,
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
    pub what: JumpKind,
    /// What slipped, where the readings tell.
    pub cause: Option<Cause>,
    /// Change of the stiffness, as a fraction.
    pub stiffness_ratio: Option<f64>,
    /// Stiffness over nominal less 1 before that.
    pub stiffness_before_ratio: f64,
    /// Number of the session it was seen in.
    pub session: u64,
    /// Sessions since then that could tell an offset, but not whether it lasts.
    pub undecided: u32,
}
