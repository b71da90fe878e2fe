//! Encoders that were not zeroed on an unloaded spring.

use super::{
    Description, Effect, JointParameter as P, Lifetime, Parameter, Point, Sum, Term, about_zero,
};

pub(crate) struct EncoderZero;

impl Effect for EncoderZero {
    const DESCRIPTION: Description = Description {
        title: "Encoder zero offset",
        text: "By definition the offset is zero directly after tensioning, for any difference of the encoder values with an unloaded spring at that time. \
               Within one recording this parameter cannot be separated from the offset. It includes the pretension of a strand that only pulls. A baseline determines it, and later sessions keep it fixed.",
        equation: "deflection   y₀",
        parameters: &[Parameter {
            place: P::Zero as usize,
            name: "encoders' zero",
            symbol: "y₀",
            unit: "rad",
            prior_text: "0 ± `zero_mrad`, for a strand in addition `pretension_percent` of its elongation by the pretension",
            source: "convention: encoders are zeroed when the rope is tensioned",
            lifetime: Lifetime::Tensioning,
            kind: None,
            term: Term::Deflection,
            prior: |inputs| {
                let pretension_rad = inputs.joint.pretension_nm / inputs.joint.stiffness_nm_per_rad;
                let pretension_rad = inputs.tolerances.pretension * pretension_rad;
                Some(about_zero(libm::hypot(
                    inputs.tolerances.zero_rad,
                    pretension_rad,
                )))
            },
        }],
    };

    #[inline]
    fn deflection(point: &Point<'_>, _: f64, sum: &mut Sum<'_>) {
        sum.add(point, P::Zero, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn encoder_zero_adds_to_the_deflection() {
        let example = Example::with(&[(P::Zero, -0.02)]);
        example.check::<EncoderZero>(|point, sum| EncoderZero::deflection(point, 0.0, sum), -0.02);
    }
}
