//! Result of a session as data.

use super::torque_range::TorqueRange;
use super::warning::Warning;
use crate::anchored::ReferenceOffset;
use crate::cause::Cause;
use crate::nuisance::NuisanceChange;
use serde::{Deserialize, Serialize};
use sinew_model::offset::{ForceEstimate, SharedError};
use sinew_model::{Gaussian, Interval95};

/// Result of a session: offset of each tendon since the baseline, or relative to the encoder zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionEstimate {
    /// Name of the robot.
    pub robot: String,
    /// Name of the recording.
    pub recording: String,
    /// Name of the first recording of the baseline; `None` without a baseline (priors from data sheets only).
    pub baseline: Option<String>,
    /// End of that recording, when every offset was zero, s since 1970 UTC; `None` if its clock has no date.
    #[serde(default)]
    pub baseline_time_utc_s: Option<f64>,
    /// Standard deviation of the encoder zeros by robot.toml, rad, with which offsets without a baseline are elongations;
    /// `None` with a baseline, or if robot.toml states none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zero_std_rad: Option<f64>,
    /// Start of the evaluated interval by the clock of the recording, or the specified date, s since 1970 UTC; `None`
    /// without a date.
    pub start_time_utc_s: Option<f64>,
    /// Duration of the evaluated interval, s.
    pub duration_s: f64,
    /// Mean temperature, °C; `None` if neither recorded nor specified.
    pub temperature_c: Option<f64>,
    /// Source of the temperature.
    pub temperature_source: TemperatureSource,
    /// Reference temperature of the offsets, °C; `None` if unknown.
    pub reference_temperature_c: Option<f64>,
    /// Results of the tendons, one entry per elastic joint.
    pub joints: Vec<TendonEstimate>,
    /// Offsets of joints that are driven by several tendons or by strands; empty on other robots, and if a strand may
    /// be slack.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joint_offsets: Vec<JointOffset>,
    /// Combinations of elongations that are not observable from the recording.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unobservable: Vec<UnobservableCombination>,
    /// Offsets at the end of each segment of the recording.
    pub segments: Vec<SegmentEstimate>,
    /// Estimates of all blocks, for a plot; not part of the JSON.
    #[serde(skip)]
    pub blocks: Vec<BlockEstimate>,
    /// Payload mass at the end of the recording, kg.
    pub payload_kg: Gaussian,
    /// Payload changes within the recording.
    pub payload_changes: Vec<PayloadChange>,
    /// Constant external force at the tool; `None` if none was detected. For a recording of several segments, the force
    /// of the segment with the highest probability.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub external_force: Option<ForceEstimate>,
    /// Source of the motor torque that was used as an independent measurement.
    pub motor_torque: MotorTorque,
    /// Whether the tensions of tendons were used.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tension_used: bool,
    /// Share of the time that was rejected as contact or disturbance, 0 to 1.
    pub rejected_share: f64,
    /// Longest intervals that were rejected as contact or disturbance, at most 20.
    #[serde(alias = "left_out")]
    pub rejected_intervals: Vec<RejectedInterval>,
    /// Number of distinct poses, at rest or in motion; poses are distinct if a joint differs by more than 0.2 rad.
    pub poses: usize,
    /// Online estimate of the same recording; `None` if not requested.
    #[serde(default, alias = "live", skip_serializing_if = "Option::is_none")]
    pub online: Option<OnlineTrajectory>,
    /// Prior and posterior of each nuisance parameter.
    pub nuisance: Vec<NuisanceChange>,
    /// Whether data was lost because the file is damaged.
    pub damaged: bool,
    /// Warnings about the recording and the result.
    pub warnings: Vec<Warning>,
}

impl SessionEstimate {
    /// Whether the offsets are elongations of the tendons: since a baseline, or from an encoder zero of stated accuracy.
    /// Otherwise they include the error of the encoder zero.
    pub fn is_elongation(&self) -> bool {
        self.baseline.is_some() || self.zero_std_rad.is_some()
    }
}

/// Offset of a joint with coupled tendons: rotation of the joint due to their elongations at constant motor positions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointOffset {
    /// Name of the joint.
    pub name: String,
    /// Offset, rad; positive if the joint lags behind its motors.
    pub offset_rad: Gaussian,
}

