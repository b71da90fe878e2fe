//! Warnings about a recording and its estimate, as data; `sinew-report` formats them.

use serde::{Deserialize, Serialize};
use sinew_log::StreamRole;

/// Warning about a recording or its estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum RecordingWarning {
    /// Warning about robot.toml or the URDF.
    Robot {
        /// Text of the warning.
        text: String,
    },
    /// Implausible signal of the recording.
    ImplausibleSignal {
        /// Text of the warning.
        text: String,
    },
    /// Joints of the recording that the robot does not have.
    UnknownJoints {
        /// Names of the joints.
        joints: Vec<String>,
    },
    /// Tendons whose tension is recorded, though no estimate of this robot uses it.
    UnusedTensions {
        /// Names of the tendons.
        tendons: Vec<String>,
    },
    /// Offset that is implausibly large for a rope.
    ImplausibleOffset {
        /// Name of the joint.
        joint: String,
        /// Estimated offset, rad.
        offset_rad: f64,
    },
    /// Torque range of a joint that is too small to separate the offset from a stiffness or mass error.
    TorqueRangeSmall {
        /// Name of the joint.
        joint: String,
        /// Smallest torque, N·m.
        min_nm: f64,
        /// Largest torque, N·m.
        max_nm: f64,
    },
    /// Damaged part of the file.
    Damaged {
        /// Position in the file, bytes from the start.
        offset: u64,
        /// Reason of the damage.
        reason: String,
        /// Number of bytes lost.
        bytes: u64,
    },
    /// Gaps in the recording.
    Gaps {
        /// Number of gaps.
        count: u64,
        /// Length of the longest gap, s.
        longest_s: f64,
    },
    /// Steps of the clock of the time stamps, over which the time of the recording continues.
    ClockJumps {
        /// Number of steps, back or ahead.
        count: u64,
    },
    /// Messages that were reordered by time stamp.
    OutOfOrder {
        /// Number of messages.
        count: u64,
    },
    /// Samples of a stream that are missing, or were excluded because of a duplicate time stamp.
    SamplesLost {
        /// Role of the stream.
        stream: StreamRole,
        /// Number of missing samples, derived from the time steps of the others.
        missing: u64,
        /// Number of excluded samples with a duplicate time stamp.
        repeated: u64,
        /// Share of all samples, 0 to 1.
        share: f64,
    },
    /// Samples of a second publisher on the topic of a stream, which were excluded.
    SecondPublisher {
        /// Role of the stream.
        stream: StreamRole,
        /// Number of excluded samples.
        samples: u64,
    },
    /// Position that is recorded from a later time on than the recording starts.
    LateStart {
        /// Symbol of the quantity.
        quantity: String,
        /// Name of the joint or motor.
        joint: String,
        /// Time of its first sample since the start of the recording, s.
        after_s: f64,
    },
    /// Messages without a time stamp in a topic with time stamps.
    NoTimeStamp {
        /// Number of messages.
        count: u64,
    },
    /// Samples that are NaN or infinite.
    NonFinite {
        /// Symbol of the quantity.
        quantity: String,
        /// Name of the joint.
        joint: String,
        /// Number of samples.
        count: u64,
    },
    /// Encoder wrap-arounds that were corrected.
    Unwrapped {
        /// Symbol of the quantity.
        quantity: String,
        /// Name of the joint.
        joint: String,
        /// Number of wrap-arounds.
        count: u64,
    },
    /// Warning about the reference recording.
    Reference {
        /// Warning of the reference recording.
        warning: Box<RecordingWarning>,
    },
}
