//! Time of a frame from its name.

use sinew_files::date::day_number;

/// Patterns of times in file names without extension, ns, in order of priority:
/// * a number with a unit at the end, from an arbitrary zero: `frame_12.5s`, `0001_1250ms`, `t=3us`, `x-7ns`;
/// * a date and time of day: `20261121_143000_250`, `2026-11-21T14-30-00.25`;
/// * 10, 13, 16 or 19 digits: seconds, milli-, micro- or nanoseconds since 1970.
pub(crate) const PATTERNS: [fn(&str) -> Option<i128>; 3] = [suffix, date, epoch];

fn suffix(stem: &str) -> Option<i128> {
    const UNITS: [(&str, u32); 4] = [("ms", 6), ("us", 3), ("ns", 0), ("s", 9)];
    let (number, power) = UNITS
        .iter()
        .find_map(|(unit, power)| Some((stem.strip_suffix(unit)?, *power)))?;
    let start = number
        .rfind(|c: char| !c.is_ascii_digit() && c != '.')
        .map_or(0, |i| i + 1);
    decimal(&number[start..], power)
}

/// Converts `12.5` with a unit of ten to the `power` exactly.
fn decimal(text: &str, power: u32) -> Option<i128> {
    let (whole, part) = text.split_once('.').unwrap_or((text, ""));
    if whole.is_empty() || whole.len() > 18 || !digits(whole) || !(part.is_empty() || digits(part))
    {
        return None;
    }
    let kept = &part[..part.len().min(power as usize)];
    let fraction: i128 = if kept.is_empty() {
        0
    } else {
        kept.parse().ok()?
    };
    let scale = |n: u32| 10_i128.pow(n);
    Some(whole.parse::<i128>().ok()? * scale(power) + fraction * scale(power - kept.len() as u32))
}

fn digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

/// Returns sequences of digits with their positions.
fn runs(stem: &str) -> Vec<&str> {
    stem.split(|c: char| !c.is_ascii_digit())
        .filter(|run| !run.is_empty())
        .collect()
}

fn date(stem: &str) -> Option<i128> {
    let runs = runs(stem);
    (0..runs.len()).find_map(|i| date_from(&runs[i..]))
}

fn date_from(runs: &[&str]) -> Option<i128> {
    let (day, rest) = match runs {
        [date, rest @ ..] if date.len() == 8 => ([&date[..4], &date[4..6], &date[6..]], rest),
        [y, m, d, rest @ ..] if y.len() == 4 && m.len() == 2 && d.len() == 2 => {
            ([*y, *m, *d], rest)
        }
        _ => return None,
    };
    let (clock, rest) = match rest {
        [time, rest @ ..] if time.len() == 6 => ([&time[..2], &time[2..4], &time[4..]], rest),
        [h, m, s, rest @ ..] if [h, m, s].iter().all(|v| v.len() == 2) => ([*h, *m, *s], rest),
        _ => return None,
    };
    let number = |text: &str| text.parse::<i64>().ok();
    let (year, month, day) = (number(day[0])?, number(day[1])?, number(day[2])?);
    let (hour, minute, second) = (number(clock[0])?, number(clock[1])?, number(clock[2])?);
    if !(1970..2200).contains(&year) || hour > 23 || minute > 59 || second > 60 {
        return None;
    }
    let fraction = match rest.first() {
        Some(part) if part.len() <= 9 => format!("0.{part}"),
        _ => "0".into(),
    };
    let days = day_number(year, month, day)?;
    let seconds = days * 86_400 + hour * 3600 + minute * 60 + second;
    Some(i128::from(seconds) * 1_000_000_000 + decimal(&fraction, 9)?)
}

fn epoch(stem: &str) -> Option<i128> {
    runs(stem).iter().rev().find_map(|run| {
        let power = match run.len() {
            10 => 9,
            13 => 6,
            16 => 3,
            19 => 0,
            _ => return None,
        };
        decimal(run, 0).map(|v| v * 10_i128.pow(power))
    })
}

/// Compares names in natural order: `frame2` before `frame10`.
pub(crate) fn natural(a: &str, b: &str) -> std::cmp::Ordering {
    let (mut a, mut b) = (a.as_bytes(), b.as_bytes());
    loop {
        match (a.first(), b.first()) {
            (Some(x), Some(y)) if x.is_ascii_digit() && y.is_ascii_digit() => {
                let take = |s: &mut &[u8]| {
                    let n = s.iter().take_while(|c| c.is_ascii_digit()).count();
                    let (run, rest) = s.split_at(n);
                    *s = rest;
                    let zeros = run.iter().take_while(|c| **c == b'0').count();
                    run[zeros..].to_vec()
                };
                let (x, y) = (take(&mut a), take(&mut b));
                let order = x.len().cmp(&y.len()).then(x.cmp(&y));
                if order.is_ne() {
                    return order;
                }
            }
            (Some(x), Some(y)) if x == y => (a, b) = (&a[1..], &b[1..]),
            (x, y) => return x.cmp(&y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_name_gives_time() {
        const SUFFIX: usize = 0;
        const DATE: usize = 1;
        const EPOCH: usize = 2;
        let pattern_of = |stem: &str| PATTERNS.iter().position(|told| told(stem).is_some());
        for (stem, pattern, ns) in [
            ("frame_0007_12.5s", SUFFIX, 12_500_000_000),
            ("t=0.1s", SUFFIX, 100_000_000),
            ("a1_1250ms", SUFFIX, 1_250_000_000),
            ("x-7ns", SUFFIX, 7),
            ("cam_20261121_143000_250", DATE, 1_795_271_400_250_000_000),
            ("2026-11-21T14-30-00.25", DATE, 1_795_271_400_250_000_000),
            ("2000-02-29 00.00.00", DATE, 951_782_400_000_000_000),
            ("1795271400", EPOCH, 1_795_271_400_000_000_000),
            ("cam2_1795271400250", EPOCH, 1_795_271_400_250_000_000),
        ] {
            assert_eq!(pattern_of(stem), Some(pattern), "{stem}");
            assert_eq!(PATTERNS[pattern](stem), Some(ns), "{stem}");
        }
        for stem in [
            "frame_0001",
            "lines",
            "1.2.3s",
            "20261321_143000",
            "glass",
            "99999999999999999999s",
        ] {
            assert_eq!(pattern_of(stem), None, "{stem}");
        }
    }

    #[test]
    fn file_names_sort_in_natural_order() {
        let mut names = ["f10", "f2", "f02b", "f1", "e99"];
        names.sort_by(|a, b| natural(a, b));
        assert_eq!(names, ["e99", "f1", "f2", "f02b", "f10"]);
    }
}
