//! Quantiles of the normal and of Student's distribution.

/// Quantile of the standard normal distribution, to 1e-9.
///
/// # Source
/// P. J. Acklam's rational approximation (1.2e-9 relative), with one step of Newton's method on
/// `libm::erfc`.
pub(super) fn normal_quantile(p: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969_683_028_665_376e1,
        2.209_460_984_245_205e2,
        -2.759_285_104_469_687e2,
        1.383_577_518_672_69e2,
        -3.066_479_806_614_716e1,
        2.506_628_277_459_239,
    ];
    const B: [f64; 5] = [
        -5.447_609_879_822_406e1,
        1.615_858_368_580_409e2,
        -1.556_989_798_598_866e2,
        6.680_131_188_771_972e1,
        -1.328_068_155_288_572e1,
    ];
    const C: [f64; 6] = [
        -7.784_894_002_430_293e-3,
        -3.223_964_580_411_365e-1,
        -2.400_758_277_161_838,
        -2.549_732_539_343_734,
        4.374_664_141_464_968,
        2.938_163_982_698_783,
    ];
    const D: [f64; 4] = [
        7.784_695_709_041_462e-3,
        3.224_671_290_700_398e-1,
        2.445_134_137_142_996,
        3.754_408_661_907_416,
    ];
    let series = |c: &[f64], x: f64| c.iter().fold(0.0, |sum, c| sum * x + c);
    let tail = |p: f64| {
        let q = (-2.0 * p.ln()).sqrt();
        series(&C, q) / (series(&D, q) * q + 1.0)
    };
    const EDGE: f64 = 0.024_25;
    let rough = if p < EDGE {
        tail(p)
    } else if p > 1.0 - EDGE {
        -tail(1.0 - p)
    } else {
        let q = p - 0.5;
        let r = q * q;
        series(&A, r) * q / (series(&B, r) * r + 1.0)
    };
    let below = normal_share(rough);
    let density = (-0.5 * rough * rough).exp() / (2.0 * std::f64::consts::PI).sqrt();
    rough - (below - p) / density
}

/// Share of the standard normal distribution below `z`.
pub(super) fn normal_share(z: f64) -> f64 {
    0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

/// Two-sided quantile of Student's distribution: `P(|t| ≤ q) = level`.
///
/// One and two degrees of freedom in closed form, more by Hill's expansion (some 1e-4 at three,
/// better above).
///
/// # Source
/// G. W. Hill, Algorithm 396, Comm. ACM 13 (1970).
pub(super) fn student_quantile(freedom: f64, level: f64) -> f64 {
    let p = 1.0 - level;
    let half_pi = std::f64::consts::FRAC_PI_2;
    if freedom.is_nan() || freedom < 0.999 {
        return f64::NAN;
    }
    if freedom < 1.5 {
        return 1.0 / (p * half_pi).tan();
    }
    if freedom < 2.5 {
        return (2.0 / (p * (2.0 - p)) - 2.0).sqrt();
    }
    let n = freedom;
    let a = 1.0 / (n - 0.5);
    let b = 48.0 / (a * a);
    let mut c = ((20_700.0 * a / b - 98.0) * a - 16.0) * a + 96.36;
    let d = ((94.5 / (b + c) - 3.0) / b + 1.0) * (a * half_pi).sqrt() * n;
    let mut y = (d * p).powf(2.0 / n);
    if y > a + 0.05 {
        let mut x = normal_quantile(0.5 * p);
        y = x * x;
        if n < 5.0 {
            c += 0.3 * (n - 4.5) * (x + 0.6);
        }
        c += (((0.05 * d * x - 5.0) * x - 7.0) * x - 2.0) * x + b;
        y = (((((0.4 * y + 6.3) * y + 36.0) * y + 94.5) / c - y - 3.0) / b + 1.0) * x;
        x = a * y * y;
        y = x.exp_m1();
    } else {
        y = ((1.0 / (((n + 6.0) / (n * y) - 0.089 * d - 0.822) * (n + 2.0) * 3.0)
            + 0.5 / (n + 4.0))
            * y
            - 1.0)
            * (n + 1.0)
            / (n + 2.0)
            + 1.0 / y;
    }
    (n * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Abramowitz and Stegun, tables 26.5 and 26.10.
        for (p, z) in [
            (0.975, 1.959_963_985),
            (0.995, 2.575_829_304),
            (0.5, 0.0),
            (0.001, -3.090_232_306),
        ] {
            assert!((normal_quantile(p) - z).abs() < 1e-8, "{p}");
        }
        for (n, t95, t99) in [
            (1.0, 12.706_2, 63.656_7),
            (2.0, 4.302_7, 9.924_8),
            (3.0, 3.182_4, 5.840_9),
            (4.0, 2.776_4, 4.604_1),
            (5.0, 2.570_6, 4.032_1),
            (10.0, 2.228_1, 3.169_3),
            (30.0, 2.042_3, 2.750_0),
            (120.0, 1.979_9, 2.617_4),
        ] {
            let (a, b) = (student_quantile(n, 0.95), student_quantile(n, 0.99));
            assert!((a / t95 - 1.0).abs() < 3e-4, "{n}: {a} {t95}");
            assert!((b / t99 - 1.0).abs() < 3e-4, "{n}: {b} {t99}");
        }
    }
}
