//! Cause of an offset change: rope or encoder.

use serde::{Deserialize, Serialize};

/// Cause of an offset change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Encoder slip at the motor: its position stepped between two samples, that of the joint did not.
    MotorEncoder,
    /// Encoder slip at the joint: its position stepped between two samples, that of the motor did not.
    JointEncoder,
    /// Rope: neither position stepped between two samples; motor or joint moved with finite acceleration.
    Rope,
    /// Ambiguous cause, with the reason.
    Unknown(UnknownCause),
}

/// Reason why the cause is ambiguous.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum UnknownCause {
    /// Samples are missing around the change.
    Missing,
    /// The change is not large compared with noise and quantisation.
    Noise,
    /// The sampling rate is too low: the arm itself could have moved by the change between two samples.
    Rate,
    /// Both positions stepped between two samples.
    Both,
}

impl Cause {
    /// Whether an encoder slipped, which neither a contact nor a rope can imitate.
    pub fn is_encoder(self) -> bool {
        matches!(self, Self::MotorEncoder | Self::JointEncoder)
    }
}
