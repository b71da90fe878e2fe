//! Days and times of day in UTC, in the Gregorian calendar.
//!
//! Three small functions (H. Hinnant, "chrono-compatible low-level date algorithms") instead of a library of 96,000
//! lines: time zones and arithmetic with months are not needed.

use std::time::{SystemTime, UNIX_EPOCH};

/// Seconds of a day.
pub const DAY_S: f64 = 86_400.0;
/// 2000-01-01 and 2200-01-01, s since 1970: range of plausible dates of a session. Earlier time stamps count from the
/// start of the computer or of the recording.
pub const PLAUSIBLE_S: std::ops::Range<f64> = 946_684_800.0..7_258_118_400.0;

/// Days from 1970-01-01; `None` where the calendar has no such day.
pub fn day_number(year: i64, month: i64, day: i64) -> Option<i64> {
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let length = match month {
        4 | 6 | 9 | 11 => 30,
        2 if leap => 29,
        2 => 28,
        1..=12 => 31,
        _ => return None,
    };
    if !(1..=length).contains(&day) {
        return None;
    }
    // Years that begin in March, so that the leap day is last.
    let y = if month <= 2 { year - 1 } else { year };
    let era = y.div_euclid(400);
    let of_era = y.rem_euclid(400);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    Some(era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468)
}

/// Year, month and day of a number of days from 1970-01-01.
pub fn civil(days: i64) -> (i64, i64, i64) {
    let z = days + 719_468;
    let era = z.div_euclid(146_097);
    let of_era = z.rem_euclid(146_097);
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * of_year + 2) / 153;
    let month = if shifted < 10 {
        shifted + 3
    } else {
        shifted - 9
    };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    (year, month, of_year - (153 * shifted + 2) / 5 + 1)
}

/// Formats a day as in `2026-03-01`.
fn day_text(days: i64) -> String {
    let (year, month, day) = civil(days);
    format!("{year:04}-{month:02}-{day:02}")
}

/// Formats the day of a time, s since 1970, such as `2026-03-01`; `–` if the time is not a plausible date of a session.
pub fn day_of(utc_s: f64) -> String {
    if PLAUSIBLE_S.contains(&utc_s) {
        day_text((utc_s / DAY_S).floor() as i64)
    } else {
        "–".into()
    }
}

/// Nanoseconds since 1970 as `2026-03-01 08:30:05 UTC`; `None` before 2000.
pub fn utc_text(time_ns: i64) -> Option<String> {
    let seconds = time_ns.div_euclid(1_000_000_000);
    if seconds < PLAUSIBLE_S.start as i64 {
        return None;
    }
    let (days, of_day) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    let day = day_text(days);
    Some(format!("{day} {hour:02}:{minute:02}:{second:02} UTC"))
}

/// Today in UTC: `2026-03-01`.
pub fn today() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    day_text(since.map_or(0, |d| (d.as_secs() / 86_400) as i64))
}

/// Reads `2026-03-01`, `2026-03-01T08:30`, `2026-03-01 08:30:05.5Z` or with `+01:00`, or seconds since
/// 1970; without a zone it is UTC. Returns s since 1970, between 2000 and 2200.
pub fn parse_utc_s(text: &str) -> Option<f64> {
    let text = text.trim();
    let seconds = match text.parse::<f64>() {
        Ok(seconds) => seconds,
        Err(_) => parse_civil(text)?,
    };
    PLAUSIBLE_S.contains(&seconds).then_some(seconds)
}

fn parse_civil(text: &str) -> Option<f64> {
    let date = text.get(..10)?;
    let mut parts = date.split('-');
    let mut number = |width: usize| {
        let part = parts.next()?;
        let digits = part.len() == width && part.bytes().all(|b| b.is_ascii_digit());
        digits.then(|| part.parse::<i64>().ok()).flatten()
    };
    let days = day_number(number(4)?, number(2)?, number(2)?)?;
    let of_day = match text.get(10..)?.strip_prefix(['T', ' ', 't']) {
        None if text.len() == 10 => 0.0,
        None => return None,
        Some(clock) => clock_s(clock)?,
    };
    Some(days as f64 * DAY_S + of_day)
}

/// Parses `08:30` or `08:30:05.25`, each followed by `Z` or `+01:00`.
fn clock_s(text: &str) -> Option<f64> {
    let (clock, zone_s) = match text.trim_end().strip_suffix(['Z', 'z']) {
        Some(clock) => (clock, 0.0),
        None => match text.rfind(['+', '-']) {
            Some(at) => {
                let (hours, minutes) = text[at + 1..].split_once(':')?;
                let zone = 3600.0 * two(hours, 14)? + 60.0 * two(minutes, 59)?;
                let sign = if text[at..].starts_with('-') {
                    -1.0
                } else {
                    1.0
                };
                (&text[..at], sign * zone)
            }
            None => (text, 0.0),
        },
    };
    let mut parts = clock.trim_end().split(':');
    let (hour, minute) = (two(parts.next()?, 23)?, two(parts.next()?, 59)?);
    let second = match parts.next() {
        None => 0.0,
        Some(s) => s.parse::<f64>().ok().filter(|s| (0.0..61.0).contains(s))?,
    };
    if parts.next().is_some() {
        return None;
    }
    Some(3600.0 * hour + 60.0 * minute + second - zone_s)
}

fn two(text: &str, most: u32) -> Option<f64> {
    let digits = text.len() == 2 && text.bytes().all(|b| b.is_ascii_digit());
    let value: u32 = digits.then(|| text.parse().ok()).flatten()?;
    (value <= most).then(|| f64::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_become_dates_and_dates_days() {
        for (days, date) in [
            (0, (1970, 1, 1)),
            (59, (1970, 3, 1)),
            (11_016, (2000, 2, 29)),
            (20_778, (2026, 11, 21)),
        ] {
            assert_eq!(civil(days), date);
            assert_eq!(day_number(date.0, date.1, date.2), Some(days));
        }
        for days in (-800_000..800_000).step_by(97) {
            let (year, month, day) = civil(days);
            assert_eq!(day_number(year, month, day), Some(days));
        }
        assert_eq!(day_number(2026, 2, 29), None);
    }

    #[test]
    fn dates_are_read_and_written() {
        // date -u -d '2024-02-29 12:34:56' +%s
        let leap = 1_709_210_096.0;
        for text in [
            "2024-02-29T12:34:56Z",
            "2024-02-29 12:34:56",
            "2024-02-29T14:34:56+02:00",
            "2024-02-29T07:04:56-05:30",
            "1709210096",
        ] {
            assert_eq!(parse_utc_s(text), Some(leap), "{text}");
        }
        assert_eq!(day_of(leap), "2024-02-29");
        assert_eq!(
            utc_text(1_709_210_096_000_000_000).as_deref(),
            Some("2024-02-29 12:34:56 UTC")
        );
        assert_eq!(
            parse_utc_s("2025-12-31").map(day_of).as_deref(),
            Some("2025-12-31")
        );
        assert_eq!(
            parse_utc_s("2026-03-01T08:30").map(|s| s % DAY_S),
            Some(30_600.0)
        );
        for bad in [
            "",
            "2026",
            "2026-13-01",
            "2025-02-29",
            "2026-03-01T25:00",
            "2026-03-01X",
            "12.5",
            "nan",
            "2026-3-1",
            "2026-03-01T08:30:00+1",
            "ä026-03-01",
            "1999-12-31",
        ] {
            assert_eq!(parse_utc_s(bad), None, "{bad}");
        }
        assert_eq!(day_of(f64::NAN), "–");
    }
}
