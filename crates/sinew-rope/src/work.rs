//! Load of a strand of a tendon in a working robot.

use crate::law::routing::{Pulley, RopeSection, touched};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use sinew_model::transmission::Tendon;

/// Load of a strand in a working robot, averaged over days.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// Mean tension over pretension.
    pub mean_factor: f64,
    /// Highest tension of a day over pretension.
    pub peak_factor: f64,
    /// Share of the time that it is near its highest.
    pub peak_share: f64,
    /// Mean temperature, °C.
    pub temperature_c: f64,
}

impl Work {
    /// Draws a load of unknown peaks: peaks of 1.5 to 4 times the pretension for a second to three quarters
    /// of an hour per day.
    pub fn unknown(temperature_c: f64, rng: &mut ChaCha8Rng) -> Self {
        let mut between = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
        Self {
            mean_factor: between(1.0, 1.3),
            peak_factor: between(1.5, 4.0),
            peak_share: 10.0_f64.powf(between(-5.0, -1.5)),
            temperature_c: temperature_c + between(-3.0, 3.0),
        }
    }
}

/// Sections of the strand between motor and joint: guiding pulleys are spaced evenly, the stroke is a quarter
/// turn of the joint.
pub fn strand(tendon: &Tendon) -> Vec<RopeSection> {
    let n = tendon.guides.len() as f64;
    let pulleys: Vec<Pulley> = tendon
        .guides
        .iter()
        .enumerate()
        .map(|(i, g)| Pulley {
            at_m: tendon.length_m * (i as f64 + 1.0) / (n + 1.0),
            radius_m: g.radius_m,
            wrap_rad: g.wrap_rad,
            friction: (g.friction > 0.0).then_some(g.friction),
        })
        .collect();
    let stroke_m = std::f64::consts::FRAC_PI_2 * tendon.joint_pulley_radius_m;
    touched(tendon.length_m, stroke_m.min(tendon.length_m), &pulleys).unwrap_or_else(|_| {
        // Pulleys that do not fit on the strand are ignored.
        vec![RopeSection {
            length_m: tendon.length_m,
            middle_m: 0.5 * tendon.length_m,
            guides: 0,
            passes: 0.0,
        }]
    })
}
