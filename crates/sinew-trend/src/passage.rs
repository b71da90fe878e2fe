//! When a limit is passed: as dates, to choose and to sort by, and as a distribution.

use super::result::{JointTrend, Limit, LimitForecast, LimitState};
use sinew_model::statistics::quantile;

/// A limit of a tendon and when it passes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// The limit.
    pub limit: Limit,
    /// The limit as an offset, rad.
    pub limit_rad: f64,
    /// By how much the offset that counts for it is beyond the limit, rad; negative: before it.
    pub beyond_rad: f64,
    /// What is known.
    pub state: LimitState,
    /// Probability that it was passed already at the last session.
    pub passed_probability: f64,
    /// Median, 2.5 and 97.5 % quantile, s since 1970; `None`: beyond the forecast's horizon, or unknown.
    pub at_utc_s: [Option<f64>; 3],
}

impl Passage {
    /// Of each limit of a tendon.
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

    /// Of a tendon's passages the first. Of two that are passed it is the strain's: who replaces a rope tensions it, too.
    pub fn first(all: &[Self]) -> Option<&Self> {
        let last_first = all.iter().rev();
        last_first.min_by(|a, b| a.order().total_cmp(&b.order()))
    }

    /// Likelier passed than not.
    pub fn is_passed(&self) -> bool {
        self.state == LimitState::Passed
    }

    /// Passed, or it may be by then, s since 1970: the lower end of its interval lies before.
    pub fn is_due(&self, until_utc_s: f64) -> bool {
        self.is_passed() || self.at_utc_s[1].is_some_and(|low| low <= until_utc_s)
    }

    /// To sort tendons by, the smaller the worse: what is passed comes first, the farthest beyond its limit before the others; then the
    /// sooner, the worse.
    pub fn rank(&self) -> (bool, f64) {
        match self.is_passed() {
            true => (false, -self.beyond_rad),
            false => (true, self.order()),
        }
    }

    /// The earlier, the smaller.
    fn order(&self) -> f64 {
        let [median, low, _] = self.at_utc_s;
        let passed = if self.is_passed() { -1e12 } else { 0.0 };
        // What has no median comes after what has one.
        passed + median.or(low.map(|low| low + 1e11)).unwrap_or(1e12)
    }
}

/// Quantiles that are kept: in steps of half a percent, so that the median and the ends of the interval are among them.
const STEPS: usize = 200;

/// When a limit is passed, as a distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct PassageTimes {
    /// The limit.
    pub limit: Limit,
    /// Quantiles of the time from the last session, s, rising; infinite: beyond the horizon.
    quantiles_s: Vec<f64>,
    horizon_s: f64,
}

impl PassageTimes {
    /// * `found_s`: time of each path drawn, s after tensioning, sorted; infinite: beyond the last time looked at.
    /// * `looked_s`: the first and the last time looked at, s after tensioning.
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

    /// Probability that it is passed so long after the last session, s, to half a percent; `None`: the forecast doesn't reach so far.
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
    fn the_probability_is_the_share_of_paths_that_have_passed() {
        // One day after the other, from the tenth on; a tenth of them has passed, and a fifth never does.
        let found_s: Vec<f64> = (0..1000)
            .map(|i| match i {
                0..100 => 9.0,
                100..800 => 10.0 + f64::from(i - 100),
                _ => f64::INFINITY,
            })
            .collect();
        let times = PassageTimes::of(LIMIT, &found_s, [10.0, 5010.0]);
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
        let surely = PassageTimes::of(LIMIT, &[11.0, 12.0], [10.0, 20.0]);
        assert_eq!(surely.probability_by(2.0), Some(1.0));
    }

    #[test]
    fn of_two_limits_that_are_passed_the_strain_comes_first_and_of_two_to_come_the_sooner() {
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
        // The farther beyond, the worse; and worse than what is to come.
        let beyond = |beyond_rad| Passage {
            beyond_rad,
            ..passed[0]
        };
        let ranks = [beyond(26e-3), beyond(1e-3), soon, later].map(|p| p.rank());
        assert!(ranks.is_sorted(), "{ranks:?}");
        assert!(soon.is_due(3.0) && !soon.is_due(2.0) && passed[0].is_due(-1.0));
    }
}
