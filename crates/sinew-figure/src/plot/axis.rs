//! Axis ranges, ticks and tick labels.

use super::{Annotation, Panel, Series};

/// Linear axis with its ticks.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) ticks: Vec<f64>,
    decimals: usize,
    /// Exponent of ten by which the tick numbers are scaled.
    pub(super) exponent: i32,
    /// Tick labels that replace the numbers; empty: numbers.
    names: Vec<String>,
}

/// Smallest magnitude written as a multiple of a power of ten.
const MIN_SCALED_MAGNITUDE: f64 = 1e5;
/// Largest magnitude below which numbers are written as multiples of a power of ten.
const MAX_SCALED_MAGNITUDE: f64 = 1e-2;
/// Minimum axis range; below it, divisions overflow.
const MIN_RANGE: f64 = 1e-280;

impl Axis {
    /// Creates an axis over `low..high` with about `count` ticks at 1, 2, 2.5 or 5 times a power of ten.
    pub(super) fn new(low: f64, high: f64, count: usize) -> Self {
        let (low, high) = widened(low, high);
        let largest = low.abs().max(high.abs());
        let exponent = if (MAX_SCALED_MAGNITUDE..MIN_SCALED_MAGNITUDE).contains(&largest) {
            0
        } else {
            3 * (largest.log10() / 3.0).floor() as i32
        };
        let step = nice_step((high - low) / count.max(1) as f64);
        let unit = 10f64.powi(exponent);
        let mut ticks = Vec::new();
        let first = (low / step - 1e-9).ceil();
        // Twice the requested count is an upper bound for all step sizes.
        for i in 0..(2 * count + 4) {
            let tick = (first + i as f64) * step;
            // A recording of 39.998 s has a tick at 40: 0.1 % of the axis is less than one pixel.
            if tick > high + 1e-3 * (high - low) {
                break;
            }
            ticks.push(tick);
        }
        Self {
            low,
            high,
            ticks,
            decimals: decimals_of(step / unit),
            exponent,
            names: Vec::new(),
        }
    }

    /// Creates an axis with named positions instead of numbers; `fits` decides whether a name has room next to the
    /// previous ones.
    pub(super) fn named(
        mut self,
        names: &[(f64, String)],
        fits: impl Fn(&[(f64, String)], &(f64, String)) -> bool,
    ) -> Self {
        if names.is_empty() {
            return self;
        }
        let slack = 1e-6 * (self.high - self.low);
        let inside = |at: f64| at >= self.low - slack && at <= self.high + slack;
        let mut taken: Vec<(f64, String)> = Vec::new();
        for name in names.iter().filter(|n| inside(n.0)) {
            if fits(&taken, name) {
                taken.push(name.clone());
            }
        }
        taken.sort_by(|a, b| a.0.total_cmp(&b.0));
        (self.ticks, self.names) = taken.into_iter().unzip();
        self.exponent = 0;
        self
    }

    /// Returns the relative position of a value, 0 at `low` and 1 at `high`.
    pub(super) fn position(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Formats the number or name at a tick.
    pub(super) fn number(&self, value: f64) -> String {
        let named = self.ticks.iter().position(|t| *t == value);
        if let Some(name) = named.and_then(|i| self.names.get(i)) {
            return name.clone();
        }
        let scaled = value / 10f64.powi(self.exponent);
        let text = format!("{scaled:.*}", self.decimals);
        if text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) {
            text.trim_start_matches('-').to_string()
        } else {
            text.replace('-', "−")
        }
    }

    /// Returns the axis label with the power of ten by which its numbers are scaled.
    pub(super) fn label(&self, label: &str) -> String {
        if self.exponent == 0 {
            return label.to_string();
        }
        let power: String = self.exponent.to_string().chars().map(superscript).collect();
        format!("{label} × 10{power}")
    }
}

fn superscript(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        other => other
            .to_digit(10)
            .and_then(|d| char::from_u32(0x2070 + d))
            .unwrap_or(other),
    }
}

/// Returns the smallest of 1, 2, 2.5 or 5 times a power of ten that is at least `rough`.
fn nice_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let mantissa = rough / power;
    let nice = [1.0, 2.0, 2.5, 5.0]
        .into_iter()
        .find(|&m| mantissa <= m * (1.0 + 1e-9))
        .unwrap_or(10.0);
    nice * power
}

/// Returns the number of decimals that represent multiples of `step` exactly.
fn decimals_of(step: f64) -> usize {
    (0..12)
        .find(|&d| {
            let scaled = step * 10f64.powi(d as i32);
            (scaled - scaled.round()).abs() < 1e-6 * scaled.max(1.0) && scaled.round() >= 1.0
        })
        .unwrap_or(12)
}

