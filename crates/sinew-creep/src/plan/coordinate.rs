//! Coordinate in which the parameters of a rope are varied.

use crate::rope_base::RopeBase;
use sinew_rope::law::entry::Uncertainty;
use sinew_rope::law::{Parameter, Parameters};

/// Varies a parameter by `by` standard deviations of the base's interval, if it has one, otherwise
/// in its logarithm.
pub(super) fn moved(p: &Parameters, base: &RopeBase, parameter: Parameter, by: f64) -> Parameters {
    let value = p.get(parameter);
    let (low, high) = parameter.range();
    let entry = base.entry.law.get(&parameter);
    let to = match entry.map(|v| v.uncertainty) {
        Some(Uncertainty::Factor(f)) => value * (f.ln() * by / sinew_model::Z95).exp(),
        Some(Uncertainty::PlusMinus(d)) => value + d * by / sinew_model::Z95,
        _ => value * by.exp(),
    };
    let mut out = *p;
    out.set(parameter, to.clamp(low, high));
    out
}
