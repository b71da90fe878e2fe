//! Result of the estimate by the method of the paper, as data.

use crate::feeder::{Injection, RejectionReason};
use crate::warning::RecordingWarning;
use serde::{Deserialize, Serialize};
use sinew_log::{Format, SignalSource};
use sinew_model::offset::{Comparison, TorqueSource};

/// Estimate of one recording by the method of the paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Estimate {
    /// Version of the program that made the estimate.
    pub sinew_version: String,
    /// Properties of the recording.
    pub recording: RecordingInfo,
    /// Properties of the robot.
    pub robot: RobotInfo,
    /// Settings of the estimate.
    pub settings: Settings,
    /// Estimates of the joints of the robot, in their order in the URDF.
    pub joints: Vec<JointEstimate>,
    /// Numbers of frames that were not used for any joint, by reason.
    pub losses: Vec<Loss>,
    /// Whether data was lost because the recording is damaged (exit status 3).
    pub damaged: bool,
    /// Warnings about the recording and the result.
    pub warnings: Vec<RecordingWarning>,
    /// Origin of each quantity.
    pub basis: Vec<Basis>,
}

/// Properties of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingInfo {
    /// File name as specified by the user.
    pub path: String,
    /// File format of the recording.
    pub format: Format,
    /// Source (topic, column or interface) of each quantity.
    pub sources: Vec<SignalSource>,
    /// Time of the first frame, ns since the epoch of the recording.
    pub start_time_ns: i64,
    /// Time from the first to the last frame, s.
    pub duration_s: f64,
    /// Number of frames in the recording.
    pub frames: u64,
    /// Median frame rate, Hz; `None` with fewer than two frames.
    pub rate_hz: Option<f64>,
    /// Number of segments without a gap or clock step.
    pub segments: u32,
}

/// Properties of the robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotInfo {
    /// Name of the robot in the URDF.
    pub name: String,
    /// Path of the robot file (robot.toml).
    pub file: String,
    /// Source of the URDF: a file, or the description in the recording.
    pub urdf: String,
    /// Names of the joints, if results are named by tendons rather than joints; empty otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<String>,
}

/// Settings of an estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Settings {
    /// Source of the elastic torque `tau_el`.
    pub source: TorqueSource,
    /// Filtering of `theta − q`: by the filters of the observed torque, or none as in the paper.
    pub comparison: Comparison,
    /// Observer gain `K_I`, 1/s.
    pub gain_per_s: f64,
    /// Cut-off of the velocity filter, rad/s; `None` with recorded velocities and unfiltered positions.
    pub velocity_filter_rad_per_s: Option<f64>,
    /// Whether the recorded external torque was used.
    pub tau_ext: bool,
    /// Offsets that were added to the motor positions for a test (`--inject`).
    pub injected: Vec<Injection>,
    /// Name of the reference recording; `None` without one.
    pub reference: Option<String>,
}

/// Frames without an estimate, for one reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Loss {
    /// Reason for the missing estimate.
    pub reason: LossReason,
    /// Number of frames without an estimate.
    pub frames: u64,
    /// Share of all frames, 0 to 1.
    pub share: f64,
}

/// Reason why frames have no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LossReason {
    /// Filters settling after the start, a gap or missing samples.
    Settling,
    /// Joint position missing or non-finite.
    JointPosition,
    /// Joint velocity missing or non-finite.
    JointVelocity,
    /// Motor position missing or non-finite.
    MotorPosition,
    /// Measured torque missing or non-finite.
    Torque,
    /// External torque missing or non-finite.
    ExternalTorque,
    /// Value outside the plausible range.
    Range,
    /// Duplicate time stamp; sample excluded.
    Duplicate,
    /// Sample too late to be reordered; excluded.
    Late,
    /// Sample that cannot be decoded; excluded.
    Undecodable,
    /// Row without a time stamp; excluded.
    WithoutTime,
}

impl From<RejectionReason> for LossReason {
    fn from(reason: RejectionReason) -> Self {
        match reason {
            RejectionReason::JointPosition => Self::JointPosition,
            RejectionReason::JointVelocity => Self::JointVelocity,
            RejectionReason::MotorPosition => Self::MotorPosition,
            RejectionReason::Torque => Self::Torque,
            RejectionReason::ExternalTorque => Self::ExternalTorque,
            RejectionReason::TimeStep => Self::Settling,
            RejectionReason::Range => Self::Range,
        }
    }
}

/// Reason why a joint has no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum JointError {
    /// Joint that is rigid in robot.toml.
    Rigid,
    /// Joint position not recorded.
    NoJointPosition,
    /// Motor position not recorded.
    NoMotorPosition,
    /// Joint torque not recorded.
    NoJointTorque,
    /// Motor torque not recorded.
    NoMotorTorque,
    /// Motor inertia missing in robot.toml.
    NoMotorInertia,
    /// Tendon coupled with others at a joint; the method of the paper has only one offset per joint.
    JointEquations,
    /// Tendon with friction along its path, which the method of the paper does not contain.
    FrictionAlongPath,
    /// No usable frame, with the most frequent reason.
    NoUsableFrame(Option<LossReason>),
}

