//! Creep that no law of the set generated: relaxation spectra drawn over thirteen decades.

use super::laws::noisy;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_creep::{Curve, FitOptions, Forecast, ForecastSet, Law};

/// Family of materials; each seed is one material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Family {
    /// Three to seven Kelvin elements, their times anywhere from 1 s to 30 years.
    Elements,
    /// A smooth spectrum that varies by a factor of e over two decades.
    Smooth,
    /// Logarithm of time up to the end of a spectrum, between 20 min and 30 years.
    Cut,
    /// Power of time that changes to another exponent, as by ageing and free volume.
    Bent,
}

impl Family {
    pub(crate) const ALL: [Family; 4] =
        [Family::Elements, Family::Smooth, Family::Cut, Family::Bent];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Elements => "elements",
            Self::Smooth => "smooth spectrum",
            Self::Cut => "cut spectrum",
            Self::Bent => "bent power",
        }
    }
}

/// Material with a random spectrum.
pub(crate) struct Material {
    /// Kelvin elements: time and share.
    elements: Vec<(f64, f64)>,
    /// `(t/τ)^n` up to `τ`, `(t/τ)^m` beyond.
    bent: Option<[f64; 3]>,
    scale: f64,
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

fn between(random: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    random.random_range(low..high)
}

/// End of the record, s: duration of the paper's creep tests.
pub(crate) const END_S: f64 = 5100.0;

impl Material {
    pub(crate) fn new(family: Family, seed: u64) -> Self {
        let random = &mut ChaCha8Rng::seed_from_u64(seed ^ 0xa7e7);
        let decades = |from: f64, to: f64, step: f64| {
            (0..=((to - from) / step) as usize).map(move |i| 10f64.powf(from + step * i as f64))
        };
        let mut bent = None;
        let elements: Vec<(f64, f64)> = match family {
            Family::Elements => (0..3 + seed % 5)
                .map(|_| {
                    (
                        10f64.powf(between(random, 0.0, 9.0)),
                        (0.7 * normal(random)).exp(),
                    )
                })
                .collect(),
            Family::Smooth => {
                // Steps of a quarter decade; correlated over two.
                let keep = (-0.125_f64).exp();
                let mut wander = normal(random);
                decades(-1.0, 10.0, 0.25)
                    .map(|tau| {
                        wander = keep * wander + (1.0 - keep * keep).sqrt() * normal(random);
                        (tau, wander.exp())
                    })
                    .collect()
            }
            Family::Cut => {
                let end = between(random, 3.0, 9.0);
                decades(0.0, end, 0.1).map(|tau| (tau, 1.0)).collect()
            }
            Family::Bent => {
                let tau = 10f64.powf(between(random, 2.0, 7.0));
                bent = Some([tau, between(random, 0.05, 0.4), between(random, 0.02, 0.3)]);
                Vec::new()
            }
        };
        let mut material = Self {
            elements,
            bent,
            scale: 1.0,
        };
        // Creep of 0.1 % in the record.
        let creep = material.strain(END_S) - material.strain(5.0);
        material.scale = 1e-3 / creep;
        material
    }

    /// Creep strain at a time after the load.
    pub(crate) fn strain(&self, t: f64) -> f64 {
        let elements: f64 = self
            .elements
            .iter()
            .map(|(tau, c)| -c * (-t / tau).exp_m1())
            .sum();
        let bent = self.bent.map_or(0.0, |[tau, n, m]| {
            // Smooth within a decade about τ: the slope in the logarithm changes from n to m.
            let u = t / tau;
            u.powf(n) * (1.0 + u).powf(m - n)
        });
        self.scale * (elements + bent)
    }

    /// Record of 85 min with errors of 0.001 %.
    pub(crate) fn record(&self, seed: u64) -> Curve {
        let time = super::laws::times(60, END_S);
        let strain = noisy(|t| self.strain(t), &time, 1e-5, seed);
        Curve::constant_load("made", time, strain)
    }
}

/// Forecast of all laws combined for a material's record at times beyond it, if possible, and the
/// truth there.
pub(crate) fn forecast_and_truth<const N: usize>(
    family: Family,
    seed: u64,
    later_s: &[f64; N],
) -> Option<(Forecast, [f64; N])> {
    let material = Material::new(family, seed);
    let options = FitOptions {
        seed,
        ..FitOptions::default()
    };
    let found = ForecastSet::new(&Law::ALL, &[material.record(seed)], 0, &options, later_s);
    Some((found.combined?, later_s.map(|t| material.strain(t))))
}
