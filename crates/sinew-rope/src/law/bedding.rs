//! Irreversible bedding-in under constant load, in closed form.
//!
//! `ḃ = c ⟨b∞ − b⟩₊ exp(−κ b/B')`. With `u = κ (b∞ − b)/B'` and `z = −ln(u/u₀)`:
//!
//! ```text
//! dz/ds = exp(u₀ e^(−z)),   s = c t exp(−κ b∞/B')
//! z − [Ein(u₀) − Ein(u₀ e^(−z))] = s,        b(t) = b + (b∞ − b)(1 − e^(−z))
//! ```
//!
//! `Ein(u) = ∫₀ᵘ (1 − e^(−x))/x dx` is the entire exponential integral. Because the solution is
//! exact, two steps of half the length equal one full step, and `b` neither decreases nor exceeds `b∞`.

use super::exponential::exp;

/// Largest jamming exponent `κ` taken: at 30 the last of the bedding-in runs 10¹³ times slower
/// than the first.
pub const JAMMING_MAX: f64 = 30.0;

const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;

/// `Ein(u) = ∫₀ᵘ (1 − e^(−x))/x dx` for `u ≥ 0`, to a few units in the last place.
///
/// Power series below 2 (terms at most 1, so nothing cancels), continued fraction of `E₁` above.
///
/// # Realtime
/// No allocation, lock, panic or clock.
///
/// # Source
/// Abramowitz and Stegun, *Handbook of Mathematical Functions*, 5.1.11 and 5.1.22.
#[must_use]
pub fn ein(u: f64) -> f64 {
    if u < 2.0 {
        // Ein(u) = Σ (−1)^(k+1) u^k/(k·k!)
        let mut power = u;
        let mut sum = u;
        for k in 2..40 {
            let k = f64::from(k);
            power *= -u / k;
            let term = power / k;
            sum += term;
            if term.abs() < 1e-17 * sum {
                break;
            }
        }
        return sum;
    }
    // E₁(u) = e^(−u)/(u + 1 − 1/(u + 3 − 4/(u + 5 − …))), by Lentz's method.
    let mut b = u + 1.0;
    let mut c = f64::INFINITY;
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..200 {
        let i = f64::from(i);
        let a = -i * i;
        b += 2.0;
        d = 1.0 / (a * d + b);
        c = b + a / c;
        let factor = c * d;
        h *= factor;
        if (factor - 1.0).abs() < 1e-16 {
            break;
        }
    }
    h * exp(-u) + libm::log(u) + EULER_GAMMA
}

/// Share of the gap `b∞ − b` that closes: `1 − e^(−z)`.
///
/// * `u`: `κ (b∞ − b)/B'`, 0 to [`JAMMING_MAX`]. `p`: `c t exp(−κ b/B')`, the rate at the start
///   times the duration, at least 0 (`p = s e^u`).
/// * Returns 0 to 1.
///
/// # Realtime
/// No allocation, lock, panic or clock; at most 60 Newton steps (in practice 2 to 5).
#[must_use]
pub fn closed_fraction(u: f64, p: f64) -> f64 {
    if p * (1.0 + u) < 2e-3 {
        // Taylor series of z about s = 0; the sixth term is below 1e-16.
        let z = p
            * (1.0
                + p * (-u / 2.0
                    + p * (u * (1.0 + 2.0 * u) / 6.0
                        + p * (-u * (1.0 + u * (7.0 + 6.0 * u)) / 24.0
                            + p * (u * (1.0 + u * (18.0 + u * (46.0 + 24.0 * u))) / 120.0)))));
        return -libm::expm1(-z);
    }
    let s = p * exp(-u);
    let ein_u = ein(u);
    // Both are above the root of a convex, rising function.
    let mut z = p.min(s + ein_u);
    for _ in 0..60 {
        if z > 800.0 {
            // e^(−z) is 0: the remaining gap is below the floating-point resolution.
            return 1.0;
        }
        let left = u * exp(-z);
        let g = z - (ein_u - ein(left)) - s;
        // g' = e^(−left), g'' = left·g': Halley's step.
        let newton = g * exp(left);
        let step = newton / (1.0 - 0.5 * newton * left).max(0.5);
        z -= step;
        if step.abs() <= 1e-14 * (1.0 + z) {
            break;
        }
    }
    -libm::expm1(-z.max(0.0))
}
