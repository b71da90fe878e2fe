//! Warnings of a session estimate as data; the report formats their text.

use super::torque_range::TorqueRange;
use crate::cable::CableLimit;
use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;

/// Reason for the rejection of a motor torque or tension as an independent measurement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MotorTorqueError {
    /// Channel of constant value.
    Constant,
    /// Channel that does not follow the spring torque.
    Contradicts {
        /// Regression slope of the channel on the spring torque; 1 is expected.
        slope: f64,
    },
    /// Channel whose work is negative, though a drive with friction does positive work: wrong sign of the channel, or of both
    /// positions.
    NegativeWork {
        /// Work of the channel over the recording, J.
        work_j: f64,
    },
    /// Channel that cannot be tested, while that of another joint is inconsistent with its spring torque.
    Untested,
}

/// Warning of a session estimate: its cause, and its effect on the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Warning {
    /// Too few distinct poses: payload, mass error and offset are not separable.
    FewPoses {
        /// Number of distinct poses in the recording.
        poses: usize,
    },
    /// Too few distinct poses for a baseline: every later session inherits its uncertainty.
    FewPosesOfBaseline {
        /// Number of distinct poses in the recording.
        poses: usize,
    },
    /// Torque range of a joint that is too small to separate its offset from an error of the stiffness.
    TorqueRangeSmall {
        /// Name of the joint.
        joint: String,
        /// Range of the torque at the joint, N·m.
        torque_nm: TorqueRange,
    },
    /// Change so close to the end of the recording that it may be a contact that has not ended.
    ChangeNearEnd {
        /// Name of the joint.
        joint: String,
        /// Time of the change since the start of the recording, s.
        time_s: f64,
        /// Time from the change to the end of the recording, s.
        before_end_s: f64,
    },
    /// Rest phase at the end of the recording, in which stiction can hide a slip.
    AtRestAtEnd {
        /// Name of the joint with the largest slip that can be hidden.
        joint: String,
        /// Start of the rest phase since the start of the recording, s.
        from_s: f64,
        /// Largest slip that stiction can hide, rad.
        stiction_bound_rad: f64,
    },
    /// Mean residual of a joint in the final rest phase that exceeds what stiction explains: a slip, or a lasting
    /// contact.
    RestPhaseInconsistent {
        /// Name of the joint.
        joint: String,
        /// Start of the rest phase since the start of the recording, s.
        from_s: f64,
        /// Mean residual in the rest phase relative to the estimated offset, rad.
        inconsistency_rad: f64,
        /// Largest slip that stiction can hide, rad.
        stiction_bound_rad: f64,
    },
    /// Viscoelastic rope whose load before the recording is unknown; the interval is widened for it.
    RopeMemory {
        /// Name of the joint.
        joint: String,
        /// Half-width of the 95 % interval for the unknown load history, rad.
        half_width_95_rad: f64,
    },
    /// Offset that drifted at a constant rate during the recording; the value at the end is reported.
    TendonCreep {
        /// Name of the joint.
        joint: String,
        /// Probability of the drift, 0 to 1.
        probability: f64,
        /// Change of the offset from the start to the end of the recording, rad.
        drift_rad: Gaussian,
        /// Duration of the recording, s.
        duration_s: f64,
    },
    /// Constant external force at the tool, which is estimated jointly.
    ExternalForce {
        /// Probability of the external force, 0 to 1.
        probability: f64,
        /// Components of the force along the axes of the base frame if there is one, N.
        force_n: [Gaussian; 3],
    },
    /// Large residual that the model does not explain; the interval is widened for it.
    UnexplainedResidual {
        /// Name of the joint.
        joint: String,
        /// Robust standard deviation of the residual, rad.
        noise_rad: f64,
    },
    /// Joint without a recorded position: the motor position is used instead, and the tendon is not estimated.
    NoJointEncoder {
        /// Name of the joint.
        joint: String,
    },
    /// Loop whose load exceeded twice its pretension, so that one of its strands was slack and its stiffness was
    /// halved.
    BeyondPretension {
        /// Name of the tendon.
        joint: String,
        /// Largest magnitude of the torque of the loop, N·m.
        torque_nm: f64,
        /// Torque up to which both strands remain taut, `2 r f0`, N·m.
        limit_nm: f64,
    },
    /// Joint that hardly moved while its motor turned: the joint or its encoder is seized. A phase of a constant reading in which
    /// the motor travels farther than the effort limit bends the spring is excluded.
    JointSeized {
        /// Name of the joint.
        joint: String,
        /// Start of the phase since the start of the recording, s.
        from_s: f64,
        /// Range of the joint position, rad.
        joint_travel_rad: f64,
        /// Range of the motor position, rad.
        motor_travel_rad: f64,
    },
    /// Joint positions beyond the limits of the URDF: wrong sign, zero, unit or joint.
    BeyondLimits {
        /// Name of the joint.
        joint: String,
        /// Smallest position, rad.
        min_rad: f64,
        /// Largest position, rad.
        max_rad: f64,
        /// Lower limit, rad.
        lower_rad: f64,
        /// Upper limit, rad.
        upper_rad: f64,
        /// Whether the positions with the opposite sign are within the limits.
        opposite_is_within: bool,
    },
    /// Motor position that is constant from a time on while its joint travels farther than the effort limit bends the spring:
    /// the motor encoder or its channel is frozen. The phase is excluded.
    MotorEncoderFrozen {
        /// Name of the joint.
        joint: String,
        /// Start of the phase since the start of the recording, s.
        from_s: f64,
        /// Constant motor position, rad.
        motor_rad: f64,
        /// Range of the joint position in the phase, rad.
        joint_travel_rad: f64,
    },
    /// Negative payload estimate: the tool is lighter than described, or units or signs are wrong.
    NegativePayload {
        /// Estimated payload mass, kg.
        payload_kg: Gaussian,
    },
    /// Specified payload that is inconsistent with the recording; the estimated payload is used instead.
    PayloadInconsistent {
        /// Estimated payload mass, kg.
        payload_kg: Gaussian,
        /// Probability that the specified payload is wrong, 0 to 1; prior odds of 1 to 20.
        probability: f64,
    },
    /// Specified external force that is inconsistent with the recording; the estimated force is used instead.
    ExternalForceInconsistent {
        /// Components of the estimated force along the axes of the base frame, N; `None` if no force was detected.
        force_n: Option<[Gaussian; 3]>,
    },
    /// Long interval that is inconsistent with the model and was rejected.
    UnmodelledInterval {
        /// Start of the interval since the start of the recording, s.
        from_s: f64,
        /// End of the interval since the start of the recording, s.
        to_s: f64,
    },
    /// Large share of the time that was rejected as contact or disturbance.
    MuchRejected {
        /// Rejected share of the time, 0 to 1.
        share: f64,
    },
    /// Encoder zero offset of a baseline that is inconsistent with robot.toml; it was estimated instead.
    EncoderZeroOffset {
        /// Name of the joint.
        joint: String,
        /// Estimated value of `theta − q` of the unloaded spring directly after tensioning, rad.
        zero_rad: Gaussian,
    },
    /// Estimate without a baseline: offsets refer to the encoder zero, and the interval depends on data-sheet
    /// tolerances.
    NoBaseline,
    /// Temperature that was not recorded: its change since the baseline is assumed to be within the tolerance.
    TemperatureUnknown {
        /// Standard deviation of the temperature change since the baseline, K.
        std_k: f64,
        /// Name of the joint whose interval is widened most.
        joint: String,
        /// Half-width of the 95 % interval of the thermal effect, rad.
        half_width_95_rad: f64,
    },
    /// Temperature difference from the baseline whose unknown effect contributes most of the variance of an offset.
    ThermalEffect {
        /// Name of the joint with the largest unknown thermal effect.
        joint: String,
        /// Temperature of the recording minus that of the baseline, K.
        temperature_difference_k: f64,
        /// Half-width of the 95 % interval of the thermal effect, rad.
        half_width_95_rad: f64,
        /// Whether robot.toml specifies the thermal expansion of the frame.
        frame_is_specified: bool,
    },
    /// Offset by contact with an end stop that is inconsistent with the offset by motion.
    ReferenceInconsistent {
        /// Name of the joint.
        joint: String,
        /// Offset by the contact with the end stop, rad.
        by_push_rad: Gaussian,
        /// Offset by motion, corrected for the encoder errors, rad.
        by_motion_rad: Gaussian,
    },
    /// Time offset between motor and joint encoder, which is estimated jointly.
    EncoderDelay {
        /// Delay of the motor encoder relative to the joint encoder, s; negative if the motor encoder leads.
        motor_delay_s: Gaussian,
    },
    /// Motor torque of a joint that is inconsistent with its spring torque and was rejected.
    MotorTorqueRejected {
        /// Name of the joint.
        joint: String,
        /// Reason for the rejection.
        fault: MotorTorqueError,
    },
    /// Tension of a tendon that is inconsistent with its extension and was rejected.
    TensionRejected {
        /// Name of the tendon.
        joint: String,
        /// Reason for the rejection.
        fault: MotorTorqueError,
    },
    /// Tendon with friction along its path whose elongation the baseline does not determine under the conditions of this
    /// recording.
    CableInconclusive {
        /// Name of the joint.
        joint: String,
        /// Condition that is missing.
        reason: CableLimit,
    },
    /// Posterior mean of a parameter that is far from its prior: wrong value or too narrow tolerance in robot.toml.
    FarFromPrior {
        /// Name of the joint or body; `None` for the payload.
        joint: Option<String>,
        /// Name of the parameter.
        name: String,
        /// Whether the parameter is the scale of the motor torque, which does not depend on robot.toml alone.
        is_motor_torque_scale: bool,
        /// Distance from the prior mean, in prior standard deviations.
        stds: f64,
    },
    /// Frames that were excluded because a position is missing.
    FramesIncomplete {
        /// Number of excluded frames.
        frames: u64,
    },
    /// Probable stiffness change between the baseline or previous session and this recording.
    StiffnessChanged {
        /// Name of the joint.
        joint: String,
        /// Probability of the change, 0 to 1.
        probability: f64,
        /// Relative change of the stiffness if there is one; negative for a loss.
        change_ratio: Gaussian,
    },
    /// Specified date that differs by more than a day from the clock of the recording; the specified date is used.
    DateInconsistent {
        /// Start of the evaluated interval by the clock of the recording, s since 1970 UTC.
        recorded_utc_s: f64,
        /// Specified date, s since 1970 UTC.
        specified_utc_s: f64,
    },
}

