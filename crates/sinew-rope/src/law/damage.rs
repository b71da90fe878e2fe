//! Damage of a rope by bending over pulleys.

use super::{Law, LoadError, State};

/// Pulley over rope diameter that [`super::Parameters::bend_life_passes`] is stated at.
pub const REFERENCE_DIAMETER_RATIO: f64 = 20.0;
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

/// Weight of a guiding pulley in the bedding-in, 0 to 1: a pulley that bends the rope to
/// [`REFERENCE_DIAMETER_RATIO`] or closer counts fully, a larger one in proportion to its curvature.
#[must_use]
pub fn pass_weight(pulley: &super::routing::Pulley, rope_m: f64) -> f64 {
    (REFERENCE_DIAMETER_RATIO * rope_m / bend_diameter_m(pulley, rope_m)).min(1.0)
}

/// `N`: effective number of guiding pulleys that pass over a portion. If the diameter of the rope is unknown, each
/// pulley counts fully.
#[must_use]
pub fn passes(
    portion: &super::routing::RopeSection,
    pulleys: &[super::routing::Pulley],
    stroke_m: f64,
    rope_m: Option<f64>,
) -> f64 {
    let over = pulleys
        .iter()
        .filter(|p| p.touches(portion.middle_m, stroke_m));
    over.map(|p| rope_m.map_or(1.0, |d| pass_weight(p, d)))
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
