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

/// Nanoseconds of a second, an hour and a day.
const SECOND_NS: i64 = 1_000_000_000;
const HOUR_NS: i64 = 3600 * SECOND_NS;
const DAY_NS: i64 = 24 * HOUR_NS;

/// Time stamp that is written with its own units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stamp {
    /// Clock without a date, ns: a time of day, or the time since the start.
    Clock(i64),
    /// Date, with or without a clock, ns since 1970.
    Date(i64),
}

/// Whether a text is a clock time or a date, such as `00:01:10`, `2024-03-01T10:00:00.5Z` or `01.03.2024 10:00:00`.
pub fn is_stamp(text: &str) -> bool {
    parse_stamp(text).is_some()
}

/// Converts a column of clock times or dates to nanoseconds; a clock without a date continues after midnight.
#[derive(Debug, Clone, Default)]
pub struct ClockColumn {
    last_ns: Option<i64>,
    step_ns: i64,
    /// Days that have ended since the first row, ns.
    days_ns: i64,
}

impl ClockColumn {
    /// Converts the next cell: ns since 1970 for a date, otherwise since midnight of the first day. `None` if the
    /// cell is neither.
    pub fn read(&mut self, text: &str) -> Option<i64> {
        let clock_ns = match parse_stamp(text)? {
            Stamp::Date(ns) => return Some(ns),
            Stamp::Clock(ns) => ns,
        };
        if let Some(last_ns) = self.last_ns {
            // Midnight, not a restart: the last row is near the end of the day and this one near its start.
            let reach_ns = HOUR_NS.max(2 * self.step_ns);
            if (DAY_NS - reach_ns..DAY_NS).contains(&last_ns) && clock_ns < reach_ns.min(last_ns) {
                self.days_ns += DAY_NS;
            } else {
                self.step_ns = clock_ns - last_ns;
            }
        }
        self.last_ns = Some(clock_ns);
        clock_ns.checked_add(self.days_ns)
    }
}

fn parse_stamp(text: &str) -> Option<Stamp> {
    let text = text.trim();
    let in_date = |c: char| c.is_ascii_digit() || matches!(c, '-' | '/' | '.');
    let end = text.find(|c| !in_date(c)).unwrap_or(text.len());
    let (date, clock) = text.split_at(end);
    let Some(days) = parse_day(date) else {
        return clock_ns(text, false).map(Stamp::Clock);
    };
    let of_day_ns = match clock.strip_prefix(['T', 't', ' ']) {
        None if clock.is_empty() => 0,
        None => return None,
        Some(clock) => clock_ns(clock.trim(), true)?,
    };
    let ns = days.checked_mul(DAY_NS)?.checked_add(of_day_ns)?;
    Some(Stamp::Date(ns))
}

/// Days since 1970 of `2024-03-01`, `2024/03/01`, `2024.03.01` or `1.3.2024`.
fn parse_day(text: &str) -> Option<i64> {
    let separator = text.chars().find(|c| !c.is_ascii_digit())?;
    let parts: Vec<&str> = text.split(separator).collect();
    let [first, month, last] = parts[..] else {
        return None;
    };
    let (year, day) = match (first.len(), last.len(), separator) {
        (4, 1 | 2, _) => (first, last),
        (1 | 2, 4, '.') => (last, first),
        _ => return None,
    };
    day_number(year.parse().ok()?, month.parse().ok()?, day.parse().ok()?)
}