/// Combination of elongations that is not observable from a recording, such as an equal loss of tension in flexor and
/// extensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnobservableCombination {
    /// Tendons of the combination, with their weights.
    pub tendons: Vec<TendonWeight>,
    /// Standard deviation of the largest elongation in the combination, rad in the coordinate of that tendon.
    pub std_rad: f64,
    /// Standard deviation of the largest elongation in the combination, m; `None` without tendon geometry.
    pub std_m: Option<f64>,
    /// Measurements that would make the combination observable.
    pub remedies: Vec<Remedy>,
    /// Sudden changes of one of the tendons; the recording does not determine which one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<UnattributedChange>,
}

/// Sudden change of one of several tendons that are indistinguishable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnattributedChange {
    /// Time of the change since the start of the recording, s.
    pub time_s: f64,
    /// 95 % interval of the time, s.
    pub interval_s: Option<Interval95>,
    /// Probability of a permanent change, 0 to 1.
    pub probability: Option<f64>,
}

/// Weight of a tendon in a combination of elongations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonWeight {
    /// Name of the tendon.
    pub name: String,
    /// Elongation relative to the largest one: ratio of values in m if all tendons have a geometry, otherwise of values
    /// in rad.
    pub weight: f64,
}

/// Measurement that would make a combination of elongations observable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Remedy {
    /// Torque or current of each motor.
    MotorTorque,
    /// Tension sensor at each tendon.
    TensionSensors,
}

/// Source of the temperature of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TemperatureSource {
    /// Temperature from the recording.
    Recorded,
    /// Temperature specified by the user.
    Stated,
    /// Temperature neither recorded nor specified: assumed as usual, with a tolerance.
    #[default]
    Unknown,
}

/// Result of one tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonEstimate {
    /// Name of the joint.
    pub name: String,
    /// Whether the joint is prismatic: values in rad are then in m, and values in N·m in N.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slides: bool,
    /// Offset at the end of the recording, rad; positive if the tendon is longer.
    pub offset_rad: Gaussian,
    /// Systematic part of the error of the offset, which other sessions share; `None` in files of earlier versions.
    #[serde(default)]
    pub systematic_error: Option<SharedError>,
    /// Elongation of the tendon, m; `None` without tendon geometry.
    pub elongation_m: Option<Gaussian>,
    /// Strain: elongation divided by the length of the tendon, m/m; `None` without tendon geometry.
    pub strain_ratio: Option<Gaussian>,
    /// Result of the test whether the offset differs from zero.
    pub verdict: Verdict,
    /// Re-tensioning limit and its state; `None` if robot.toml specifies no limit.
    pub retension: Option<RetensionLimit>,
    /// Sudden changes within the recording.
    pub changes: Vec<TendonChange>,
    /// Estimated relative deviation of the stiffness from nominal: `K/K_nominal − 1`.
    pub stiffness_change_ratio: Gaussian,
    /// Stiffness change relative to the prior of the recording; `None` if not evaluated.
    pub stiffness_change: Option<StiffnessSinceBefore>,
    /// Drift of the offset during the recording; `None` if none was detected.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub creep: Option<TendonCreep>,
    /// Half-width of the dead zone (slack) of an antagonistic pair, rad; `None` for other tendons.
    pub slack_rad: Option<Gaussian>,
    /// Range of the torque of the tendon, N·m.
    pub torque_nm: TorqueRange,
    /// Robust standard deviation of the residual, rad.
    pub noise_rad: f64,
    /// Part of the residual that exceeds the sensor noise, rad; the interval includes it.
    pub excess_residual_rad: f64,
    /// Share of the recording in which the strand was slack, 0 to 1; its elongation is then not determined. `None` if
    /// never slack.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slack_share: Option<f64>,
    /// Lower bound of the offset of a strand that was slack for most of the recording, rad; `None` otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower_bound_rad: Option<f64>,
    /// Lower bound of the elongation of a strand that was slack for most of the recording, m; `None` otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower_bound_m: Option<f64>,
    /// Correction by reference contacts and index marks; `None` if none was touched.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub anchored: Option<ReferenceOffset>,
}

/// Drift of an offset at a constant rate, from creep or a temperature change of the rope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonCreep {
    /// Probability of the drift, 0 to 1; for a recording of several segments, the highest of all segments.
    pub probability: f64,
    /// Change of the offset from the start to the end of the recording, rad, averaged over both hypotheses (drift, no
    /// drift).
    pub drift_rad: Gaussian,
    /// Mean drift rate over the recording, rad/s.
    pub rate_rad_per_s: Gaussian,
}

