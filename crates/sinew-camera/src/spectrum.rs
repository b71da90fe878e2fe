//! Power spectra of short stretches of a strip.

use super::strips::hann;
use std::f64::consts::TAU;

/// Fourier transform of a fixed power-of-two length with a Hann window.
#[derive(Debug, Clone)]
pub(crate) struct Spectrum {
    length: usize,
    window: Vec<f64>,
    twiddles: Vec<(f64, f64)>,
    re: Vec<f64>,
    im: Vec<f64>,
    /// Power per bin, up to half the sampling frequency.
    pub(crate) power: Vec<f64>,
}

impl Spectrum {
    /// `length` must be a power of two of at least 4.
    pub(crate) fn new(length: usize) -> Self {
        debug_assert!(length.is_power_of_two() && length >= 4);
        Self {
            length,
            window: hann(length),
            twiddles: (0..length / 2)
                .map(|k| {
                    let (s, c) = (-TAU * k as f64 / length as f64).sin_cos();
                    (c, s)
                })
                .collect(),
            re: vec![0.0; length],
            im: vec![0.0; length],
            power: vec![0.0; length / 2],
        }
    }

    /// Fills [`power`](Self::power) with squared amplitudes (of a cosine: amplitude²) and returns
    /// the mean level. The straight line through the ends' halves is taken out first.
    pub(crate) fn of(&mut self, levels: &[f32]) -> f64 {
        let n = self.length;
        let half = n as f64 / 2.0;
        let sum = |part: &[f32]| part.iter().map(|v| f64::from(*v)).sum::<f64>();
        let (left, right) = (sum(&levels[..n / 2]) / half, sum(&levels[n / 2..n]) / half);
        let (mean, slope) = ((left + right) / 2.0, (right - left) / half);
        for i in 0..n {
            let line = mean + slope * (i as f64 + 0.5 - half);
            self.re[i] = (f64::from(levels[i]) - line) * self.window[i];
        }
        self.im.fill(0.0);
        self.transform();
        // The Hann window's sum is n/2; a cosine's power is shared with its mirror image.
        let scale = 2.0 / half;
        for (k, power) in self.power.iter_mut().enumerate() {
            *power = (self.re[k].powi(2) + self.im[k].powi(2)) * scale * scale;
        }
        mean
    }

    /// Iterative radix-2, in place.
    fn transform(&mut self) {
        let n = self.length;
        let shift = usize::BITS - n.trailing_zeros();
        for i in 0..n {
            let j = i.reverse_bits() >> shift;
            if i < j {
                self.re.swap(i, j);
                self.im.swap(i, j);
            }
        }
        let mut size = 2;
        while size <= n {
            let step = n / size;
            for start in (0..n).step_by(size) {
                for k in 0..size / 2 {
                    let (wr, wi) = self.twiddles[k * step];
                    let (a, b) = (start + k, start + k + size / 2);
                    let re = self.re[b] * wr - self.im[b] * wi;
                    let im = self.re[b] * wi + self.im[b] * wr;
                    self.re[b] = self.re[a] - re;
                    self.im[b] = self.im[a] - im;
                    self.re[a] += re;
                    self.im[a] += im;
                }
            }
            size *= 2;
        }
    }
}

/// Place of a peak between bins, from the three powers around bin `k`: for a Hann window the ratio
/// of neighbouring amplitudes is a rational function of the place.
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
    fn a_cosine_on_a_slope_is_one_peak_at_its_frequency() {
        let cycles = 25.3;
        let levels: Vec<f32> = (0..256)
            .map(|i| {
                let x = f64::from(i);
                (0.5 + 0.001 * x + 0.1 * (TAU * cycles * x / 256.0 + 0.7).cos()) as f32
            })
            .collect();
        let mut spectrum = Spectrum::new(256);
        let mean = spectrum.of(&levels);
        assert!((mean - 0.6275).abs() < 2e-3, "{mean}");
        let peak = (1..127).max_by(|a, b| spectrum.power[*a].total_cmp(&spectrum.power[*b]));
        assert_eq!(peak, Some(25));
        let place = between_bins(&spectrum.power, 25);
        assert!((place - cycles).abs() < 0.01, "{place}");
        // At 0.3 bins off its middle a Hann window passes 0.94 of the amplitude.
        assert!((spectrum.power[25].sqrt() - 0.1 * 0.94).abs() < 2e-3);
        assert!(spectrum.power[60].sqrt() < 1e-4);
    }
}
