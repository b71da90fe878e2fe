//! What a session says of every tendon, as data.

use super::torque_range::TorqueRange;
use super::warning::Warning;
use crate::anchored::AnchoredOffset;
use crate::cause::Cause;
use crate::nuisance::NuisanceChange;
use serde::{Deserialize, Serialize};
use sinew_model::offset::{ForceEstimate, SharedError};
use sinew_model::{Gaussian, Interval95};

/// Offsets since the baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionEstimate {
    /// The robot.
    pub robot: String,
    /// The recording.
    pub recording: String,
    /// First recording of the baseline; `None`: data-sheet priors only.
    pub baseline: Option<String>,
    /// When that ended, s since 1970 UTC: every offset was zero then. `None` where its clock doesn't say.
    #[serde(default)]
    pub baseline_time_utc_s: Option<f64>,
    /// When the part used began, s since 1970 UTC; `None` where the recording's clock doesn't say.
    pub start_time_utc_s: Option<f64>,
    /// Length of the part used, s.
    pub duration_s: f64,
    /// Mean temperature, °C, where it was recorded or stated.
    pub temperature_c: Option<f64>,
    /// Where that comes from.
    pub temperature_source: TemperatureSource,
    /// Temperature the offsets refer to, °C, where it was recorded.
    pub reference_temperature_c: Option<f64>,
    /// One entry per elastic joint.
    pub joints: Vec<TendonEstimate>,
    /// Offsets at the end of every segment the recording was estimated in.
    pub segments: Vec<SegmentEstimate>,
    /// Block by block, for a plot; not part of the JSON.
    #[serde(skip)]
    pub blocks: Vec<BlockEstimate>,
    /// Payload at the end, kg.
    pub payload_kg: Gaussian,
    /// Loads picked up or put down within the recording.
    pub payload_changes: Vec<PayloadChange>,
    /// A constant force from outside at the tool; `None`: there was none to be seen. Of a long recording, in the stretch where
    /// it is likeliest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub external_force: Option<ForceEstimate>,
    /// Which torque of the motors was used as a second witness.
    pub motor_torque: MotorTorque,
    /// Share of the time left out as contact or disturbance.
    pub left_out_share: f64,
    /// The longest such times.
    pub left_out: Vec<LeftOut>,
    /// Distinct poses the arm stood or passed at, as far as gravity tells them apart.
    pub poses: usize,
    /// What the online estimate says of the same recording; `None` where nobody asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub live: Option<LiveCourse>,
    /// Everything estimated along: what was believed before and after.
    pub nuisance: Vec<NuisanceChange>,
    /// Whether part of the file was lost.
    pub damaged: bool,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// Where the temperature of a recording comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TemperatureSource {
    /// The recording.
    Recorded,
    /// Its owner.
    Stated,
    /// Nobody: it is as usual, with a tolerance.
    #[default]
    Unknown,
}

/// One tendon since its baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonEstimate {
    /// Joint.
    pub name: String,
    /// Whether it slides: rad is then m, and N·m is N.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slides: bool,
    /// Offset at the end of the recording, rad.
    pub offset_rad: Gaussian,
    /// What of its error other sessions have too; `None` in files of programs that didn't say.
    #[serde(default)]
    pub shared_error: Option<SharedError>,
    /// Elongation, m; `None` without tendon geometry.
    pub elongation_m: Option<Gaussian>,
    /// Elongation over the tendon's length; `None` without tendon geometry.
    pub strain_ratio: Option<Gaussian>,
    /// What that comes to.
    pub verdict: Verdict,
    /// The elongation at which the owner wants to tension again, where robot.toml says.
    pub retension: Option<RetensionLimit>,
    /// Sudden changes within the recording.
    pub changes: Vec<TendonChange>,
    /// Stiffness as the recording sees it over nominal, less one.
    pub stiffness_change_ratio: Gaussian,
    /// Whether it has changed since what was known before the recording; `None`: not sought.
    pub stiffness_since_before: Option<StiffnessSinceBefore>,
    /// How its offset moved while it was looked at; `None`: it was not seen to move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub creep: Option<TendonCreep>,
    /// Half the dead zone of an antagonistic pair, rad.
    pub slack_rad: Option<Gaussian>,
    /// Least and greatest torque the joint carried, N·m.
    pub torque_nm: TorqueRange,
    /// What no parameter explains, robust standard deviation, rad.
    pub noise_rad: f64,
    /// What of that is more than sensors leave, rad: it is in the interval.
    pub misfit_rad: f64,
    /// What an end stop or a mark said, where one was touched.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub anchored: Option<AnchoredOffset>,
}

/// An offset that moved evenly while it was looked at: a rope that creeps, or one that warms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonCreep {
    /// Probability that it did; of a long recording, in the stretch where that is likeliest.
    pub probability: f64,
    /// By how much from start to end, rad: averaged over whether it did.
    pub moved_rad: Gaussian,
    /// How fast, rad/s: that over the recording's length.
    pub rate_rad_per_s: Gaussian,
}

/// What an interval says of a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Zero is below the 95 % interval.
    Longer,
    /// Zero is above it.
    Shorter,
    /// Zero is in it.
    Unchanged,
    /// The interval is too wide to tell stretch from nothing.
    CannotTell,
}

impl Verdict {
    /// What an offset comes to, rad.
    pub fn of(offset_rad: Gaussian) -> Self {
        /// An interval whose half is wider than this can't tell stretch from nothing, rad.
        const USELESS_RAD: f64 = 5e-3;
        if !(offset_rad.half_width_95() <= USELESS_RAD) {
            Self::CannotTell
        } else if !offset_rad.is_nonzero_95() {
            Self::Unchanged
        } else if offset_rad.mean > 0.0 {
            Self::Longer
        } else {
            Self::Shorter
        }
    }
}

