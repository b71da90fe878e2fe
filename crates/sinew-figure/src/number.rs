//! Numbers as a reader wants them: two digits of what is uncertain, none of what is not known.

/// Most decimals shown: below a tenth of a microradian (in mrad) nothing here is known.
const MOST_DECIMALS: i32 = 4;

/// Decimals that show `digits` significant digits of `size`, 0 to 4.
fn decimals(size: f64, digits: i32) -> usize {
    if !size.is_finite() || size == 0.0 {
        return 2;
    }
    let leading = size.abs().log10().floor() as i32;
    (digits - 1 - leading).clamp(0, MOST_DECIMALS) as usize
}

fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let text = format!("{value:.decimals$}");
    if text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) {
        text.trim_start_matches('-').to_string()
    } else {
        text.replace('-', "−")
    }
}

/// A value with `digits` significant digits and at most four decimals; `–` where there is none.
pub fn rounded(value: f64, digits: u8) -> String {
    fixed(value, decimals(value, i32::from(digits)))
}

/// A value to two digits of its standard error: `10.02 ± 0.13`; three digits without one.
pub fn with_error(value: f64, standard_error: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    if !(standard_error.is_finite() && standard_error > 0.0) {
        return rounded(value, 3);
    }
    let decimals = decimals(standard_error, 2);
    format!(
        "{} ± {}",
        fixed(value, decimals),
        fixed(standard_error, decimals)
    )
}

/// A whole number with a thin gap between thousands: `1 234 567`.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(c);
    }
    out
}

/// A value that was given, to six decimals without trailing zeros: `20`, `0.125`.
pub fn given(value: f64) -> String {
    let text = fixed(value, 6);
    match text.split_once('.') {
        Some((whole, rest)) if rest.trim_end_matches('0').is_empty() => whole.to_string(),
        Some(_) => text.trim_end_matches('0').to_string(),
        None => text,
    }
}

/// A share of all frames as a percentage that never rounds a loss away.
pub fn share(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        p if !p.is_finite() => "–".into(),
        p if p <= 0.0 => "0 %".into(),
        p if p >= 100.0 => "100 %".into(),
        p if p > 99.9 => "over 99.9 %".into(),
        p if p < 0.1 => "under 0.1 %".into(),
        p => format!("{p:.1} %"),
    }
}

/// Seconds in words of a fitting unit.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() => "–".into(),
        s if s < 600.0 => format!("{} s", given((1e3 * s).round() / 1e3)),
        s if s < 3.0 * 3600.0 => format!("{} min", given((10.0 * s / 60.0).round() / 10.0)),
        s => format!("{} h", given((100.0 * s / 3600.0).round() / 100.0)),
    }
}

/// Nanoseconds since 1970 as UTC; `None` when that is no plausible date of a recording.
pub fn date_utc(time_ns: i64) -> Option<String> {
    /// 2000-01-01: earlier stamps count from a boot or from the recording's start.
    const EARLIEST_S: i64 = 946_684_800;
    let seconds = time_ns.div_euclid(1_000_000_000);
    if seconds < EARLIEST_S {
        return None;
    }
    let (days, of_day) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    // Civil date of a day count, with years that begin in March so that the leap day is last
    // (H. Hinnant, "chrono-compatible low-level date algorithms").
    let z = days + 719_468;
    let era = z.div_euclid(146_097);
    let of_era = z.rem_euclid(146_097);
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    Some(format!(
        "{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_shows_two_digits_of_its_error() {
        assert_eq!(with_error(10.0234, 0.1321), "10.02 ± 0.13");
        assert_eq!(with_error(-0.00003, 0.0042), "0.0000 ± 0.0042");
        assert_eq!(with_error(-1234.6, 56.7), "−1235 ± 57");
        assert_eq!(with_error(10.0234, f64::NAN), "10.0");
        assert_eq!(with_error(f64::NAN, 1.0), "–");
        assert_eq!(rounded(0.256_78, 2), "0.26");
        assert_eq!(rounded(1.2e-9, 2), "0.0000");
    }

    #[test]
    fn a_loss_is_never_rounded_away() {
        assert_eq!(share(0.999_999), "over 99.9 %");
        assert_eq!(share(1e-7), "under 0.1 %");
        assert_eq!(share(1.0), "100 %");
        assert_eq!(share(0.1234), "12.3 %");
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date_utc(0), None);
        // date -u -d @1709210096
        let leap_day = date_utc(1_709_210_096_500_000_000);
        assert_eq!(leap_day.as_deref(), Some("2024-02-29 12:34:56 UTC"));
        let new_year = date_utc(1_767_225_599_000_000_000);
        assert_eq!(new_year.as_deref(), Some("2025-12-31 23:59:59 UTC"));
    }

    #[test]
    fn thousands_are_apart() {
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(count(999), "999");
    }
}
