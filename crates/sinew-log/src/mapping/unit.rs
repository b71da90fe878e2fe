//! Units of a recording's signals.

use crate::frame::Quantity;
use sinew_files::unit::{Dimension as D, Unit};

/// Dimensions of the units in a mapping.
const DIMENSIONS: [D; 10] = [
    D::One,
    D::Angle,
    D::Count,
    D::AngularVelocity,
    D::Velocity,
    D::Length,
    D::Torque,
    D::Force,
    D::Current,
    D::Temperature,
];

/// Finds a unit by its name; the error lists the valid names.
pub(super) fn parse(text: &str) -> Result<Unit, String> {
    Unit::parse(text, &DIMENSIONS)
}

/// Whether a value in this unit can be the quantity without a further `scale`.
pub(super) fn fits(unit: Unit, quantity: Quantity) -> bool {
    let wanted: &[D] = match quantity {
        Quantity::Q | Quantity::Theta => &[D::Angle, D::Length, D::Count],
        Quantity::Dq => &[D::AngularVelocity, D::Velocity],
        Quantity::TauM => &[D::Torque, D::Force, D::Current],
        Quantity::TauEl | Quantity::TauExt => &[D::Torque, D::Force],
        Quantity::Temperature => &[D::Temperature],
        Quantity::Tension => &[D::Force],
    };
    unit.dimension == D::One || wanted.contains(&unit.dimension)
}

/// Power of ten from a time unit to nanoseconds.
pub(crate) fn time_unit_exponent(text: &str) -> Result<i32, String> {
    match text {
        "s" | "sec" | "seconds" => Ok(9),
        "ms" | "msec" => Ok(6),
        "us" | "µs" | "μs" | "usec" => Ok(3),
        "ns" | "nsec" => Ok(0),
        _ => Err(format!(
            "unknown time unit '{text}': valid units are s, ms, us, ns"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_ten_of_time_are_those_of_the_table_of_units() {
        for (name, exponent) in [("s", 9), ("ms", 6), ("us", 3), ("µs", 3), ("ns", 0)] {
            assert_eq!(time_unit_exponent(name), Ok(exponent));
            let second = Unit::parse(name, &[D::Time]).expect("a time");
            let ns = second.factor * 1e9;
            assert!((ns / 10_f64.powi(exponent) - 1.0).abs() < 1e-14, "{name}");
        }
        let refused = time_unit_exponent("min").expect_err("not a power of ten");
        assert!(refused.contains("'min'"), "{refused}");
    }
}
