//! Quantiles of the normal and of Student's distribution.

/// Quantile of the standard normal distribution, to rounding.
///
/// Newton's method for the logarithm of the share, which is concave, so that it converges from one
/// side.
pub(super) fn normal_quantile(p: f64) -> f64 {
    /// Maximum number of steps: a tail of 1e-300 needs a dozen.
    const STEPS: usize = 30;
    if p > 0.5 {
        return -normal_quantile(1.0 - p);
    }
    let mut z = 0.0_f64;
    for _ in 0..STEPS {
        let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let share = normal_share(z);
        let step = (p / share).ln() * share / density;
        z += step;
        if step.abs() < 1e-14 {
            break;
        }
    }
    z
}

/// Share of the standard normal distribution below `z`.
pub(super) fn normal_share(z: f64) -> f64 {
    0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

/// Two-sided quantile of Student's distribution with integer degrees of freedom: `P(|t| ≤ q) =
/// level`. NaN below one.
///
/// Bisection of the angle `atan(t/√ν)`.
pub(super) fn student_quantile(freedom: f64, level: f64) -> f64 {
    /// Number of bisections of a right angle to rounding.
    const HALVINGS: usize = 60;
    if !(freedom >= 1.0) {
        return f64::NAN;
    }
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if student_share(freedom as usize, middle) < level {
            low = middle;
        } else {
            high = middle;
        }
    }
    freedom.sqrt() * low.tan()
}

/// Evaluates `P(|t| ≤ √ν tan angle)`.
///
/// # Source
/// M. Abramowitz, I. A. Stegun, *Handbook of Mathematical Functions*, 1964, 26.7.3 and 26.7.4.
fn student_share(freedom: usize, angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let remainder = freedom % 2;
    let mut term = if remainder == 1 { cos } else { 1.0 };
    let mut sum = 0.0;
    for k in (remainder + 2..=freedom).step_by(2) {
        sum += term;
        term *= (k as f64 - 1.0) / k as f64 * cos * cos;
    }
    match remainder {
        1 => std::f64::consts::FRAC_2_PI * (angle + sin * sum),
        _ => sin * sum,
    }
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
