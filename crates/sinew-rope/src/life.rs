//! Lifetime of a rope under a duty, and the section that fails first.
//!
//! Palmgren–Miner rule along the rope: `D = ∫ Ḋ_creep dt + Σ passes/passes survived`, per section and at the
//! terminations; the rope breaks where `D` reaches 1 first.

use super::duty::{Duty, Stretch};
use super::endurance::RopeTermination;
use super::route::Request;
use crate::law::endurance::Endurance;
use crate::law::routing::{self, Pulley, RopeSection, RoutingError};
use crate::law::{Law, RopeLoad, damage};
use serde::{Deserialize, Serialize};
use sinew_model::Bounded;

/// Longest lifetime that is reported, s: 300 years.
pub const LIFE_MOST_S: f64 = 1e10;
/// Share of draws above which a rope that breaks is ranked behind those that last.
pub const MAY_BREAK_SHARE: f64 = 0.025;

/// Cause of a break.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum BreakCause {
    /// Constant load: creep rupture or static fatigue.
    CreepRupture,
    /// Bending fatigue over pulleys.
    BendingFatigue,
}

/// Location on the rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// Free length of the rope.
    Rope,
    /// Terminations of the rope.
    Termination,
}

/// Section of the rope with its damage; it breaks at a damage of 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DamageSite {
    /// Location of the section: rope or terminations.
    pub place: Place,
    /// Start of the section, m from the drive with the drive at rest.
    pub from_m: f64,
    /// End of the section, m from the drive.
    pub to_m: f64,
    /// Number of guiding pulleys that pass over the section.
    pub guides: usize,
    /// Damage by constant load, 0 to 1.
    pub creep_damage: f64,
    /// Damage by bending, 0 to 1.
    pub bending_damage: f64,
}

impl DamageSite {
    /// Total damage by load and bending.
    #[must_use]
    pub fn damage(&self) -> f64 {
        self.creep_damage + self.bending_damage
    }
}

/// Predicted lifetime of a rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RopeLifetime {
    /// Time of the break since first loading, s, limited to 300 years; `None` if value and lower bound exceed
    /// that.
    pub breaks_after_s: Option<Bounded>,
    /// Cause of the larger part of the damage.
    pub cause: BreakCause,
    /// Share of the draws in which the rope breaks within the longest requested time, 0 to 1.
    pub broken_share: f64,
    /// Termination of the rope.
    pub termination: RopeTermination,
    /// Share of the rope's strength that the termination retains, 0 to 1.
    pub termination_share: f64,
    /// Specified factor by which abrasion accelerates bending fatigue.
    pub abrasion_factor: f64,
    /// Sections in order from the drive, then the terminations, at the longest requested time or at the
    /// break, at the catalogue values.
    pub spots: Vec<DamageSite>,
}

/// Damage rates of one section.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wear {
    spot: DamageSite,
    /// Creep and bending damage of one cycle of the duty.
    cycle: [f64; 2],
    cycle_s: f64,
    /// Damage rates after the first cycle, 1/s; the same as in the cycle if the duty repeats.
    after_per_s: [f64; 2],
}

impl Wear {
    /// Time at which the damage reaches 1, s; infinite without damage.
    fn life_s(&self) -> f64 {
        let cycle: f64 = self.cycle.iter().sum();
        if cycle >= 1.0 {
            return self.cycle_s / cycle;
        }
        let after: f64 = self.after_per_s.iter().sum();
        self.cycle_s + (1.0 - cycle) / after
    }

    /// Damage of the section at a time.
    fn at(&self, time_s: f64) -> DamageSite {
        let of = |i: usize| {
            let share = (time_s / self.cycle_s).min(1.0);
            share * self.cycle[i] + (time_s - self.cycle_s).max(0.0) * self.after_per_s[i]
        };
        DamageSite {
            creep_damage: of(0),
            bending_damage: of(1),
            ..self.spot
        }
    }
}

/// Duty of one section: friction acts in both directions on a moving rope; a rope at rest keeps the tension
/// that friction leaves.
pub(crate) fn felt_by(portion: &RopeSection, law: &Law, request: &Request) -> Duty {
    let route = &request.route;
    if route.stroke_m == 0.0 {
        return request.duty.clone();
    }
    let (at, out) = (portion.middle_m, 0.5 * route.stroke_m);
    let friction = law.parameters().friction;
    let share = routing::tension_share(&route.pulleys, friction, at, out, false);
    request.duty.with_friction(share.ln())
}

/// Damage rates of every section and of the terminations.
pub(crate) fn wear(
    law: &Law,
    endurance: &Endurance,
    request: &Request,
    rope_m: Option<f64>,
) -> Result<Vec<Wear>, RoutingError> {
    let route = &request.route;
    let portions = routing::touched(route.length_m, route.stroke_m, &route.pulleys)?;
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
        let spot = DamageSite {
            place: Place::Rope,
            from_m: portion.middle_m - 0.5 * portion.length_m,
            to_m: portion.middle_m + 0.5 * portion.length_m,
            guides: portion.guides,
            creep_damage: 0.0,
            bending_damage: 0.0,
        };
        out.push(worn(spot, &duty, creeps_per_s, bends_per_s));
    }
    let termination_share = route.termination.share(endurance);
    if termination_share < 1.0 {
        let spot = DamageSite {
            place: Place::Termination,
            from_m: 0.0,
            to_m: route.length_m,
            guides: 0,
            creep_damage: 0.0,
            bending_damage: 0.0,
        };
        let rate = |load| {
            endurance
                .damage_per_s(law, load, termination_share)
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
    spot: DamageSite,
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

/// Mean of a rate over a segment; Simpson's rule if the load changes.
fn mean(s: &Stretch, rate: &dyn Fn(RopeLoad) -> f64) -> f64 {
    /// Number of parts of a ramp; rates are exponential in the load and change by at most about ten e-foldings.
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

/// Time at which the first section breaks, s; infinite without damage, 0 for a damage that is not a number.
pub(crate) fn life_s(wear: &[Wear]) -> f64 {
    let lives = wear.iter().map(Wear::life_s);
    lives.fold(f64::INFINITY, |least, life| match life.is_nan() {
        true => 0.0,
        false => least.min(life),
    })
}

/// Damage of every section at a time.
pub(crate) fn spots(wear: &[Wear], time_s: f64) -> Vec<DamageSite> {
    wear.iter().map(|w| w.at(time_s)).collect()
}

/// Cause of the larger part of the damage of the section that breaks first.
pub(crate) fn cause(wear: &[Wear]) -> BreakCause {
    let first = wear.iter().min_by(|a, b| a.life_s().total_cmp(&b.life_s()));
    let [creep, bending] = first.map_or([0.0; 2], |w| w.cycle);
    if bending > creep {
        BreakCause::BendingFatigue
    } else {
        BreakCause::CreepRupture
    }
}
