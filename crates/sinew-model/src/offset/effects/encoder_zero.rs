//! Encoders that were not zeroed on an unloaded spring.

use super::{
    Description, Effect, JointParameter as P, Lifetime, Parameter, Point, Sum, Term, about_zero,
};

pub(crate) struct EncoderZero;

impl Effect for EncoderZero {
    const DESCRIPTION: Description = Description {
        title: "Encoder zero offset",
        text: "The offset is zero right after tensioning by definition, whatever the encoders show of an unloaded spring then. \
               Within one recording this parameter cannot be separated from the offset. \
               A baseline determines it, and later sessions hold it fixed.",
        equation: "deflection   y₀",
        parameters: &[Parameter {
            place: P::Zero as usize,
            name: "encoders' zero",
            symbol: "y₀",
            unit: "rad",
            prior_text: "0 ± `zero_mrad`",
            source: "convention: encoders are zeroed when the rope is tensioned",
            lifetime: Lifetime::Tensioning,
            kind: None,
            term: Term::Deflection,
            prior: |inputs| Some(about_zero(inputs.tolerances.zero_rad)),
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
