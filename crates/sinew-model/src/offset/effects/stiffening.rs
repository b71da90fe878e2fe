//! Stiffening of a spring with its deflection.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
    about_zero,
};

pub(crate) struct Stiffening;

impl Effect for Stiffening {
    const DESCRIPTION: Description = Description {
        title: "Cubic stiffening",
        text: "A rope spring stiffens with its deflection. The cubic term uses the measured deflection, averaged like every other signal; \
               the offset affects it only as a shift. The equation therefore stays linear in stiffness, stiffening and torque at any deflection.",
        equation: "stiffening   η",
        parameters: &[Parameter {
            place: P::Stiffening as usize,
            name: "stiffening",
            symbol: "η",
            unit: "1/rad²",
            prior_text: "`stiffening_mean_per_rad2` ± `stiffening_per_rad2`; of a strand that only pulls 0 ± the same",
            source: ASSUMED,
            lifetime: Lifetime::Months,
            kind: Some(Kind::Stiffness),
            term: Term::Stiffening,
            // About its pretension a strand stiffens one way, which a cubic term does not describe.
            prior: |inputs| {
                let stated = inputs.tolerances.stiffening_per_rad2;
                Some(match inputs.joint.pretension_nm > 0.0 {
                    true => about_zero(stated.std),
                    false => stated,
                })
            },
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
