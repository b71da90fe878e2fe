//! Passes of a rope over pulleys: their cost in bedding-in, and their damage.

use super::{Law, LoadError, State};

/// Pulley over rope diameter that [`super::Parameters::bend_life_passes`] is stated at.
pub const REFERENCE_DIAMETER_RATIO: f64 = 20.0;
/// Pressure ratio `λ d/D` of a pass that costs 1 in the bedding-in: 100 N on a rope of 4450 N and 1.5 mm over 16 mm, the paper's bench
/// as assumed in [`crate::bench::routings`].
pub const REFERENCE_BEND_PRESSURE: f64 = 0.0021;
/// Wrap angle over which a deflection becomes a full bend, rad: `d/R` of the same bench, 10.7°. A rope takes the
/// curvature of a pulley over a length of about its diameter; assumed.
pub const FULL_BEND_WRAP_RAD: f64 = 0.1875;
/// Load ratio that [`super::Parameters::bend_life_passes`] is stated at.
pub const REFERENCE_LOAD_RATIO: f64 = 0.1;
/// Strength a spent rope (damage 1) has left, as a share of a new one's: the usual mark for
/// discarding a fibre rope.
pub const STRENGTH_LEFT_WHEN_SPENT: f64 = 0.5;

/// Diameter of the circle that a rope is really bent to, m: `1/D' = (1 − exp(−R φ/d))/D`.
///
/// A rope takes a pulley's curvature over a length of about its own diameter; where the contact is shorter,
/// it is bent less. That length is assumed.
///
/// * Returns at least `2 R`; infinite without a wrap.
#[must_use]
pub fn bend_diameter_m(pulley: &super::routing::Pulley, rope_m: f64) -> f64 {
    -2.0 * pulley.radius_m / libm::expm1(-pulley.contact_m() / rope_m)
}

/// Cost of a pass over a guiding pulley in the bedding-in, relative to one of the paper's bench.
///
/// `c = (1 − exp(−φ/10.7°)) ((λ d/D)/0.0021)^n` ([`bend_share`], [`pressure_cost`]). It falls with the radius for
/// every `n` above 0.
///
/// * `tension_n`: mean tension, N, for `λ`. `rope_m`: diameter `d`, m; `None`: the pressure of the bench.
///
/// # Source
/// Assumed. `λ d/D` is the pressure that tables of bending life use; no published elongation of a fibre rope against
/// `D/d` or wrap was found, so [`super::Parameters::pass_pressure_exponent`] spans 0 to 1.
#[must_use]
pub fn pass_cost(
    law: &Law,
    pulley: &super::routing::Pulley,
    rope_m: Option<f64>,
    tension_n: f64,
) -> f64 {
    bend_share(pulley.wrap_rad) * pressure_cost(law, pulley, rope_m, tension_n)
}

/// Share of a full bend in a deflection by `φ`, rad: `1 − exp(−φ/10.7°)` ([`FULL_BEND_WRAP_RAD`]).
#[must_use]
pub fn bend_share(wrap_rad: f64) -> f64 {
    -libm::expm1(-wrap_rad / FULL_BEND_WRAP_RAD)
}

/// `((λ d/D)/0.0021)^n`, with `D` at least `d`; arguments as in [`pass_cost`].
#[must_use]
pub fn pressure_cost(
    law: &Law,
    pulley: &super::routing::Pulley,
    rope_m: Option<f64>,
    tension_n: f64,
) -> f64 {
    let Some(rope_m) = rope_m else { return 1.0 };
    let pressure = law.load_ratio(tension_n) * rope_m / (2.0 * pulley.radius_m).max(rope_m);
    let exponent = law.parameters().pass_pressure_exponent;
    libm::pow(pressure / REFERENCE_BEND_PRESSURE, exponent)
}

/// `N`: passes over a portion, each times its cost ([`pass_cost`]).
#[must_use]
pub fn passes(
    law: &Law,
    portion: &super::routing::RopeSection,
    pulleys: &[super::routing::Pulley],
    stroke_m: f64,
    rope_m: Option<f64>,
    tension_n: f64,
) -> f64 {
    let each = pulleys.iter();
    each.map(|p| p.passes(portion.middle_m, stroke_m) * pass_cost(law, p, rope_m, tension_n))
        .sum()
}

/// Passes over a pulley that the rope survives:
/// `N = N_ref ((D/d)/20)^m_D (λ/0.1)^(−m_λ)`.
///
/// A power law as for wire ropes (Feyrer); for thin fibre ropes its numbers are hardly
/// published, so the catalogue gives them a wide interval.
///
/// * `pulley_m`, `rope_m`: diameters, m, above 0.
/// * Returns passes (one pass: onto the pulley and off again); infinite without tension.
///
/// # Errors
/// [`LoadError`].
pub fn passes_survived(
    law: &Law,
    tension_n: f64,
    pulley_m: f64,
    rope_m: f64,
) -> Result<f64, LoadError> {
    law.check(super::RopeLoad::at_reference(tension_n))?;
    let ratio = pulley_m / rope_m;
    if !(ratio > 0.0 && ratio.is_finite() && rope_m > 0.0) {
        return Err(LoadError::Bend);
    }
    let lambda = law.load_ratio(tension_n);
    if lambda == 0.0 {
        return Ok(f64::INFINITY);
    }
    let p = law.parameters();
    Ok(p.bend_life_passes
        * libm::pow(ratio / REFERENCE_DIAMETER_RATIO, p.bend_ratio_exponent)
        * libm::pow(lambda / REFERENCE_LOAD_RATIO, -p.bend_load_exponent))
}

/// Counts passes over a pulley into the state (Palmgren–Miner).
///
/// # Errors
/// [`LoadError`]; the state is unchanged.
///
/// # Realtime
/// No allocation, lock, panic or clock.
pub fn bend(
    law: &Law,
    state: &mut State,
    tension_n: f64,
    pulley_m: f64,
    rope_m: f64,
    passes: f64,
) -> Result<(), LoadError> {
    let survived = passes_survived(law, tension_n, pulley_m, rope_m)?;
    if !(passes >= 0.0 && passes.is_finite()) {
        return Err(LoadError::Bend);
    }
    let damage = passes / survived;
    if !damage.is_finite() || !state.is_possible() {
        return Err(LoadError::State);
    }
    state.bending_damage += damage;
    Ok(())
}

/// Share of the breaking load that is left: 1 when new, [`STRENGTH_LEFT_WHEN_SPENT`] at
/// damage 1, falling on to 0.
#[must_use]
pub fn strength_left(state: &State) -> f64 {
    (1.0 - (1.0 - STRENGTH_LEFT_WHEN_SPENT) * state.bending_damage).max(0.0)
}
