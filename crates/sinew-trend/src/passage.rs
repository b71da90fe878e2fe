//! First passage of a limit: as dates, for selection and sorting, and as a distribution.

use super::result::{JointTrend, Limit, LimitForecast, LimitState};
use sinew_model::statistics::quantile;

/// Limit of a tendon and its first passage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// Limit that is exceeded.
    pub limit: Limit,
    /// Limit as an offset, rad.
    pub limit_rad: f64,
    /// Offset minus limit, rad; negative before the limit is reached.
    pub beyond_rad: f64,
    /// State of the forecast.
    pub state: LimitState,
    /// Probability that the limit was exceeded at the last session.
    pub passed_probability: f64,
    /// Median, 2.5 and 97.5 % quantile, s since 1970; `None` beyond the forecast's horizon, or
    /// unknown.
    pub at_utc_s: [Option<f64>; 3],
}

impl Passage {
    /// First passages of all limits of a tendon.
    pub fn all(trend: &JointTrend) -> Vec<Self> {
        let limits = trend.limits.iter();
        limits.map(|found| Self::of(found, trend)).collect()
    }

    fn of(found: &LimitForecast, trend: &JointTrend) -> Self {
        let at = |after_s: Option<f64>| after_s.map(|t| trend.last_utc_s + t);
        let limit_rad = found.limit_rad;
        // A strain counts from the first tensioning, an offset from the last.
        let counts_rad = match (found.limit, trend.strain_ratio) {
            (Limit::Replace { strain_ratio }, Some(strain)) => {
                limit_rad * strain.mean / strain_ratio
            }
            _ => trend.offset_rad.mean,
        };
        Self {
            limit: found.limit,
            limit_rad,
            beyond_rad: counts_rad - limit_rad,
            state: found.state,
            passed_probability: found.passed_probability,
            at_utc_s: [found.after_s, found.after_low_s, found.after_high_s].map(at),
        }
    }

    /// First of a tendon's passages. Of two exceeded limits it is the strain's: a replaced rope is
    /// tensioned, too.
    pub fn first(all: &[Self]) -> Option<&Self> {
        let last_first = all.iter().rev();
        last_first.min_by(|a, b| a.order().total_cmp(&b.order()))
    }

    /// Whether the limit is exceeded with a probability above one half.
    pub fn is_passed(&self) -> bool {
        self.state == LimitState::Passed
    }

    /// Whether the limit is exceeded, or may be by a time, s since 1970: the lower end of its
    /// interval is before it.
    pub fn is_due(&self, until_utc_s: f64) -> bool {
        self.is_passed() || self.at_utc_s[1].is_some_and(|low| low <= until_utc_s)
    }

    /// Sort key of tendons, smallest first: exceeded limits come first, the largest exceedance
    /// before the others; then by date.
    pub fn rank(&self) -> (bool, f64) {
        match self.is_passed() {
            true => (false, -self.beyond_rad),
            false => (true, self.order()),
        }
    }

    /// Sort key by time.
    fn order(&self) -> f64 {
        let [median, low, _] = self.at_utc_s;
        let passed = if self.is_passed() { -1e12 } else { 0.0 };
        // Passages without a median follow those with one.
        passed + median.or(low.map(|low| low + 1e11)).unwrap_or(1e12)
    }
}

/// Number of quantile steps: half a percent each, so that the median and the ends of the interval
/// are among them.
const STEPS: usize = 200;

/// First-passage distribution of a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstPassage {
    /// Limit that is exceeded.
    pub limit: Limit,
    /// Quantiles of the time from the last session, s, rising; infinite beyond the horizon.
    quantiles_s: Vec<f64>,
    horizon_s: f64,
}

