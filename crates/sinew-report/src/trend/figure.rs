//! The trend of a tendon as a figure.

use super::words::{MONTH_S, event_name, format_verdict, limit_name};
use crate::words::plus_minus;
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel, Points};
use sinew_figure::rounded;
use sinew_files::date::{DAY_S, day_of};
use sinew_model::Z95;
use sinew_trend::{JointTrend, Limit};

/// Offset of one tendon over days since tensioning: sessions at the reference temperature, what the
/// trend knew, the forecast, limits and events.
pub fn figure(joint: &JointTrend) -> Figure {
    let s = &joint.series;
    let start = s.first().map_or(joint.last_utc_s, |p| p.time_utc_s);
    // Cycles where sessions have no dates.
    let per_s = joint
        .cycles
        .and_then(|c| c.per_s)
        .filter(|_| !joint.is_dated());
    let unit_s = per_s.map_or(DAY_S, |per_s| 1.0 / per_s);
    let day = |t: f64| (t - start) / unit_s;
    let days: Vec<f64> = s.iter().map(|p| day(p.time_utc_s)).collect();
    let tracked = |z: f64| -> Vec<f64> {
        (s.iter().map(|p| p.tracked_rad))
            .map(|t| 1e3 * t.mean + z * (1e3 * Z95 * t.deviation))
            .collect()
    };
    let at_reference: Vec<f64> = (s.iter())
        .map(|p| p.at_reference_rad.map_or(f64::NAN, |y| 1e3 * y))
        .collect();
    // As far ahead as it was watched, or until the first limit, at most four times as far.
    let watched = days.last().copied().unwrap_or(0.0);
    let watched = if per_s.is_none() && watched > 2.0 {
        watched.max(14.0)
    } else {
        watched.max(1e-3)
    };
    let reach = joint
        .limits
        .iter()
        .filter_map(|l| l.after_high_s.or(l.after_s.map(|t| 1.3 * t)))
        .map(|t| t / unit_s)
        .fold(watched, f64::max)
        .min(3.0 * watched);
    let end = days.last().copied().unwrap_or(0.0) + reach;
    let shown = || joint.forecast.iter().filter(|f| day(f.time_utc_s) <= end);
    let ahead: Vec<f64> = shown().map(|f| day(f.time_utc_s)).collect();
    let low = shown().map(|f| 1e3 * f.interval_95_rad.low).collect();
    let high: Vec<f64> = shown().map(|f| 1e3 * f.interval_95_rad.high).collect();
    let median = shown().map(|f| 1e3 * f.offset_rad).collect();
    // A limit far above all that happens would flatten the curve.
    let top = (high.iter().copied()).fold((1e3 * joint.offset_rad.mean).abs(), f64::max);
    let axis = match per_s {
        Some(_) => "cycles since the first session".into(),
        None if !joint.is_dated() => "days since the first session".into(),
        None => format!("days since the first session, on {}", day_of(start)),
    };
    let sessions = format!("sessions, at {} °C", rounded(joint.reference_c, 3));
    let sessions = Points::new(sessions, days.clone(), at_reference.clone());
    let forecast = Line::new("forecast, median", ahead.clone(), median);
    let mut panel = Panel::new("", axis, "offset (mrad)")
        .band(Band::new("forecast, 95 %", ahead, low, high).colour(Colour::Orange))
        .band(Band::new(
            "known then, 95 %",
            days.clone(),
            tracked(-1.0),
            tracked(1.0),
        ))
        .points(sessions.colour(Colour::Grey).size(3.5))
        .line(Line::new("trend", days, tracked(0.0)))
        .line(forecast.colour(Colour::Orange).dash(Dash::Dashed))
        .x_range(0.0, end);
    if joint.is_dated() {
        panel = panel.x_days_since(start);
    }
    for limit in &joint.limits {
        let limit_mrad = 1e3 * limit.limit_rad;
        if limit_mrad < 1.5 * top && matches!(limit.limit, Limit::Retension { .. }) {
            panel = panel.reference(limit_mrad, limit_name(limit.limit));
        }
    }
    // The first session after a jump looks off until the next agrees with it.
    let jumped = |t: f64| (joint.events.iter()).any(|e| (e.time_utc_s - t).abs() < 0.5 * unit_s);
    let last_off = s.iter().rposition(|p| p.is_off && !jumped(p.time_utc_s));
    if let Some(i) = last_off {
        panel = panel.note(day(s[i].time_utc_s), at_reference[i], "off by itself");
    }
    for event in &joint.events {
        panel = panel.event(day(event.time_utc_s), event_name(event.kind));
    }
    Figure::new(format!("Offset of {}", joint.name))
        .subtitle(format_verdict(joint))
        .seen(seen(joint))
        .size(820.0, 360.0)
        .panel(panel)
}

/// What the figure shows: the verdict, where the offset stands, which way it goes.
fn seen(joint: &JointTrend) -> String {
    let rate = joint.rate_rad_per_s;
    let way = match rate.mean {
        _ if rate.mean.abs() < rate.half_width_95() => "hardly changes",
        up if up > 0.0 => "still grows",
        _ => "falls",
    };
    format!(
        "{}: {}. The offset is {} mrad and {way}, by {} mrad a month; ± is 95 %",
        joint.name,
        format_verdict(joint),
        plus_minus(joint.offset_rad, 1e3),
        plus_minus(rate, 1e3 * MONTH_S)
    )
}
