//! Texts of the monitor, one file per result; texts about a robot are identical on pages, in `/diagnostics`, in
//! notifications and in the journal.
//!
//! `tests/golden/messages.txt` lists all of them with example values.

mod alarms;
mod journal;
pub mod log;
pub mod response;
mod robots;
#[cfg(test)]
mod tests;

pub use alarms::{
    advice, ambiguous_topics, message_too_long, observation, title, topic_not_found,
    unsupported_type,
};
pub use journal::{entry, mail};
pub use robots::{
    disconnected, has_failed, is_being_stored, resumes, robot, tendon, waits_for_urdf,
};

use jiff::Timestamp;
use jiff::tz::TimeZone;
use sinew_files::date::PLAUSIBLE_S;
use sinew_files::number::rounded;
use sinew_model::Gaussian;
use std::sync::{PoisonError, RwLock};

/// Time zone of the texts; `None`: UTC.
static TIME_ZONE: RwLock<Option<TimeZone>> = RwLock::new(None);

/// Sets the time zone of the texts of this process; `None`: UTC.
pub fn set_time_zone(zone: Option<TimeZone>) {
    *TIME_ZONE.write().unwrap_or_else(PoisonError::into_inner) = zone;
}

/// Formats a time, s since 1970 UTC, in the time zone of the texts; `–` if it is not plausible.
fn formatted(utc_s: f64, form: &str) -> String {
    let zone = TIME_ZONE.read().unwrap_or_else(PoisonError::into_inner);
    in_zone(utc_s, form, zone.clone().unwrap_or(TimeZone::UTC))
}

fn in_zone(utc_s: f64, form: &str, zone: TimeZone) -> String {
    let time = Timestamp::from_second(utc_s.floor() as i64);
    let time = time.ok().filter(|_| PLAUSIBLE_S.contains(&utc_s));
    time.map_or("–".into(), |time| {
        let local = time.to_zoned_datetime(zone);
        local.strftime(form).to_string()
    })
}

/// Formats `12.3 ± 0.4` with the half-width of the 95 % interval, scaled by `factor` from SI.
fn plus_minus(value: Gaussian, factor: f64) -> String {
    sinew_files::number::with_interval(factor * value.mean, factor * value.std)
}

/// Formats a time such as `2026-03-01 08:30 UTC` or `2026-03-01 09:30 CET`.
fn when(utc_s: f64) -> String {
    formatted(utc_s, "%Y-%m-%d %H:%M %Z")
}

/// Formats a time in UTC for a calendar, such as `20260301T083005Z`.
pub(crate) fn compact_utc(utc_s: f64) -> String {
    in_zone(utc_s, "%Y%m%dT%H%M%SZ", TimeZone::UTC)
}

/// Formats a day such as `2026-03-01`.
pub(crate) fn day(utc_s: f64) -> String {
    formatted(utc_s, "%Y-%m-%d")
}

/// Formats a duration such as `40 s`, `12 min`, `3 h`, `12 days`.
fn span(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() => "–".into(),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 2.0 * 86_400.0 => format!("{:.0} h", s / 3600.0),
        s => format!("{:.0} days", s / 86_400.0),
    }
}

fn percent(share: f64) -> String {
    sinew_files::number::share(share)
}

/// Formats the dates of a limit exceedance, s since 1970 UTC: median and 95 % interval as
/// `about 2026-12-24 (95 %: 2026-12-01 to 2027-03-02)`, without a median as `not before 2026-12-01 (95 %)`.
fn exceedance([at, low, high]: [Option<f64>; 3]) -> String {
    let low = low.map_or("–".into(), day);
    let Some(at) = at else {
        return format!("not before {low} (95 %)");
    };
    let high = high.map_or("beyond the forecast horizon".into(), day);
    format!("about {} (95 %: {low} to {high})", day(at))
}
