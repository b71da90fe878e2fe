//! Routing of a rope in the machine, and the request of a prediction.

use super::duty::Duty;
use super::endurance::RopeTermination;
use crate::law::RopeLoad;
use crate::law::routing::Pulley;
use sinew_model::transmission::Guide as TendonGuide;

/// Routing of a rope in the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    /// Length of the strand, m.
    pub length_m: f64,
    /// Stroke of the drive, m.
    pub stroke_m: f64,
    /// Guiding pulleys in order from the drive.
    pub pulleys: Vec<Pulley>,
    /// Strokes per hour, back and forth counted as one; 0 if bending is not considered.
    pub strokes_per_hour: f64,
    /// Termination of the rope.
    pub termination: RopeTermination,
    /// Factor by which abrasion accelerates bending fatigue; 1: none beyond that in the bending tests.
    pub abrasion_factor: f64,
}

impl Route {
    /// A strand without guiding pulleys.
    pub fn straight(length_m: f64) -> Self {
        Self {
            length_m,
            stroke_m: 0.0,
            pulleys: Vec::new(),
            strokes_per_hour: 0.0,
            termination: RopeTermination::NotSpecified,
            abrasion_factor: 1.0,
        }
    }

    /// Places guiding pulleys along the strand; those without a position are spaced evenly.
    #[must_use]
    pub fn guided(mut self, guides: &[Guide]) -> Self {
        let place = |(i, guide): (usize, &Guide)| Pulley {
            at_m: guide
                .at_m
                .unwrap_or(self.length_m * (i + 1) as f64 / (guides.len() + 1) as f64),
            radius_m: guide.radius_m,
            wrap_rad: guide.wrap_rad,
            friction: guide.friction,
        };
        self.pulleys = guides.iter().enumerate().map(place).collect();
        self
    }
}

/// Guiding pulley with an optional position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guide {
    /// Wrap angle of the rope, rad.
    pub wrap_rad: f64,
    /// Radius of the pulley, m.
    pub radius_m: f64,
    /// Coefficient of friction; `None`: that of the rope.
    pub friction: Option<f64>,
    /// Point of first contact, m from the drive.
    pub at_m: Option<f64>,
}

impl From<&TendonGuide> for Guide {
    /// Converts a guide of a robot; a friction of 0 is unspecified.
    fn from(guide: &TendonGuide) -> Self {
        Self {
            wrap_rad: guide.wrap_rad,
            radius_m: guide.radius_m,
            friction: (guide.friction > 0.0).then_some(guide.friction),
            at_m: None,
        }
    }
}

/// Request of a prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Tension and temperature over time.
    pub duty: Duty,
    /// Routing of the rope.
    pub route: Route,
    /// Times of the predicted elongations, s, ascending.
    pub times_s: Vec<f64>,
    /// Load that the elongations refer to; `None`: the means of the duty.
    pub read_at: Option<RopeLoad>,
    /// Number of draws for the intervals.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}
