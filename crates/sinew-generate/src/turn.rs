//! Sine and cosine as code: a rest of at most half a quarter turn, and polynomials of it.
//!
//! A control loop's `sin` and `cos` cost more than the arithmetic of a joint. These have no table and no branch but the
//! one for angles that no joint has.

use crate::write::number;

/// Quarter turns of a radian, 2/π.
const PER_RAD: f64 = std::f64::consts::FRAC_2_PI;
/// π/2 in three parts. The first two have 33 bits, so that their products with a whole number below 2²⁰ are exact.
const QUARTER: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_795_950_6e-21,
];
/// sin r = r + r³ P(r²), the polynomial of least error on |r| ≤ π/4 (Remez's algorithm, 60 digits): 4e-18.
const SINE: [f64; 6] = [
    -0.166_666_666_666_666_32,
    0.008_333_333_333_322_564,
    -0.000_198_412_698_299_081_94,
    2.755_731_372_221_273e-6,
    -2.505_076_236_437_412_6e-8,
    1.589_702_081_760_587_4e-10,
];
/// cos r = 1 − r²/2 + r⁴ P(r²), likewise: 6e-20.
const COSINE: [f64; 6] = [
    0.041_666_666_666_666_616,
    -0.001_388_888_888_887_614_8,
    2.480_158_729_058_598e-5,
    -2.755_731_463_717_614_4e-7,
    2.087_575_849_405_784_7e-9,
    -1.136_132_657_186_036_9e-11,
];

/// A polynomial of `z`, by Horner's scheme.
fn horner(coefficients: &[f64]) -> String {
    let (last, rest) = coefficients.split_last().unwrap_or((&0.0, &[]));
    let inner = number(*last);
    (rest.iter().rev()).fold(inner, |inner, c| format!("{} + z * ({inner})", number(*c)))
}

/// Puts the numbers into a text.
pub(crate) fn filled(text: &str) -> String {
    let [p0, p1, p2] = QUARTER.map(number);
    text.replace("@PER_RAD@", &number(PER_RAD))
        .replace("@P0@", &p0)
        .replace("@P1@", &p1)
        .replace("@P2@", &p2)
        .replace("@SINE@", &horner(&SINE))
        .replace("@COSINE@", &horner(&COSINE))
}
