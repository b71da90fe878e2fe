//! Option values with a unit, such as `60N`, `700mm`, `3weeks`, `22degC` or `80%`.
//!
//! Each quantity has one parser. A number without a unit is in the unit that `--help` names.

use sinew_files::unit::{Dimension, Unit};
use sinew_rope::predict::{MONTH_S, YEAR_S};
use std::str::FromStr;

/// Physical quantity of an option value.
pub(crate) trait Quantity: Copy {
    /// Dimensions of its units.
    const DIMENSIONS: &'static [Dimension];
    /// Unit of a number without a unit.
    const UNIT: &'static str;
    /// Units that files do not name, with their factors to the SI unit.
    const OTHERS: &'static [(&'static str, f64)] = &[];
    /// Valid value, for messages.
    const EXAMPLE: &'static str;

    /// Creates a value from its SI unit (temperatures: °C).
    fn of_si(si: f64) -> Self;

    /// Value in the SI unit (temperatures: °C).
    fn si(self) -> f64;
}

/// Defines quantities as numbers in their SI unit (temperatures: °C).
macro_rules! quantities {
    ($($(#[$doc:meta])* $name:ident: $dimensions:expr, $unit:literal, $example:literal $(, $others:expr)?;)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
        pub(crate) struct $name(pub(crate) f64);

        impl Quantity for $name {
            const DIMENSIONS: &'static [Dimension] = $dimensions;
            const UNIT: &'static str = $unit;
            $(const OTHERS: &'static [(&'static str, f64)] = $others;)?
            const EXAMPLE: &'static str = $example;

            fn of_si(si: f64) -> Self {
                Self(si)
            }

            fn si(self) -> f64 {
                self.0
            }
        }

        impl FromStr for $name {
            type Err = String;

            fn from_str(text: &str) -> Result<Self, String> {
                parse(text)
            }
        }
    )*};
}

/// Seconds of a week.
const WEEK_S: f64 = 604_800.0;

quantities! {
    /// Option value of a length, m.
    Length: &[Dimension::Length], "mm", "700mm";
    /// Option value of an area, m².
    Area: &[Dimension::Area], "mm2", "0.8mm2";
    /// Option value of a force, N.
    Force: &[Dimension::Force], "N", "60N";
    /// Option value of a torque, N·m.
    Torque: &[Dimension::Torque], "N·m", "2Nm";
    /// Option value of a temperature, °C.
    Temperature: &[Dimension::Temperature], "°C", "22degC";
    /// Option value of an angle, rad.
    Angle: &[Dimension::Angle], "rad", "10mrad";
    /// Share, as a ratio.
    Share: &[Dimension::Ratio], "ratio", "80%", &[("ratio", 1.0)];
    /// Time or duration, s.
    Time: &[Dimension::Time], "s", "30min, 8h, 2d, 3weeks, 1year", &[
        ("week", WEEK_S),
        ("weeks", WEEK_S),
        ("month", MONTH_S),
        ("months", MONTH_S),
        ("y", YEAR_S),
        ("year", YEAR_S),
        ("years", YEAR_S),
    ];
    /// Option value of a mass, kg.
    Mass: &[], "kg", "0.5kg", &[("kg", 1.0), ("g", 1e-3)];
}

/// Parses a finite value, a number with or without a unit.
pub(crate) fn parse<Q: Quantity>(text: &str) -> Result<Q, String> {
    let text = text.trim();
    let number = |end: &usize| text[..*end].trim().parse::<f64>().ok();
    let mut ends: Vec<usize> = text.char_indices().map(|(at, _)| at).skip(1).collect();
    ends.push(text.len());
    let expected = || format!("expected e.g. {} (without a unit: {})", Q::EXAMPLE, Q::UNIT);
    // The longest number: `1e3s` are a thousand seconds.
    let end = ends.into_iter().rev().find(|end| number(end).is_some());
    let Some((value, unit)) = end.and_then(|end| Some((number(&end)?, text[end..].trim()))) else {
        return Err(format!("'{text}' is not a number; {}", expected()));
    };
    if !value.is_finite() {
        return Err(format!("'{text}' is not a finite number; {}", expected()));
    }
    let unit = if unit.is_empty() { Q::UNIT } else { unit };
    let si = match Q::OTHERS.iter().find(|(name, _)| *name == unit) {
        Some((_, factor)) => scaled(value, *factor),
        None => {
            let found = Unit::parse(unit, Q::DIMENSIONS);
            let found =
                found.map_err(|_| format!("'{unit}' is not a valid unit; {}", expected()))?;
            scaled(value, found.factor) + found.offset
        }
    };
    Ok(Q::of_si(si))
}

/// Product of a value and the factor of its unit. A factor such as 0.01 is no binary number: the quotient by its inverse is
/// the nearest number to the product, so that 95 % is 0.95.
fn scaled(value: f64, factor: f64) -> f64 {
    let inverse = (1.0 / factor).round();
    match factor < 1.0 && (inverse * factor - 1.0).abs() < f64::EPSILON {
        true => value / inverse,
        false => value * factor,
    }
}

/// Value as it was specified, with the unit of the quantity if none was.
fn with_unit<Q: Quantity>(text: &str) -> String {
    match text.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
        true if !Q::UNIT.is_empty() => format!("{text} {}", Q::UNIT),
        _ => text.to_owned(),
    }
}

/// Parses a value above 0.
pub(crate) fn above_zero<Q: Quantity>(text: &str) -> Result<Q, String> {
    match parse::<Q>(text)? {
        value if value.si() > 0.0 => Ok(value),
        _ => Err(format!("{} must be above 0", with_unit::<Q>(text))),
    }
}