/// Result of the test whether an offset differs from zero at the 95 % level.
///
/// With a baseline the offset is the elongation since then, and with `zero_mrad` in robot.toml that since the encoders
/// were zeroed. The width of a detection is not limited for tendons with friction along their path. Otherwise the reference is the encoder zero, and no verdict speaks of the rope. An interval that contains zero never shows that nothing has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Elongation since the baseline: the 95 % interval lies above zero.
    Elongated,
    /// Shortening since the baseline: the 95 % interval lies below zero.
    Shortened,
    /// The 95 % interval of the elongation since the baseline contains zero and is at most ± 5 mrad wide.
    NoChangeDetected,
    /// Without a baseline: the 95 % interval of the offset from the encoder zero excludes zero.
    OffsetDetected,
    /// Without a baseline: the 95 % interval of the offset from the encoder zero contains zero.
    NoneDetected,
    /// The 95 % interval is wider than ± 5 mrad.
    Inconclusive,
    /// The tendon transmits no torque at the end of the recording, so it has no elongation.
    TransmissionLost,
}

impl Verdict {
    /// Largest half-width of a conclusive 95 % interval, rad; a convention. It is 0.1 to 0.15 mm of rope on pulleys of 20
    /// to 30 mm radius.
    pub const MAX_HALF_WIDTH_RAD: f64 = 5e-3;

    /// Verdict on an offset in rad, which is an elongation or refers to the encoder zero.
    pub fn of(offset_rad: Gaussian, is_elongation: bool) -> Self {
        if Self::is_inconclusive(offset_rad) {
            return Self::Inconclusive;
        }
        match (is_elongation, offset_rad.is_nonzero_95()) {
            (true, false) => Self::NoChangeDetected,
            (true, true) if offset_rad.mean > 0.0 => Self::Elongated,
            (true, true) => Self::Shortened,
            (false, true) => Self::OffsetDetected,
            (false, false) => Self::NoneDetected,
        }
    }

    /// Whether the 95 % interval of an offset in rad is too wide for a verdict.
    pub fn is_inconclusive(offset_rad: Gaussian) -> bool {
        !(offset_rad.half_width_95() <= Self::MAX_HALF_WIDTH_RAD)
    }

    /// Name of the verdict in JSON and in tables for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Elongated => "elongated",
            Self::Shortened => "shortened",
            Self::NoChangeDetected => "no-change-detected",
            Self::OffsetDetected => "offset-detected",
            Self::NoneDetected => "none-detected",
            Self::Inconclusive => "inconclusive",
            Self::TransmissionLost => "transmission-lost",
        }
    }
}

/// Re-tensioning limit of a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RetensionLimit {
    /// Elongation at which to re-tension, m.
    pub elongation_m: f64,
    /// Result of the test whether the elongation exceeds the limit.
    pub state: LimitState,
}

/// Result of the test whether the 95 % interval of the elongation exceeds a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LimitState {
    /// 95 % interval above the limit.
    Passed,
    /// 95 % interval below the limit.
    NotPassed,
    /// 95 % interval that contains the limit, or an estimate without a verdict.
    Inconclusive,
}

/// Source of the motor torques that were used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MotorTorque {
    /// No motor torque: not recorded, rejected, or not used by option.
    Unused,
    /// Measured motor torque.
    Measured,
    /// Motor current times a torque constant, which has a larger tolerance.
    FromCurrent,
}

/// Stiffness change between two recordings, under a model error that depends on pose and direction of motion and a drift
/// of 2 %. Offsets are averaged over both hypotheses (change, no change).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StiffnessSinceBefore {
    /// Probability that the stiffness changed by more than 5 %, 0 to 1.
    pub probability: f64,
    /// Relative change of the stiffness if there is one; negative for a loss.
    pub change_ratio: Gaussian,
}

/// Sudden change of a tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonChange {
    /// Type of the change.
    pub kind: TendonChangeKind,
    /// Time of the change since the start of the recording, s.
    pub time_s: f64,
    /// 95 % interval of the time, s; `None` for a change before the recording.
    pub interval_s: Option<Interval95>,
    /// Probability of a permanent change, 0 to 1; a change near the end may also be a contact. `None` for a change
    /// before the recording.
    pub probability: Option<f64>,
    /// Size of the step of the offset, rad; `None` if only the stiffness changed.
    pub size_rad: Option<Gaussian>,
    /// Simultaneous relative change of the stiffness, negative for a loss; `None` if none was detected.
    pub stiffness_change_ratio: Option<Gaussian>,
    /// Cause of a slip; `None` for other changes.
    pub cause: Option<Cause>,
}

