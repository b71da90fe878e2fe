//! Histogram of the intervals of one stream: missing samples give intervals of two, three, … samples.

use super::key::Key;
use crate::health::{StreamRole, StreamTiming};

/// Steps are counted in bins of this relative width.
const BIN: f64 = 0.01;
/// Number of bins, from 1 ns to about 10 minutes.
const BINS: usize = 2_700;
/// Relative variation of the steps above which missing samples are not counted.
const IRREGULAR: f64 = 0.2;
/// Ratio to the typical interval above which an interval has missing samples.
const SKIPPED: f64 = 1.5;
/// Minimum number of steps for a rate.
const MIN_STEPS: u64 = 10;

/// Counts of steps by their length; as large for an hour as for a minute.
#[derive(Debug, Clone)]
pub(crate) struct Steps {
    limit_ns: i64,
    last: Option<Key>,
    samples: u64,
    /// Count and sum, ns, of each bin; none before the first step.
    bins: Vec<(u64, u64)>,
    /// The last step and its bin: most steps are like the one before.
    cached: (i64, usize),
}

impl Steps {
    /// Steps up to `limit_ns`; longer ones are gaps, counted elsewhere.
    pub(crate) fn new(limit_ns: i64) -> Self {
        Self {
            limit_ns,
            last: None,
            samples: 0,
            bins: Vec::new(),
            cached: (0, 0),
        }
    }

    /// The next sample of the stream, in order.
    #[inline]
    pub(crate) fn sample(&mut self, key: Key) {
        self.samples += 1;
        let last = self.last.replace(key);
        let Some(last) = last.filter(|last| last.epoch == key.epoch) else {
            return;
        };
        let step_ns = key.time_ns.saturating_sub(last.time_ns);
        if step_ns <= 0 || step_ns > self.limit_ns {
            return;
        }
        if step_ns != self.cached.0 {
            let bin = ((step_ns as f64).ln() / BIN) as usize;
            self.cached = (step_ns, bin.min(BINS - 1));
        }
        if self.bins.is_empty() {
            self.bins.resize(BINS, (0, 0));
        }
        let bin = &mut self.bins[self.cached.1];
        bin.0 += 1;
        bin.1 = bin.1.saturating_add(step_ns.unsigned_abs());
    }

    /// Timing of a stream, given the number of samples with duplicate time stamps.
    pub(crate) fn timing(&self, role: StreamRole, repeated: u64) -> StreamTiming {
        let steps: u64 = self.bins.iter().map(|b| b.0).sum();
        let mut timing = StreamTiming {
            role,
            samples: self.samples,
            step_s: None,
            jitter_s: None,
            missing: None,
            repeated,
        };
        if steps < MIN_STEPS {
            return timing;
        }
        let at = |share: f64| self.quantile_ns(share * steps as f64);
        let usual_ns = at(0.5);
        // Missing samples only lengthen steps: the shorter half measures the jitter.
        let jitter_ns = usual_ns - at(0.16);
        timing.step_s = Some(1e-9 * usual_ns);
        timing.jitter_s = Some(1e-9 * jitter_ns.max(0.0));
        if jitter_ns <= IRREGULAR * usual_ns {
            let longer = self
                .means()
                .filter(|(mean_ns, _)| *mean_ns > SKIPPED * usual_ns);
            let missing =
                |(mean_ns, count): (f64, u64)| ((mean_ns / usual_ns).round() as u64 - 1) * count;
            timing.missing = Some(longer.map(missing).sum());
        }
        timing
    }

    /// Mean, ns, and count of the bins that hold any.
    fn means(&self) -> impl Iterator<Item = (f64, u64)> {
        let held = self.bins.iter().filter(|(count, _)| *count > 0);
        held.map(|(count, sum_ns)| (*sum_ns as f64 / *count as f64, *count))
    }

    /// Duration, ns, that `rank` of the steps do not exceed.
    fn quantile_ns(&self, rank: f64) -> f64 {
        let mut before = 0;
        let mut found = 0.0;
        for (mean_ns, count) in self.means() {
            found = mean_ns;
            before += count;
            if before as f64 >= rank {
                break;
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timing(stamps: impl IntoIterator<Item = i64>) -> StreamTiming {
        let mut steps = Steps::new(500_000_000);
        for time_ns in stamps {
            steps.sample(Key { epoch: 0, time_ns });
        }
        steps.timing(StreamRole::JointSide, 0)
    }

    /// A number that looks random.
    fn mixed(i: i64) -> i64 {
        (i.wrapping_mul(0x9E37_79B9_7F4A_7C15_u64 as i64)).rem_euclid(1000)
    }

    #[test]
    fn missing_samples_are_counted() {
        let all = (0..10_000).map(|i| i * 4_000_000);
        assert_eq!(timing(all.clone()).missing, Some(0));
        let kept = all
            .clone()
            .filter(|t| mixed(t / 4_000_000) >= 200 || *t == 0);
        let kept: Vec<i64> = kept.collect();
        let found = timing(kept.iter().copied());
        let last = kept.last().unwrap() / 4_000_000;
        assert_eq!(found.missing, Some(last as u64 + 1 - kept.len() as u64));
        assert!((found.step_s.unwrap() - 0.004).abs() < 1e-9);
    }

    #[test]
    fn jitter_is_not_loss_and_irregular_rate_is_unknown() {
        let uneven =
            |part: i64| (0..10_000).map(move |i| i * 4_000_000 + mixed(i) * 4_000 * part / 100);
        let found = timing(uneven(5));
        assert_eq!(found.missing, Some(0));
        assert!(
            (20e-6..200e-6).contains(&found.jitter_s.unwrap()),
            "{found:?}"
        );
        assert_eq!(timing(uneven(90)).missing, None, "steps of 0.4 to 7.6 ms");
    }

    #[test]
    fn pauses_and_jumps_of_the_clock_are_no_steps() {
        let mut steps = Steps::new(500_000_000);
        for i in 0..2_000_i64 {
            let pause = if i > 1_000 { 3_000_000_000 } else { 0 };
            let epoch = u32::from(i > 1_500);
            steps.sample(Key {
                epoch,
                time_ns: i * 2_000_000 + pause,
            });
        }
        assert_eq!(steps.timing(StreamRole::JointSide, 0).missing, Some(0));
        assert_eq!(timing([i64::MIN, i64::MAX, 0]).step_s, None);
    }
}