/// Parses a value of at least 0.
pub(crate) fn at_least_zero<Q: Quantity>(text: &str) -> Result<Q, String> {
    match parse::<Q>(text)? {
        value if value.si() >= 0.0 => Ok(value),
        _ => Err(format!("{} must be at least 0", with_unit::<Q>(text))),
    }
}

/// Parses a share between 0 and 1.
pub(crate) fn part(text: &str) -> Result<Share, String> {
    match parse(text)? {
        Share(ratio) if ratio > 0.0 && ratio < 1.0 => Ok(Share(ratio)),
        Share(ratio) => Err(format!(
            "{text} is a ratio of {ratio}; it must be between 0 and 1 (0 and 100 %)"
        )),
    }
}

/// Parses a temperature of a rope, °C.
pub(crate) fn rope_temperature(text: &str) -> Result<Temperature, String> {
    match parse(text)? {
        Temperature(c) if (-100.0..=200.0).contains(&c) => Ok(Temperature(c)),
        Temperature(c) => Err(format!("{c} °C must be between -100 and 200 °C")),
    }
}

/// Parses a duration above 0 and of at most 100 years.
pub(crate) fn duration(text: &str) -> Result<Time, String> {
    match parse(text)? {
        Time(s) if s > 0.0 && s <= 100.0 * YEAR_S => Ok(Time(s)),
        _ => Err(format!(
            "{} must be above 0 and at most 100 years",
            with_unit::<Time>(text)
        )),
    }
}

/// Parses a value with optional standard deviation, `0.5±0.02` or `0.5+-0.02`, both with or without a unit.
///
/// * `difference`: parser of the standard deviation, which has no zero point.
pub(crate) fn with_std<Q: Quantity>(
    text: &str,
    difference: impl Fn(&str) -> Result<f64, String>,
) -> Result<(f64, Option<f64>), String> {
    match text.split_once('±').or_else(|| text.split_once("+-")) {
        Some((mean, std)) => Ok((parse::<Q>(mean)?.si(), Some(difference(std)?))),
        None => Ok((parse::<Q>(text)?.si(), None)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_report::rope::spoken;

    #[test]
    fn decimal_values_are_the_nearest_numbers() {
        assert_eq!(parse::<Share>("95%"), Ok(Share(0.95)));
        assert_eq!(parse::<Length>("700mm"), Ok(Length(0.7)));
        assert_eq!(parse::<Mass>("85g"), Ok(Mass(0.085)));
        assert_eq!(parse::<Time>("0.3h"), Ok(Time(1080.0)));
    }

    #[test]
    fn values_with_units_become_si() {
        let close = |found: f64, si: f64, text: &str| {
            assert!((found - si).abs() <= 1e-12 * si.abs(), "{text}: {found}");
        };
        for (text, si) in [
            ("700", 0.7),
            ("700mm", 0.7),
            ("0.7 m", 0.7),
            ("1in", 0.0254),
        ] {
            close(parse::<Length>(text).unwrap().0, si, text);
        }
        for (text, si) in [
            ("60", 60.0),
            ("60N", 60.0),
            ("6kgf", 58.8399),
            ("1e-1kN", 100.0),
        ] {
            close(parse::<Force>(text).unwrap().0, si, text);
        }
        for (text, si) in [
            ("22", 22.0),
            ("22degC", 22.0),
            ("-5°C", -5.0),
            ("300K", 26.85),
        ] {
            assert!(
                (parse::<Temperature>(text).unwrap().0 - si).abs() < 1e-12,
                "{text}"
            );
        }
        for (text, si) in [("0.8", 0.8), ("80%", 0.8), ("80 %", 0.8), ("5‰", 0.005)] {
            close(parse::<Share>(text).unwrap().0, si, text);
        }
        close(parse::<Area>("0.8").unwrap().0, 0.8e-6, "area");
        close(parse::<Torque>("2Nm").unwrap().0, 2.0, "torque");
        close(parse::<Angle>("10mrad").unwrap().0, 0.01, "angle");
        close(parse::<Mass>("500g").unwrap().0, 0.5, "mass");
    }

    #[test]
    fn durations_have_units_up_to_years() {
        for (text, s, words) in [
            ("45", 45.0, "45 s"),
            ("30min", 1800.0, "30 min"),
            ("8h", 28_800.0, "8 h"),
            ("1e3 s", 1000.0, "16.7 min"),
            ("2 d", 172_800.0, "2 days"),
            ("1month", MONTH_S, "1 month"),
            ("10years", 10.0 * YEAR_S, "10 years"),
        ] {
            assert_eq!(duration(text), Ok(Time(s)), "{text}");
            assert_eq!(spoken(s), words);
        }
        assert_eq!(duration("3weeks"), Ok(Time(21.0 * 86_400.0)));
        for text in ["", "h", "-1h", "3 fortnights", "nan", "1000year"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }

    #[test]
    fn invalid_values_name_the_unit() {
        for text in ["", "N", "60mm", "60 stone", "nan", "infN", "6 0"] {
            let error = parse::<Force>(text).unwrap_err();
            assert!(
                error.contains("60N") && error.contains("without a unit: N"),
                "{error}"
            );
        }
        assert!(above_zero::<Force>("0N").unwrap_err().contains("above 0"));
        assert!(
            at_least_zero::<Length>("-1")
                .unwrap_err()
                .contains("at least 0")
        );
        assert!(part("80").unwrap_err().contains("100 %"));
        assert!(rope_temperature("300").is_err());
    }
}
