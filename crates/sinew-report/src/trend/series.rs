//! Sessions and forecasts of all tendons as machine-readable tables.

use crate::data::Data;
use sinew_files::date::{DAY_S, day_of};
use sinew_log::Table;
use sinew_model::{Bounded, Interval95};
use sinew_trend::{JointTrend, SessionPoint, TrendReport};

/// Tabulates all sessions in SI units: recorded value, and estimate of the trend at that date. `days` counts from the tensioning.
pub fn trend_table(report: &TrendReport) -> Table {
    let joints = report.joints.iter();
    Data::of(joints.flat_map(|j| j.series.iter().map(move |s| (j, s))))
        .text("day", |(_, s)| day_of(s.time_utc_s))
        .number("days", |(j, s)| (s.time_utc_s - j.tensioned_utc_s) / DAY_S)
        .number("time_utc_s", |(_, s)| s.time_utc_s)
        .number("cycle", |(_, s)| s.cycle)
        .text("joint", |(j, _)| j.name.as_str())
        .number("offset_rad", |(_, s)| s.offset_rad.map(|y| y.mean))
        .number("offset_std_rad", |(_, s)| s.offset_rad.map(|y| y.std))
        .number("temperature_c", |(_, s)| s.temperature_c)
        .number("at_reference_rad", |(_, s)| s.at_reference_rad)
        .number("tracked_rad", |(_, s)| s.tracked_rad.mean)
        .number("tracked_std_rad", |(_, s)| s.tracked_rad.std)
        .number("step_probability", |(_, s)| s.step_probability)
        .flag("is_outlier", |(_, s)| s.is_outlier)
        .table()
}

/// Estimate of a tendon at a session, or its forecast.
struct TrendPoint<'a> {
    joint: &'a JointTrend,
    time_utc_s: f64,
    cycle: Option<f64>,
    tracked_rad: Bounded,
    session: Option<&'a SessionPoint>,
}

/// Iterates over the estimates at the sessions of a tendon, then over its forecast.
fn points(joint: &JointTrend) -> impl Iterator<Item = TrendPoint<'_>> {
    let level = |value, ends: Interval95| Bounded {
        value,
        low: ends.low,
        high: ends.high,
    };
    let sessions = joint.series.iter().map(move |s| TrendPoint {
        joint,
        time_utc_s: s.time_utc_s,
        cycle: s.cycle,
        tracked_rad: level(s.tracked_rad.mean, s.tracked_rad.interval_95()),
        session: Some(s),
    });
    let per_s = joint.cycles.and_then(|c| Some((c.last, c.per_s?)));
    let ahead = joint.forecast.iter().map(move |f| TrendPoint {
        joint,
        time_utc_s: f.time_utc_s,
        cycle: per_s.map(|(last, per_s)| last + per_s * (f.time_utc_s - joint.last_utc_s)),
        tracked_rad: level(f.offset_rad, f.interval_95_rad),
        session: None,
    });
    sessions.chain(ahead)
}

/// Tabulates sessions and forecasts of all tendons in SI units, one row per joint and time; `kind` is `session` or `forecast`.
///
/// `tracked_rad` with its 95 % interval is the estimate at the date of a session, or the median of the forecast.
pub fn trend_series(report: &TrendReport) -> Table {
    Data::of(report.joints.iter().flat_map(points))
        .text("joint", |k| k.joint.name.as_str())
        .text("kind", |k| match k.session {
            Some(_) => "session",
            None => "forecast",
        })
        .text("day", |k| day_of(k.time_utc_s))
        // Time since the first session of the joint.
        .number("time_s", |k| k.time_utc_s - k.joint.first_utc_s)
        .integer("time_utc_ns", |k| (1e9 * k.time_utc_s).round() as i64)
        .number("cycle", |k| k.cycle)
        .bounded(
            ["tracked_rad", "tracked_low_rad", "tracked_high_rad"],
            |k| Some(k.tracked_rad),
        )
        .number("offset_rad", |k| Some(k.session?.offset_rad?.mean))
        .number("offset_std_rad", |k| Some(k.session?.offset_rad?.std))
        .number("at_reference_rad", |k| k.session?.at_reference_rad)
        .number("temperature_c", |k| k.session?.temperature_c)
        .number("step_probability", |k| Some(k.session?.step_probability))
        .flag("is_outlier", |k| Some(k.session?.is_outlier))
        .table()
}
