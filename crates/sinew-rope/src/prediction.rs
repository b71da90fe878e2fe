//! Result of a prediction of one rope under a duty.

use super::CatalogueRope;
use super::caution::Caution;
use super::duty::DutySummary;
use super::endurance::RopeTermination;
use super::life::RopeLifetime;
use super::route::Request;
use super::times::DAY_S;
use crate::law::endurance::Endurance;
use crate::law::routing::Pulley;
use crate::law::tested_range::{Extrapolation, TestedRange};
use crate::law::validity::LimitViolation;
use crate::law::{Law, damage};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::{Bounded, Z95};

/// Predicted elongation at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PredictedElongation {
    /// Time under the duty, s.
    pub time_s: f64,
    /// Total strain of the strand since new and slack, m/m.
    pub strain_ratio: Bounded,
    /// Total elongation of the strand since new and slack, m.
    pub elongation_m: Bounded,
    /// Elongation after pretensioning, counted from one minute after it, m.
    pub since_tensioned_m: Bounded,
    /// Permanent (irreversible) part of the total elongation, m.
    pub irreversible_m: Bounded,
    /// Share of the draws in which the rope is broken by then, 0 to 1; in these the elongation is that at the break,
    /// so that no bound falls because ropes break.
    pub broken_share: f64,
}

/// Guiding pulley along a strand, and the bend of the rope over it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PulleyPlace {
    /// Point of first contact with the drive at rest, m from the drive.
    pub at_m: f64,
    /// Radius of the rope's path, m.
    pub radius_m: f64,
    /// Wrap angle, rad.
    pub wrap_rad: f64,
    /// Ratio of bend diameter to rope diameter; `None` if the rope diameter is not published.
    pub bend_ratio: Option<f64>,
}

impl PulleyPlace {
    /// Bend of a rope of diameter `rope_m`, m, over a pulley.
    pub(super) fn new(pulley: &Pulley, rope_m: Option<f64>) -> Self {
        Self {
            at_m: pulley.at_m,
            radius_m: pulley.radius_m,
            wrap_rad: pulley.wrap_rad,
            bend_ratio: rope_m.map(|d| damage::bend_diameter_m(pulley, d) / d),
        }
    }
}

/// Prediction for one rope under a duty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Prediction {
    /// Name of the rope in the catalogue.
    pub rope: String,
    /// Description of the duty in words.
    pub duty: String,
    /// Means and extremes of the duty.
    pub summary: DutySummary,
    /// Length of the strand, m.
    pub length_m: f64,
    /// Tension that the elongations refer to, N.
    pub read_at_n: f64,
    /// Temperature that the elongations refer to, °C.
    pub read_at_c: f64,
    /// Elongations at the requested times, up to the break of the rope.
    pub readings: Vec<PredictedElongation>,
    /// Remaining strength at the last elongation, as a share of the new rope; `None` without strokes or if
    /// the rope diameter is unknown.
    pub strength_left_share: Option<Bounded>,
    /// Share of the draws in which the tension broke the rope, 0 to 1.
    pub broken_share: f64,
    /// Number of creep law parameters that are assumed, not measured.
    pub assumed_parameters: usize,
    /// Number of creep law parameters.
    pub parameters: usize,
    /// Number of draws.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Time at which the rope breaks at the catalogue values, s, if within the requested times; there are no
    /// elongations after it.
    pub breaks_after_s: Option<f64>,
    /// Predicted lifetime, with the section that fails first.
    pub lifetime: RopeLifetime,
    /// The guiding pulleys along the rope, in order from the drive.
    pub pulleys: Vec<PulleyPlace>,
    /// Tested range of the rope.
    pub tested_range: TestedRange,
    /// Extrapolation distance of the duty from the tested range, in load and temperature; intervals are
    /// widened for it, and for times beyond [`TestedRange::duration_s`].
    pub extrapolation: Extrapolation,
    /// Warnings, such as an extrapolation beyond the validity of the law.
    pub cautions: Vec<Caution>,
}

impl Prediction {
    /// Whether the rope breaks or is to be replaced within the requested times, at the catalogue values.
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
    const SCHEMA: &'static str = "sinew/rope-predict/2";
}

pub(super) fn cautions(
    rope: &CatalogueRope,
    law: &Law,
    endurance: &Endurance,
    request: &Request,
    extrapolation: Extrapolation,
) -> Vec<Caution> {
    let mut outside = LimitViolation::default();
    for s in &request.duty.stretches {
        outside = outside
            .or(LimitViolation::of(law, s.from))
            .or(LimitViolation::of(law, s.to));
    }
    let mut out = Caution::outside(outside);
    let entry = &rope.entry;
    let load_share = law.load_ratio(request.duty.summary().tension_max_n);
    if load_share > endurance.load_share_most {
        out.push(Caution::LoadShare {
            load_share,
            max_share: endurance.load_share_most,
        });
    }
    let rope_m = rope.diameter_m();
    let bend = |p: &Pulley| Some(damage::bend_diameter_m(p, rope_m?) / rope_m?);
    let pulleys = request.route.pulleys.iter();
    let bend_ratio = pulleys.filter_map(bend).fold(f64::INFINITY, f64::min);
    if bend_ratio < endurance.bend_ratio_least {
        out.push(Caution::TightBend {
            bend_ratio,
            min_ratio: endurance.bend_ratio_least,
        });
    }
    if request.route.termination == RopeTermination::NotSpecified {
        out.push(Caution::TerminationNotSpecified {
            splice_share: endurance.splice_share,
            knot_share: endurance.knot_share,
        });
    }
    if entry.breaking_load_n.is_none() {
        out.push(Caution::BreakingLoadAssumed {
            breaking_load_n: law.parameters().breaking_load_n,
        });
    }
    let longest = request.times_s.last().copied().unwrap_or(0.0);
    if entry.assumed() > 0 && longest > DAY_S {
        let tests_s = rope.tested_range().duration_s;
        out.push(Caution::Extrapolated { tests_s });
    }
    let summary = request.duty.summary();
    out.extend(beyond_data(
        rope.tested_range(),
        extrapolation,
        [summary.tension_mean_n, summary.tension_max_n].map(|n| law.load_ratio(n)),
        [summary.temperature_min_c, summary.temperature_max_c],
        longest,
    ));
    out
}

/// Warning about a duty outside the tested range of its rope; `None` within.
pub(super) fn beyond_data(
    tested_range: TestedRange,
    extrapolation: Extrapolation,
    load_share: [f64; 2],
    temperature_c: [f64; 2],
    duration_s: f64,
) -> Option<Caution> {
    let decades = tested_range.decades_beyond(duration_s);
    let std = extrapolation.std_after(decades).max(extrapolation.std());
    (extrapolation != Extrapolation::default() || decades > 0.0).then(|| Caution::BeyondData {
        tested_range,
        load_share,
        temperature_c,
        duration_s,
        factor: (Z95 * std).exp(),
    })
}
