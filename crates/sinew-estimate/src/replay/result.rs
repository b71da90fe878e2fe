//! What the paper's estimate says of a recording, as data.

use crate::feeder::{Injection, Refusal};
use crate::warning::RecordingWarning;
use serde::{Deserialize, Deserializer, Serialize};
use sinew_log::{Format, SignalSource};
use sinew_model::offset::{Comparison, TorqueSource};

/// The estimate of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Estimate {
    /// Version of the program that made it.
    pub sinew_version: String,
    /// The recording.
    pub recording: RecordingInfo,
    /// The robot.
    pub robot: RobotInfo,
    /// How it was made.
    pub settings: Settings,
    /// One entry per joint of the robot, in its order.
    pub joints: Vec<JointEstimate>,
    /// Frames of the recording that could not be used for any joint, by reason.
    pub losses: Vec<Loss>,
    /// Whether data was lost to damage (exit code 3).
    pub damaged: bool,
    /// What the reader should know.
    pub warnings: Vec<RecordingWarning>,
    /// What the numbers rest on.
    pub basis: Vec<Basis>,
}

/// What was read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingInfo {
    /// File name as given.
    pub path: String,
    /// Its format.
    pub format: Format,
    /// Where each quantity is read from.
    pub sources: Vec<SignalSource>,
    /// Time of the first frame, ns since the recording's epoch.
    pub start_time_ns: i64,
    /// From first to last frame, s.
    pub duration_s: f64,
    /// Frames read.
    pub frames: u64,
    /// Median frame rate, Hz; `None` with fewer than two frames.
    pub rate_hz: Option<f64>,
    /// Segments without a gap or clock jump.
    pub segments: u32,
}

/// What it was held against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotInfo {
    /// Name in the URDF.
    pub name: String,
    /// Where the robot's file is.
    pub file: String,
    /// Where the URDF comes from: a file, or the recording's own description.
    pub urdf: String,
}

/// How the estimate was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Settings {
    /// Where `tau_el` comes from.
    pub source: TorqueSource,
    /// Whether `theta − q` lags like the observed torque.
    pub comparison: Comparison,
    /// Observer gain `K_I`, 1/s.
    pub gain_per_s: f64,
    /// Cut-off of the velocity filter, rad/s; `None`: recorded velocities, unfiltered positions.
    pub velocity_filter_rad_per_s: Option<f64>,
    /// Whether the recording's known external torque was used.
    pub tau_ext: bool,
    /// Offsets added by hand.
    pub injected: Vec<Injection>,
    /// Recording the estimate is compared with.
    pub reference: Option<String>,
}

/// Frames that gave no estimate, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Loss {
    /// Why.
    pub reason: LossReason,
    /// How many frames.
    pub frames: u64,
    /// Share of all frames, 0 to 1.
    pub share: f64,
}

/// Why frames gave no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LossReason {
    /// The filters were settling after the start, a gap or missing samples.
    Settling,
    /// A joint position was missing or not finite.
    JointPosition,
    /// A joint velocity was missing or not finite.
    JointVelocity,
    /// The motor position was missing or not finite.
    MotorPosition,
    /// The measured torque was missing or not finite.
    Torque,
    /// The external torque was missing or not finite.
    ExternalTorque,
    /// A value was too large to be one.
    Range,
    /// Dropped: its time stamp had been seen before.
    Duplicate,
    /// Dropped: it came too late to be sorted in.
    Late,
    /// Dropped: it could not be decoded.
    Undecodable,
    /// Dropped: a row without a time.
    WithoutTime,
}

impl From<Refusal> for LossReason {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::JointPosition => Self::JointPosition,
            Refusal::JointVelocity => Self::JointVelocity,
            Refusal::MotorPosition => Self::MotorPosition,
            Refusal::Torque => Self::Torque,
            Refusal::ExternalTorque => Self::ExternalTorque,
            Refusal::TimeStep => Self::Settling,
            Refusal::Range => Self::Range,
        }
    }
}

/// Why a joint got no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum JointRefusal {
    /// It is rigid in robot.toml.
    Rigid,
    /// Its position is not recorded.
    NoJointPosition,
    /// Its motor position is not recorded.
    NoMotorPosition,
    /// Its joint torque is not recorded.
    NoJointTorque,
    /// Its motor torque is not recorded.
    NoMotorTorque,
    /// robot.toml says no motor inertia.
    NoMotorInertia,
    /// No frame could be used, mostly for this reason.
    NoUsableFrame(Option<LossReason>),
}

