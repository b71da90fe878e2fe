//! A rope that follows its load with a delay.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
    about_zero,
};

pub(crate) struct Viscoelastic;

impl Effect for Viscoelastic {
    const DESCRIPTION: Description = Description {
        title: "Viscoelastic rope",
        text: "A rope creeps after a change of its load, and recovers after unloading. A share of the deflection follows with a time constant of 30 s, `LP₃₀`.",
        equation: "deflection   v (LP₃₀[theta_measured − q] − Δ_e − y₀)",
        parameters: &[Parameter {
            place: P::Viscoelastic as usize,
            name: "viscoelastic share",
            symbol: "v",
            unit: "",
            prior_text: "0 ± `viscoelastic_percent`",
            source: ASSUMED,
            lifetime: Lifetime::Months,
            kind: Some(Kind::Viscoelasticity),
            term: Term::Deflection,
            prior: |inputs| Some(about_zero(inputs.tolerances.viscoelastic)),
        }],
    };

    #[inline]
    fn deflection(point: &Point<'_>, _: f64, sum: &mut Sum<'_>) {
        let slow = point.measured.y_slow - (point.at(P::Offset) + point.at(P::Zero));
        sum.add(point, P::Viscoelastic, slow);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn viscoelastic_share_is_of_the_slow_deflection_without_offset() {
        let mut example = Example::with(&[
            (P::Viscoelastic, 0.03),
            (P::Offset, 0.01),
            (P::Zero, -0.002),
        ]);
        example.measured.y_slow = 0.058;
        example.check::<Viscoelastic>(
            |point, sum| Viscoelastic::deflection(point, 0.0, sum),
            0.03 * 0.05,
        );
    }
}