impl FirstPassage {
    /// * `found_s`: first-passage time of each path, s after tensioning, sorted; infinite beyond
    ///   the last time evaluated.
    /// * `looked_s`: first and last time evaluated, s after tensioning.
    pub(super) fn of(limit: Limit, found_s: &[f64], looked_s: [f64; 2]) -> Self {
        let [now_s, end_s] = looked_s;
        let after_s = |k: usize| {
            let t = quantile(found_s, k as f64 / STEPS as f64);
            if t.is_finite() {
                (t - now_s).max(0.0)
            } else {
                f64::INFINITY
            }
        };
        Self {
            limit,
            quantiles_s: (0..=STEPS).map(after_s).collect(),
            horizon_s: end_s - now_s,
        }
    }

    /// Probability that the limit is exceeded within a time after the last session, s, to half a
    /// percent; `None` beyond the horizon.
    pub fn probability_by(&self, after_s: f64) -> Option<f64> {
        if !(after_s <= self.horizon_s) {
            return None;
        }
        let passed = self.quantiles_s.partition_point(|t| *t <= after_s);
        let Some(below) = passed.checked_sub(1) else {
            return Some(0.0);
        };
        let between = match (self.quantiles_s.get(below), self.quantiles_s.get(passed)) {
            (Some(a), Some(b)) if b.is_finite() => (after_s - a) / (b - a),
            _ => 0.0,
        };
        Some((below as f64 + between) / STEPS as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: Limit = Limit::Retension { elongation_m: 5e-4 };

    #[test]
    fn probability_is_share_of_passed_paths() {
        // One passage per day from the tenth on; a tenth has passed before, and a fifth never does.
        let found_s: Vec<f64> = (0..1000)
            .map(|i| match i {
                0..100 => 9.0,
                100..800 => 10.0 + f64::from(i - 100),
                _ => f64::INFINITY,
            })
            .collect();
        let times = FirstPassage::of(LIMIT, &found_s, [10.0, 5010.0]);
        let by = |after_s: f64| times.probability_by(after_s);
        for (after_s, share) in [(0.0, 0.1), (350.0, 0.45), (699.0, 0.8), (5000.0, 0.8)] {
            let found = by(after_s).unwrap();
            assert!((found - share).abs() <= 5.1e-3, "{after_s}: {found}");
        }
        assert_eq!(
            (by(-1.0), by(5001.0), by(f64::NAN)),
            (Some(0.0), None, None)
        );
        let all: Vec<f64> = (0..5000).filter_map(|t| by(f64::from(t))).collect();
        assert!(all.len() == 5000 && all.is_sorted());
        let surely = FirstPassage::of(LIMIT, &[11.0, 12.0], [10.0, 20.0]);
        assert_eq!(surely.probability_by(2.0), Some(1.0));
    }

    #[test]
    fn first_prefers_exceeded_strain_then_earliest() {
        let of = |limit, state, day: Option<f64>| Passage {
            limit,
            limit_rad: 20e-3,
            beyond_rad: -1e-3,
            state,
            passed_probability: 0.5,
            at_utc_s: [day, day, None],
        };
        let replace = Limit::Replace { strain_ratio: 6e-3 };
        let passed = [LIMIT, replace].map(|limit| of(limit, LimitState::Passed, Some(0.0)));
        assert_eq!(Passage::first(&passed), Some(&passed[1]));
        let soon = of(LIMIT, LimitState::Forecast, Some(3.0));
        let later = of(replace, LimitState::Forecast, Some(4.0));
        assert_eq!(Passage::first(&[soon, later]), Some(&soon));
        assert_eq!(Passage::first(&[]), None);
        // A larger exceedance ranks worse, and worse than a future one.
        let beyond = |beyond_rad| Passage {
            beyond_rad,
            ..passed[0]
        };
        let ranks = [beyond(26e-3), beyond(1e-3), soon, later].map(|p| p.rank());
        assert!(ranks.is_sorted(), "{ranks:?}");
        assert!(soon.is_due(3.0) && !soon.is_due(2.0) && passed[0].is_due(-1.0));
    }
}