/// Type of a sudden change of a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TendonChangeKind {
    /// Step of the offset without a significant loss of stiffness.
    Slip,
    /// No torque is transmitted from here on: the tendon is torn or off its pulley, or its motor side is detached.
    TransmissionLost,
    /// Significant loss of stiffness.
    StrandFailure,
    /// Slip or strand failure, neither of which is significant alone.
    SlipOrStrandFailure,
    /// Increase of the stiffness.
    Stiffer,
    /// Re-tensioning: at least half of the offset disappeared without a slip of an encoder.
    Retensioned,
    /// Stiffness at the start of the recording below its prior.
    StiffnessLoss,
    /// Stiffness at the start of the recording above its prior.
    StiffnessIncrease,
}

/// Change of the payload within a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PayloadChange {
    /// Time of the change since the start of the recording, s.
    pub time_s: f64,
    /// 95 % interval of the time, s.
    pub interval_s: Option<Interval95>,
    /// Probability of the change, 0 to 1.
    pub probability: Option<f64>,
    /// Change of the payload mass, kg; negative for a load that was released.
    pub change_kg: Gaussian,
}

/// Offsets at the end of a segment of some minutes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SegmentEstimate {
    /// Start of the segment since the start of the recording, s.
    pub from_s: f64,
    /// End of the segment since the start of the recording, s.
    pub to_s: f64,
    /// Offset of each elastic joint at `to_s`, rad, in the order of `joints`.
    pub offset_rad: Vec<Gaussian>,
}

/// Estimate of one block of 0.2 s; offsets in the order of `joints`.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockEstimate {
    /// Middle of the block, s.
    pub time_s: f64,
    /// Robust weight, 0 to 1; [rejected](BlockEstimate::is_rejected) if small.
    pub weight: f64,
    /// Offset by this block alone (estimated offset plus residual), rad.
    pub block_rad: Vec<f64>,
    /// Estimated offset at the time of the block, rad.
    pub offset_rad: Vec<Gaussian>,
}

/// Minimum weight of a block that is not rejected: that of residuals of three standard deviations on average.
pub(crate) const OUTLIER: f64 = 0.25;

impl BlockEstimate {
    /// Whether the block was rejected as contact or disturbance.
    pub fn is_rejected(&self) -> bool {
        self.weight < OUTLIER
    }
}

/// Result of the online estimator ([`crate::online`]) for a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OnlineTrajectory {
    /// Results of the tendons at the end of the recording, one entry per elastic joint.
    pub joints: Vec<OnlineTendon>,
    /// Constant external force at the tool at the end of the recording; `None` if it is not estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub external_force: Option<ForceEstimate>,
    /// Whether any offset is provisional at the end.
    pub provisional: bool,
    /// Intervals with a provisional offset: until the first window is solved, and after suspected steps and possible
    /// contacts.
    pub provisional_intervals: Vec<ProvisionalInterval>,
    /// Estimates of all blocks, for a plot; not part of the JSON.
    #[serde(skip)]
    pub blocks: Vec<OnlineBlock>,
}

/// Result of a tendon at the end of an [`OnlineTrajectory`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OnlineTendon {
    /// Name of the joint.
    pub name: String,
    /// Offset at the end of the recording, rad.
    pub offset_rad: Gaussian,
    /// Probability of a stiffness change since the baseline, 0 to 1; `None` without a baseline.
    pub stiffness_changed_probability: Option<f64>,
}

/// Interval in which an offset of an [`OnlineTrajectory`] was provisional.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProvisionalInterval {
    /// Start of the interval since the start of the recording, s.
    pub from_s: f64,
    /// End of the interval since the start of the recording, s.
    pub to_s: f64,
}

/// Estimate of one block of 0.2 s of an [`OnlineTrajectory`]; offsets in the order of its joints.
#[derive(Debug, Clone, PartialEq)]
pub struct OnlineBlock {
    /// Middle of the block, s.
    pub time_s: f64,
    /// Probability that there is no contact, 0 to 1.
    pub weight: f64,
    /// Offset at the time of the block, rad; NaN until the first window is solved.
    pub offset_rad: Vec<Gaussian>,
    /// Whether any offset is provisional at the time of the block.
    pub provisional: bool,
}

/// Interval that was rejected as contact or disturbance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RejectedInterval {
    /// Start of the interval since the start of the recording, s.
    pub from_s: f64,
    /// End of the interval since the start of the recording, s.
    pub to_s: f64,
}
