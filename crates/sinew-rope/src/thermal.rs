//! Thermal effect on a tendon of a joint: expansion of the rope relative to the frame.
//!
//! ```text
//! rope        ΔL = α_rope L ΔT                        less than 0 for fibres: they shorten
//! its path    ΔL = α_frame L ΔT                       the frame grows, and asks for more rope
//! offset      Δdelta_e = (α_rope − α_frame) L/r ΔT    a rope too short for its path pulls the joint
//! retraction  Δdelta_e = −S exp(−λ/λ_s) L/r Δg(θ)     HMPE above 35 °C
//! ```
//!
//! Two antagonistic ropes shorten equally: tension changes, the offset does not. One temperature applies to
//! rope and frame; temperature differences between them are not modelled.

use super::CatalogueRope;
use crate::law::Parameter;
use crate::law::entry::Value;
use sinew_model::Gaussian;
use sinew_model::tolerances::Tolerances;
use sinew_model::transmission::{Tendon, TendonThermal};

/// Expansion of an unspecified frame, 1/K: 95 % between carbon fibre, 0, and aluminium, 24e-6.
const FRAME_PER_K: Gaussian = Gaussian::new(12e-6, 6e-6);
/// Relative standard deviation of a specified expansion: alloys differ, and a frame consists of several.
const STATED_SHARE: f64 = 0.1;
/// Relative standard deviation of `g(θ)`: the retraction between 35 and 60 °C is assumed to be a straight
/// line.
const RETRACTION_SHAPE: f64 = 0.3;

/// Mean and standard deviation of a catalogue value.
fn gaussian(value: &Value) -> Gaussian {
    Gaussian::new(value.value, 0.5 * (value.at(1.0) - value.at(-1.0)).abs())
}

/// Thermal effect on the offset of a tendon of `rope`; `None` for an antagonistic pair, if the rope's
/// expansion is not available, or if the drift is specified and the frame's expansion is not.
///
/// If the frame's expansion is not specified, the drift has mean 0 and, as standard deviation, the root mean
/// square of the drift of frames from carbon fibre to aluminium.
#[must_use]
pub fn thermal_effect(
    rope: &CatalogueRope,
    tendon: &Tendon,
    tolerances: &Tolerances,
) -> Option<TendonThermal> {
    if tendon.antagonistic {
        return None;
    }
    let law = &rope.entry.law;
    let expansion = gaussian(law.get(&Parameter::Expansion)?);
    let per_strain = tendon.length_m / tendon.joint_pulley_radius_m;
    let rest = tolerances.drift_rad_per_k();
    let drift_rad_per_k = match tendon.frame_expansion_per_k {
        Some(frame) => {
            let spread = (STATED_SHARE * frame).hypot(expansion.std);
            Gaussian::new(
                (expansion.mean - frame) * per_strain,
                (spread * per_strain).hypot(rest),
            )
        }
        None if tolerances.drift_rad_per_k.is_some() => return None,
        None => {
            let spread = FRAME_PER_K.std.hypot(expansion.std);
            let size = (expansion.mean - FRAME_PER_K.mean).hypot(spread);
            Gaussian::new(0.0, (size * per_strain).hypot(rest))
        }
    };
    Some(TendonThermal {
        drift_rad_per_k,
        retraction_rad: retraction_rad(rope, tendon).unwrap_or(Gaussian::new(0.0, 0.0)),
    })
}

/// Full heat retraction at the tendon's pretension, rad of offset.
fn retraction_rad(rope: &CatalogueRope, tendon: &Tendon) -> Option<Gaussian> {
    let value = |p| rope.entry.law.get(&p);
    let full = gaussian(value(Parameter::Retraction)?);
    let held = value(Parameter::RetractionLoadRatio)?.value;
    let breaking_n = value(Parameter::BreakingLoad)?.value;
    let lambda = tendon.pretension_n.unwrap_or(0.0) / breaking_n;
    let rad = 0.01 * (-lambda / held).exp() * tendon.length_m / tendon.joint_pulley_radius_m;
    let spread = full.std.hypot(RETRACTION_SHAPE * full.mean);
    Some(Gaussian::new(full.mean * rad, spread * rad))
}
