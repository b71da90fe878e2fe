//! How a rope lies in the machine, and what is asked of a prediction.

use super::duty::Duty;
use super::endurance::Ends;
use crate::law::RopeLoad;
use crate::law::routing::Pulley;
use sinew_model::transmission::Guide as TendonGuide;

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
    /// How the rope's ends are held.
    pub ends: Ends,
    /// Factor by which abrasion speeds up the wear of bending; 1: none beyond the tests behind it.
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
            ends: Ends::NotStated,
            abrasion_factor: 1.0,
        }
    }

    /// Puts guiding pulleys along the strand; one that doesn't say where stands evenly among all.
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

/// A guiding pulley that may not say where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guide {
    /// Angle that the rope lies on it, rad.
    pub wrap_rad: f64,
    /// Radius, m.
    pub radius_m: f64,
    /// Coefficient of friction; `None`: the rope's.
    pub friction: Option<f64>,
    /// Where the rope meets it, from the drive, m.
    pub at_m: Option<f64>,
}

impl From<&TendonGuide> for Guide {
    /// A robot's guide; friction 0 is not stated.
    fn from(guide: &TendonGuide) -> Self {
        Self {
            wrap_rad: guide.wrap_rad,
            radius_m: guide.radius_m,
            friction: (guide.friction > 0.0).then_some(guide.friction),
            at_m: None,
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
