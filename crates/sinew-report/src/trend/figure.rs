//! Figure of the trend of a tendon.

use super::messages::{MONTH_S, event_name, format_verdict, limit_name};
use crate::format::plus_minus;
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel, Points};
use sinew_figure::rounded;
use sinew_files::date::{DAY_S, day_of};
use sinew_model::Z95;
use sinew_trend::{JointTrend, Limit};

/// Plots the offset of a tendon over time: sessions at the reference temperature, estimate, forecast, limits and events.
pub fn figure(joint: &JointTrend) -> Figure {
    let s = &joint.series;
    let start = s.first().map_or(joint.last_utc_s, |p| p.time_utc_s);
    // The axis is in cycles if sessions have no dates.
    let per_s = joint
        .cycles
        .and_then(|c| c.per_s)
        .filter(|_| !joint.is_dated());
    let unit_s = per_s.map_or(DAY_S, |per_s| 1.0 / per_s);
    let day = |t: f64| (t - start) / unit_s;
    let days: Vec<f64> = s.iter().map(|p| day(p.time_utc_s)).collect();
    let tracked = |z: f64| -> Vec<f64> {
        (s.iter().map(|p| p.tracked_rad))
            .map(|t| 1e3 * t.mean + z * (1e3 * Z95 * t.std))
            .collect()
    };
    let at_reference: Vec<f64> = (s.iter())
        .map(|p| p.at_reference_rad.map_or(f64::NAN, |y| 1e3 * y))
        .collect();
    // The forecast is shown for the observed span, or until the limits, at most three times the span.
    let observed = days.last().copied().unwrap_or(0.0);
    let observed = if per_s.is_none() && observed > 2.0 {
        observed.max(14.0)
    } else {
        observed.max(1e-3)
    };
    let reach = joint
        .limits
        .iter()
        .filter_map(|l| l.after_high_s.or(l.after_s.map(|t| 1.3 * t)))
        .map(|t| t / unit_s)
        .fold(observed, f64::max)
        .min(3.0 * observed);
    let end = days.last().copied().unwrap_or(0.0) + reach;
    let shown = || joint.forecast.iter().filter(|f| day(f.time_utc_s) <= end);
    let ahead: Vec<f64> = shown().map(|f| day(f.time_utc_s)).collect();
    let low = shown().map(|f| 1e3 * f.interval_95_rad.low).collect();
    let high: Vec<f64> = shown().map(|f| 1e3 * f.interval_95_rad.high).collect();
    let median = shown().map(|f| 1e3 * f.offset_rad).collect();
    // A limit far above all values is not drawn, because it would flatten the curve.
    let top = (high.iter().copied()).fold((1e3 * joint.offset_rad.mean).abs(), f64::max);
    let axis = match per_s {
        Some(_) => "cycles since the first session".into(),
        None if !joint.is_dated() => "days since the first session".into(),
        None => format!("days since the first session ({})", day_of(start)),
    };
    let sessions = format!("session at {} °C", rounded(joint.reference_c, 3));
    let sessions = Points::new(sessions, days.clone(), at_reference.clone());
    let forecast = Line::new("forecast", ahead.clone(), median);
    let mut panel = Panel::new("", axis, "offset (mrad)")
        .band(Band::new("95 % prediction interval", ahead, low, high).colour(Colour::Orange))
        .band(Band::new(
            "95 % interval at that date",
            days.clone(),
            tracked(-1.0),
            tracked(1.0),
        ))
        .points(sessions.colour(Colour::Grey).size(3.5))
        .line(Line::new("estimate", days, tracked(0.0)))
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
    // The first session after a step change is marked as outlier until the next session confirms it.
    let stepped = |t: f64| (joint.events.iter()).any(|e| (e.time_utc_s - t).abs() < 0.5 * unit_s);
    let last_outlier = s
        .iter()
        .rposition(|p| p.is_outlier && !stepped(p.time_utc_s));
    if let Some(i) = last_outlier {
        panel = panel.note(day(s[i].time_utc_s), at_reference[i], "outlier");
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

/// Describes the figure for screen readers: verdict, offset and its rate.
fn seen(joint: &JointTrend) -> String {
    let rate = joint.rate_rad_per_s;
    let change = match rate.mean {
        _ if rate.mean.abs() < rate.half_width_95() => "is constant within its interval",
        up if up > 0.0 => "increases",
        _ => "decreases",
    };
    format!(
        "{}: {}. The offset is {} mrad and {change}, rate {} mrad per month; ± is the half-width of the 95 % interval",
        joint.name,
        format_verdict(joint),
        plus_minus(joint.offset_rad, 1e3),
        plus_minus(rate, 1e3 * MONTH_S)
    )
}
