//! Parsers of shares, temperatures, durations and guiding pulleys.

use crate::args::{not_negative, number, positive};
use sinew_rope::predict::{DAY_S, Guide, HOUR_S, MONTH_S, YEAR_S};

/// Parses a share between 0 and 1.
pub(super) fn share(text: &str) -> Result<f64, String> {
    match number(text, "(a share)")? {
        v if v > 0.0 && v < 1.0 => Ok(v),
        v => Err(format!("{v} must be between 0 and 1")),
    }
}

/// Parses a temperature, °C.
pub(crate) fn celsius(text: &str) -> Result<f64, String> {
    match number(text, "°C")? {
        v if (-100.0..=200.0).contains(&v) => Ok(v),
        v => Err(format!("{v} °C must be between -100 and 200 °C")),
    }
}

/// Parses a duration, `30min`, `8h`, `2d`, `3month` or `1year`; a number without unit is in seconds.
pub(crate) fn duration(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let end = text
        .find(|c: char| c.is_ascii_alphabetic() && c != 'e' && c != 'E')
        .unwrap_or(text.len());
    let (value, unit) = text.split_at(end);
    let unit_s = match unit.trim() {
        "" | "s" => 1.0,
        "min" => 60.0,
        "h" => HOUR_S,
        "d" => DAY_S,
        "month" | "months" => MONTH_S,
        "y" | "year" | "years" => YEAR_S,
        other => {
            return Err(format!(
                "'{other}' is not a unit of time; expected e.g. 30min, 8h, 2d, 3month, 1year"
            ));
        }
    };
    match number(value, "a duration")? * unit_s {
        s if s > 0.0 && s <= 100.0 * YEAR_S => Ok(s),
        s => Err(format!("{s} s must be above 0 and at most 100 years")),
    }
}

/// Parses a guiding pulley, `WRAP_DEG:RADIUS_MM[:FRICTION][@AT_MM]`.
pub(super) fn guide(text: &str) -> Result<Guide, String> {
    let form = "expected WRAP_DEG:RADIUS_MM[:FRICTION][@AT_MM], e.g. 90:8 or 60:8:0.05@250";
    let (rest, at) = match text.split_once('@') {
        Some((rest, at)) => (rest, Some(at)),
        None => (text, None),
    };
    let parts: Vec<&str> = rest.split(':').collect();
    let (wrap, radius, friction) = match parts[..] {
        [wrap, radius] => (wrap, radius, None),
        [wrap, radius, friction] => (wrap, radius, Some(friction)),
        _ => return Err(form.into()),
    };
    Ok(Guide {
        wrap_rad: not_negative("°")(wrap)?.to_radians(),
        radius_m: 1e-3 * positive("mm")(radius)?,
        friction: friction.map(not_negative("(friction)")).transpose()?,
        at_m: at.map(not_negative("mm")).transpose()?.map(|mm| 1e-3 * mm),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_report::rope::spoken;

    #[test]
    fn duration_parses_and_formats() {
        for (text, s, words) in [
            ("45", 45.0, "45 s"),
            ("30min", 1800.0, "30 min"),
            ("8h", 28_800.0, "8 h"),
            ("1e3 s", 1000.0, "16.7 min"),
            ("2 d", 172_800.0, "2 days"),
            ("1month", MONTH_S, "1 month"),
            ("10years", 10.0 * YEAR_S, "10 years"),
        ] {
            assert_eq!(duration(text), Ok(s), "{text}");
            assert_eq!(spoken(s), words);
        }
        for text in ["", "h", "-1h", "3 weeks", "nan", "1000year"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }

    #[test]
    fn guide_parses_fields() {
        let g = guide("60:8:0.05@250").expect("a guide");
        assert_eq!((g.wrap_rad, g.radius_m), (60_f64.to_radians(), 0.008));
        assert_eq!((g.friction, g.at_m), (Some(0.05), Some(0.25)));
        let g = guide("180:10").expect("a guide");
        assert_eq!((g.friction, g.at_m), (None, None));
        for text in ["60", "60:0", "a:8", "60:8:1:2", "60:8@", "-5:8"] {
            assert!(guide(text).is_err(), "{text}");
        }
    }
}
