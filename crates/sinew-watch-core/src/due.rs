//! Which tendons pass a limit when: over all robots, from the trend of each tendon.

use crate::snapshot::{RobotSnapshot, TendonSnapshot};
use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_trend::{JointTrend, Limit, LimitState, Passage, TrendVerdict};

/// What is due over all robots: a tendon is, when its limit is passed or when the lower end of its interval lies within the time asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DueList {
    /// When this was said, s since 1970 UTC: times to come count from here.
    pub time_utc_s: f64,
    /// What is due by then, s since 1970 UTC.
    pub until_utc_s: f64,
    /// Tendons that are due: those first that have passed a limit, the farthest beyond it before the others; then by the day.
    pub due: Vec<DueTendon>,
    /// Tendons that pass no limit by then.
    pub not_due: usize,
    /// Tendons with a limit of which it can't be told yet: too few sessions, or no trend so far.
    pub cannot_tell: usize,
    /// Tendons without a limit.
    pub without_limit: usize,
}

/// A tendon that is due, with the limit it passes first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DueTendon {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Name of the joint.
    pub joint: String,
    /// Its rope, as robot.toml names it.
    pub rope: Option<String>,
    /// The limit that is passed first.
    pub limit: Limit,
    /// The limit as an offset, rad.
    pub limit_rad: f64,
    /// What to do, by its trend.
    pub verdict: TrendVerdict,
    /// What is known of the day.
    pub state: LimitState,
    /// Probability that the limit was passed already at the last session.
    pub passed_probability: f64,
    /// Probability that it is passed by `until_utc_s`; `None`: the forecast doesn't reach so far.
    pub until_probability: Option<f64>,
    /// Median of the time from `time_utc_s` until it is passed, s; negative: before. `None`: beyond the forecast. Of a limit that is passed
    /// it is the last session's: when that was, isn't known.
    pub after_s: Option<f64>,
    /// 2.5 % quantile of that time, s.
    pub after_low_s: Option<f64>,
    /// 97.5 % quantile of that time, s; `None`: beyond the forecast, perhaps never.
    pub after_high_s: Option<f64>,
    /// The median as a date, s since 1970 UTC.
    pub at_utc_s: Option<f64>,
    /// The 2.5 % quantile as a date.
    pub at_low_utc_s: Option<f64>,
    /// The 97.5 % quantile as a date.
    pub at_high_utc_s: Option<f64>,
    /// Offset since the last tensioning, at the last session.
    pub offset_rad: Gaussian,
    /// The same as elongation, m.
    pub elongation_m: Option<Gaussian>,
    /// Strain since the first tensioning, as a fraction.
    pub strain_ratio: Option<Gaussian>,
    /// Sessions the trend rests on.
    pub sessions: usize,
    /// Start of the first of them, s since 1970 UTC.
    pub first_utc_s: f64,
    /// Start of the last of them, s since 1970 UTC.
    pub last_utc_s: f64,
    /// Start of the creep's clock, tensioning or replacement, s since 1970 UTC.
    pub tensioned_utc_s: f64,
    /// Whether somebody stated that; else it is the first session's.
    pub tensioned_stated: bool,
}

/// What a tendon's trend says of the time asked for.
enum Found<'a> {
    WithoutLimit,
    CannotTell,
    NotDue,
    Due(&'a JointTrend, Passage),
}

impl DueList {
    /// Of robots as they are known now.
    ///
    /// * `time_utc_s`: now, s since 1970 UTC.
    /// * `within_s`: the time asked for, s from now.
    pub fn of<'a>(
        robots: impl IntoIterator<Item = &'a RobotSnapshot>,
        time_utc_s: f64,
        within_s: f64,
    ) -> Self {
        let mut out = Self {
            time_utc_s,
            until_utc_s: time_utc_s + within_s,
            due: Vec::new(),
            not_due: 0,
            cannot_tell: 0,
            without_limit: 0,
        };
        let mut due = Vec::new();
        for robot in robots {
            for tendon in &robot.tendons {
                match found(tendon, out.until_utc_s) {
                    Found::WithoutLimit => out.without_limit += 1,
                    Found::CannotTell => out.cannot_tell += 1,
                    Found::NotDue => out.not_due += 1,
                    Found::Due(trend, passage) => {
                        let row = DueTendon::of((&robot.robot, tendon), trend, &passage, &out);
                        due.push((passage.rank(), row));
                    }
                }
            }
        }
        due.sort_by(|((waits, a), _), ((others, b), _)| waits.cmp(others).then(a.total_cmp(b)));
        out.due = due.into_iter().map(|(_, row)| row).collect();
        out
    }
}

fn found(tendon: &TendonSnapshot, until_utc_s: f64) -> Found<'_> {
    if tendon.limits.is_empty() {
        return Found::WithoutLimit;
    }
    let Some(trend) = tendon.trend.as_deref() else {
        return Found::CannotTell;
    };
    match Passage::first(&Passage::all(trend)) {
        Some(first) if first.is_due(until_utc_s) => Found::Due(trend, *first),
        Some(first) if first.state != LimitState::TooFewSessions => Found::NotDue,
        _ => Found::CannotTell,
    }
}

impl DueTendon {
    fn of(
        (robot, tendon): (&str, &TendonSnapshot),
        trend: &JointTrend,
        passage: &Passage,
        list: &DueList,
    ) -> Self {
        let times = tendon.passages.iter().find(|t| t.limit == passage.limit);
        let until_s = list.until_utc_s - trend.last_utc_s;
        let [at_utc_s, at_low_utc_s, at_high_utc_s] = passage.at_utc_s;
        let from_now = |at: f64| at - list.time_utc_s;
        Self {
            robot: robot.into(),
            joint: tendon.joint.clone(),
            rope: tendon.rope.clone(),
            limit: passage.limit,
            limit_rad: passage.limit_rad,
            verdict: trend.verdict,
            state: passage.state,
            passed_probability: passage.passed_probability,
            until_probability: times.and_then(|times| times.probability_by(until_s)),
            after_s: at_utc_s.map(from_now),
            after_low_s: at_low_utc_s.map(from_now),
            after_high_s: at_high_utc_s.map(from_now),
            at_utc_s,
            at_low_utc_s,
            at_high_utc_s,
            offset_rad: trend.offset_rad,
            elongation_m: trend.elongation_m,
            strain_ratio: trend.strain_ratio,
            sessions: trend.sessions,
            first_utc_s: trend.first_utc_s,
            last_utc_s: trend.last_utc_s,
            tensioned_utc_s: trend.tensioned_utc_s,
            tensioned_stated: trend.tensioned_stated,
        }
    }
}
