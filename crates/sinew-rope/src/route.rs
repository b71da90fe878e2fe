//! How a rope lies in the machine, and what is asked of a prediction.

use super::duty::Duty;
use sinew_model::rope::RopeLoad;
use sinew_model::rope::routing::Pulley;

/// How a rope lies in the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    /// Length of the strand, m.
    pub length_m: f64,
    /// How far the drive moves the rope back and forth, m.
    pub stroke_m: f64,
    /// Guiding pulleys.
    pub pulleys: Vec<Pulley>,
    /// Strokes per hour, back and forth counting as one; 0 where bending is not asked for.
    pub strokes_per_hour: f64,
}

impl Route {
    /// A strand without guiding pulleys.
    pub fn straight(length_m: f64) -> Self {
        Self {
            length_m,
            stroke_m: 0.0,
            pulleys: Vec::new(),
            strokes_per_hour: 0.0,
        }
    }
}

/// What is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The duty.
    pub duty: Duty,
    /// The route.
    pub route: Route,
    /// Times to read at, s, rising.
    pub times_s: Vec<f64>,
    /// Load the readings refer to; `None` takes the duty's means.
    pub read_at: Option<RopeLoad>,
    /// Draws for the intervals.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}