/// Converts an empty, reversed or non-finite range into a valid one.
fn widened(low: f64, high: f64) -> (f64, f64) {
    if !(low.is_finite() && high.is_finite()) {
        return (0.0, 1.0);
    }
    let (low, high) = if low <= high {
        (low, high)
    } else {
        (high, low)
    };
    // Beyond this, differences overflow.
    let (low, high) = (low.clamp(-1e300, 1e300), high.clamp(-1e300, 1e300));
    let size = low.abs().max(high.abs());
    // In a narrower range, neighbouring pixels have the same floating-point value.
    if high - low > (1e-9 * size).max(MIN_RANGE) {
        (low, high)
    } else if size < MIN_RANGE {
        (-1.0, 1.0)
    } else {
        (low - 0.1 * size, high + 0.1 * size)
    }
}

/// Returns the smallest and largest finite value; `None` if there is none.
fn extent<'a>(values: impl IntoIterator<Item = &'a f64>) -> Option<(f64, f64)> {
    let mut range: Option<(f64, f64)> = None;
    for &v in values {
        if v.is_finite() {
            range = Some(range.map_or((v, v), |(a, b)| (a.min(v), b.max(v))));
        }
    }
    range
}

/// Returns the required range of a panel's horizontal axis.
pub(super) fn x_extent(panel: &Panel) -> (f64, f64) {
    let fitted = || extent(panel.series.iter().flat_map(Series::x));
    finite(panel.x_range).or_else(fitted).unwrap_or((0.0, 1.0))
}

/// Returns the required range of a panel's vertical axis, over the visible part of the horizontal one.
pub(super) fn y_extent(panel: &Panel, x: (f64, f64)) -> (f64, f64) {
    if let Some(range) = finite(panel.y_range) {
        return range;
    }
    let visible = |xs: &[f64], ys: &[f64]| -> Option<(f64, f64)> {
        let inside = xs.iter().zip(ys).filter(|(t, _)| (x.0..=x.1).contains(*t));
        extent(inside.map(|(_, y)| y))
    };
    let of_series = (panel.series.iter())
        .flat_map(|series| series.ys().map(|ys| visible(series.x(), ys)))
        .collect::<Vec<_>>()
        .into_iter();
    let of_marks = panel.marks.iter().map(|mark| match mark {
        Annotation::Reference { y, .. } | Annotation::Note { y, .. } => extent([y]),
        Annotation::Event { .. } | Annotation::Span { .. } => None,
    });
    let all: Vec<f64> = of_series
        .chain(of_marks)
        .flatten()
        .flat_map(|(a, b)| [a, b])
        .collect();
    let Some((low, high)) = extent(&all) else {
        return (0.0, 1.0);
    };
    let (low, high) = widened(low, high);
    let margin = 0.06 * (high - low);
    (low - margin, high + margin)
}

fn finite(range: Option<(f64, f64)>) -> Option<(f64, f64)> {
    range.filter(|(a, b)| a.is_finite() && b.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(low: f64, high: f64, count: usize) -> Vec<String> {
        let axis = Axis::new(low, high, count);
        axis.ticks.iter().map(|&t| axis.number(t)).collect()
    }

    #[test]
    fn ticks_are_round_numbers_with_the_digits_they_need() {
        assert_eq!(numbers(0.0, 10.0, 5), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(numbers(-0.3, 0.3, 4), ["−0.2", "0.0", "0.2"]);
        assert_eq!(
            numbers(0.0, 1.0, 4),
            ["0.00", "0.25", "0.50", "0.75", "1.00"]
        );
        assert_eq!(
            numbers(9.98, 10.02, 4),
            ["9.98", "9.99", "10.00", "10.01", "10.02"]
        );
    }

    #[test]
    fn small_and_large_numbers_leave_their_power_to_the_label() {
        let axis = Axis::new(0.0, 4e-6, 4);
        assert_eq!(axis.number(axis.ticks[1]), "1");
        assert_eq!(axis.label("offset (rad)"), "offset (rad) × 10⁻⁶");
        assert_eq!(Axis::new(0.0, 3e6, 3).label("frames"), "frames × 10⁶");
    }

    #[test]
    fn axis_degenerate_range_is_drawable() {
        for (low, high) in [
            (0.0, 0.0),
            (5.0, 5.0),
            (3.0, -3.0),
            (f64::NAN, 1.0),
            (f64::NEG_INFINITY, f64::INFINITY),
            (1e300, 1e300),
            (-5e-324, 5e-324),
            (f64::MIN, f64::MAX / 2.0),
        ] {
            let axis = Axis::new(low, high, 5);
            assert!(axis.low < axis.high, "{low} {high}: {axis:?}");
            assert!(axis.ticks.len() <= 14, "{low} {high}");
            assert!(axis.ticks.iter().all(|t| axis.position(*t).is_finite()));
        }
    }

    #[test]
    fn axis_has_2_to_6_ticks_in_range() {
        for i in 0..500 {
            let low = (f64::from(i) * 0.731).sin() * 10f64.powi(i % 9 - 4);
            let high = low + (1.1 + (f64::from(i) * 1.3).cos()) * 10f64.powi(i % 7 - 3);
            let axis = Axis::new(low, high, 5);
            assert!((2..=6).contains(&axis.ticks.len()), "{low} {high} {axis:?}");
            for &t in &axis.ticks {
                let at = axis.position(t);
                assert!((-1e-6..=1.001_001).contains(&at), "{low} {high} {t}");
            }
        }
    }
}