/// Estimate of one joint by the method of the paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointEstimate {
    /// Name of the joint or tendon.
    pub name: String,
    /// Whether the joint is prismatic: values in rad are then in m, and values in N·m in N.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slides: bool,
    /// Reason why there is no estimate; `None` if there is one.
    #[serde(alias = "refused")]
    pub reason: Option<JointError>,
    /// Mean offset of the motor position, rad; `None` without an estimate.
    pub offset_rad: Option<f64>,
    /// Standard deviation of the estimates of single frames, rad.
    pub scatter_rad: Option<f64>,
    /// Standard error of the mean with correlated samples (method of batch means), rad; `None` if the
    /// recording is too short.
    pub standard_error_rad: Option<f64>,
    /// Elongation of the tendon, m; `None` without tendon geometry.
    pub elongation_m: Option<f64>,
    /// Standard error of the elongation, m.
    pub elongation_standard_error_m: Option<f64>,
    /// Strain of the tendon: elongation divided by length, m/m; `None` without tendon geometry.
    pub strain_ratio: Option<f64>,
    /// Number of frames with an estimate.
    pub usable_frames: u64,
    /// Share of frames with an estimate, 0 to 1.
    pub usable_share: f64,
    /// Frames without an estimate, by reason.
    pub losses: Vec<Loss>,
    /// Stiffness used in the estimate, N·m/rad; `None` for a rigid joint.
    pub stiffness_nm_per_rad: Option<f64>,
    /// Statistics of the elastic torque, N·m; `None` without an estimate.
    pub tau_el_nm: Option<TorqueStatistics>,
    /// Sensitivity of the offset to a relative error of the stiffness, rad: `mean(tau_el)/K`. The sensitivity to a
    /// relative error of the masses has the same magnitude and the opposite sign.
    pub offset_per_stiffness_error_rad: Option<f64>,
    /// Difference from the reference recording; `None` without one.
    pub difference: Option<Difference>,
    /// Time series of the estimate; not part of the JSON, `--series FILE` writes it.
    #[serde(skip)]
    pub series: Series,
}

/// Statistics of a torque over a recording, N·m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueStatistics {
    /// Minimum torque, N·m.
    pub min: f64,
    /// Mean torque, N·m.
    pub mean: f64,
    /// Maximum torque, N·m.
    pub max: f64,
}

/// Difference of an estimate from that of a reference recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Difference {
    /// Offset in the reference recording, rad.
    pub reference_rad: f64,
    /// Offset minus offset in the reference recording, rad.
    pub difference_rad: f64,
    /// Standard error of the difference, rad; `None` if a recording is too short.
    pub standard_error_rad: Option<f64>,
    /// Difference as elongation of the tendon, m; `None` without tendon geometry.
    pub elongation_m: Option<f64>,
    /// Sensitivity of the difference to a relative error of the stiffness, rad.
    pub offset_per_stiffness_error_rad: f64,
}

/// Time series of the estimate of a joint, averaged over at most [`Series::POINTS`] intervals.
///
/// All columns have the same length; intervals without an estimate contain NaN.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Middle of each interval since the start of the recording, s.
    pub time_s: Vec<f64>,
    /// Mean offset in the interval, rad.
    pub offset_rad: Vec<f64>,
    /// Smallest offset in the interval, rad.
    pub offset_min_rad: Vec<f64>,
    /// Largest offset in the interval, rad.
    pub offset_max_rad: Vec<f64>,
    /// Mean elastic torque from the selected source, N·m.
    pub tau_el_nm: Vec<f64>,
    /// Mean torque of the spring by the encoders, `K (theta_measured − q)`, N·m.
    pub tau_spring_nm: Vec<f64>,
    /// Mean joint position in the interval, rad.
    pub q_rad: Vec<f64>,
    /// Share of usable frames in the interval, 0 to 1.
    pub usable_share: Vec<f64>,
}

impl Series {
    /// Maximum number of intervals, for recordings of any length.
    pub const POINTS: usize = 2000;
}

/// Origin of a quantity of an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Basis {
    /// Quantity of the estimate.
    pub quantity: Quantity,
    /// Origin of the quantity.
    pub based_on: Origin,
}

/// Quantities of an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Motor and joint positions.
    Positions,
    /// Elastic torque of the joints.
    ElasticTorque,
    /// Stiffness, friction and tendon geometry.
    Transmission,
    /// External torque at the joints.
    ExternalTorque,
    /// Offset, elongation and strain.
    Offset,
}

/// Origin of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// Measured value in the recording.
    Measured,
    /// Computed by the momentum observer from positions and masses.
    Observed,
    /// Computed from the recorded motor torque, motor inertia and friction.
    MotorTorque,
    /// Specified in robot.toml.
    Stated,
    /// Recorded value, assumed exact.
    AssumedExact,
    /// Estimated from the other quantities.
    Estimated,
}
