//! The offset of the motor position that is estimated.

use super::{
    Description, Effect, JointParameter as P, Lifetime, Parameter, Point, Sum, Term, about_zero,
};

pub(crate) struct Offset;

impl Effect for Offset {
    const DESCRIPTION: Description = Description {
        title: "Offset",
        text: "With an elongated tendon the motor turns further for the same joint torque. \
               The offset is the difference of motor and joint position at zero load since tensioning. \
               Changes found by the search, such as slips, are added from their time on.",
        equation: "deflection   Δ_e",
        parameters: &[Parameter {
            place: P::Offset as usize,
            name: "offset",
            symbol: "Δ_e",
            unit: "rad",
            prior_text: "without a baseline 0 ± 30 mrad, directly after tensioning 0 ± 0.01 mrad",
            source: "definition: zero after tensioning; otherwise engineering judgement",
            lifetime: Lifetime::Recording,
            kind: None,
            term: Term::Deflection,
            prior: |inputs| Some(about_zero(inputs.offset_rad)),
        }],
    };

    #[inline]
    fn deflection(point: &Point<'_>, _: f64, sum: &mut Sum<'_>) {
        sum.add(point, P::Offset, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn offset_adds_to_the_deflection() {
        let example = Example::with(&[(P::Offset, 0.012)]);
        example.check::<Offset>(|point, sum| Offset::deflection(point, 0.0, sum), 0.012);
    }
}
