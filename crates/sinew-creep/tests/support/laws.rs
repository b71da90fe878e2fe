//! Records that a law of the set made.

use super::score::Scores;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_creep::*;

/// Times even in the logarithm, from 5 s on.
pub(crate) fn times(count: usize, last_s: f64) -> Vec<f64> {
    (0..count)
        .map(|i| 5.0 * (last_s / 5.0).powf(i as f64 / (count - 1) as f64))
        .collect()
}

pub(crate) fn noisy(truth: impl Fn(f64) -> f64, time: &[f64], sigma: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    time.iter()
        .map(|t| {
            let z: f64 = StandardNormal.sample(&mut random);
            truth(*t) + sigma * z
        })
        .collect()
}

/// A law with its strain over time and its numbers.
pub(crate) struct Known {
    pub(crate) law: Law,
    pub(crate) strain: fn(f64) -> f64,
    pub(crate) numbers: &'static [(&'static str, f64)],
}

/// Laws whose parameters a record of 40 readings tells.
pub(crate) const KNOWN: [Known; 3] = [
    Known {
        law: Law::LogTime,
        strain: |t| 2e-3 + 3e-4 * (1.0 + t / 60.0).ln(),
        numbers: &[("tau", 60.0), ("b", 0.03), ("epsilon_0", 0.2)],
    },
    Known {
        law: Law::Findley,
        strain: |t| 2e-3 + 1e-3 * (t / 3600.0).powf(0.2),
        numbers: &[("n", 0.2), ("m", 0.1), ("epsilon_0", 0.2)],
    },
    Known {
        law: Law::Burgers,
        strain: |t| 2e-3 + 3e-4 * t / 3600.0 + 8e-4 * (1.0 - (-t / 300.0_f64).exp()),
        numbers: &[("tau", 300.0), ("s", 0.03), ("c", 0.08), ("epsilon_0", 0.2)],
    },
];

impl Known {
    /// Scores of every number over so many records.
    pub(crate) fn scores(&self, seeds: u64) -> Vec<Scores> {
        let numbers: Vec<u64> = (0..seeds).collect();
        let time = times(40, 5100.0);
        let rows = each(&numbers, |&seed| self.scores_of(&time, seed), |_| {});
        let mut all = vec![Scores::default(); self.numbers.len()];
        for row in rows {
            for (all, own) in all.iter_mut().zip(row) {
                all.append(own);
            }
        }
        all
    }

    fn scores_of(&self, time: &[f64], seed: u64) -> Vec<Scores> {
        let strain = noisy(self.strain, time, 2e-5, seed);
        let curve = Curve::constant_load("made", time.to_vec(), strain);
        let options = FitOptions {
            noise: NoiseKind::White,
            seed,
            ..FitOptions::default()
        };
        let found = fit(self.law, &[curve], &options).expect("a fit");
        let score = |&(name, truth): &(&str, f64)| {
            let p = found.parameter(name).expect("fitted");
            let mut scores = Scores::default();
            scores.add(p.value, p.low, p.high, truth);
            scores
        };
        self.numbers.iter().map(score).collect()
    }
}
