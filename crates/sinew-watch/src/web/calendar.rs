//! Maintenance forecast as a calendar: iCalendar, RFC 5545.

use crate::words;
use sinew_trend::Limit;
use sinew_watch_core::due::{DueList, DueTendon};

/// Maximum length of a line, octets without the line break (RFC 5545, section 3.1).
const MAX_LINE: usize = 75;

/// Returns the calendar: one event of a whole day per tendon, at the median of the date on which its limit is exceeded; today
/// if it is exceeded already. A tendon whose median is beyond the forecast horizon is an event at the lower end of its 95 %
/// interval.
pub(super) fn text(list: &DueList) -> String {
    let mut out = String::new();
    for line in [
        "BEGIN:VCALENDAR",
        "VERSION:2.0",
        "PRODID:-//Sinew//sinew-watch//EN",
        "X-WR-CALNAME:Tendon maintenance",
    ] {
        push(&mut out, line);
    }
    for tendon in &list.due {
        event(&mut out, tendon, list.time_utc_s);
    }
    push(&mut out, "END:VCALENDAR");
    out
}

fn event(out: &mut String, tendon: &DueTendon, now_utc_s: f64) {
    let at_utc_s = tendon.at_utc_s.or(tendon.at_low_utc_s);
    let at_utc_s = at_utc_s.unwrap_or(now_utc_s).max(now_utc_s);
    let (what, kind) = match tendon.limit {
        Limit::Retension { .. } => ("Re-tension", "retension"),
        Limit::Replace { .. } => ("Replace the rope of", "replace"),
    };
    let DueTendon { robot, joint, .. } = tendon;
    let day = |utc_s: Option<f64>| utc_s.map_or("beyond the forecast horizon".into(), words::day);
    let interval = match tendon.at_low_utc_s {
        None => "limit exceeded".into(),
        low => format!(
            "95 % interval: {} to {}",
            day(low),
            day(tendon.at_high_utc_s)
        ),
    };
    for line in [
        "BEGIN:VEVENT".into(),
        format!(
            "UID:{}",
            escaped(&format!("{robot}/{joint}/{kind}@sinew-watch"))
        ),
        format!("DTSTAMP:{}", words::compact_utc(now_utc_s)),
        format!(
            "DTSTART;VALUE=DATE:{}",
            words::day(at_utc_s).replace('-', "")
        ),
        format!("SUMMARY:{}", escaped(&format!("{what} {robot} {joint}"))),
        format!("DESCRIPTION:{}", escaped(&interval)),
        "TRANSP:TRANSPARENT".to_owned(),
        "END:VEVENT".to_owned(),
    ] {
        push(out, &line);
    }
}

/// Escapes the characters with a meaning in text values (RFC 5545, section 3.3.11).
fn escaped(text: &str) -> String {
    let text = text.replace('\\', "\\\\").replace(';', "\\;");
    text.replace(',', "\\,").replace('\n', "\\n")
}

/// Appends a line, folded between characters.
fn push(out: &mut String, line: &str) {
    let mut length = 0;
    for c in line.chars() {
        if length + c.len_utf8() > MAX_LINE {
            out.push_str("\r\n ");
            length = 1;
        }
        out.push(c);
        length += c.len_utf8();
    }
    out.push_str("\r\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calendar_lines_are_folded_and_escaped() {
        let mut out = String::new();
        push(
            &mut out,
            &format!("SUMMARY:{}", escaped(&"a;b,é\n".repeat(40))),
        );
        assert!(
            out.split("\r\n").all(|line| line.len() <= MAX_LINE),
            "{out}"
        );
        let whole = out.replace("\r\n ", "");
        assert_eq!(
            whole.trim_end(),
            format!("SUMMARY:{}", "a\\;b\\,é\\n".repeat(40))
        );
        assert_eq!(words::compact_utc(1_767_225_600.0), "20260101T000000Z");
    }
}
