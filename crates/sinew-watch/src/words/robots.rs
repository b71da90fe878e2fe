//! A robot and a tendon in one sentence.

use super::alarms::{is_over, title};
use super::{percent, plus_minus, span, when};
use sinew_estimate::online::Provisional;
use sinew_files::date::day_of;
use sinew_trend::{JointTrend, Limit, LimitForecast, LimitState};
use sinew_watch_core::alarm::{Alarm, Level};
use sinew_watch_core::record::NoOffset;
use sinew_watch_core::snapshot::{Freshness, Learning, NotNow, RobotSnapshot, TendonSnapshot};

/// The robot: what it needs, or that it needs nothing.
pub fn robot(robot: &RobotSnapshot) -> String {
    let mut pressing = robot.alarms.iter().filter(|a| a.level() == robot.level);
    if robot.level != Level::Ok
        && let Some(first) = pressing.next()
    {
        let said = of_alarm(first);
        return match pressing.count() {
            0 => said,
            more => format!("{said}, and {more} more"),
        };
    }
    match (robot.freshness, robot.learning) {
        (Freshness::Never, _) => "nothing received yet".into(),
        (Freshness::Stale { for_s }, _) => format!("nothing received for {}", span(for_s)),
        (_, Learning::NoBaseline) => "no baseline yet: offsets are wide".into(),
        (
            _,
            Learning::Baseline {
                poses,
                poses_needed,
                ..
            },
        ) => {
            format!("learns a baseline: {poses} of {poses_needed} poses")
        }
        _ if robot.level == Level::Stale => "begins: nothing is known yet".into(),
        (Freshness::Fresh, Learning::Following) => match robot.tendons.len() {
            1 => "its tendon is fine".into(),
            n => format!("all {n} tendons are fine"),
        },
    }
}

fn of_alarm(alarm: &Alarm) -> String {
    let what = title(alarm);
    match &alarm.key.joint {
        Some(joint) => format!("{joint}: {what}"),
        None => what.into(),
    }
}

/// A tendon: what it needs and when, with how sure that is.
pub fn tendon(tendon: &TendonSnapshot, alarms: &[Alarm]) -> String {
    let own = alarms
        .iter()
        .filter(|a| a.key.joint.as_deref() == Some(&tendon.joint));
    let worst = own
        .filter(|a| a.level() != Level::Ok)
        .max_by_key(|a| (a.level().urgency(), a.key.condition.severity()));
    let now = match (tendon.offset_rad, tendon.elongation_m, tendon.reason) {
        (Some(offset), Some(length), _) => {
            format!(
                "{} mm longer ({} mrad)",
                plus_minus(length, 1e3),
                plus_minus(offset, 1e3)
            )
        }
        (Some(offset), None, _) => format!("{} mrad", plus_minus(offset, 1e3)),
        (None, _, reason) => why_not(reason).into(),
    };
    let now = match tendon.provisional {
        Some(why) => format!("{now}, provisional: {}", provisional(why)),
        None => now,
    };
    let what = worst.map(|alarm| match is_over(alarm) {
        true => format!("{}: over, waits for somebody", title(alarm)),
        false => title(alarm).to_owned(),
    });
    let ahead = tendon.trend.as_deref().and_then(ahead);
    let parts: Vec<String> = what.into_iter().chain([now]).chain(ahead).collect();
    parts.join("; ")
}

fn why_not(reason: Option<NotNow>) -> &'static str {
    match reason {
        Some(NotNow::NoData) => "no data",
        Some(NotNow::LearnsBaseline) => "learns its baseline",
        Some(NotNow::CannotTell {
            why: NoOffset::TooShort,
        }) => "moved too little to tell",
        Some(NotNow::CannotTell {
            why: NoOffset::Refused,
        }) => "the data don't fit the robot",
        Some(NotNow::CannotTell { .. }) => "too uncertain to tell",
        Some(NotNow::Starting) | None => "not known yet: the newest data are being estimated",
    }
}

/// Why an offset may still move by more than its interval says.
fn provisional(why: Provisional) -> String {
    match why {
        Provisional::Starting => "the estimate begins".into(),
        Provisional::Step {
            since_s,
            probability,
        } => format!(
            "a step at {} is {} probable",
            when(since_s),
            percent(probability)
        ),
        Provisional::ChangeMayEnd { since_s } => {
            format!("the change at {} may be a contact", when(since_s))
        }
        Provisional::Rejected { share } => {
            format!("{} of the data are outliers", percent(share))
        }
        Provisional::Refused => "the newest data do not fit the robot".into(),
    }
}

/// When its first limit is passed.
fn ahead(trend: &JointTrend) -> Option<String> {
    let limit = trend.limits.first()?;
    let what = match limit.limit {
        Limit::Retension { .. } => "tension it again",
        Limit::Replace { .. } => "replace the rope",
    };
    Some(match limit.state {
        LimitState::Passed => format!("{what}: its limit is passed"),
        LimitState::Forecast => format!("{what} {}", days(limit, trend.last_utc_s)),
        LimitState::NotBefore => format!(
            "{what} not before {}",
            day_of(trend.last_utc_s + limit.after_low_s.unwrap_or(0.0))
        ),
        LimitState::NotWithinHorizon => "no limit in sight".into(),
        LimitState::TooFewSessions => "too few sessions for a forecast".into(),
    })
}

/// `about 2026-12-24 (95 %: 2026-12-01 to 2027-03-02)`.
fn days(limit: &LimitForecast, last_utc_s: f64) -> String {
    let day = |after_s: Option<f64>| after_s.map(|s| day_of(last_utc_s + s));
    let middle = day(limit.after_s).unwrap_or_default();
    let low = day(limit.after_low_s).unwrap_or_default();
    match day(limit.after_high_s) {
        Some(high) => format!("about {middle} (95 %: {low} to {high})"),
        None => format!("about {middle} (95 %: {low}, perhaps never)"),
    }
}