/// Nanoseconds of `10:00:05.25`, of `10:00:05 PM`, and after a date of `10:00` and of a clock with its zone.
fn clock_ns(text: &str, is_dated: bool) -> Option<i64> {
    let mut clock = text;
    let mut zone_ns = 0;
    if is_dated {
        if let Some(utc) = clock.strip_suffix(['Z', 'z']) {
            clock = utc;
        } else if let Some(at) = clock.rfind(['+', '-']) {
            let (hours, minutes) = clock[at + 1..].split_once(':')?;
            let minutes = 60.0 * two(hours, 14)? + two(minutes, 59)?;
            let sign = if clock[at..].starts_with('-') { -1 } else { 1 };
            zone_ns = sign * minutes as i64 * 60 * SECOND_NS;
            clock = &clock[..at];
        }
    }
    let lower = clock.trim_end().to_ascii_lowercase();
    let (clock, half) = match lower
        .strip_suffix('m')
        .and_then(|c| Some((c.get(..c.len().checked_sub(1)?)?, c)))
    {
        Some((clock, half)) if half.ends_with('a') => (clock.trim_end(), Some(0)),
        Some((clock, half)) if half.ends_with('p') => (clock.trim_end(), Some(12)),
        _ => (lower.as_str(), None),
    };
    let mut parts = clock.split(':');
    let hour = parts.next()?;
    let is_whole = (1..=4).contains(&hour.len()) && hour.bytes().all(|b| b.is_ascii_digit());
    let mut hour: i64 = is_whole.then(|| hour.parse().ok()).flatten()?;
    match half {
        Some(half) if (1..=12).contains(&hour) => hour = hour % 12 + half,
        Some(_) => return None,
        None if is_dated && hour > 24 => return None,
        None => {}
    }
    let minute = two(parts.next()?, 59)? as i64;
    let second_ns = match parts.next() {
        None if is_dated => 0,
        None => return None,
        Some(second) => {
            let (whole, fraction) = second.split_once(['.', ',']).unwrap_or((second, ""));
            let digits = fraction.bytes().all(|b| b.is_ascii_digit());
            let nanos = format!("{fraction:0<9}");
            let nanos: i64 = digits.then(|| nanos.get(..9)?.parse().ok()).flatten()?;
            two(whole, 60)? as i64 * SECOND_NS + nanos
        }
    };
    if parts.next().is_some() {
        return None;
    }
    Some(hour * HOUR_NS + minute * 60 * SECOND_NS + second_ns - zone_ns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clock_column_reads_clocks_and_dates() {
        let ns = |text: &str| ClockColumn::default().read(text);
        for (text, expected) in [
            ("00:00:10", Some(10 * SECOND_NS)),
            ("1:02:03.25", Some(3_723_250_000_000)),
            ("1:02:03,25", Some(3_723_250_000_000)),
            ("100:00:00", Some(100 * HOUR_NS)),
            ("12:00:01 AM", Some(SECOND_NS)),
            ("01:00:00 pm", Some(13 * HOUR_NS)),
            // date -u -d '2024-02-29 12:34:56' +%s
            ("2024-02-29T12:34:56.5Z", Some(1_709_210_096_500_000_000)),
            ("2024-02-29 14:34:56+02:00", Some(1_709_210_096_000_000_000)),
            ("29.2.2024 12:34:56", Some(1_709_210_096_000_000_000)),
            ("2024/02/29 12:34", Some(1_709_210_040_000_000_000)),
            ("2024-02-29", Some(1_709_164_800_000_000_000)),
            ("10:00", None),
            ("10:60:00", None),
            ("2/29/2024 10:00:00", None),
            ("1.099,8", None),
            ("2024", None),
            ("m", None),
            ("", None),
            ("äm", None),
        ] {
            assert_eq!(ns(text), expected, "{text}");
        }
    }

    #[test]
    fn clock_column_continues_after_midnight() {
        let read = |cells: &[&str]| -> Vec<i64> {
            let mut column = ClockColumn::default();
            let ns = cells.iter().filter_map(|cell| column.read(cell));
            ns.map(|ns| ns / SECOND_NS).collect()
        };
        assert_eq!(
            read(&["23:59:50", "23:59:59", "00:00:08", "00:00:17"]),
            [86_390, 86_399, 86_408, 86_417]
        );
        // Readings every six hours.
        assert_eq!(
            read(&["10:00:00", "16:00:00", "22:00:00", "04:00:00"]),
            [36_000, 57_600, 79_200, 100_800]
        );
        // A second specimen begins again.
        assert_eq!(read(&["00:00:00", "00:30:00", "00:00:00"]), [0, 1800, 0]);
    }

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
