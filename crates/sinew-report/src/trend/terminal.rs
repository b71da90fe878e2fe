//! The trend as a terminal shows it.

use super::words::{
    event_name, format_basis, format_life, format_limit, format_meaning, format_passage,
    format_shared, format_sureness, format_verdict, format_when, limit_name, limit_of_verdict,
    plus_minus_or_dash, sessions,
};
use crate::text::{indented, paragraph, plain, table};
use crate::words::plus_minus;
use sinew_figure::rounded;
use sinew_files::date::{DAY_S, day_of};
use sinew_trend::{JointTrend, Limit, LimitForecast, LimitState, TrendReport};

/// What the last column counts in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unit {
    Days,
    Hours,
    Cycles,
}

impl Unit {
    /// Cycles where sessions have no dates, hours where all of it happens within a few days.
    fn of(report: &TrendReport) -> Self {
        /// Below so many days every span is told in hours.
        const FEW_DAYS: f64 = 3.0;
        if !report.joints.iter().all(JointTrend::is_dated) {
            return Self::Cycles;
        }
        let limits = report.joints.iter().flat_map(|j| &j.limits);
        let spans = limits.flat_map(|l| [l.after_s, l.after_low_s]).flatten();
        let longest = spans.fold(0.0, f64::max);
        match longest > 0.0 && longest < FEW_DAYS * DAY_S {
            true => Self::Hours,
            false => Self::Days,
        }
    }

    fn head(self) -> &'static str {
        match self {
            Self::Days => "re-tension in\ndays; on",
            Self::Hours => "re-tension in\nhours; on",
            Self::Cycles => "re-tension in\ncycles",
        }
    }

    fn whole(self, joint: &JointTrend, time_s: f64) -> String {
        let per_s = joint.cycles.and_then(|c| c.per_s);
        match self {
            Self::Days => format!("{:.0}", (time_s / DAY_S).round()),
            Self::Hours => rounded(time_s / 3600.0, 2),
            Self::Cycles => per_s.map_or("…".into(), |per_s| format!("{:.0}", per_s * time_s)),
        }
    }
}
/// Mean length of a month as the table has it, s.
pub(super) const MONTH_S: f64 = 30.0 * 86_400.0;

/// The trend as text of at most 80 columns.
pub fn render_table(report: &TrendReport) -> String {
    let robot = report.robot.as_deref().unwrap_or("robot");
    let first = report.joints.iter().map(|j| j.first_utc_s).reduce(f64::min);
    let last = report.joints.iter().map(|j| j.last_utc_s).reduce(f64::max);
    let mut out = String::new();
    if let Some((first, last)) = first.zip(last) {
        let heading_joint = report.joints.first().filter(|j| !j.is_dated());
        let when = |utc_s: f64| heading_joint.map_or(day_of(utc_s), |j| format_when(j, utc_s));
        let (first, last) = (when(first), when(last));
        let heading = format!("{robot}: {first} to {last}; ± and brackets are 95 %");
        out.push_str(&paragraph(&plain(&heading), 2));
    }
    let unit = Unit::of(report);
    let head = [
        "tendon",
        "offset\nmrad",
        "stretch\nmm",
        "creep\nmrad/month",
        unit.head(),
    ];
    let rows = report.joints.iter().map(|j| row(j, unit)).collect();
    out.push_str(&table(&head, rows, 1));
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

fn row(joint: &JointTrend, unit: Unit) -> Vec<String> {
    let limit = (joint.limits.iter()).find(|l| matches!(l.limit, Limit::Retension { .. }));
    vec![
        plain(&joint.name),
        plus_minus(joint.offset_rad, 1e3),
        plus_minus_or_dash(joint.elongation_m, 1e3),
        plus_minus(joint.rate_rad_per_s, 1e3 * MONTH_S),
        limit.map_or("–".into(), |limit| passage(joint, limit, unit)),
    ]
}

/// `85 (18 to 300)` and the date below; the words stand below the table.
fn passage(joint: &JointTrend, limit: &LimitForecast, unit: Unit) -> String {
    let whole = |time_s: Option<f64>| time_s.map_or("…".into(), |t| unit.whole(joint, t));
    match limit.state {
        LimitState::Passed => "passed".into(),
        LimitState::Forecast => {
            let date = limit
                .at_utc_s
                .map_or(String::new(), |t| format!("\n{}", day_of(t)));
            format!(
                "{} ({} to {}){date}",
                whole(limit.after_s),
                whole(limit.after_low_s),
                whole(limit.after_high_s)
            )
        }
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
        let (day, name) = (format_when(joint, event.time_utc_s), event_name(event.kind));
        let sure = format_sureness(event).map_or(String::new(), |sure| format!("; {sure}"));
        out.push(format!(
            "{day}: {name}{by}; {}{sure}",
            format_meaning(event)
        ));
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
            let passage = format_passage(limit, joint);
            out.push(format!("{name} at {value}: {passage}"));
        }
    }
    if let Some(life) = joint.life.as_ref().filter(|_| !joint.limits.is_empty()) {
        out.push(format!("replace {}", format_life(life, joint)));
    }
    out.push(sessions(joint));
    out.extend(format_shared(joint));
    out.push(format!(
        "the forecast rests on {}",
        format_basis(&joint.basis)
    ));
    out
}
