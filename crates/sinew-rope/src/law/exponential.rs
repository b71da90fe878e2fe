//! `exp` at the price a year of one-minute steps can pay.

/// Bound to which inputs are clamped: `exp(±700)` is 1e±304, which exceeds every rate.
const RANGE: f64 = 700.0;
/// Adding it leaves the nearest integer in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0; // 1.5 · 2^52
/// ln 2 in two parts; the first has zeros at its end, so that its multiples are exact.
const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// `e^x` to 2 units in the last place for `|x| ≤ 700`, beyond that the value at ±700.
///
/// `x = k/64 ln 2 + r` with `|r| ≤ ln 2/128`, a Taylor polynomial of degree 5 for `e^r` (its
/// remainder is 4e-17), `2^(k/64)` from a table and by its bits. A quarter of the time of
/// `libm::exp`.
///
/// # Realtime
/// No allocation, lock, panic or clock; no branch.
#[inline]
pub(super) fn exp(x: f64) -> f64 {
    let x = x.clamp(-RANGE, RANGE);
    let shifted = x * (PARTS as f64 * core::f64::consts::LOG2_E) + ROUNDER;
    let parts = shifted - ROUNDER;
    let r = (x - parts * (LN2_HIGH / PARTS as f64)) - parts * (LN2_LOW / PARTS as f64);
    let r2 = r * r;
    let tail = (1.0 / 2.0 + r * (1.0 / 6.0)) + r2 * (1.0 / 24.0 + r * (1.0 / 120.0));
    // The sum's low bits are `k`.
    let k = shifted.to_bits();
    let root = ROOTS[(k % PARTS) as usize];
    // Whole powers of two: the sign's bits fall off the end.
    let power = f64::from_bits(root.to_bits().wrapping_add((k / PARTS) << 52));
    power + power * (r + r2 * tail)
}

/// Parts of an octave.
const PARTS: u64 = 64;

/// Table of `2^(i/64)`.
#[rustfmt::skip]
const ROOTS: [f64; PARTS as usize] = [
    1.0,
    1.010_889_286_051_700_5,
    1.021_897_148_654_116_6,
    1.033_024_879_021_228_4,
    1.044_273_782_427_413_8,
    1.055_645_178_360_557_2,
    1.067_140_400_676_823_7,
    1.078_760_797_757_119_9,
    1.090_507_732_665_257_7,
    1.102_382_583_307_841,
    1.114_386_742_595_892_4,
    1.126_521_618_608_241_8,
    1.138_788_634_756_691_6,
    1.151_189_229_952_982_7,
    1.163_724_858_777_577_5,
    1.176_396_991_650_281_2,
    1.189_207_115_002_721,
    1.202_156_731_452_703,
    1.215_247_359_980_469,
    1.228_480_536_106_87,
    1.241_857_812_073_484,
    1.255_380_757_024_691,
    1.269_050_957_191_733_2,
    1.282_870_016_078_778_3,
    1.296_839_554_651_009_6,
    1.310_961_211_524_764_4,
    1.325_236_643_159_741_3,
    1.339_667_524_053_303,
    1.354_255_546_936_892_7,
    1.369_002_422_974_590_5,
    1.383_909_881_963_832,
    1.398_979_672_538_311_2,
    core::f64::consts::SQRT_2,
    1.429_613_338_391_97,
    1.445_180_806_977_046_7,
    1.460_917_794_180_647,
    1.476_826_145_939_499_3,
    1.492_907_728_291_264_8,
    1.509_164_427_593_422_8,
    1.525_598_150_744_538_4,
    1.542_210_825_407_940_7,
    1.559_004_400_237_837,
    1.575_980_845_107_886_5,
    1.593_142_151_342_267,
    1.610_490_331_949_254_3,
    1.628_027_421_857_347_8,
    1.645_755_478_153_965,
    1.663_676_580_326_736_4,
    1.681_792_830_507_429,
    1.700_106_353_718_523_5,
    1.718_619_298_122_478,
    1.737_333_835_273_706_2,
    1.756_252_160_373_299_5,
    1.775_376_492_526_521_2,
    1.794_709_075_003_107_2,
    1.814_252_175_500_398_9,
    1.834_008_086_409_342_4,
    1.853_979_125_083_385_5,
    1.874_167_634_110_3,
    1.894_575_981_586_965_6,
    1.915_206_561_397_147_4,
    1.936_061_793_492_294_3,
    1.957_144_124_175_400_2,
    1.978_456_026_387_951,
];

#[cfg(test)]
mod tests {
    use super::exp;

    #[test]
    fn agrees_with_libm_to_two_units() {
        for i in -699_000..699_000 {
            let x = f64::from(i) * 1.000_37e-3;
            let expected = libm::exp(x);
            assert!(
                (exp(x) / expected - 1.0).abs() <= 2.0 * f64::EPSILON,
                "{x}: {} {expected}",
                exp(x)
            );
        }
        for x in [-1e-300, -1e-17, -1e-9, 1e-9, 1e-5, -0.34657359, 0.34657360] {
            assert!((exp(x) - libm::exp(x)).abs() <= 2.0 * f64::EPSILON, "{x}");
        }
    }

    #[test]
    fn ends_where_it_must() {
        assert_eq!(exp(0.0), 1.0);
        assert!(exp(-1e9) > 0.0 && exp(-1e9) < 1e-300);
        assert!(exp(1e9).is_finite());
        assert!(exp(f64::NAN).is_nan());
    }
}