/// The estimate of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointEstimate {
    /// Joint.
    pub name: String,
    /// Whether it slides: rad is then m, and N·m is N.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slides: bool,
    /// `None` where there is an estimate; else why there is none.
    pub refused: Option<JointRefusal>,
    /// Mean offset of the motor position, rad; `None` where refused.
    pub offset_rad: Option<f64>,
    /// Standard deviation of the single estimates, rad.
    pub scatter_rad: Option<f64>,
    /// Standard error of the mean that respects their correlation (batch means), rad; `None` when the
    /// recording is too short for one.
    pub standard_error_rad: Option<f64>,
    /// Elongation of the tendon, m; `None` without tendon geometry.
    pub elongation_m: Option<f64>,
    /// Standard error of the elongation, m.
    pub elongation_standard_error_m: Option<f64>,
    /// Strain of the tendon.
    pub strain_ratio: Option<f64>,
    /// Frames that gave an estimate.
    pub usable_frames: u64,
    /// Their share of all frames, 0 to 1.
    pub usable_share: f64,
    /// Why the rest didn't.
    pub losses: Vec<Loss>,
    /// Stiffness used, N·m/rad; `None` where rigid.
    pub stiffness_nm_per_rad: Option<f64>,
    /// Elastic torque, N·m; `None` without an estimate.
    pub tau_el_nm: Option<TorqueStatistics>,
    /// What an error of the stiffness adds to the offset, rad per relative error: `mean(tau_el)/K`. An
    /// error of the masses has the same size and the opposite sign.
    pub offset_per_stiffness_error_rad: Option<f64>,
    /// Against the reference recording.
    pub difference: Option<Difference>,
    /// The estimate over time.
    pub series: Series,
}

/// Torque over a recording, N·m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueStatistics {
    /// Smallest.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}

/// Change since a reference recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Difference {
    /// Offset of the reference, rad.
    pub reference_rad: f64,
    /// Offset now minus offset then, rad.
    pub difference_rad: f64,
    /// Standard error of the difference, rad; `None` when a recording is too short for one.
    pub standard_error_rad: Option<f64>,
    /// The difference as elongation, m.
    pub elongation_m: Option<f64>,
    /// What an error of the stiffness adds to the difference, rad per relative error.
    pub offset_per_stiffness_error_rad: f64,
}

/// A joint's estimate over time, averaged into at most [`Series::POINTS`] intervals.
///
/// All columns have the same length; intervals without an estimate hold NaN (null in JSON).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Series {
    /// Middle of each interval, s from the start of the recording.
    pub time_s: Vec<f64>,
    /// Mean offset, rad.
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Option<f64>>"))]
    pub offset_rad: Vec<f64>,
    /// Smallest offset in the interval, rad.
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Option<f64>>"))]
    pub offset_min_rad: Vec<f64>,
    /// Largest offset in the interval, rad.
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Option<f64>>"))]
    pub offset_max_rad: Vec<f64>,
    /// Mean elastic torque from the source chosen, N·m.
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Option<f64>>"))]
    pub tau_el_nm: Vec<f64>,
    /// Mean torque of the spring as the encoders show it, `K (theta_measured − q)`, N·m.
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Option<f64>>"))]
    pub tau_spring_nm: Vec<f64>,
    /// Mean joint position, rad.
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Option<f64>>"))]
    pub q_rad: Vec<f64>,
    /// Share of the interval's frames that could be used, 0 to 1.
    #[serde(deserialize_with = "null_is_nan")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Option<f64>>"))]
    pub usable_share: Vec<f64>,
}

impl Series {
    /// Most intervals a series holds, however long the recording.
    pub const POINTS: usize = 2000;
}

/// JSON has no NaN: it is written as null.
fn null_is_nan<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
    let values: Vec<Option<f64>> = Deserialize::deserialize(from)?;
    Ok(values.into_iter().map(|v| v.unwrap_or(f64::NAN)).collect())
}

/// What a quantity rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Basis {
    /// Quantity.
    pub quantity: Quantity,
    /// Where it comes from.
    pub rests_on: Origin,
}

/// Quantities of an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Motor and joint positions.
    Positions,
    /// Elastic torque.
    ElasticTorque,
    /// Stiffness, friction and tendon geometry.
    Transmission,
    /// External torque.
    ExternalTorque,
    /// Offset, elongation and strain.
    Offset,
}

/// Where a quantity comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// Measured, in the recording.
    Measured,
    /// Computed by the momentum observer from positions and masses.
    Observed,
    /// Computed from the recorded motor torque, motor inertia and friction.
    MotorTorque,
    /// As robot.toml states it.
    Stated,
    /// As recorded, taken as known.
    TakenAsKnown,
    /// Estimated from the others.
    Estimated,
}
