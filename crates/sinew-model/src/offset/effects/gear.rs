//! A gear ratio that differs from its description.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
    about_zero,
};

pub(crate) struct Gear;

impl Effect for Gear {
    const DESCRIPTION: Description = Description {
        title: "Gear ratio error",
        text: "The motor position is divided by a gear ratio that differs from robot.toml, as pulley radii differ from their drawing. \
               The error grows with the joint position.",
        equation: "deflection   γ LP[q]",
        parameters: &[Parameter {
            place: P::Gear as usize,
            name: "gear ratio error",
            symbol: "γ",
            unit: "",
            prior_text: "0 ± `gear_percent`",
            source: ASSUMED,
            lifetime: Lifetime::Months,
            kind: Some(Kind::Encoders),
            term: Term::Deflection,
            prior: |inputs| Some(about_zero(inputs.tolerances.gear)),
        }],
    };

    #[inline]
    fn deflection(point: &Point<'_>, _: f64, sum: &mut Sum<'_>) {
        sum.add(point, P::Gear, point.measured.turned);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn gear_error_grows_with_the_joint_position() {
        let mut example = Example::with(&[(P::Gear, 0.002)]);
        example.measured.turned = -1.5;
        example.check::<Gear>(|point, sum| Gear::deflection(point, 0.0, sum), -0.003);
    }
}
