//! Range of the torque at a joint.

use serde::{Deserialize, Serialize};

/// Minimum and maximum torque in a recording, N·m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueRange {
    /// Minimum torque, N·m.
    pub min: f64,
    /// Maximum torque, N·m.
    pub max: f64,
}
