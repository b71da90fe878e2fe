//! How long a rope lasts under a duty, and which portion of it wears out first.
//!
//! Palmgren–Miner along the rope: `D = ∫ Ḋ_creep dt + Σ passes/passes survived`, portion by portion
//! and at the ends; the rope is broken where `D` is 1 first.

use super::duty::{Duty, Stretch};
use super::endurance::Ends;
use super::route::Request;
use crate::law::endurance::Endurance;
use crate::law::routing::{self, Portion, Pulley, RoutingError};
use crate::law::{Law, RopeLoad, damage};
use serde::{Deserialize, Serialize};
use sinew_model::Bounded;

/// A life beyond this is none that can be told, s: 300 years.
pub(crate) const LIFE_MOST_S: f64 = 1e10;
/// A rope that breaks in more of the draws than this is ranked behind those that last.
pub const MAY_BREAK_SHARE: f64 = 0.025;

/// What breaks a rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum BreakCause {
    /// Constant load: flow until it parts, or static fatigue.
    CreepRupture,
    /// Bending over pulleys.
    BendingFatigue,
}

/// Where on the rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// Along the rope.
    Rope,
    /// Where it is held.
    Ends,
}

/// A portion of the rope and what it has lost of its life; 1 is all of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Spot {
    /// Rope or ends.
    pub place: Place,
    /// From here, m from the drive with the drive at rest.
    pub from_m: f64,
    /// To here, m.
    pub to_m: f64,
    /// Guiding pulleys that pass over it.
    pub guides: usize,
    /// Lost to constant load.
    pub creep_damage: f64,
    /// Lost to bending.
    pub bending_damage: f64,
}

impl Spot {
    /// Both together.
    #[must_use]
    pub fn damage(&self) -> f64 {
        self.creep_damage + self.bending_damage
    }
}

/// How long a rope lasts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Life {
    /// When it breaks, s since it was first loaded; `None` beyond 300 years. The interval ends there.
    pub breaks_after_s: Option<Bounded>,
    /// What takes most of its life.
    pub cause: BreakCause,
    /// Share of the draws in which it breaks within the longest time asked for, 0 to 1.
    pub broken_share: f64,
    /// How its ends are held.
    pub ends: Ends,
    /// Share of the rope's strength that they keep.
    pub end_share: f64,
    /// Factor by which abrasion speeds up the wear of bending, as stated.
    pub abrasion_factor: f64,
    /// Portions in order from the drive, then the ends, at the longest time asked for or when it
    /// breaks, at the catalogue's values.
    pub spots: Vec<Spot>,
}

/// How a spot wears.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wear {
    spot: Spot,
    /// Creep and bending damage of one run through the duty.
    cycle: [f64; 2],
    cycle_s: f64,
    /// Per second afterwards; a duty that repeats goes on as before.
    after_per_s: [f64; 2],
}

impl Wear {
    /// When its damage is 1, s.
    fn life_s(&self) -> f64 {
        let cycle: f64 = self.cycle.iter().sum();
        if cycle >= 1.0 {
            return self.cycle_s / cycle;
        }
        let after: f64 = self.after_per_s.iter().sum();
        (self.cycle_s + (1.0 - cycle) / after).min(LIFE_MOST_S)
    }

    /// The spot at a time.
    fn at(&self, time_s: f64) -> Spot {
        let of = |i: usize| {
            let share = (time_s / self.cycle_s).min(1.0);
            share * self.cycle[i] + (time_s - self.cycle_s).max(0.0) * self.after_per_s[i]
        };
        Spot {
            creep_damage: of(0),
            bending_damage: of(1),
            ..self.spot
        }
    }
}

/// The duty as a portion feels it: a rope that moves is pulled both ways by friction, one at rest
/// keeps whatever friction has left it.
pub(crate) fn felt_by(portion: &Portion, law: &Law, request: &Request) -> Duty {
    let route = &request.route;
    if route.stroke_m == 0.0 {
        return request.duty.clone();
    }
    let (at, out) = (portion.middle_m, 0.5 * route.stroke_m);
    let friction = law.parameters().friction;
    let share = routing::tension_share(&route.pulleys, friction, at, out, false);
    request.duty.with_friction(share.ln())
}

