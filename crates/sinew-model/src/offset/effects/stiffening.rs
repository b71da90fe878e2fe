//! A spring that stiffens as it is deflected.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
};

pub(crate) struct Stiffening;

impl Effect for Stiffening {
    const DESCRIPTION: Description = Description {
        title: "Cubic stiffening",
        text: "A rope spring stiffens with its deflection. The cube is that of the measured deflection, averaged like every other signal, \
               and the offset only shifts it. The equation therefore stays linear in stiffness, stiffening and torque at any deflection.",
        equation: "stiffening   η",
        parameters: &[Parameter {
            place: P::Stiffening as usize,
            name: "stiffening",
            symbol: "η",
            unit: "1/rad²",
            prior_text: "`stiffening_mean_per_rad2` ± `stiffening_per_rad2`",
            source: ASSUMED,
            lifetime: Lifetime::Months,
            kind: Some(Kind::Stiffness),
            term: Term::Stiffening,
            prior: |inputs| Some(inputs.tolerances.stiffening_per_rad2),
        }],
    };

    #[inline]
    fn stiffening(point: &Point<'_>, sum: &mut Sum<'_>) {
        sum.add(point, P::Stiffening, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn stiffening_is_the_coefficient_of_the_cube() {
        let example = Example::with(&[(P::Stiffening, 1.7)]);
        example.check::<Stiffening>(Stiffening::stiffening, 1.7);
    }
}
