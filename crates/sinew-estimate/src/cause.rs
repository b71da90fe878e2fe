//! What made an offset change: rope or encoder.

use serde::{Deserialize, Serialize};

/// What made an offset change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// The motor's reading jumped between two samples, the joint's did not.
    MotorEncoder,
    /// The joint's reading jumped between two samples, the motor's did not.
    JointEncoder,
    /// Neither jumped: motor or joint moved, as a rope lets them.
    Rope,
    /// The recording doesn't tell, and why not.
    Unknown(UnknownCause),
}

/// Why a cause can't be told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum UnknownCause {
    /// Samples are missing around the change.
    Missing,
    /// The change is not large against noise and quantisation.
    Noise,
    /// Between two samples the arm itself could have moved as far.
    Rate,
    /// Both readings jumped.
    Both,
}

impl Cause {
    /// Whether an encoder's reading jumped: no contact looks like that, nor a rope.
    pub fn is_encoder(self) -> bool {
        matches!(self, Self::MotorEncoder | Self::JointEncoder)
    }
}
