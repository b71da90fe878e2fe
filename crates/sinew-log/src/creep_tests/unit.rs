//! Units of a test laboratory.

use super::TestQuantity;
use crate::unit::{Dimension as D, Unit};

/// What the units of a creep test measure.
const DIMENSIONS: [D; 8] = [
    D::One,
    D::Time,
    D::Force,
    D::Pressure,
    D::Length,
    D::Area,
    D::Ratio,
    D::Temperature,
];

/// Finds a unit; the error lists what is known.
pub(super) fn parse(text: &str) -> Result<Unit, String> {
    Unit::parse(text, &DIMENSIONS)
}

impl Unit {
    /// Whether a value in this unit can be the quantity.
    pub(super) fn fits(self, quantity: TestQuantity) -> bool {
        let wanted: &[D] = match quantity {
            TestQuantity::Time => &[D::Time],
            TestQuantity::Force => &[D::Force],
            TestQuantity::Stress | TestQuantity::Modulus => &[D::Pressure],
            TestQuantity::Elongation | TestQuantity::GaugeLength => &[D::Length],
            TestQuantity::Strain | TestQuantity::Humidity => &[D::Ratio, D::One],
            TestQuantity::Temperature => &[D::Temperature],
            TestQuantity::Area => &[D::Area],
        };
        wanted.contains(&self.dimension)
    }

    /// A raw value in the unit the quantity is kept in.
    pub(super) fn convert(self, quantity: TestQuantity, raw: f64) -> f64 {
        let value = raw * self.factor + self.offset;
        if quantity == TestQuantity::Humidity {
            100.0 * value
        } else {
            value
        }
    }
}