/// A limit of elongation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RetensionLimit {
    /// Elongation at which to tension again, m.
    pub elongation_m: f64,
    /// Whether it is passed.
    pub state: LimitState,
}

/// Whether a limit is passed, as far as the 95 % interval tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LimitState {
    /// The interval is above it.
    Passed,
    /// The interval is below it.
    NotPassed,
    /// The limit is in the interval.
    CannotTell,
}

/// Which torque of the motors was used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MotorTorque {
    /// None was recorded, or it was left out.
    Unused,
    /// A measured torque.
    Measured,
    /// A current times a torque constant, which is known less well.
    FromCurrent,
}

/// Stiffness that may have changed between two recordings. Offsets are averaged over whether it has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StiffnessSinceBefore {
    /// Probability that it has.
    pub probability: f64,
    /// By how much if it has; lost stiffness is negative.
    pub change_ratio: Gaussian,
}

/// A sudden change of a tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonChange {
    /// What it is.
    pub kind: TendonChangeKind,
    /// When, s from the start of the recording.
    pub time_s: f64,
    /// It happened between these with 95 %, s; `None` for what happened before the recording.
    pub interval_s: Option<Interval95>,
    /// Probability that it happened and lasts: one that comes late may be a contact as well. `None` for
    /// what happened before the recording.
    pub probability: Option<f64>,
    /// By how much the offset changed, rad; `None`: only the stiffness did.
    pub size_rad: Option<Gaussian>,
    /// Stiffness lost or gained with it, relative; `None`: no change seen.
    pub stiffness_change_ratio: Option<Gaussian>,
    /// Of a slip: what slipped.
    pub cause: Option<Cause>,
}

/// What a sudden change of a tendon is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TendonChangeKind {
    /// The offset changed, and no stiffness was surely lost.
    Slip,
    /// The stiffness surely fell.
    StrandFailure,
    /// Neither alone is sure.
    SlipOrStrandFailure,
    /// The stiffness rose.
    Stiffer,
    /// Much of the offset went without a slip of an encoder.
    Retensioned,
    /// The recording began with less stiffness than was known.
    SofterSinceBefore,
    /// The recording began with more stiffness than was known.
    StifferSinceBefore,
}

/// A load picked up or put down.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PayloadChange {
    /// When, s from the start of the recording.
    pub time_s: f64,
    /// It happened between these with 95 %, s.
    pub interval_s: Option<Interval95>,
    /// Probability that it happened.
    pub probability: Option<f64>,
    /// By how much, kg.
    pub change_kg: Gaussian,
}

/// Offsets at the end of a segment of some minutes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SegmentEstimate {
    /// From, s of the recording.
    pub from_s: f64,
    /// Up to here, s of the recording.
    pub to_s: f64,
    /// Offset of every elastic joint at `to_s`, rad, in the order of `joints`.
    pub offset_rad: Vec<Gaussian>,
}

/// One block of 0.2 s; offsets in the order of `joints`.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockEstimate {
    /// Middle of the block, s.
    pub time_s: f64,
    /// Weight, 0 to 1; [small](BlockEstimate::is_left_out): left out.
    pub weight: f64,
    /// What the block says of the offset once everything else is taken off, rad.
    pub block_rad: Vec<f64>,
    /// Estimated offset then, rad.
    pub offset_rad: Vec<Gaussian>,
}

/// A block of less weight, three standard deviations off in the mean, counts as left out.
pub(crate) const OUTLIER: f64 = 0.25;

impl BlockEstimate {
    /// Whether it was left out as contact or disturbance: it is three standard deviations off in the mean.
    pub fn is_left_out(&self) -> bool {
        self.weight < OUTLIER
    }
}

/// What the online estimate ([`crate::online`]) says of a recording, block by block.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LiveCourse {
    /// One entry per elastic joint, at the end of the recording.
    pub joints: Vec<LiveTendon>,
    /// A constant force from outside at the tool, as far as it is known at the end; `None`: none is looked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub external_force: Option<ForceEstimate>,
    /// Whether any offset is provisional at the end.
    pub in_doubt: bool,
    /// When any was: until the first window is solved, and after steps that are suspected or may end.
    pub doubts: Vec<Doubt>,
    /// Block by block, for a plot; not part of the JSON.
    #[serde(skip)]
    pub blocks: Vec<LiveBlock>,
}

/// A tendon at the end of a [`LiveCourse`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LiveTendon {
    /// Joint.
    pub name: String,
    /// Offset as it is then, rad.
    pub offset_rad: Gaussian,
    /// Probability that its stiffness has changed since the baseline; `None` without one.
    pub stiffness_changed_probability: Option<f64>,
}

/// A time in which the offsets of a [`LiveCourse`] were in doubt.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Doubt {
    /// From here, s.
    pub from_s: f64,
    /// To here, s.
    pub to_s: f64,
}

/// One block of 0.2 s of a [`LiveCourse`]; offsets in the order of its joints.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveBlock {
    /// Middle of the block, s.
    pub time_s: f64,
    /// Probability that nothing touches the arm, 0 to 1.
    pub weight: f64,
    /// Offset as it is then, rad; not a number until a window has been solved.
    pub offset_rad: Vec<Gaussian>,
    /// Whether any offset is provisional then.
    pub in_doubt: bool,
}

/// A time that was left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftOut {
    /// From, s.
    pub from_s: f64,
    /// To, s.
    pub to_s: f64,
}
