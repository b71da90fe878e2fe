//! Sine and cosine as code: a rest of at most half a quarter turn, and the polynomials of it that the library has.
//!
//! A control loop's `sin` and `cos` cost more than the arithmetic of a joint. These have no table and no branch but the
//! one for angles that no joint has.

use crate::write::number;
use sinew_model::sines::{COSINE, SINE};

/// Quarter turns of a radian, 2/π.
const PER_RAD: f64 = std::f64::consts::FRAC_2_PI;
/// π/2 in three parts. The first two have 33 bits, so that their products with a whole number below 2²⁰ are exact.
const QUARTER: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_795_950_6e-21,
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
