//! Trend as text for a terminal.

use super::messages::{
    event_line, format_basis, format_life, format_systematic, format_verdict, format_when,
    limit_line, limit_of_verdict, now, sessions,
};
use crate::text::{TerminalText, or_dash};
use sinew_figure::rounded;
use sinew_files::date::{DAY_S, day_of};
use sinew_trend::{JointTrend, Limit, LimitForecast, LimitState, TrendReport};

/// Time unit of the forecast column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unit {
    Days,
    Hours,
    Cycles,
}

impl Unit {
    /// Returns cycles if sessions have no dates, hours if all limits lie within a few days, else days.
    fn of(report: &TrendReport) -> Self {
        /// Shortest forecast in days.
        const MIN_DAYS: f64 = 3.0;
        if !report.joints.iter().all(JointTrend::is_dated) {
            return Self::Cycles;
        }
        let limits = report.joints.iter().flat_map(|j| &j.limits);
        let spans = limits.flat_map(|l| [l.after_s, l.after_low_s]).flatten();
        let longest = spans.fold(0.0, f64::max);
        match longest > 0.0 && longest < MIN_DAYS * DAY_S {
            true => Self::Hours,
            false => Self::Days,
        }
    }

    fn head(self) -> &'static str {
        match self {
            Self::Days => "re-tension in\n(days); date",
            Self::Hours => "re-tension in\n(hours); date",
            Self::Cycles => "re-tension in\n(cycles)",
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
/// Renders a trend as text of at most 80 columns.
pub fn render_table(report: &TrendReport) -> String {
    let robot = report.robot.as_deref().unwrap_or("robot");
    let first = report.joints.iter().map(|j| j.first_utc_s).reduce(f64::min);
    let last = report.joints.iter().map(|j| j.last_utc_s).reduce(f64::max);
    let mut out = TerminalText::default();
    if let Some((first, last)) = first.zip(last) {
        let heading_joint = report.joints.first().filter(|j| !j.is_dated());
        let when = |utc_s: f64| heading_joint.map_or(day_of(utc_s), |j| format_when(j, utc_s));
        let (first, last) = (when(first), when(last));
        out.paragraph(format!(
            "{robot}: {first} to {last}; ± and ranges in brackets: 95 % intervals"
        ));
    }
    let unit = Unit::of(report);
    let retension = |j: &&JointTrend| {
        let limit = (j.limits.iter()).find(|l| matches!(l.limit, Limit::Retension { .. }));
        or_dash(limit, |limit| exceedance(j, limit, unit))
    };
    out.table(now(report).lines(unit.head(), retension).table());
    out.add("\n");
    for joint in &report.joints {
        out.paragraph(format!("{}: {}", joint.name, format_verdict(joint)));
        for line in lines(joint) {
            out.item(line);
        }
    }
    out.0
}

/// Formats the time until a limit is exceeded, `85 (18 to 300)`, with its date on the next line.
fn exceedance(joint: &JointTrend, limit: &LimitForecast, unit: Unit) -> String {
    let whole = |time_s: Option<f64>| time_s.map_or("…".into(), |t| unit.whole(joint, t));
    match limit.state {
        LimitState::Passed => "exceeded".into(),
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
            "not predictable".into()
        }
    }
}

/// Lists events, further limits and the basis of the forecast of a tendon.
fn lines(joint: &JointTrend) -> Vec<String> {
    let events = joint.events.iter();
    let mut out: Vec<String> = events.map(|event| event_line(event, joint)).collect();
    let headline = limit_of_verdict(joint);
    for limit in &joint.limits {
        // Limits with the same forecast as the headline are not repeated.
        let is_repeated = headline.is_some_and(|h| {
            let of = |l: &LimitForecast| (l.state, l.after_s, l.after_low_s, l.after_high_s);
            of(h) == of(limit)
        });
        if !is_repeated {
            out.push(limit_line(limit, joint));
        }
    }
    if let Some(life) = joint.life.as_ref().filter(|_| !joint.limits.is_empty()) {
        out.push(format!("replacement: {}", format_life(life, joint)));
    }
    out.push(sessions(joint));
    out.extend(format_systematic(joint));
    let basis = format_basis(&joint.basis);
    out.push(format!("forecast based on {basis}"));
    out
}
