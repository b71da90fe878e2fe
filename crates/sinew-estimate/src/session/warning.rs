//! What the reader of a session's estimate should know, as data; the words are the report's.

use super::torque_range::TorqueRange;
use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;

/// Why a motor torque can't be a witness.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum WitnessFault {
    /// It never changes.
    Constant,
    /// It doesn't follow the torque of the spring.
    Contradicts {
        /// What it shows of the spring's torque; 1 is right.
        slope: f64,
    },
    /// Another joint's contradicts, and this one's can't be tested.
    Untested,
}

/// What the reader of a session's estimate should know.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Warning {
    /// Too few distinct poses to tell a payload or a wrong mass from stretch.
    FewPoses {
        /// Distinct poses.
        poses: usize,
    },
    /// Too few distinct poses for a baseline.
    FewPosesOfBaseline {
        /// Distinct poses.
        poses: usize,
    },
    /// A joint's torque hardly changed: stretch can't be told from a wrong stiffness.
    TorqueHardlyChanged {
        /// Joint.
        joint: String,
        /// What it carried, N·m.
        torque_nm: TorqueRange,
    },
    /// A change came so late that it may be a contact.
    ChangeMayEnd {
        /// Joint.
        joint: String,
        /// When, s.
        time_s: f64,
        /// So long before the end, s.
        before_end_s: f64,
    },
    /// The arm stands at the end of the recording: friction may hide a slip there.
    StandsAtEnd {
        /// Joint of which it may hide most.
        joint: String,
        /// Since when, s.
        from_s: f64,
        /// The largest slip that friction may hold, rad.
        hidden_rad: f64,
    },
    /// A joint reads off where the arm stands at the end, by more than friction can hold: a slip, or a contact that lasts.
    StandReadsOff {
        /// Joint.
        joint: String,
        /// Since when the arm stands, s.
        from_s: f64,
        /// By how much it reads off, rad.
        off_rad: f64,
        /// The largest slip that friction may hold, rad.
        hidden_rad: f64,
    },
    /// A rope follows its load slowly, and what it carried before isn't known.
    RopeCreeps {
        /// Joint.
        joint: String,
        /// Half of the 95 % interval for that, rad.
        half_width_95_rad: f64,
    },
    /// An offset moved evenly while it was looked at.
    TendonCreeps {
        /// Joint.
        joint: String,
        /// Probability that it did.
        probability: f64,
        /// By how much, rad.
        moved_rad: Gaussian,
        /// In how long, s.
        duration_s: f64,
    },
    /// A constant force from outside acts on the arm.
    ExternalForce {
        /// Probability that it does.
        probability: f64,
        /// Along the axes of the base, N, if it does.
        force_n: [Gaussian; 3],
    },
    /// Much of the reading fits nothing.
    Unexplained {
        /// Joint.
        joint: String,
        /// Robust standard deviation, rad.
        noise_rad: f64,
    },
    /// The position of a joint is not recorded: its motor's stands in, and its tendon is not estimated.
    NoJointEncoder {
        /// Joint.
        joint: String,
    },
    /// A loop carried more than twice its pretension, so that one of its strands was slack and the loop half as stiff.
    BeyondPretension {
        /// Tendon.
        joint: String,
        /// Largest size of the torque that the loop carried, N·m.
        torque_nm: f64,
        /// Torque up to which both strands stay taut, `2 r f0`, N·m.
        limit_nm: f64,
    },
    /// A joint hardly moved while its motor turned.
    Stuck {
        /// Joint.
        joint: String,
        /// Travel of the joint, rad.
        joint_travel_rad: f64,
        /// Travel of the motor, rad.
        motor_travel_rad: f64,
    },
    /// The payload weighs less than nothing.
    NegativePayload {
        /// Payload, kg.
        payload_kg: Gaussian,
    },
    /// The recording contradicts the payload that was stated; it was estimated instead.
    PayloadContradicted {
        /// Payload as estimated, kg.
        payload_kg: Gaussian,
    },
    /// The recording contradicts the constant force that was stated; what it shows was used instead.
    ExternalForceContradicted {
        /// Along the axes of the base, N; `None` where it shows no force.
        force_n: Option<[Gaussian; 3]>,
    },
    /// A long time in which nothing fits.
    NothingFits {
        /// From, s.
        from_s: f64,
        /// To, s.
        to_s: f64,
    },
    /// Much of the time was left out.
    MuchLeftOut {
        /// Share, 0 to 1.
        share: f64,
    },
    /// A baseline's encoders were not zeroed as robot.toml states; the zero was estimated instead.
    NotZeroed {
        /// Joint.
        joint: String,
        /// What `theta − q` of the unloaded spring reads right after tensioning, rad.
        zero_rad: Gaussian,
    },
    /// There is no baseline: offsets are against the encoders' zero.
    NoBaseline,
    /// The temperature is not known as well as a recorded one.
    TemperatureUnknown {
        /// Standard deviation of its change since the baseline, K.
        deviation_k: f64,
        /// Joint whose interval that widens most.
        joint: String,
        /// Half of the 95 % interval for that, rad.
        half_width_95_rad: f64,
    },
    /// The temperature differs from the baseline's, and what that does to an offset is most of its interval.
    DriftUnknown {
        /// Joint of which it leaves most unknown.
        joint: String,
        /// Warmer than the baseline, K.
        warmer_k: f64,
        /// Half of the 95 % interval for that, rad.
        half_width_95_rad: f64,
        /// Whether robot.toml states the frame's expansion.
        frame_is_stated: bool,
    },
    /// A push against an end stop shows another offset than motion does.
    AnchorDisagrees {
        /// Joint.
        joint: String,
        /// By the push, rad.
        by_push_rad: Gaussian,
        /// By motion, corrected for the encoders, rad.
        by_motion_rad: Gaussian,
    },
    /// One side is stamped late against the other.
    SidesOutOfStep {
        /// How late the motor side is, s; below 0 it is early.
        motor_late_s: Gaussian,
    },
    /// A joint's motor torque can't be one, and was left out.
    MotorTorqueLeftOut {
        /// Joint.
        joint: String,
        /// Why.
        fault: WitnessFault,
    },
    /// A parameter is far from what was believed.
    FarFromPrior {
        /// Joint or body; `None` for the payload.
        joint: Option<String>,
        /// Parameter.
        name: String,
        /// Whether it is the scale of the motor torque, which is no matter of robot.toml alone.
        is_motor_torque_scale: bool,
        /// How far, standard deviations of what was believed.
        deviations: f64,
    },
    /// Frames without every position were left out.
    FramesMissing {
        /// How many.
        frames: u64,
    },
    /// Stiffness has, or may have, changed before the recording began.
    StiffnessChangedBefore {
        /// Joint.
        joint: String,
        /// Probability that it has.
        probability: f64,
        /// By how much if it has.
        change_ratio: Gaussian,
    },
}
