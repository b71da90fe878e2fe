//! Formatting of numbers: two digits of the uncertainty, a placeholder for missing values.

/// Maximum number of decimals: results are not more accurate than 0.1 µrad (in mrad).
const MOST_DECIMALS: i32 = 4;

/// Standard deviations on either side of a mean that hold 95 % of a normal distribution, as intervals are stated.
pub const Z95: f64 = 1.96;

/// Placeholder for a missing number.
const NONE: &str = "–";

/// Decimals that show `digits` significant digits of `size`, 0 to 4.
fn decimals(size: f64, digits: i32) -> usize {
    if !size.is_finite() || size == 0.0 {
        return 2;
    }
    let leading = size.abs().log10().floor() as i32;
    (digits - 1 - leading).clamp(0, MOST_DECIMALS) as usize
}

fn fixed(value: f64, decimals: usize) -> String {
    /// Above it a double has no decimals, and its digits are not those of the value.
    const MAX_FIXED: f64 = 1e15;
    if !value.is_finite() {
        return NONE.into();
    }
    let text = match value.abs() < MAX_FIXED {
        true => format!("{value:.decimals$}"),
        false => format!("{value:.2e}"),
    };
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

/// Formats a value with the half-width of its 95 % interval to two digits: `10.02 ± 0.26` for a standard error of
/// 0.13; three digits without an interval. Every number after ± in Sinew is the half-width of a 95 % interval.
pub fn with_interval(value: f64, standard_error: f64) -> String {
    let [value, half] = interval_cells(value, standard_error);
    match half.as_str() {
        NONE => value,
        half => format!("{value} ± {half}"),
    }
}

/// Formats value and half-width as two cells of a table with equal numbers of decimals; `–` for a missing value.
pub fn interval_cells(value: f64, standard_error: f64) -> [String; 2] {
    if !value.is_finite() {
        return [NONE.into(), NONE.into()];
    }
    if !(standard_error.is_finite() && standard_error > 0.0) {
        return [rounded(value, 3), NONE.into()];
    }
    let half = Z95 * standard_error;
    let decimals = decimals(half, 2);
    [fixed(value, decimals), fixed(half, decimals)]
}

/// A number to three digits, as group names, files and tables write it.
pub fn three_digits(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
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
        Some(_) if text.contains('e') => text,
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

/// Smallest probability that is printed as a number; below it, and above its complement, a bound is printed.
const MIN_PROBABILITY: f64 = 0.001;

/// Formats a probability: two decimals, three near 0 and 1, `< 0.001` and `> 0.999` beyond; never 0 or 1.
pub fn probability(probability: f64) -> String {
    match probability {
        p if !p.is_finite() => NONE.into(),
        p if p < MIN_PROBABILITY => format!("< {MIN_PROBABILITY}"),
        p if p > 1.0 - MIN_PROBABILITY => format!("> {}", 1.0 - MIN_PROBABILITY),
        // Two decimals would round to 0 or 1.
        p if !(0.005..0.995).contains(&p) => format!("{p:.3}"),
        p => format!("{p:.2}"),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probability_never_prints_zero_or_one() {
        for (p, text) in [
            (0.0, "< 0.001"),
            (0.0042, "0.004"),
            (0.5, "0.50"),
            (0.9849, "0.98"),
            (0.996, "0.996"),
            (1.0, "> 0.999"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(probability(p), text);
        }
    }

    #[test]
    fn value_has_two_digits_of_interval() {
        assert_eq!(with_interval(10.0234, 0.1321), "10.02 ± 0.26");
        assert_eq!(with_interval(-0.00003, 0.0042), "0.0000 ± 0.0082");
        assert_eq!(with_interval(-1234.6, 56.7), "−1235 ± 111");
        assert_eq!(with_interval(10.0234, f64::NAN), "10.0");
        assert_eq!(with_interval(f64::NAN, 1.0), "–");
        assert_eq!(interval_cells(12.794, 1.173), ["12.8", "2.3"]);
        assert_eq!(interval_cells(-0.1234, 0.306), ["−0.12", "0.60"]);
        assert_eq!(interval_cells(10.0234, 0.0), ["10.0", "–"]);
        assert_eq!(rounded(0.256_78, 2), "0.26");
        assert_eq!(rounded(1.2e-9, 2), "0.0000");
        assert_eq!(rounded(-1.234e300, 3), "−1.23e300");
        assert_eq!(given(1.5e20), "1.50e20");
    }

    #[test]
    fn share_never_rounds_loss_to_zero() {
        assert_eq!(share(0.999_999), "over 99.9 %");
        assert_eq!(share(1e-7), "under 0.1 %");
        assert_eq!(share(1.0), "100 %");
        assert_eq!(share(0.1234), "12.3 %");
    }

    #[test]
    fn thousands_are_apart() {
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(count(999), "999");
    }
}
