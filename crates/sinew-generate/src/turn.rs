//! Code for sine and cosine: range reduction to at most an eighth of a turn, and the polynomials of the library.
//!
//! The `sin` and `cos` of a control loop take longer than the arithmetic of a joint. The generated functions have no
//! table and only one branch, for angles beyond the range of joints.

use crate::Precision;
use crate::write::number;
use sinew_model::sines::{COSINE, SINE};

/// Quarter turns of a radian, 2/π.
const PER_RAD: f64 = std::f64::consts::FRAC_2_PI;

/// Constants of the range reduction in one precision.
struct Reduction {
    /// π/2 in three parts. The first two end in enough zero bits that their products with up to `far` quarter turns are
    /// exact.
    quarter: [f64; 3],
    /// Beyond this angle, rad, the library computes sine and cosine.
    far: f64,
    /// A number of this size has no room for a fraction: adding it rounds.
    rounding: f64,
    /// From the second bit of the quarter to the sign.
    shift: u8,
}

const fn reduction(precision: Precision) -> Reduction {
    match precision {
        Precision::Double => Reduction {
            quarter: [
                1.570_796_326_734_125_6,
                6.077_100_506_303_966e-11,
                2.022_266_248_795_950_6e-21,
            ],
            far: 1e5,
            rounding: 6_755_399_441_055_744.0, // 1.5 · 2^52
            shift: 62,
        },
        Precision::Single => Reduction {
            quarter: [
                1.570_312_5,
                4.837_512_969_970_703e-4,
                7.549_789_954_891_88e-8,
            ],
            far: 1e4,
            rounding: 12_582_912.0, // 1.5 · 2^23
            shift: 30,
        },
    }
}

/// A polynomial of `z`, by Horner's scheme.
fn horner(coefficients: &[f64]) -> String {
    let (last, rest) = coefficients.split_last().unwrap_or((&0.0, &[]));
    let inner = number(*last);
    (rest.iter().rev()).fold(inner, |inner, c| format!("{} + z * ({inner})", number(*c)))
}

/// Puts the numbers into a text.
pub(crate) fn filled(text: &str, precision: Precision) -> String {
    let reduction = reduction(precision);
    let [p0, p1, p2] = reduction.quarter.map(number);
    text.replace("@PER_RAD@", &number(PER_RAD))
        .replace("@P0@", &p0)
        .replace("@P1@", &p1)
        .replace("@P2@", &p2)
        .replace("@FAR@", &number(reduction.far))
        .replace("@ROUNDING@", &number(reduction.rounding))
        .replace("@SHIFT@", &reduction.shift.to_string())
        .replace("@SINE@", &horner(&SINE))
        .replace("@COSINE@", &horner(&COSINE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn quarter_turn_parts_sum_and_multiples_are_exact() {
        let [p0, p1, p2] = reduction(Precision::Double).quarter;
        assert_eq!(p0 + (p1 + p2), FRAC_PI_2);
        let single = reduction(Precision::Single);
        let [p0, p1, p2] = single.quarter.map(|part| part as f32);
        let sum = f64::from(p0) + f64::from(p1) + f64::from(p2);
        assert!((sum - FRAC_PI_2).abs() < 1e-14, "{sum}");
        for part in [p0, p1] {
            let most = (single.far / FRAC_PI_2).ceil() as u16;
            for quarters in [most, most - 1, most / 2 + 1] {
                let product = f32::from(quarters) * part;
                assert_eq!(f64::from(product), f64::from(quarters) * f64::from(part));
            }
        }
    }
}
