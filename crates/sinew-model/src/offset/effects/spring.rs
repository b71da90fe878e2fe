//! Deviation of a spring's stiffness from its description.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
    about_zero,
};

pub(crate) struct Spring;

impl Effect for Spring {
    const DESCRIPTION: Description = Description {
        title: "Spring",
        text: "The joint torque deflects a spring, including the rope, whose compliance differs from 1/K of robot.toml. \
               The parameter is the relative error of the compliance, so the deflection is linear in it. \
               A strand failure is added from its time on.",
        equation: "compliance   δκ",
        parameters: &[Parameter {
            place: P::Compliance as usize,
            name: "compliance over nominal",
            symbol: "δκ",
            unit: "",
            prior_text: "0 ± `stiffness_percent`",
            source: ASSUMED,
            lifetime: Lifetime::Months,
            kind: Some(Kind::Stiffness),
            term: Term::Compliance,
            prior: |inputs| Some(about_zero(inputs.tolerances.stiffness)),
        }],
    };

    #[inline]
    fn compliance(point: &Point<'_>, sum: &mut Sum<'_>) {
        sum.add(point, P::Compliance, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn spring_adds_its_relative_compliance() {
        let example = Example::with(&[(P::Compliance, 0.08)]);
        example.check::<Spring>(Spring::compliance, 0.08);
    }
}
