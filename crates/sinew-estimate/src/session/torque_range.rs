//! Torques a joint carried.

use serde::{Deserialize, Serialize};

/// Smallest and largest torque, N·m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueRange {
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}
