//! Mean, standard deviation and standard error in one pass and bounded memory.

/// Streaming statistics of a correlated signal.
///
/// The standard error is that of batch means: neighbouring samples of a filtered signal are
/// correlated, so `scatter/√n` would be far too small. The batch length doubles when the number of batches reaches
/// [`Tally::BATCHES`], so that the number remains between half of this value and this value.
#[derive(Debug, Clone)]
pub(super) struct Tally {
    count: u64,
    mean: f64,
    /// Sum of squared deviations (Welford).
    square: f64,
    min: f64,
    max: f64,
    batch_length: u64,
    batches: Vec<f64>,
    batch_sum: f64,
    batch_count: u64,
}

impl Tally {
    const BATCHES: usize = 64;
    /// Minimum number of batch means for a standard error.
    const MIN_BATCHES: usize = 8;

    pub(super) fn new() -> Self {
        Self {
            count: 0,
            mean: 0.0,
            square: 0.0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            // 25 samples: below the correlation time of the default filters at most rates, so
            // that the doubling determines the length.
            batch_length: 25,
            batches: Vec::with_capacity(Self::BATCHES),
            batch_sum: 0.0,
            batch_count: 0,
        }
    }

    pub(super) fn add(&mut self, x: f64) {
        self.count += 1;
        let d = x - self.mean;
        self.mean += d / self.count as f64;
        self.square += d * (x - self.mean);
        self.min = self.min.min(x);
        self.max = self.max.max(x);
        self.batch_sum += x;
        self.batch_count += 1;
        if self.batch_count == self.batch_length {
            if self.batches.len() == Self::BATCHES {
                for i in 0..Self::BATCHES / 2 {
                    self.batches[i] = 0.5 * (self.batches[2 * i] + self.batches[2 * i + 1]);
                }
                self.batches.truncate(Self::BATCHES / 2);
                self.batch_length *= 2;
                // The completed batch is half of the new length and is filled further.
                return;
            }
            self.batches.push(self.batch_sum / self.batch_count as f64);
            self.batch_sum = 0.0;
            self.batch_count = 0;
        }
    }

    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Mean of the samples, or NaN without a sample.
    pub(super) fn mean(&self) -> f64 {
        if self.count == 0 { f64::NAN } else { self.mean }
    }

    pub(super) fn min(&self) -> f64 {
        if self.count == 0 { f64::NAN } else { self.min }
    }

    pub(super) fn max(&self) -> f64 {
        if self.count == 0 { f64::NAN } else { self.max }
    }

    /// Standard deviation of single samples, or NaN with fewer than two.
    pub(super) fn scatter(&self) -> f64 {
        if self.count < 2 {
            f64::NAN
        } else {
            (self.square / (self.count - 1) as f64).sqrt()
        }
    }

    /// Standard error of the mean, or NaN with fewer than [`Tally::MIN_BATCHES`] batches.
    pub(super) fn standard_error(&self) -> f64 {
        let n = self.batches.len();
        if n < Self::MIN_BATCHES {
            return f64::NAN;
        }
        let mean = self.batches.iter().sum::<f64>() / n as f64;
        let square: f64 = self.batches.iter().map(|b| (b - mean).powi(2)).sum();
        (square / (n - 1) as f64 / n as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use rand::SeedableRng;

    /// First-order noise of unit variance and a correlation time of `tau` samples.
    fn correlated(seed: u64, n: usize, tau: f64) -> Tally {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let a = (-1.0f64 / tau).exp();
        let mut x = 0.0;
        let mut tally = Tally::new();
        for _ in 0..n {
            // Uniform of variance 1.
            let u: f64 = (rng.random::<f64>() - 0.5) * 12f64.sqrt();
            x = a * x + (1.0 - a * a).sqrt() * u;
            tally.add(x);
        }
        tally
    }

    #[test]
    fn standard_error_correlated_noise_matches_analytic() {
        // Var(mean) of first-order noise: (1+a)/(1−a)/n ≈ 2 τ/n.
        let (n, tau) = (20_000, 50.0);
        let expected = (2.0 * tau / n as f64).sqrt();
        let mut errors = 0.0;
        let mut within = 0;
        let runs = 200;
        for seed in 0..runs {
            let tally = correlated(seed, n, tau);
            errors += tally.standard_error() / runs as f64;
            within += usize::from(tally.mean().abs() < sinew_model::Z95 * tally.standard_error());
        }
        // Batch means of 312–625 samples, ≥ 6 correlation times: at most 1/6·… ≈ 10 % low.
        assert!(
            (errors / expected - 1.0).abs() < 0.15,
            "{errors} {expected}"
        );
        assert!((178..=198).contains(&within), "{within} of {runs}");
    }

    #[test]
    fn mean_and_scatter_match_analytic() {
        let mut tally = Tally::new();
        for x in [1.0, 2.0, 4.0] {
            tally.add(x);
        }
        assert!((tally.mean() - 7.0 / 3.0).abs() < 1e-15);
        assert!((tally.scatter() - (7.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!(tally.standard_error().is_nan());
        assert!(Tally::new().mean().is_nan());
    }
}
