//! Errors of a prediction.

use super::CatalogueError;
use super::endurance::RopeTermination;
use super::life::BreakCause;
use super::times::{DAY_S, HOUR_S, YEAR_S};
use crate::law::LoadError;
use crate::law::routing::RoutingError;

/// Reason why a rope has no prediction.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PredictError {
    /// Invalid catalogue, rope or entry.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// Invalid routing of the rope.
    #[error(transparent)]
    Routing(#[from] RoutingError),
    /// Invalid load, at the catalogue values.
    #[error("rope '{rope}': {error}")]
    Load {
        /// Name of the rope.
        rope: String,
        /// Cause of the error.
        error: LoadError,
    },
    /// Temperature above the melting point of the fibre.
    #[error("rope '{rope}': {temperature_c} °C is too high; its fibre melts at {melts_c} °C")]
    Melts {
        /// Name of the rope.
        rope: String,
        /// Highest temperature of the duty, °C.
        temperature_c: f64,
        /// Melting temperature of the fibre, °C.
        melts_c: f64,
    },
    /// Break of the rope before the first elongation.
    #[error(
        "rope '{rope}': at {tension_n:.0} N it breaks by {} within {}; no elongation is predicted",
        match cause {
            BreakCause::CreepRupture => "creep rupture",
            BreakCause::BendingFatigue => "bending fatigue",
        },
        rounded(*time_s)
    )]
    BreaksEarly {
        /// Name of the rope.
        rope: String,
        /// Largest tension of the duty, with friction on the guides, N.
        tension_n: f64,
        /// Cause of the break.
        cause: BreakCause,
        /// Time of the break, s.
        time_s: f64,
    },
    /// Break of the rope before the end of the planning horizon.
    #[error(
        "rope '{rope}': at {tension_n} N it breaks by creep rupture after about {}, and --horizon is {}; reduce the tension, select a stronger rope or shorten the horizon",
        rounded(*life_s), rounded(*horizon_s)
    )]
    BreaksBefore {
        /// Name of the rope.
        rope: String,
        /// Working tension, N.
        tension_n: f64,
        /// Time of the break, s.
        life_s: f64,
        /// Horizon of the plan, s.
        horizon_s: f64,
    },
    /// Load above the strength that heat, pulleys and terminations leave.
    #[error(
        "rope '{rope}': {tension_n:.0} N exceeds its strength of {strength_n:.0} N at {temperature_c:.0} °C{}",
        match termination {
            _ if *is_bent => " and over its pulleys",
            RopeTermination::NotSpecified => "",
            RopeTermination::Spliced => " and spliced",
            RopeTermination::Knotted => " and knotted",
        }
    )]
    TooWeak {
        /// Name of the rope.
        rope: String,
        /// Largest tension of the duty, N.
        tension_n: f64,
        /// Lowest strength along the rope, N.
        strength_n: f64,
        /// Highest temperature of the duty, °C.
        temperature_c: f64,
        /// Termination of the rope.
        termination: RopeTermination,
        /// Whether a pulley reduces the strength more than the terminations.
        is_bent: bool,
    },
    /// Torque that slackens the second rope before the re-tensioning.
    #[error(
        "the joint's torque slackens the second rope once their mean tension is {slack_n:.1} N; --lowest is {lowest_n:.1} N and must be above that, and --tension above --lowest"
    )]
    Slack {
        /// Lowest tension allowed, N.
        lowest_n: f64,
        /// Mean tension at which the partner is slack, N.
        slack_n: f64,
    },
    /// Stroke as long as the strand, or longer.
    #[error(
        "a stroke of {} mm is not shorter than the strand of {} mm; reduce the stroke",
        millimetres(*stroke_m), millimetres(*length_m)
    )]
    Stroke {
        /// Stroke of the drive, m.
        stroke_m: f64,
        /// Length of the strand, m.
        length_m: f64,
    },
}

/// Millimetres without the rounding error of the factor 1000.
fn millimetres(m: f64) -> f64 {
    (1e9 * m).round() / 1e6
}

/// Formats a time in a suitable unit.
fn rounded(time_s: f64) -> String {
    match time_s {
        t if t < 60.0 => "a minute".into(),
        t if t > 2.0 * YEAR_S => format!("{:.0} years", t / YEAR_S),
        t if t < 2.0 * HOUR_S => format!("{:.0} min", t / 60.0),
        t if t < 2.0 * DAY_S => format!("{:.0} h", t / HOUR_S),
        t => format!("{:.0} days", t / DAY_S),
    }
}
