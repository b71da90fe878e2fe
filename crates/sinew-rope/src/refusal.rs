//! Why there is no prediction.

use super::CatalogueError;
use super::endurance::Ends;
use super::life::BreakCause;
use super::times::{DAY_S, HOUR_S, YEAR_S};
use crate::law::LoadError;
use crate::law::routing::RoutingError;

/// Why there is no prediction.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PredictError {
    /// The rope.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The routing.
    #[error(transparent)]
    Routing(#[from] RoutingError),
    /// The load, with the catalogue's own values.
    #[error("rope '{rope}': {error}")]
    Load {
        /// Rope.
        rope: String,
        /// Why.
        error: LoadError,
    },
    /// The fibre melts.
    #[error(
        "rope '{rope}': at {temperature_c} °C there is no rope; its fibre melts at {melts_c} °C"
    )]
    Melts {
        /// Rope.
        rope: String,
        /// Hottest of the duty, °C.
        temperature_c: f64,
        /// Where it melts, °C.
        melts_c: f64,
    },
    /// The rope breaks before there is anything to read.
    #[error(
        "rope '{rope}': under {tension_n:.0} N it {}, within {}; no elongation can be given",
        match cause {
            BreakCause::CreepRupture => "creeps until it breaks",
            BreakCause::BendingFatigue => "wears out over its pulleys",
        },
        rounded(*time_s)
    )]
    BreaksEarly {
        /// Rope.
        rope: String,
        /// Largest tension of the duty, with friction on the guides, N.
        tension_n: f64,
        /// Of what.
        cause: BreakCause,
        /// When, s.
        time_s: f64,
    },
    /// A rope that is to be held at its tension for longer than it lasts.
    #[error(
        "rope '{rope}': held at {tension_n} N it breaks after some {}, of creep under load, and --horizon is {}; pull it less, take a stronger rope, or plan for a shorter time",
        rounded(*life_s), rounded(*horizon_s)
    )]
    BreaksBefore {
        /// Rope.
        rope: String,
        /// Working tension, N.
        tension_n: f64,
        /// When it breaks, s.
        life_s: f64,
        /// How long it must hold, s.
        horizon_s: f64,
    },
    /// The load is more than heat and ends leave of the rope's strength.
    #[error(
        "rope '{rope}': {tension_n:.0} N breaks it at once; at {temperature_c:.0} °C{} it holds {strength_n:.0} N",
        match ends {
            _ if *is_bent => " and over its pulleys",
            Ends::NotStated => "",
            Ends::Spliced => " and spliced",
            Ends::Knotted => " and knotted",
        }
    )]
    TooWeak {
        /// Rope.
        rope: String,
        /// Largest tension of the duty, N.
        tension_n: f64,
        /// Its strength where it is weakest, N.
        strength_n: f64,
        /// Hottest of the duty, °C.
        temperature_c: f64,
        /// How its ends are held.
        ends: Ends,
        /// Whether a pulley leaves less of it than the ends.
        is_bent: bool,
    },
    /// A load that slackens the partner before the rope is tensioned again.
    #[error(
        "the joint's torque slackens the second rope once their mean tension is {slack_n:.1} N; --lowest is {lowest_n:.1} N and must be above that, and --tension above --lowest"
    )]
    Slack {
        /// Lowest tension allowed, N.
        lowest_n: f64,
        /// Mean tension at which the partner is slack, N.
        slack_n: f64,
    },
    /// A stroke that pulls the rope out of its route.
    #[error(
        "a stroke of {} mm is no shorter than the strand of {} mm: none of it would stay between its ends",
        millimetres(*stroke_m), millimetres(*length_m)
    )]
    Stroke {
        /// Stroke, m.
        stroke_m: f64,
        /// Strand, m.
        length_m: f64,
    },
}

/// Millimetres without the last digits that a factor of 1000 leaves.
fn millimetres(m: f64) -> f64 {
    (1e9 * m).round() / 1e6
}

/// A time in the unit that suits it.
fn rounded(time_s: f64) -> String {
    match time_s {
        t if t < 60.0 => "a minute".into(),
        t if t > 2.0 * YEAR_S => format!("{:.0} years", t / YEAR_S),
        t if t < 2.0 * HOUR_S => format!("{:.0} min", t / 60.0),
        t if t < 2.0 * DAY_S => format!("{:.0} h", t / HOUR_S),
        t => format!("{:.0} days", t / DAY_S),
    }
}
