//! Temperature: the rope's length on its frame, and its compliance.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
    about_zero,
};

pub(crate) struct Thermal;

impl Thermal {
    /// Parameters that change with temperature, and their change per kelvin.
    pub(crate) const CHANGES: [(P, P); 2] = [(P::Compliance, P::Thermal), (P::Offset, P::Drift)];
}

impl Effect for Thermal {
    const DESCRIPTION: Description = Description {
        title: "Temperature",
        text: "A fibre contracts and the frame expands with temperature; both change the offset. \
               The compliance of the rope grows with temperature, too. \
               `ΔT` is the temperature of the block relative to that of the baseline, and 0 where one of them is unknown.",
        equation: "deflection   α_T ΔT\ncompliance   c_K ΔT",
        parameters: &[
            Parameter {
                place: P::Drift as usize,
                name: "zero drift",
                symbol: "α_T",
                unit: "rad/K",
                prior_text: "from rope and frame, see [temperature effects](absolute.md#temperature); otherwise 0 ± `drift_mrad_per_k`",
                source: "rope catalogue; otherwise engineering judgement",
                lifetime: Lifetime::Months,
                kind: Some(Kind::Drift),
                term: Term::Deflection,
                prior: |inputs| {
                    let otherwise = about_zero(inputs.tolerances.drift_rad_per_k());
                    Some(inputs.joint.drift_rad_per_k.unwrap_or(otherwise))
                },
            },
            Parameter {
                place: P::Thermal as usize,
                name: "compliance per kelvin",
                symbol: "c_K",
                unit: "1/K",
                prior_text: "the default; no key",
                source: ASSUMED,
                lifetime: Lifetime::Months,
                kind: Some(Kind::Stiffness),
                term: Term::Compliance,
                prior: |inputs| Some(inputs.tolerances.stiffness_per_k),
            },
        ],
    };

    #[inline]
    fn deflection(point: &Point<'_>, _: f64, sum: &mut Sum<'_>) {
        sum.add(point, P::Drift, point.temperature_difference_k);
    }

    #[inline]
    fn compliance(point: &Point<'_>, sum: &mut Sum<'_>) {
        sum.add(point, P::Thermal, point.temperature_difference_k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn temperature_shifts_offset_and_compliance() {
        let mut example = Example::with(&[(P::Drift, -0.4e-3), (P::Thermal, 2e-3)]);
        example.temperature_difference_k = 5.0;
        example.check::<Thermal>(|point, sum| Thermal::deflection(point, 0.0, sum), -2e-3);
        example.check::<Thermal>(Thermal::compliance, 0.01);
    }
}
