//! An estimated quantity and its uncertainty, in SI.

/// Standard deviations on either side of the mean that hold 95 % of a normal distribution, as
/// intervals are stated: 1.96, the usual rounded value.
pub const Z95: f64 = 1.96;
/// The 97.5 % quantile to full precision. It converts the 95 % bounds of a catalogue to a standard
/// deviation, so that a draw at the quantile equals the bound.
pub const QUANTILE_975: f64 = 1.959_963_984_540_054;

/// A normally distributed quantity, in the unit that the name of its field or function states.
///
/// `std` is one standard deviation. It is converted to the half-width of a 95 % interval only for
/// display.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Gaussian {
    /// Mean of the quantity.
    pub mean: f64,
    /// Standard deviation, not negative.
    #[cfg_attr(feature = "serde", serde(alias = "deviation"))]
    pub std: f64,
}

impl Gaussian {
    /// From mean and standard deviation.
    pub const fn new(mean: f64, std: f64) -> Self {
        Self { mean, std }
    }

    /// Half the width of the 95 % interval.
    pub fn half_width_95(self) -> f64 {
        Z95 * self.std
    }

    /// The 95 % interval.
    pub fn interval_95(self) -> Interval95 {
        let half = self.half_width_95();
        Interval95 {
            low: self.mean - half,
            high: self.mean + half,
        }
    }

    /// Whether both numbers are finite.
    pub fn is_finite(self) -> bool {
        self.mean.is_finite() && self.std.is_finite()
    }

    /// Converts the quantity to another unit: `factor` new units equal one old unit.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            mean: factor * self.mean,
            std: factor.abs() * self.std,
        }
    }

    /// Probability of more than `x`: `½ erfc((x − mean)/(√2 std))`; NaN where that is none.
    pub fn probability_above(self, x: f64) -> f64 {
        0.5 * libm::erfc((x - self.mean) / (core::f64::consts::SQRT_2 * self.std))
    }

    /// Sum with an independent quantity.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            mean: self.mean + other.mean,
            std: libm::hypot(self.std, other.std),
        }
    }

    /// Whether zero lies outside the 95 % interval.
    pub fn is_nonzero_95(self) -> bool {
        self.mean.abs() > self.half_width_95()
    }
}

/// Bounds of a 95 % interval of a quantity, in the unit that its field's name states.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Interval95 {
    /// Lower bound of the interval.
    pub low: f64,
    /// Upper bound of the interval.
    pub high: f64,
}

impl Interval95 {
    /// From its bounds.
    pub const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Whether `x` is inside, the bounds included.
    pub fn contains(self, x: f64) -> bool {
        (self.low..=self.high).contains(&x)
    }
}

/// A value with possibly asymmetric bounds, in the unit that its field's name states.
///
/// The level of the bounds is 95 % unless the field states another.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bounded {
    /// Central value of the quantity.
    pub value: f64,
    /// Lower bound of the interval.
    pub low: f64,
    /// Upper bound of the interval.
    pub high: f64,
}

impl Bounded {
    /// Bounds at the same distance on either side.
    pub fn even(value: f64, half_width: f64) -> Self {
        Self {
            value,
            low: value - half_width,
            high: value + half_width,
        }
    }

    /// Converts the quantity to another unit: `factor` new units, above 0, equal one old unit.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            low: factor * self.low,
            high: factor * self.high,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interval_is_mean_and_multiple_of_std() {
        let offset_rad = Gaussian::new(0.012, 0.5e-3);
        let interval = offset_rad.interval_95();
        assert!(
            (interval.low - 0.011_02).abs() < 1e-15 && (interval.high - 0.012_98).abs() < 1e-15
        );
        assert!(interval.contains(0.0125) && !interval.contains(0.013));
        assert!(offset_rad.is_nonzero_95() && !Gaussian::new(0.9, 0.5).is_nonzero_95());
    }

    #[test]
    fn another_unit_is_the_same_interval() {
        let mm = Bounded::even(0.012, 0.002).scaled(1e3);
        assert!((mm.value - 12.0).abs() < 1e-12 && (mm.low - 10.0).abs() < 1e-12);
        assert!((mm.high - 14.0).abs() < 1e-12);
    }

    #[test]
    fn exceedance_probability_matches_table() {
        let x = Gaussian::new(1.0, 2.0);
        assert!((x.probability_above(1.0) - 0.5).abs() < 1e-15);
        assert!((x.probability_above(1.0 - 1.959_963_984_540_054 * 2.0) - 0.975).abs() < 1e-12);
        assert!((x.probability_above(5.0) - 0.022_750_131_948_179).abs() < 1e-12);
        assert!(Gaussian::new(f64::NAN, 1.0).probability_above(0.0).is_nan());
    }

    #[test]
    fn independent_stds_add_in_squares() {
        let sum = Gaussian::new(1.0, 3.0).plus(Gaussian::new(-3.0, 4.0));
        assert_eq!(sum, Gaussian::new(-2.0, 5.0));
    }

    #[test]
    fn std_stays_positive_after_unit_change() {
        assert_eq!(
            Gaussian::new(2.0, 0.5).scaled(-1e3),
            Gaussian::new(-2e3, 500.0)
        );
    }
}
