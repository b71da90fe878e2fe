//! Comparison of intervals with the truth: errors in units of the interval's own standard
//! deviation. Tests of other crates use it too.

#![allow(dead_code, reason = "each crate uses its own part")]

/// Errors of many intervals, each over its own standard deviation.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scores(Vec<f64>);

/// Quantile of the normal distribution behind a 95 % interval.
const Z95: f64 = 1.96;

impl Scores {
    /// Adds an interval of a value, and the truth.
    pub(crate) fn add(&mut self, value: f64, low: f64, high: f64, truth: f64) {
        let side = if truth > value {
            high - value
        } else {
            value - low
        };
        self.0
            .push(Z95 * (truth - value) / side.max(f64::MIN_POSITIVE));
    }

    /// Adds an error with its reported standard deviation.
    pub(crate) fn add_error(&mut self, error: f64, std: f64) {
        self.0.push(error / std.max(f64::MIN_POSITIVE));
    }

    pub(crate) fn append(&mut self, other: Scores) {
        self.0.extend(other.0);
    }

    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// Coverage of the truths with intervals scaled by `times`.
    pub(crate) fn inside(&self, times: f64) -> f64 {
        let inside = self.0.iter().filter(|z| z.abs() <= Z95 * times).count();
        inside as f64 / self.0.len().max(1) as f64
    }

    /// Mean square with intervals scaled by `times`: 1 if they are calibrated. An error counts as
    /// five standard deviations at most.
    pub(crate) fn mean_square(&self, times: f64) -> f64 {
        let squares = self.0.iter().map(|z| (z / times).abs().min(5.0).powi(2));
        squares.sum::<f64>() / self.0.len().max(1) as f64
    }

    /// Whether intervals scaled by `times` pass as calibrated. Halfway, as a ratio, between 1 and
    /// 0.7 or 1.4 times the width: mean squares of 2.0, 1 and 0.5. A hundred independent scores
    /// scatter by 0.14.
    pub(crate) fn right(&self, times: f64) -> bool {
        self.is_about(times, 1.0)
    }

    fn is_about(&self, times: f64, mean_square: f64) -> bool {
        (0.71..=1.43).contains(&(self.mean_square(times) / mean_square))
    }

    /// Asserts that intervals are calibrated, and that the same test would fail for 0.7 or 1.4
    /// times the width.
    #[track_caller]
    pub(crate) fn hold(&self, name: &str) {
        self.hold_as(name, 1.0);
    }

    /// Asserts the mean square of intervals that are documented as too wide: squared errors divided by
    /// those of the interval.
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

    /// Row of a table: count, coverage at 0.7, 1 and 1.4 times the interval, mean square.
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