impl Warning {
    /// Name of the joint or tendon that the warning concerns; `None` for a warning about the robot or the recording.
    pub fn joint(&self) -> Option<&str> {
        match self {
            Self::TorqueRangeSmall { joint, .. }
            | Self::ChangeNearEnd { joint, .. }
            | Self::AtRestAtEnd { joint, .. }
            | Self::RestPhaseInconsistent { joint, .. }
            | Self::RopeMemory { joint, .. }
            | Self::TendonCreep { joint, .. }
            | Self::UnexplainedResidual { joint, .. }
            | Self::NoJointEncoder { joint, .. }
            | Self::BeyondPretension { joint, .. }
            | Self::JointSeized { joint, .. }
            | Self::BeyondLimits { joint, .. }
            | Self::MotorEncoderFrozen { joint, .. }
            | Self::EncoderZeroOffset { joint, .. }
            | Self::TemperatureUnknown { joint, .. }
            | Self::ThermalEffect { joint, .. }
            | Self::ReferenceInconsistent { joint, .. }
            | Self::MotorTorqueRejected { joint, .. }
            | Self::TensionRejected { joint, .. }
            | Self::CableInconclusive { joint, .. }
            | Self::StiffnessChanged { joint, .. } => Some(joint),
            Self::FarFromPrior { joint, .. } => joint.as_deref(),
            _ => None,
        }
    }
}
