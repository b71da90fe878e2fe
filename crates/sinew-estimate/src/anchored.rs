//! What a stop or a mark that was touched said, and did to a tendon's estimate.

use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_model::transmission::AnchorKind;

/// What one anchor said in one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AnchorReading {
    /// Joint.
    pub joint: String,
    /// What it is.
    pub kind: AnchorKind,
    /// Where it is, rad (m for a joint that slides).
    pub position_rad: f64,
    /// When it was touched, s since the recording began.
    pub time_s: f64,
    /// Error of the encoder it is read by: the joint's at a stop or joint mark, the motor's at a motor mark, rad.
    pub encoder_error_rad: Gaussian,
    /// Offset of the tendon by the push alone, rad; `None` without a push or without the motor's torque.
    pub offset_rad: Option<Gaussian>,
}

/// What anchors did to one tendon's estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AnchoredOffset {
    /// What was touched, in the order of time.
    pub readings: Vec<AnchorReading>,
    /// Whether the baseline had touched the same, so that what follows is a difference.
    pub since_baseline: bool,
    /// What the encoders were off by, and the offset has been corrected for, rad.
    pub correction_rad: Gaussian,
    /// Offset as motion alone shows it, rad.
    pub by_motion_rad: Gaussian,
    /// Offset as pushes alone show it, rad.
    pub by_push_rad: Option<Gaussian>,
}

impl AnchorReading {
    /// Whether both are of one anchor.
    pub(crate) fn is_of(&self, other: &Self) -> bool {
        self.joint == other.joint
            && self.kind == other.kind
            && self.position_rad == other.position_rad
    }
}
