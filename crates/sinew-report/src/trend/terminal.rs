//! The trend as a terminal shows it.

use super::words::{
    event_name, format_basis, format_limit, format_meaning, format_passage, format_verdict,
    limit_name, limit_of_verdict, plus_minus, plus_minus_or_dash, sessions, whole_days,
};
use crate::text::{indented, paragraph, plain, table};
use sinew_estimate::trend::{JointTrend, Limit, LimitForecast, LimitState, TrendReport};
use sinew_files::date::day_of;

/// Head of the table.
const HEAD: [&str; 5] = [
    "tendon",
    "offset\nmrad",
    "stretch\nmm",
    "creep\nmrad/month",
    "re-tension in\ndays",
];
/// Mean length of a month as the table has it, s.
pub(super) const MONTH_S: f64 = 30.0 * 86_400.0;

/// The trend as text of at most 80 columns.
pub fn render_table(report: &TrendReport) -> String {
    let robot = report.robot.as_deref().unwrap_or("robot");
    let first = report.joints.iter().map(|j| j.first_utc_s).reduce(f64::min);
    let last = report.joints.iter().map(|j| j.last_utc_s).reduce(f64::max);
    let mut out = String::new();
    if let Some((first, last)) = first.zip(last) {
        let (first, last) = (day_of(first), day_of(last));
        let heading = format!("{robot}: {first} to {last}; ± and brackets are 95 %");
        out.push_str(&paragraph(&plain(&heading), 2));
    }
    out.push_str(&table(&HEAD, report.joints.iter().map(row).collect(), 1));
    out.push('\n');
    for joint in &report.joints {
        let headline = format!("{}: {}", joint.name, format_verdict(joint));
        out.push_str(&paragraph(&plain(&headline), 2));
        for line in lines(joint) {
            out.push_str(&indented(&plain(&line), 2, 4));
        }
    }
    out
}

fn row(joint: &JointTrend) -> Vec<String> {
    let limit = (joint.limits.iter()).find(|l| matches!(l.limit, Limit::Retension { .. }));
    vec![
        plain(&joint.name),
        plus_minus(joint.offset_rad, 1e3),
        plus_minus_or_dash(joint.elongation_m, 1e3),
        plus_minus(joint.rate_rad_per_s, 1e3 * MONTH_S),
        limit.map_or("–".into(), in_days),
    ]
}

/// `85 (18 to 300)`; the words stand below the table.
fn in_days(limit: &LimitForecast) -> String {
    let whole = |time_s: Option<f64>| time_s.map_or("…".into(), whole_days);
    match limit.state {
        LimitState::Passed => "passed".into(),
        LimitState::Forecast => format!(
            "{} ({} to {})",
            whole(limit.after_s),
            whole(limit.after_low_s),
            whole(limit.after_high_s)
        ),
        LimitState::NotBefore | LimitState::NotWithinHorizon | LimitState::TooFewSessions => {
            "unknown".into()
        }
    }
}

/// Events, other limits and the basis of one tendon.
fn lines(joint: &JointTrend) -> Vec<String> {
    let mut out = Vec::new();
    for event in &joint.events {
        let by = event.size_rad.map_or(String::new(), |size| {
            format!(" by {} mrad", plus_minus(size, 1e3))
        });
        let (day, name) = (day_of(event.time_utc_s), event_name(event.kind));
        out.push(format!("{day}: {name}{by}; {}", format_meaning(event)));
    }
    let headline = limit_of_verdict(joint);
    for limit in &joint.limits {
        // What the headline says already, or says of another limit with the same words.
        let is_said = headline.is_some_and(|h| {
            let of = |l: &LimitForecast| (l.state, l.after_s, l.after_low_s, l.after_high_s);
            of(h) == of(limit)
        });
        if !is_said {
            let (name, value) = (limit_name(limit.limit), format_limit(limit.limit));
            let passage = format_passage(limit, joint.last_utc_s);
            out.push(format!("{name} at {value}: {passage}"));
        }
    }
    out.push(sessions(joint));
    out.push(format!(
        "the forecast rests on {}",
        format_basis(&joint.basis)
    ));
    out
}
