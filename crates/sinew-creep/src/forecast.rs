//! Forecast of a fitted law at later times, with an interval for the next measurement.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::fit::Fit;
use super::forecast_request::Continuation;
use super::noise::Filter;
use sinew_model::statistics::quantile;

/// Forecast strain at given times, m/m.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Forecast {
    /// Times after the load, s.
    pub time_s: Vec<f64>,
    /// Median of the law's strain, m/m.
    pub strain_ratio: Vec<f64>,
    /// Lower end of the interval of the law's strain, m/m.
    pub low_strain_ratio: Vec<f64>,
    /// Upper end of the interval of the law's strain, m/m.
    pub high_strain_ratio: Vec<f64>,
    /// Lower end of the prediction interval of a measurement, m/m: law, slow part and measurement
    /// error.
    pub reading_low_strain_ratio: Vec<f64>,
    /// Upper end of the prediction interval of a measurement, m/m.
    pub reading_high_strain_ratio: Vec<f64>,
}

/// Draws of the strain at given times: of the law, and of a measurement.
#[derive(Default)]
struct Paths {
    law: Vec<Vec<f64>>,
    reading: Vec<Vec<f64>>,
}

impl Paths {
    /// Draws paths of the curve with index `curve` at increasing times after its last measurement.
    fn of(fit: &Fit, curve: usize, continuation: Continuation, time_s: &[f64]) -> Paths {
        let model = &fit.model;
        let mut random = ChaCha8Rng::seed_from_u64(fit.seed ^ 0x5eed);
        let member = &continuation.of(&model.curves[curve]);
        let clock = |t: f64| model.clock.at(member, t);
        let end = clock(member.time_s.last().copied().unwrap_or(0.0));
        let clocks: Vec<f64> = member.time_s.iter().map(|t| clock(*t)).collect();
        let mut filter = Filter::default();
        let mut paths = Paths::default();
        for draw in &fit.draws {
            let law = draw.strain_under(model, curve, member, time_s);
            // Slow part at the end of the record, given this draw's law.
            filter.prepare(&clocks, &member.count, draw.noise);
            let mut left: Vec<f64> = draw
                .strain_under(model, curve, member, &member.time_s)
                .iter()
                .zip(&member.strain)
                .map(|(fitted, seen)| (seen - fitted) / model.scale)
                .collect();
            let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
            let mut slow =
                filter.whiten(&mut left) + draw.sigma * filter.state_variance.sqrt() * normal();
            let mut before = end;
            let share = draw.noise.share;
            let reading = law
                .iter()
                .zip(time_s)
                .map(|(law, &t)| {
                    let t = clock(t);
                    let decay = (-(t - before).max(0.0) / draw.noise.memory).exp();
                    before = t;
                    slow = decay * slow
                        + draw.sigma * (share * (1.0 - decay * decay)).sqrt() * normal();
                    let own = draw.sigma * (1.0 - share).sqrt() * normal();
                    law + (slow + own) * model.scale
                })
                .collect();
            paths.law.push(law);
            paths.reading.push(reading);
        }
        paths
    }
}

impl Forecast {
    /// Forecast of one law for the curve with index `curve` at increasing times after its last
    /// measurement.
    pub fn of(fit: &Fit, curve: usize, time_s: &[f64]) -> Forecast {
        let fits = std::slice::from_ref(fit);
        Forecast::under(fits, curve, Continuation::AsRecorded, time_s)
    }

    /// Forecast of several laws combined by their Akaike weights; the interval includes the
    /// uncertainty of the law.
    pub(super) fn under(
        fits: &[Fit],
        curve: usize,
        continuation: Continuation,
        time_s: &[f64],
    ) -> Forecast {
        let total = fits.iter().map(|f| f.draws.len()).max().unwrap_or(0);
        let mut paths = Paths::default();
        for (fit, weight) in fits.iter().zip(akaike_weights(fits)) {
            let take = (weight * total as f64).round() as usize;
            if take > 0 {
                let own = Paths::of(fit, curve, continuation, time_s);
                paths.law.extend(own.law.into_iter().take(take));
                paths.reading.extend(own.reading.into_iter().take(take));
            }
        }
        let sorted = |list: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let at = |i: usize| {
                let mut values: Vec<f64> = list.iter().map(|p| p[i]).collect();
                values.sort_by(f64::total_cmp);
                values
            };
            (0..time_s.len()).map(at).collect()
        };
        let (law, reading) = (sorted(&paths.law), sorted(&paths.reading));
        let tail = 0.5 * (1.0 - fits.first().map_or(0.95, |fit| fit.level));
        let at = |of: &[Vec<f64>], share| of.iter().map(|v| quantile(v, share)).collect();
        Forecast {
            time_s: time_s.to_vec(),
            strain_ratio: at(&law, 0.5),
            low_strain_ratio: at(&law, tail),
            high_strain_ratio: at(&law, 1.0 - tail),
            reading_low_strain_ratio: at(&reading, tail),
            reading_high_strain_ratio: at(&reading, 1.0 - tail),
        }
    }

    /// Widens both intervals by `factor` on either side of the median.
    #[must_use]
    pub fn widened(mut self, factor: f64) -> Forecast {
        for (i, &middle) in self.strain_ratio.iter().enumerate() {
            for end in [
                &mut self.low_strain_ratio[i],
                &mut self.high_strain_ratio[i],
                &mut self.reading_low_strain_ratio[i],
                &mut self.reading_high_strain_ratio[i],
            ] {
                *end = middle + factor * (*end - middle);
            }
        }
        self
    }
}

/// Akaike weights of fits of the same measurements; they sum to one.
pub fn akaike_weights(fits: &[Fit]) -> Vec<f64> {
    let least = fits.iter().map(|f| f.aicc).fold(f64::INFINITY, f64::min);
    let raw: Vec<f64> = fits
        .iter()
        .map(|f| (-0.5 * (f.aicc - least)).exp())
        .collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|w| w / sum).collect()
}
