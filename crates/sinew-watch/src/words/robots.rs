//! Summary texts of robots and tendons.

use super::alarms::{has_ended, headline, title};
use super::{exceedance, percent, plus_minus, span, when};
use sinew_estimate::online::Provisional;
use sinew_trend::{JointTrend, Limit, LimitForecast, LimitState};
use sinew_watch_core::alarm::{Alarm, Condition, Level};
use sinew_watch_core::record::NoOffset;
use sinew_watch_core::snapshot::{
    Freshness, Learning, NoEstimateReason, RobotSnapshot, TendonSnapshot,
};

/// Returns the required action of a robot, or its state.
pub fn robot(robot: &RobotSnapshot) -> String {
    let mut pressing = robot.alarms.iter().filter(|a| a.level() == robot.level);
    if robot.level != Level::Ok
        && let Some(first) = pressing.next()
    {
        // Missing data have the fault of the data as their cause.
        let is_cause = |alarm: &&Alarm| alarm.key.condition == Condition::Data && alarm.is_active();
        let mut faults = robot.alarms.iter().filter(is_cause);
        let cause = faults
            .next()
            .filter(|_| first.key.condition == Condition::NoData);
        let message = headline(cause.unwrap_or(first));
        return match pressing.count() {
            0 => message,
            more => format!("{message}, and {more} more"),
        };
    }
    match (robot.freshness, robot.learning) {
        (Freshness::Never, _) => "No data received yet".into(),
        (Freshness::Stale { for_s }, _) => format!("No data for {}", span(for_s)),
        (_, Learning::NoBaseline) => {
            "No baseline: offsets refer to the encoder zero and have wide intervals".into()
        }
        (
            _,
            Learning::Baseline {
                poses,
                poses_needed,
                ..
            },
        ) => {
            format!("Acquiring baseline: {poses} of {poses_needed} poses")
        }
        _ if robot.level == Level::Stale => "Starting: no estimate yet".into(),
        (Freshness::Fresh, Learning::Following) => match robot.tendons.len() {
            1 => "Tendon OK".into(),
            n => format!("{n} tendons OK"),
        },
    }
}

/// Returns the required action of a tendon with its forecast date and interval.
pub fn tendon(tendon: &TendonSnapshot, alarms: &[Alarm]) -> String {
    let of_tendon = alarms
        .iter()
        .filter(|a| a.key.joint.as_deref() == Some(&tendon.joint));
    let worst = of_tendon
        .filter(|a| a.level() != Level::Ok)
        .max_by_key(|a| (a.level().urgency(), a.severity()));
    let now = match (tendon.offset_rad, tendon.elongation_m, tendon.reason) {
        (Some(offset), Some(length), _) => {
            format!(
                "elongation {} mm ({} mrad)",
                plus_minus(length, 1e3),
                plus_minus(offset, 1e3)
            )
        }
        (Some(offset), None, _) => format!("offset {} mrad", plus_minus(offset, 1e3)),
        (None, _, reason) => no_estimate(reason).into(),
    };
    let now = match tendon.provisional {
        Some(reason) => format!("{now}, provisional: {}", provisional(reason)),
        None => now,
    };
    let what = worst.map(|alarm| match has_ended(alarm) {
        true => format!("{} (cleared, latched)", title(alarm)),
        false => title(alarm).to_owned(),
    });
    let ahead = tendon.trend.as_deref().and_then(ahead);
    let parts: Vec<String> = what.into_iter().chain([now]).chain(ahead).collect();
    parts.join("; ")
}

fn no_estimate(reason: Option<NoEstimateReason>) -> &'static str {
    match reason {
        Some(NoEstimateReason::NoData) => "no data",
        Some(NoEstimateReason::BaselineAcquisition) => "acquiring baseline",
        Some(NoEstimateReason::Inconclusive {
            reason: NoOffset::TooShort,
        }) => "inconclusive: insufficient motion",
        Some(NoEstimateReason::Inconclusive {
            reason: NoOffset::Rejected,
        }) => "inconclusive: data inconsistent with robot.toml",
        Some(NoEstimateReason::Inconclusive { .. }) => "inconclusive: interval too wide",
        Some(NoEstimateReason::Starting) | None => "starting: the newest data are being estimated",
    }
}

/// Returns the reason why the offset may still change by more than its interval.
fn provisional(reason: Provisional) -> String {
    match reason {
        Provisional::Starting => "converging".into(),
        Provisional::Step {
            since_s,
            probability,
        } => format!(
            "suspected step change at {} (probability {})",
            when(since_s),
            percent(probability)
        ),
        Provisional::ChangeNearEnd { since_s } => {
            format!("the change at {} may be an ongoing contact", when(since_s))
        }
        Provisional::Rejected { share } => {
            format!("{} of the data are outliers", percent(share))
        }
        Provisional::NotSolved => "newest data inconsistent with the model".into(),
    }
}

/// Returns the forecast of the first limit exceedance.
fn ahead(trend: &JointTrend) -> Option<String> {
    let limit = trend.limits.first()?;
    Some(forecast(limit, trend.last_utc_s))
}

/// Returns the forecast of a limit exceedance.
pub(super) fn forecast(limit: &LimitForecast, last_utc_s: f64) -> String {
    let what = match limit.limit {
        Limit::Retension { .. } => "re-tension",
        Limit::Replace { .. } => "replace rope",
    };
    match limit.state {
        LimitState::Passed => format!("{what}: limit exceeded"),
        LimitState::Forecast | LimitState::NotBefore => {
            let at = |after_s: Option<f64>| after_s.map(|s| last_utc_s + s);
            let after_s = limit
                .after_s
                .filter(|_| limit.state == LimitState::Forecast);
            let dates = [after_s, limit.after_low_s, limit.after_high_s].map(at);
            format!("{what} {}", exceedance(dates))
        }
        LimitState::NotWithinHorizon => "no limit exceedance within the forecast horizon".into(),
        LimitState::TooFewSessions => "too few sessions for a forecast".into(),
    }
}

/// Returns the reason why a robot without a URDF is not monitored.
pub fn waits_for_urdf() -> String {
    "waiting for a URDF on /robot_description, because robot.toml specifies none".into()
}

/// Returns the reason why a robot that waits for its URDF is not monitored if its transport is disconnected.
pub fn disconnected(transport: &str, reason: &str) -> String {
    format!("{transport} disconnected: {reason}")
}

/// Returns the reason why a robot is not monitored after an error of the program.
pub fn has_failed() -> String {
    "its data caused an internal error; restarted from the stored state".into()
}

/// Returns the reason why a restarted robot receives no data yet.
pub fn resumes(within: std::time::Duration) -> String {
    format!(
        "{}; data are received again within {}",
        has_failed(),
        span(within.as_secs_f64())
    )
}

/// Returns the reason why a robot whose last session is not stored yet is not monitored.
pub fn is_being_stored() -> String {
    "the previous session is still being stored; reload the configuration in a few seconds".into()
}
