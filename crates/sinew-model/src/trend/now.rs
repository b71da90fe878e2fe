//! Where a tendon stands after the last record.

use super::component::{AMPLITUDE, BASELINE, DRIFT, LEVEL, STATES, TAKEN_OUT};
use super::gauss::LogSum;
use super::tracker::Trend;
use crate::Gaussian;

/// Where the tendon stands after the last entry, over all filters.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrendNow {
    /// True offset at the reference temperature since the last tensioning, rad.
    pub offset_rad: Gaussian,
    /// The same since the first tensioning, rad.
    pub whole_rad: Gaussian,
    /// How fast the creep goes on, rad/s.
    pub rate_rad_per_s: Gaussian,
    /// Drift of the records with temperature, rad/K.
    pub drift_rad_per_k: Gaussian,
    /// Error that all sessions since the baseline share, rad: what is left unknown of it is in the offset's deviation,
    /// however many sessions there are.
    pub baseline_error_rad: Gaussian,
    /// Deviation of the error that neighbouring sessions share, rad: mean over what is still likely.
    pub slow_deviation_rad: f64,
    /// True over stated deviation of a record's own error: mean.
    pub white_scale: f64,
}

impl TrendNow {
    /// Of a trend.
    #[must_use]
    pub fn of(trend: &Trend) -> Self {
        const DAY_S: f64 = 86_400.0;
        let prior = trend.prior();
        let t = trend.time_s();
        let mut all = LogSum::new();
        for c in trend.components() {
            all.add(c.weight_above_zero());
        }
        let total = all.value();
        let mut moments = [[0.0; 2]; 5];
        let (mut slow_deviation_rad, mut white_scale) = (0.0, 0.0);
        for c in trend.components() {
            let share = libm::exp(c.weight_above_zero() - total);
            let rate = prior
                .curves
                .get(c.curve as usize)
                .map_or(0.0, |k| (k.at(t + DAY_S) - k.at(t)) / DAY_S);
            let mut whole = [0.0; STATES];
            whole[LEVEL] = 1.0;
            let mut offset = whole;
            offset[TAKEN_OUT] = 1.0;
            let mut pace = [0.0; STATES];
            pace[AMPLITUDE] = rate;
            let mut drift = [0.0; STATES];
            drift[DRIFT] = 1.0;
            let mut baseline = [0.0; STATES];
            baseline[BASELINE] = 1.0;
            let seen = [offset, whole, pace, drift, baseline];
            for (sums, h) in moments.iter_mut().zip(seen) {
                let found = c.expect(&h);
                sums[0] += share * found.mean;
                sums[1] += share * (found.mean * found.mean + found.variance);
            }
            if let Some(noise) = prior.noises.get(c.noise as usize) {
                slow_deviation_rad += share * noise.slow_deviation_rad;
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
            slow_deviation_rad,
            white_scale,
        }
    }
}
