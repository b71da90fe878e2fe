//! Present state of a tendon after the last record.

use super::bank::added;
use super::component::{
    AMPLITUDE, BASELINE, Component, DRIFT, LEVEL, RETENSIONED, TAKEN_OUT, entry,
};
use super::curve::Place;
use super::gauss::LogSum;
use super::tracker::Trend;
use sinew_model::Gaussian;

/// Present state of the tendon after the last entry, over all filters.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrendNow {
    /// True offset at the reference temperature since the last tensioning, rad.
    pub offset_rad: Gaussian,
    /// True offset at the reference temperature since the first tensioning, rad.
    pub whole_rad: Gaussian,
    /// Present creep rate, rad/s.
    pub rate_rad_per_s: Gaussian,
    /// Drift of the records with temperature, rad/K.
    pub drift_rad_per_k: Gaussian,
    /// Common error of all sessions since the baseline, rad; its uncertainty is included in the
    /// standard deviation of the offset and does not decrease with the number of sessions.
    pub baseline_error_rad: Gaussian,
    /// Standard deviation of the slow error of neighbouring sessions, rad: posterior mean.
    pub slow_std_rad: f64,
    /// Ratio of actual to reported standard deviation of the independent error: posterior mean.
    pub white_scale: f64,
}

impl TrendNow {
    /// Computes the present state of a trend.
    #[must_use]
    pub fn of(trend: &Trend) -> Self {
        const DAY_S: f64 = 86_400.0;
        let prior = trend.prior();
        let t = trend.time_s();
        let weights: Vec<f64> = (trend.components().iter())
            .map(Component::weight_above_zero)
            .collect();
        let mut all = LogSum::new();
        weights.iter().for_each(|w| all.add(*w));
        let total = all.value();
        let [today, tomorrow] = [t, t + DAY_S].map(Place::of);
        let rates: Vec<f64> = (prior.curves.iter())
            .map(|k| (k.between(tomorrow) - k.between(today)) / DAY_S)
            .collect();
        let added = added(prior, trend.retensioned_s(), t, t + DAY_S);
        let mut moments = [[0.0; 2]; 5];
        let (mut slow_std_rad, mut white_scale) = (0.0, 0.0);
        for (c, weight) in trend.components().iter().zip(&weights) {
            let share = libm::exp(weight - total);
            let rate = rates.get(c.curve as usize).copied().unwrap_or(0.0);
            let extra = added.get(c.curve as usize).map_or(0.0, |step| step / DAY_S);
            let p = |i: usize, k: usize| c.covariance[entry(i, k)];
            let offset = c.mean[LEVEL] + c.mean[TAKEN_OUT];
            let offset_variance =
                p(LEVEL, LEVEL) + 2.0 * p(LEVEL, TAKEN_OUT) + p(TAKEN_OUT, TAKEN_OUT);
            let seen = [
                (offset, offset_variance.max(0.0)),
                (c.mean[LEVEL], p(LEVEL, LEVEL)),
                (
                    rate * c.mean[AMPLITUDE] + extra * c.mean[RETENSIONED],
                    (rate * rate * p(AMPLITUDE, AMPLITUDE)
                        + 2.0 * rate * extra * p(AMPLITUDE, RETENSIONED)
                        + extra * extra * p(RETENSIONED, RETENSIONED))
                    .max(0.0),
                ),
                (c.mean[DRIFT], p(DRIFT, DRIFT)),
                (c.mean[BASELINE], p(BASELINE, BASELINE)),
            ];
            for (sums, (mean, variance)) in moments.iter_mut().zip(seen) {
                sums[0] += share * mean;
                sums[1] += share * (mean * mean + variance);
            }
            if let Some(noise) = prior.noises.get(c.noise as usize) {
                slow_std_rad += share * noise.slow_std_rad;
                white_scale += share * noise.white_scale;
            }
        }
        let of = |[mean, square]: [f64; 2]| {
            Gaussian::new(mean, libm::sqrt((square - mean * mean).max(0.0)))
        };
        Self {
            offset_rad: of(moments[0]),
            whole_rad: of(moments[1]),
            rate_rad_per_s: of(moments[2]),
            drift_rad_per_k: of(moments[3]),
            baseline_error_rad: of(moments[4]),
            slow_std_rad,
            white_scale,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::{Curve, Prior, TrendConfig, node_times_s};

    // A level that creeps by `a ln t` moves by `a ln(1 + d/t)` in the following day `d`.
    #[test]
    fn creep_rate_refers_to_following_day() {
        const DAY_S: f64 = 86_400.0;
        const AMPLITUDE: f64 = 1e-3;
        for days in [0.5, 10.0, 100.0] {
            let mut prior = Prior::new(vec![Curve {
                retensioned: None,
                values: node_times_s().iter().map(|t| libm::log(*t)).collect(),
                amplitude: AMPLITUDE,
                amplitude_std: 1e-9,
                log_weight: 0.0,
            }]);
            prior.baseline_s = days * DAY_S;
            let trend = Trend::new(prior, TrendConfig::default()).unwrap();
            let expected = AMPLITUDE * libm::log(1.0 + 1.0 / days) / DAY_S;
            let rate = TrendNow::of(&trend).rate_rad_per_s;
            assert!(
                (rate.mean / expected - 1.0).abs() < 1e-3,
                "{rate:?} {expected}"
            );
            assert!(rate.std < 1e-3 * expected, "{rate:?}");
        }
    }
}
