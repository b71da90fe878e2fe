//! How intervals are held against the truth: errors in units of the interval's own deviation. Tests of other crates use it too.

#![allow(dead_code, reason = "each crate uses its own part")]

/// Errors of many intervals, each over its own deviation.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scores(Vec<f64>);

/// Quantile of the normal distribution behind a 95 % interval.
const Z95: f64 = 1.96;

impl Scores {
    /// Adds an interval around a value and the truth.
    pub(crate) fn add(&mut self, value: f64, low: f64, high: f64, truth: f64) {
        let side = if truth > value {
            high - value
        } else {
            value - low
        };
        self.0
            .push(Z95 * (truth - value) / side.max(f64::MIN_POSITIVE));
    }

    /// Adds an error with the deviation stated of it.
    pub(crate) fn add_error(&mut self, error: f64, deviation: f64) {
        self.0.push(error / deviation.max(f64::MIN_POSITIVE));
    }

    pub(crate) fn append(&mut self, other: Scores) {
        self.0.extend(other.0);
    }

    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// Share of the truths inside, with intervals so many times as wide.
    pub(crate) fn inside(&self, times: f64) -> f64 {
        let inside = self.0.iter().filter(|z| z.abs() <= Z95 * times).count();
        inside as f64 / self.0.len().max(1) as f64
    }

    /// Mean square with intervals so many times as wide: 1 where they are right. A miss counts as five deviations at most.
    pub(crate) fn mean_square(&self, times: f64) -> f64 {
        let squares = self.0.iter().map(|z| (z / times).abs().min(5.0).powi(2));
        squares.sum::<f64>() / self.0.len().max(1) as f64
    }

    /// Whether intervals so many times as wide pass for right. Halfway, as a ratio, between right and 0.7 or 1.4 times as wide:
    /// mean squares of 2.0, 1 and 0.5. A hundred independent scores scatter by 0.14.
    pub(crate) fn right(&self, times: f64) -> bool {
        self.is_about(times, 1.0)
    }

    fn is_about(&self, times: f64, mean_square: f64) -> bool {
        (0.71..=1.43).contains(&(self.mean_square(times) / mean_square))
    }

    /// Intervals are right, and the same test would notice if they were 0.7 or 1.4 times as wide.
    #[track_caller]
    pub(crate) fn hold(&self, name: &str) {
        self.hold_as(name, 1.0);
    }

    /// The same of intervals that the documentation says are too wide: squares of the errors are so much of what they claim.
    #[track_caller]
    pub(crate) fn hold_as(&self, name: &str, mean_square: f64) {
        println!("{}", self.row(name));
        let found = self.mean_square(1.0);
        assert!(
            self.is_about(1.0, mean_square),
            "{name}: {found}, {mean_square} expected"
        );
        for times in [0.7, 1.4] {
            assert!(
                !self.is_about(times, mean_square),
                "{name}: {found} would pass at {times} times the interval"
            );
        }
    }

    /// A row of a table: how many, shares inside at 0.7, 1 and 1.4 times the interval, mean square.
    pub(crate) fn row(&self, name: &str) -> String {
        let percent = |times| 100.0 * self.inside(times);
        format!(
            "{name:34} {:6} {:7.1} {:7.1} {:7.1} {:7.2}",
            self.count(),
            percent(0.7),
            percent(1.0),
            percent(1.4),
            self.mean_square(1.0)
        )
    }
}

/// Heading of [`Scores::row`].
#[allow(dead_code, reason = "tables are those of examples/coverage.rs")]
pub(crate) fn heading() -> String {
    format!(
        "{:34} {:>6} {:>7} {:>7} {:>7} {:>7}",
        "inside, %, at so much the interval", "of", "0.7", "1", "1.4", "z²"
    )
}
