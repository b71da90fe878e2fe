//! What the reader of a recording's estimate should know, as data; the words are the report's.

use serde::{Deserialize, Serialize};
use sinew_log::StreamRole;

/// What the reader of a recording's estimate should know.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum RecordingWarning {
    /// What robot.toml or the URDF are warned of.
    Robot {
        /// In words.
        text: String,
    },
    /// What looks wrong in the recording's signals.
    Suspicion {
        /// In words.
        text: String,
    },
    /// Joints of the recording that the robot doesn't have.
    UnknownJoints {
        /// Their names.
        joints: Vec<String>,
    },
    /// An offset no rope stretches by.
    ImplausibleOffset {
        /// Joint.
        joint: String,
        /// Offset, rad.
        offset_rad: f64,
    },
    /// A joint's torque hardly changes: a wrong stiffness can't be told from stretch.
    TorqueHardlyChanges {
        /// Joint.
        joint: String,
        /// Smallest torque, N·m.
        min_nm: f64,
        /// Largest torque, N·m.
        max_nm: f64,
    },
    /// A part of the file is damaged.
    Damaged {
        /// Where, bytes from the start.
        offset: u64,
        /// Why.
        reason: String,
        /// Bytes lost.
        bytes: u64,
    },
    /// Pauses in the recording.
    Gaps {
        /// How many.
        count: u64,
        /// The longest, s.
        longest_s: f64,
    },
    /// The clock went back.
    ClockJumps {
        /// How often.
        count: u64,
    },
    /// Messages that came out of order.
    OutOfOrder {
        /// How many.
        count: u64,
    },
    /// Samples of a stream that are missing, or were dropped because their stamp was there already.
    SamplesLost {
        /// What the stream brings.
        stream: StreamRole,
        /// Missing, as far as the steps between the others tell.
        missing: u64,
        /// Dropped.
        repeated: u64,
        /// Part of all samples, 0 to 1.
        share: f64,
    },
    /// Samples that are NaN or infinite.
    NonFinite {
        /// Symbol of the quantity.
        quantity: String,
        /// Joint.
        joint: String,
        /// How many.
        count: u64,
    },
    /// Encoder wrap-arounds that were removed.
    Unwrapped {
        /// Symbol of the quantity.
        quantity: String,
        /// Joint.
        joint: String,
        /// How many.
        count: u64,
    },
    /// One of the reference recording.
    Reference {
        /// Which.
        warning: Box<RecordingWarning>,
    },
}
