//! What is asked of a plan, and a way to bed a rope in.

use serde::{Deserialize, Serialize};
use sinew_model::Bounded;

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Working tension, N.
    pub tension_n: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Strand length, m.
    pub length_m: f64,
    /// How long it must hold, s.
    pub horizon_s: f64,
    /// Tension below which the rope is tensioned again, N.
    pub lowest_n: f64,
    /// Share of the later elongation that the procedure must take away, 0 to 1.
    pub remove: f64,
    /// Draws for the intervals.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// A bedding-in procedure and what it does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Procedure {
    /// Held at this tension, N.
    pub tension_n: f64,
    /// For this long, s.
    pub duration_s: f64,
    /// Largest elongation at working tension that is still to come, m, counted from a minute
    /// after the rope is back at working tension.
    pub still_to_come_m: Bounded,
    /// Share of the elongation without procedure that it takes away.
    pub removed_share: Bounded,
}
