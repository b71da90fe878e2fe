//! Periodic errors of the joint encoder: first and second harmonic of the joint position.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
    about_zero,
};

pub(crate) struct Encoder;

const fn amplitude(k: usize, name: &'static str, symbol: &'static str) -> Parameter {
    Parameter {
        place: P::Encoder as usize + k,
        name,
        symbol,
        unit: "rad",
        prior_text: "0 ± `encoder_mrad`",
        source: ASSUMED,
        lifetime: Lifetime::Months,
        kind: Some(Kind::Encoders),
        term: Term::Deflection,
        prior: |inputs| Some(about_zero(inputs.tolerances.encoder_rad)),
    }
}

impl Effect for Encoder {
    const DESCRIPTION: Description = Description {
        title: "Encoder error",
        text: "An eccentric encoder disc causes an error with a period of one turn of the joint. A tilted or oval disc causes an error with a period of half a turn.",
        equation: "deflection   e(q) = e_s1 LP[sin q] + e_c1 LP[cos q] + e_s2 LP[sin 2q] + e_c2 LP[cos 2q]",
        parameters: &[
            amplitude(0, "encoder error, sine once", "e_s1"),
            amplitude(1, "encoder error, cosine once", "e_c1"),
            amplitude(2, "encoder error, sine twice", "e_s2"),
            amplitude(3, "encoder error, cosine twice", "e_c2"),
        ],
    };

    #[inline]
    fn deflection(point: &Point<'_>, _: f64, sum: &mut Sum<'_>) {
        sum.add_all(point, P::Encoder, &point.measured.encoder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::ENCODER;
    use crate::offset::effects::example::Example;

    #[test]
    fn encoder_error_is_a_sum_of_four_waves() {
        let mut example = Example::with(&[]);
        let amplitudes = [1e-4, -2e-4, 3e-4, 4e-4];
        example.x[P::Encoder as usize..][..ENCODER].copy_from_slice(&amplitudes);
        let q = 0.7_f64;
        example.measured.encoder = [q.sin(), q.cos(), (2.0 * q).sin(), (2.0 * q).cos()];
        let expected =
            1e-4 * q.sin() - 2e-4 * q.cos() + 3e-4 * (2.0 * q).sin() + 4e-4 * (2.0 * q).cos();
        example.check::<Encoder>(|point, sum| Encoder::deflection(point, 0.0, sum), expected);
    }
}