/// How every portion and the ends wear.
pub(crate) fn wear(
    law: &Law,
    endurance: &Endurance,
    request: &Request,
    rope_m: Option<f64>,
) -> Result<Vec<Wear>, RoutingError> {
    let route = &request.route;
    let portions = routing::portions(route.length_m, route.stroke_m, &route.pulleys)?;
    let mut out = Vec::with_capacity(portions.len() + 1);
    for portion in &portions {
        let duty = felt_by(portion, law, request);
        let touching = |p: &&Pulley| p.touches(portion.middle_m, route.stroke_m);
        let over: Vec<&Pulley> = route.pulleys.iter().filter(touching).collect();
        let bends_per_s = |load: RopeLoad| {
            let passed = |p: &&Pulley| {
                let rope_m = rope_m?;
                let round_m = damage::bend_diameter_m(p, rope_m);
                let survived = damage::passes_survived(law, load.tension_n, round_m, rope_m);
                // A stroke takes the rope on and off each pulley twice.
                let passes = 2.0 * route.strokes_per_hour / 3600.0 * route.abrasion_factor;
                Some(survived.map_or(f64::INFINITY, |n| passes / n))
            };
            over.iter().filter_map(passed).sum()
        };
        let bent = bent_share(endurance, &over, rope_m);
        let creeps_per_s = |load: RopeLoad| {
            // What a bend leaves of the strength counts for a break at once alone.
            let strength = bent * endurance.strength_share(load.temperature_k);
            if law.load_ratio(load.tension_n) > strength {
                return f64::INFINITY;
            }
            endurance
                .damage_per_s(law, load, 1.0)
                .unwrap_or(f64::INFINITY)
        };
        let spot = Spot {
            place: Place::Rope,
            from_m: portion.middle_m - 0.5 * portion.length_m,
            to_m: portion.middle_m + 0.5 * portion.length_m,
            guides: portion.guides,
            creep_damage: 0.0,
            bending_damage: 0.0,
        };
        out.push(worn(spot, &duty, creeps_per_s, bends_per_s));
    }
    let end_share = route.ends.share(endurance);
    if end_share < 1.0 {
        let spot = Spot {
            place: Place::Ends,
            from_m: 0.0,
            to_m: route.length_m,
            guides: 0,
            creep_damage: 0.0,
            bending_damage: 0.0,
        };
        let rate = |load| {
            endurance
                .damage_per_s(law, load, end_share)
                .unwrap_or(f64::INFINITY)
        };
        out.push(worn(spot, &request.duty, rate, |_| 0.0));
    }
    Ok(out)
}

/// Share of the strength that the tightest of some pulleys leaves.
pub(crate) fn bent_share(endurance: &Endurance, over: &[&Pulley], rope_m: Option<f64>) -> f64 {
    let Some(rope_m) = rope_m else { return 1.0 };
    let ratio = |p: &&Pulley| damage::bend_diameter_m(p, rope_m) / rope_m;
    let shares = over.iter().map(|p| endurance.bent_share(ratio(p)));
    shares.fold(1.0, f64::min)
}

fn worn(
    spot: Spot,
    duty: &Duty,
    creeps_per_s: impl Fn(RopeLoad) -> f64,
    bends_per_s: impl Fn(RopeLoad) -> f64,
) -> Wear {
    let over = |rate: &dyn Fn(RopeLoad) -> f64| -> f64 {
        let each = duty.stretches.iter();
        each.map(|s| s.duration_s * mean(s, rate)).sum()
    };
    let cycle = [over(&creeps_per_s), over(&bends_per_s)];
    let cycle_s: f64 = duty.stretches.iter().map(|s| s.duration_s).sum();
    let after_per_s = match duty.stretches.last() {
        Some(last) if !duty.repeat => [creeps_per_s(last.to), bends_per_s(last.to)],
        _ => cycle.map(|d| d / cycle_s),
    };
    Wear {
        spot,
        cycle,
        cycle_s,
        after_per_s,
    }
}

/// Mean of a rate over a stretch; Simpson's rule where the load changes.
fn mean(s: &Stretch, rate: &dyn Fn(RopeLoad) -> f64) -> f64 {
    /// Rates go with the exponential of the load, over some ten e-foldings at most.
    const PARTS: u32 = 16;
    if s.from == s.to {
        return rate(s.from);
    }
    let at = |i: u32| {
        let x = f64::from(i) / f64::from(PARTS);
        let between = |a: f64, b: f64| a + (b - a) * x;
        rate(RopeLoad {
            tension_n: between(s.from.tension_n, s.to.tension_n),
            temperature_k: between(s.from.temperature_k, s.to.temperature_k),
        })
    };
    let inner = (1..PARTS).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * at(i));
    (at(0) + inner.sum::<f64>() + at(PARTS)) / (3.0 * f64::from(PARTS))
}

/// When the first spot breaks, s, at most [`LIFE_MOST_S`].
pub(crate) fn life_s(wear: &[Wear]) -> f64 {
    wear.iter().map(Wear::life_s).fold(LIFE_MOST_S, f64::min)
}

/// Every spot at a time.
pub(crate) fn spots(wear: &[Wear], time_s: f64) -> Vec<Spot> {
    wear.iter().map(|w| w.at(time_s)).collect()
}

/// What takes most of the life of the spot that breaks first.
pub(crate) fn cause(wear: &[Wear]) -> BreakCause {
    let first = wear.iter().min_by(|a, b| a.life_s().total_cmp(&b.life_s()));
    let [creep, bending] = first.map_or([0.0; 2], |w| w.cycle);
    if bending > creep {
        BreakCause::BendingFatigue
    } else {
        BreakCause::CreepRupture
    }
}
