//! What warmth does to a tendon that holds a joint: rope against frame.
//!
//! ```text
//! rope        ΔL = α_rope L ΔT                        less than 0 for fibres: they shorten
//! its path    ΔL = α_frame L ΔT                       the frame grows, and asks for more rope
//! offset      Δdelta_e = (α_rope − α_frame) L/r ΔT    a rope too short for its path pulls the joint
//! retraction  Δdelta_e = −S exp(−λ/λ_s) L/r Δg(θ)     HMPE above 35 °C
//! ```
//!
//! Of two ropes that pull against each other both shorten alike: tension changes, not the offset.
//! One thermometer stands for rope and frame; what is warmer than the other is not modelled.

use super::CatalogueRope;
use crate::law::Parameter;
use crate::law::entry::Value;
use sinew_model::Gaussian;
use sinew_model::tolerances::Tolerances;
use sinew_model::transmission::{Tendon, TendonWarmth};

/// Expansion of a frame that nobody states, 1/K: 95 % between carbon fibre, 0, and aluminium, 24e-6.
const FRAME_PER_K: Gaussian = Gaussian::new(12e-6, 6e-6);
/// A stated expansion is good to a tenth: alloys differ, and a frame is of more than one.
const STATED_SHARE: f64 = 0.1;
/// `g(θ)`, the retraction between 35 and 60 °C, is a straight line by judgement; a deviation.
const RETRACTION_SHAPE: f64 = 0.3;

/// Mean and standard deviation of a catalogue value.
fn gaussian(value: &Value) -> Gaussian {
    Gaussian::new(value.value, 0.5 * (value.at(1.0) - value.at(-1.0)).abs())
}

/// What warmth does to the offset of a tendon of `rope`; `None` where the ropes of a pair shorten alike,
/// where the rope's expansion isn't known, or where the owner states the drift and not the frame.
///
/// Where the frame isn't stated, nobody knows whether the routing balances: the drift is 0 ± the root
/// mean square of what a frame from carbon fibre to aluminium would make of it.
#[must_use]
pub fn warmth(
    rope: &CatalogueRope,
    tendon: &Tendon,
    tolerances: &Tolerances,
) -> Option<TendonWarmth> {
    if tendon.antagonistic {
        return None;
    }
    let law = &rope.entry.law;
    let expansion = gaussian(law.get(&Parameter::Expansion)?);
    let per_strain = tendon.length_m / tendon.joint_pulley_radius_m;
    let rest = tolerances.drift_rad_per_k();
    let drift_rad_per_k = match tendon.frame_expansion_per_k {
        Some(frame) => {
            let spread = (STATED_SHARE * frame).hypot(expansion.deviation);
            Gaussian::new(
                (expansion.mean - frame) * per_strain,
                (spread * per_strain).hypot(rest),
            )
        }
        None if tolerances.drift_rad_per_k.is_some() => return None,
        None => {
            let spread = FRAME_PER_K.deviation.hypot(expansion.deviation);
            let size = (expansion.mean - FRAME_PER_K.mean).hypot(spread);
            Gaussian::new(0.0, (size * per_strain).hypot(rest))
        }
    };
    Some(TendonWarmth {
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
    let spread = full.deviation.hypot(RETRACTION_SHAPE * full.mean);
    Some(Gaussian::new(full.mean * rad, spread * rad))
}
