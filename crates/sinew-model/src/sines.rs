//! Sines and cosines of several angles, side by side.

/// Maximum angle for an exact range reduction by quarter turns, rad: 160,000 turns.
const LARGEST: f64 = 1e6;
/// Adding it leaves the nearest integer in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0; // 1.5 · 2^52
/// First of two parts of π/2; its trailing bits are zero, so that its multiples are exact.
const QUARTER_HIGH: f64 = 1.570_796_326_734_125_6;
const QUARTER_LOW: f64 = 6.077_100_506_506_192e-11;
/// sin r = r + r³ P(r²), the polynomial of least error on |r| ≤ π/4 (Remez's algorithm, 60 digits): 4e-18.
pub const SINE: [f64; 6] = [
    -0.166_666_666_666_666_32,
    0.008_333_333_333_322_564,
    -0.000_198_412_698_299_081_94,
    2.755_731_372_221_273e-6,
    -2.505_076_236_437_412_6e-8,
    1.589_702_081_760_587_4e-10,
];
/// cos r = 1 − r²/2 + r⁴ P(r²), likewise: 6e-20.
pub const COSINE: [f64; 6] = [
    0.041_666_666_666_666_616,
    -0.001_388_888_888_887_614_8,
    2.480_158_729_058_598e-5,
    -2.755_731_463_717_614_4e-7,
    2.087_575_849_405_784_7e-9,
    -1.136_132_657_186_036_9e-11,
];

/// Sine and cosine of every angle, rad, to 2.3e-16; slices are of one length.
///
/// No branch if all angles are within 10⁶ rad, so that the compiler computes them in vector registers. Larger and
/// non-finite angles use `libm`, whose calls are sequential and slow down the pass over an arm.
///
/// # Realtime
/// No allocation, lock, panic or clock.
///
/// # Source
/// Range reduction by quarter turns in parts, after W. J. Cody and W. Waite, *Software Manual for the Elementary
/// Functions*, 1980.
pub(crate) fn sin_cos(angles: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
    let all = angles.iter().zip(sines.iter_mut()).zip(cosines.iter_mut());
    if angles.iter().map(|x| x.abs()).sum::<f64>() <= LARGEST {
        for ((x, sin), cos) in all {
            (*sin, *cos) = within_range(*x);
        }
    } else {
        for ((x, sin), cos) in all {
            (*sin, *cos) = libm::sincos(*x);
        }
    }
}

/// Computes sine and cosine of one angle within ±[`LARGEST`].
#[inline(always)]
fn within_range(x: f64) -> (f64, f64) {
    let shifted = x * core::f64::consts::FRAC_2_PI + ROUNDER;
    let quarters = shifted - ROUNDER;
    // The sum's low bits are how many quarter turns.
    let quadrant = shifted.to_bits();
    let high = x - quarters * QUARTER_HIGH;
    let low = quarters * QUARTER_LOW;
    let y = high - low;
    // What rounding took from `y`.
    let rest = (high - y) - low;

    let z = y * y;
    let z2 = z * z;
    let [s1, s2, s3, s4, s5, s6] = SINE;
    let tail = (s2 + z * (s3 + z * s4)) + z * z2 * (s5 + z * s6);
    let s = y + (rest + y * z * (s1 + z * tail));

    let [c1, c2, c3, c4, c5, c6] = COSINE;
    let tail = z * (c1 + z * (c2 + z * c3)) + z2 * z2 * (c4 + z * (c5 + z * c6));
    let half = 0.5 * z;
    let near = 1.0 - half;
    let c = near + (((1.0 - near) - half) + (z * tail - y * rest));

    // Sine and cosine are swapped in every second quadrant, and negative according to their sign bit.
    let swapped = (quadrant & 1).wrapping_neg();
    let (s, c) = (s.to_bits(), c.to_bits());
    let differ = (s ^ c) & swapped;
    let minus = |quadrant: u64| (quadrant & 2) << 62;
    (
        f64::from_bits(s ^ differ ^ minus(quadrant)),
        f64::from_bits(c ^ differ ^ minus(quadrant.wrapping_add(1))),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use alloc::vec::Vec;

    fn of(angles: &[f64]) -> Vec<(f64, f64)> {
        let (mut sines, mut cosines) = (vec![0.0; angles.len()], vec![0.0; angles.len()]);
        sin_cos(angles, &mut sines, &mut cosines);
        sines.into_iter().zip(cosines).collect()
    }

    /// Returns the largest difference from `libm`, for each angle as one of several.
    fn worst(angles: impl Iterator<Item = f64>) -> f64 {
        let mut worst = 0.0_f64;
        for x in angles {
            let some = [x, -0.3 * x, 3.0];
            for (angle, (sin, cos)) in some.into_iter().zip(of(&some)) {
                let (s, c) = libm::sincos(angle);
                worst = worst.max((sin - s).abs()).max((cos - c).abs());
            }
        }
        worst
    }

    #[test]
    fn they_are_those_of_libm() {
        let near = worst((0..400_000).map(|i| 1.000_37e-4 * f64::from(i)));
        assert!(near <= 2.3e-16, "{near}");
        // Quarter turns and their neighbours, and as far as it goes.
        let quarters = worst((0..60_000).flat_map(|i| {
            let x = core::f64::consts::FRAC_PI_2 * f64::from(i);
            [
                x,
                x.next_up(),
                x.next_down(),
                x + core::f64::consts::FRAC_PI_4,
            ]
        }));
        assert!(quarters <= 2.3e-16, "{quarters}");
        let far = worst((1..200_000).map(|i| 0.75 * LARGEST - 0.123_457 * f64::from(i)));
        assert!(far <= 2.3e-16, "{far}");
    }

    #[test]
    fn angles_beyond_limit_use_libm() {
        let angles = [1e22, 0.5, -1e7, LARGEST];
        assert_eq!(of(&angles), angles.map(libm::sincos));
        let [(sin, cos), (one, _)] = of(&[f64::NAN, 1.0])[..] else {
            panic!("two were asked for");
        };
        assert!(sin.is_nan() && cos.is_nan() && one == libm::sin(1.0));
        assert_eq!(of(&[0.0, -0.0]), [(0.0, 1.0); 2]);
    }
}
