//! Sines and cosines of several angles, side by side.

/// Up to here, rad, quarter turns are taken off without error: 160,000 turns.
const LARGEST: f64 = 1e6;
/// Adding it leaves the nearest integer in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0; // 1.5 · 2^52
/// π/2 in two parts: the first has so many zeros at its end that its multiples are exact.
const QUARTER_HIGH: f64 = 1.570_796_326_734_125_6;
const QUARTER_LOW: f64 = 6.077_100_506_506_192e-11;

/// Sine and cosine of every angle, rad, to 2.3e-16; slices are of one length.
///
/// No branch where angles are within 10⁶ rad together, so that the compiler computes them in vector registers. Beyond that,
/// and of what is no number, `libm`'s: it waits for one to ask for the next, and a pass over an arm waits with it.
///
/// # Realtime
/// No allocation, lock, panic or clock.
///
/// # Source
/// Polynomials and reduction are those of FreeBSD's msun (`k_sin.c`, `k_cos.c`, `e_rem_pio2.c`).
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

/// Of one angle within ±[`LARGEST`].
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
    let tail = (8.333_333_333_322_49e-3
        + z * (-1.984_126_982_985_795e-4 + z * 2.755_731_370_707_006_8e-6))
        + z * z2 * (-2.505_076_025_340_686_3e-8 + z * 1.589_690_995_211_55e-10);
    let s = y + (rest + y * z * (-1.666_666_666_666_663_2e-1 + z * tail));

    let tail = z
        * (4.166_666_666_666_66e-2
            + z * (-1.388_888_888_887_411e-3 + z * 2.480_158_728_947_673e-5))
        + z2 * z2
            * (-2.755_731_435_139_066_3e-7
                + z * (2.087_572_321_298_175e-9 + z * -1.135_964_755_778_819_5e-11));
    let half = 0.5 * z;
    let near = 1.0 - half;
    let c = near + (((1.0 - near) - half) + (z * tail - y * rest));

    // Swapped in every second quadrant, and negative where their bit says so.
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

    /// Largest difference from `libm`, of each angle beside others.
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
    fn what_lies_beyond_is_left_to_libm() {
        let angles = [1e22, 0.5, -1e7, LARGEST];
        assert_eq!(of(&angles), angles.map(libm::sincos));
        let [(sin, cos), (one, _)] = of(&[f64::NAN, 1.0])[..] else {
            panic!("two were asked for");
        };
        assert!(sin.is_nan() && cos.is_nan() && one == libm::sin(1.0));
        assert_eq!(of(&[0.0, -0.0]), [(0.0, 1.0); 2]);
    }
}
