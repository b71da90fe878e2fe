//! Factors of one step: Arrhenius factors, and responses of first-order lags.

use super::exponential::exp;
use super::{DELAY_TIMES_S, GAS_CONSTANT, REFERENCE_K};

/// Temperature in the form of the Arrhenius factors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heat {
    /// `(1/T_ref − 1/θ)/R`, mol/J.
    per_energy: f64,
}

impl Heat {
    pub(super) fn new(temperature_k: f64) -> Self {
        Self {
            per_energy: (1.0 / REFERENCE_K - 1.0 / temperature_k) * (1.0 / GAS_CONSTANT),
        }
    }

    /// `E/R (1/T_ref − 1/θ)`.
    pub(super) fn exponent(self, energy_j_per_mol: f64) -> f64 {
        energy_j_per_mol * self.per_energy
    }

    /// `exp[E/R (1/T_ref − 1/θ)]`.
    pub(super) fn speed_up(self, energy_j_per_mol: f64) -> f64 {
        exp(self.exponent(energy_j_per_mol))
    }
}

/// `sinh x` for `x ≥ 0` and its `e^x`; the series keeps full accuracy where the exponentials would
/// cancel.
pub(super) fn sinh(x: f64, e: f64) -> f64 {
    if x < 0.3 {
        let s = x * x;
        let high = 1.0 / 5040.0 + s * (1.0 / 362_880.0 + s * (1.0 / 39_916_800.0));
        x * (1.0 + s * (1.0 / 6.0 + s * (1.0 / 120.0 + s * high)))
    } else {
        0.5 * (e - 1.0 / e)
    }
}

/// Response `1 − exp(−x)` of a first-order lag for `x ≥ 0`.
pub(super) fn closed(x: f64) -> f64 {
    let [closed] = closings([x]);
    closed
}

/// Computes `1 − exp(−x)` of each input, all `≥ 0`, to a few units in the last place.
///
/// Below 0.03 a Taylor series (the ninth term is below 1e-17 of the first), because the
/// difference would cancel; several times faster than a general `expm1`.
pub(super) fn closings<const N: usize>(x: [f64; N]) -> [f64; N] {
    let series = |x: f64| {
        let high = 1.0 / 120.0 - x * (1.0 / 720.0 - x * (1.0 / 5040.0 - x * (1.0 / 40320.0)));
        x * (1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * high))))
    };
    let mut out = x.map(|x| exp(-x));
    for (out, x) in out.iter_mut().zip(x) {
        *out = if x < 0.03 { series(x) } else { 1.0 - *out };
    }
    out
}

/// `1 − exp(−a_v t/τ_i)` for the five decades.
///
/// The times are exact decades, so a factor is the tenth power of the next slower one;
/// `m ↦ (1 + m)² − 1 = m (2 + m)` keeps full relative accuracy near 0. Three independent exponentials and two such
/// powers are faster than five exponentials or one.
pub(super) fn delayed_fractions(speed_times_s: f64) -> [f64; 5] {
    const PER_S: [f64; 3] = [
        1.0 / DELAY_TIMES_S[0],
        1.0 / DELAY_TIMES_S[2],
        1.0 / DELAY_TIMES_S[4],
    ];
    let ten_times = |fraction: f64| {
        let m = -fraction;
        let p2 = m * (2.0 + m);
        let p4 = p2 * (2.0 + p2);
        let p8 = p4 * (2.0 + p4);
        -(p8 + p2 + p8 * p2)
    };
    let [tens, thousands, slowest] = closings(PER_S.map(|per_s| speed_times_s * per_s));
    [
        tens,
        ten_times(thousands),
        thousands,
        ten_times(slowest),
        slowest,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_exponentials_are_one_hyperbolic_sine() {
        for k in 1..4000 {
            let x = 0.005 * f64::from(k);
            let expected = libm::sinh(x);
            let found = sinh(x, libm::exp(x));
            assert!((found / expected - 1.0).abs() < 1e-14, "{x}: {found}");
        }
        assert_eq!(sinh(0.0, 1.0), 0.0);
    }
}
