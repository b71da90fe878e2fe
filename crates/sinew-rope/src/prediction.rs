//! What a rope does under a duty, as a result.

use super::CatalogueRope;
use super::caution::Caution;
use super::duty::DutySummary;
use super::endurance::Ends;
use super::life::Life;
use super::route::Request;
use super::times::DAY_S;
use crate::law::endurance::Endurance;
use crate::law::holds::{Beyond, Holds};
use crate::law::routing::Pulley;
use crate::law::validity::Outside;
use crate::law::{Law, damage};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::{Bounded, Z95};

/// Elongation at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reading {
    /// Time under the duty, s.
    pub time_s: f64,
    /// Strain of the strand from new and slack, m/m.
    pub strain_ratio: Bounded,
    /// Elongation of the strand from new and slack, m.
    pub elongation_m: Bounded,
    /// Elongation since a minute after tensioning, m.
    pub since_tensioned_m: Bounded,
    /// Part of it that unloading would not bring back, m.
    pub irreversible_m: Bounded,
    /// Share of the draws in which the rope is broken by then, 0 to 1: they are left out.
    pub broken_share: f64,
}

/// A guiding pulley along a strand, and how it bends the rope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PulleyPlace {
    /// Where the rope first touches it with the drive at rest, m from the drive.
    pub at_m: f64,
    /// Radius of the rope's path, m.
    pub radius_m: f64,
    /// Wrap angle, rad.
    pub wrap_rad: f64,
    /// Diameter that the rope is bent to, over its own; `None` where that isn't published.
    pub bend_ratio: Option<f64>,
}

impl PulleyPlace {
    /// A pulley under a rope of a diameter, m.
    pub(super) fn new(pulley: &Pulley, rope_m: Option<f64>) -> Self {
        Self {
            at_m: pulley.at_m,
            radius_m: pulley.radius_m,
            wrap_rad: pulley.wrap_rad,
            bend_ratio: rope_m.map(|d| damage::bend_diameter_m(pulley, d) / d),
        }
    }
}

/// The prediction for one rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Prediction {
    /// Rope.
    pub rope: String,
    /// The duty in words.
    pub duty: String,
    /// Its sums.
    pub summary: DutySummary,
    /// Strand length, m.
    pub length_m: f64,
    /// Tension the readings refer to, N.
    pub read_at_n: f64,
    /// Temperature the readings refer to, °C.
    pub read_at_c: f64,
    /// Readings, up to the time at which the rope breaks.
    pub readings: Vec<Reading>,
    /// Strength left at the last reading, share of new; `None` where bending was not asked for or
    /// the rope's diameter is unknown.
    pub strength_left_share: Option<Bounded>,
    /// Share of draws in which the tension broke the rope, 0 to 1.
    pub broken_share: f64,
    /// Parameters of the law that are starting guesses.
    pub starting_guesses: usize,
    /// All parameters of the law.
    pub parameters: usize,
    /// Draws made.
    pub draws: usize,
    /// Their seed.
    pub seed: u64,
    /// When the rope breaks, s, at the catalogue's values, where that is within the times asked for;
    /// there is no reading from then on.
    pub breaks_after_s: Option<f64>,
    /// How long it lasts, and which portion wears out first.
    pub life: Life,
    /// The guiding pulleys along the rope, in order from the drive.
    pub pulleys: Vec<PulleyPlace>,
    /// Data behind the rope's values.
    pub holds: Holds,
    /// How far the duty lies beyond it in load and temperature; intervals are widened for that, and
    /// for times beyond [`Holds::duration_s`].
    pub beyond: Beyond,
    /// Where the duty leaves what the law was made for, and other cautions.
    pub cautions: Vec<Caution>,
}

impl Prediction {
    /// Whether within the times asked for it breaks or is to be replaced, at the catalogue's values.
    #[must_use]
    pub fn ends(&self) -> bool {
        let replaced = |c: &Caution| {
            matches!(
                c,
                Caution::Replace {
                    time_s: Some(_),
                    ..
                }
            )
        };
        self.breaks_after_s.is_some() || self.cautions.iter().any(replaced)
    }
}

impl JsonDocument for Prediction {
    const SCHEMA: &'static str = "sinew/rope-predict/1";
}

pub(super) fn cautions(
    rope: &CatalogueRope,
    law: &Law,
    endurance: &Endurance,
    request: &Request,
    beyond: Beyond,
) -> Vec<Caution> {
    let mut outside = Outside::default();
    for s in &request.duty.stretches {
        outside = outside
            .or(Outside::of(law, s.from))
            .or(Outside::of(law, s.to));
    }
    let mut out = Caution::outside(outside);
    let entry = &rope.entry;
    let load_share = law.load_ratio(request.duty.summary().tension_max_n);
    if load_share > endurance.load_share_most {
        out.push(Caution::LoadShare {
            load_share,
            most_share: endurance.load_share_most,
        });
    }
    let rope_m = rope.diameter_m();
    let bend = |p: &Pulley| Some(damage::bend_diameter_m(p, rope_m?) / rope_m?);
    let pulleys = request.route.pulleys.iter();
    let bend_ratio = pulleys.filter_map(bend).fold(f64::INFINITY, f64::min);
    if bend_ratio < endurance.bend_ratio_least {
        out.push(Caution::TightBend {
            bend_ratio,
            least_ratio: endurance.bend_ratio_least,
        });
    }
    if request.route.ends == Ends::NotStated {
        out.push(Caution::EndsNotStated {
            splice_share: endurance.splice_share,
            knot_share: endurance.knot_share,
        });
    }
    if entry.breaking_load_n.is_none() {
        out.push(Caution::BreakingLoadGuessed {
            breaking_load_n: law.parameters().breaking_load_n,
        });
    }
    let longest = request.times_s.last().copied().unwrap_or(0.0);
    if entry.guesses() > 0 && longest > DAY_S {
        let tests_s = rope.holds().duration_s;
        out.push(Caution::Extrapolated { tests_s });
    }
    let decades = rope.holds().decades_beyond(longest);
    if beyond != Beyond::default() || decades > 0.0 {
        let summary = request.duty.summary();
        out.push(Caution::BeyondData {
            holds: rope.holds(),
            load_share: [summary.tension_mean_n, summary.tension_max_n].map(|n| law.load_ratio(n)),
            temperature_c: [summary.temperature_min_c, summary.temperature_max_c],
            duration_s: longest,
            factor: (Z95 * beyond.deviation_after(decades)).exp(),
        });
    }
    out
}
