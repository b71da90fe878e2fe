//! Numbers as text: exact times.

/// Nanoseconds of a decimal number times a power of ten, rounded half away from zero.
///
/// `exponent` is 9 for seconds. Exact: no floating point is involved, so
/// `1530821160.114326` s keeps its microseconds. `None`: not a number, not
/// finite, or out of the range of 64-bit nanoseconds (the years 1677 to 2262).
pub(crate) fn parse_ns(text: &[u8], exponent: i32) -> Option<i64> {
    let (negative, text) = match text.split_first()? {
        (b'-', rest) => (true, rest),
        (b'+', rest) => (false, rest),
        _ => (false, text),
    };
    // Digits beyond 10^28 < i128::MAX / 10 cannot change a time in range.
    const MAX_MANTISSA: i128 = 10_i128.pow(28);
    let mut mantissa: i128 = 0;
    let mut scale: i32 = 0;
    let mut digits = 0_usize;
    let mut point = false;
    let mut rest = text;
    while let Some((&byte, next)) = rest.split_first() {
        match byte {
            b'0'..=b'9' => {
                digits += 1;
                if mantissa < MAX_MANTISSA {
                    mantissa = mantissa * 10 + i128::from(byte - b'0');
                    scale -= i32::from(point);
                } else {
                    scale += i32::from(!point);
                }
            }
            b'.' if !point => point = true,
            _ => break,
        }
        rest = next;
    }
    if digits == 0 {
        return None;
    }
    let written = match rest.split_first() {
        None => 0,
        Some((b'e' | b'E', power)) => std::str::from_utf8(power).ok()?.parse::<i32>().ok()?,
        Some(_) => return None,
    };
    let power = scale.checked_add(written)?.checked_add(exponent)?;
    let value = if power >= 0 {
        let factor = 10_i128.checked_pow(u32::try_from(power).ok()?);
        match factor {
            Some(factor) => mantissa.checked_mul(factor)?,
            None if mantissa == 0 => 0,
            None => return None,
        }
    } else {
        match 10_i128.checked_pow(power.unsigned_abs()) {
            Some(divisor) => (mantissa + divisor / 2) / divisor,
            None => 0,
        }
    };
    i64::try_from(if negative { -value } else { value }).ok()
}

#[cfg(any(feature = "parquet", feature = "numpy"))]
/// Converts a floating-point time to nanoseconds with the full resolution of the double.
pub(crate) fn float_ns(value: f64, exponent: i32) -> Option<i64> {
    if !value.is_finite() {
        return None;
    }
    // The whole part is exact as an integer; only the fraction is scaled.
    let whole = value.trunc();
    let factor = 10_i128.checked_pow(u32::try_from(exponent).ok()?)?;
    if whole.abs() >= 1e19 {
        return None;
    }
    let fraction = ((value - whole) * factor as f64).round();
    i64::try_from((whole as i128).checked_mul(factor)? + fraction as i128).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_times_are_exact() {
        let ns = |text: &str, exponent| parse_ns(text.as_bytes(), exponent);
        assert_eq!(ns("1530821160.114326", 9), Some(1_530_821_160_114_326_000));
        assert_eq!(ns("1530821160.1224868", 9), Some(1_530_821_160_122_486_800));
        assert_eq!(ns("0.0000000005", 9), Some(1));
        assert_eq!(ns("-0.0000000005", 9), Some(-1));
        assert_eq!(ns("-1.5e3", 0), Some(-1500));
        assert_eq!(ns("12", 6), Some(12_000_000));
        assert_eq!(ns("9223372036854775807", 0), Some(i64::MAX));
        assert_eq!(ns("9223372036854775808", 0), None);
        assert_eq!(ns("1e400", 9), None);
        assert_eq!(ns("0e400", 9), Some(0));
        assert_eq!(ns("1e-400", 9), Some(0));
        assert_eq!(ns(&"1".repeat(400), 9), None);
        assert_eq!(
            ns(&format!("1.{}", "0".repeat(400)), 9),
            Some(1_000_000_000)
        );
        for bad in [
            "",
            "-",
            ".",
            "nan",
            "1.2.3",
            "1e",
            "1x",
            "e5",
            "1e99999999999",
        ] {
            assert_eq!(ns(bad, 9), None, "{bad}");
        }
    }

    #[test]
    fn float_times_keep_what_the_double_holds() {
        assert_eq!(float_ns(179.996, 9), Some(179_996_000_000));
        assert_eq!(float_ns(-0.0, 9), Some(0));
        assert_eq!(
            float_ns(1_530_821_160.5, 9),
            Some(1_530_821_160_500_000_000)
        );
        assert_eq!(float_ns(f64::NAN, 9), None);
        assert_eq!(float_ns(1e300, 9), None);
    }
}
