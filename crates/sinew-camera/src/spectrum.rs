//! Power spectra of short sections of a strip.

use super::strips::hann;
use std::f64::consts::TAU;

/// Fourier transform of a fixed power-of-two length with a Hann window.
#[derive(Debug, Clone)]
pub(crate) struct Spectrum {
    window: Vec<f64>,
    twiddles: Vec<(f64, f64)>,
}

impl Spectrum {
    /// Creates a transform; `length` must be a power of two of at least 4.
    pub(crate) fn new(length: usize) -> Self {
        debug_assert!(length.is_power_of_two() && length >= 4);
        let turn = |k| (-TAU * k as f64 / length as f64).sin_cos();
        Self {
            window: hann(length),
            twiddles: (0..length / 2).map(turn).collect(),
        }
    }

    /// Returns the mean level, and squared amplitudes (of a cosine: amplitude²) up to half the sampling frequency. The
    /// linear trend is removed first.
    pub(crate) fn of(&self, levels: &[f32]) -> (f64, Vec<f64>) {
        let n = self.window.len();
        let half = n as f64 / 2.0;
        let sum = |part: &[f32]| part.iter().map(|v| f64::from(*v)).sum::<f64>();
        let (left, right) = (sum(&levels[..n / 2]) / half, sum(&levels[n / 2..n]) / half);
        let (mean, slope) = ((left + right) / 2.0, (right - left) / half);
        let level = levels.iter().zip(&self.window).enumerate();
        let level = level.map(|(i, (level, weight))| {
            let line = mean + slope * (i as f64 + 0.5 - half);
            ((f64::from(*level) - line) * weight, 0.0)
        });
        // The sum of the Hann window is n/2; the power of a cosine is shared with its mirror image.
        let scale = (2.0 / half).powi(2);
        let bins = self.transform(level.collect(), 1);
        let power = bins[..n / 2]
            .iter()
            .map(|(re, im)| (re * re + im * im) * scale);
        (mean, power.collect())
    }

    /// Radix-2 step: combines the transforms of every second value. `stride` twiddles lie between two of this length.
    fn transform(&self, values: Vec<(f64, f64)>, stride: usize) -> Vec<(f64, f64)> {
        if values.len() == 1 {
            return values;
        }
        let every_second = |from: usize| values[from..].iter().step_by(2).copied().collect();
        let even_terms = self.transform(every_second(0), 2 * stride);
        let odd_terms = self.transform(every_second(1), 2 * stride);
        let turns = self.twiddles.iter().step_by(stride);
        let turned = odd_terms.iter().zip(turns);
        let turned =
            turned.map(|((re, im), (sin, cos))| (re * cos - im * sin, re * sin + im * cos));
        let pairs: Vec<_> = even_terms.into_iter().zip(turned).collect();
        let sums = pairs.iter().map(|(a, b)| (a.0 + b.0, a.1 + b.1));
        let differences = pairs.iter().map(|(a, b)| (a.0 - b.0, a.1 - b.1));
        sums.chain(differences).collect()
    }
}

/// Returns the position of a peak between bins from the three powers around bin `k`: for a Hann window the ratio of
/// neighbouring amplitudes is a rational function of the position.
pub(crate) fn between_bins(power: &[f64], k: usize) -> f64 {
    let amplitude = |i: usize| power[i].sqrt();
    let (left, here, right) = (amplitude(k - 1), amplitude(k), amplitude(k + 1));
    let (side, sign) = if right > left {
        (right, 1.0)
    } else {
        (left, -1.0)
    };
    let shift = (2.0 * side - here) / (side + here).max(f64::MIN_POSITIVE);
    k as f64 + sign * shift.clamp(0.0, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spectrum_cosine_with_trend_has_one_peak() {
        let cycles = 25.3;
        let levels: Vec<f32> = (0..256)
            .map(|i| {
                let x = f64::from(i);
                (0.5 + 0.001 * x + 0.1 * (TAU * cycles * x / 256.0 + 0.7).cos()) as f32
            })
            .collect();
        let (mean, power) = Spectrum::new(256).of(&levels);
        assert!((mean - 0.6275).abs() < 2e-3, "{mean}");
        let peak = (1..127).max_by(|a, b| power[*a].total_cmp(&power[*b]));
        assert_eq!(peak, Some(25));
        let place = between_bins(&power, 25);
        assert!((place - cycles).abs() < 0.01, "{place}");
        // At an offset of 0.3 bins, a Hann window passes 0.94 of the amplitude.
        assert!((power[25].sqrt() - 0.1 * 0.94).abs() < 2e-3);
        assert!(power[60].sqrt() < 1e-4);
    }
}
