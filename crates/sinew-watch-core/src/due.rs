//! Maintenance forecast over all robots, from the trend of each tendon.

use crate::snapshot::{RobotSnapshot, TendonSnapshot};
use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_trend::{JointTrend, Limit, LimitState, Passage, TrendVerdict};

/// Maintenance due over all robots. A tendon is due if its limit is exceeded, or if the lower end of the interval of
/// its first-passage time lies within the requested time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DueList {
    /// Time of the list, s since 1970 UTC; relative times refer to it.
    pub time_utc_s: f64,
    /// End of the requested time, s since 1970 UTC.
    pub until_utc_s: f64,
    /// Tendons that are due: first those that have exceeded a limit, the largest exceedance first; then by date.
    pub due: Vec<DueTendon>,
    /// Number of tendons that exceed no limit within the requested time.
    pub not_due: usize,
    /// Number of tendons with a limit but without a forecast: too few sessions, or no trend yet.
    pub inconclusive: usize,
    /// Number of tendons without a limit.
    pub without_limit: usize,
}

/// Tendon that is due, with the limit that it exceeds first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DueTendon {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Name of the joint.
    pub joint: String,
    /// Name of the rope in robot.toml.
    pub rope: Option<String>,
    /// Limit that is exceeded first.
    pub limit: Limit,
    /// Limit expressed as an offset, rad.
    pub limit_rad: f64,
    /// Recommended action according to the trend.
    pub verdict: TrendVerdict,
    /// State of the limit: exceeded, predicted or not predictable.
    pub state: LimitState,
    /// Probability that the limit was exceeded at the last session, 0…1.
    pub passed_probability: f64,
    /// Probability that the limit is exceeded by `until_utc_s`, 0…1; `None`: beyond the forecast horizon.
    pub until_probability: Option<f64>,
    /// Median of the time from `time_utc_s` until the limit is exceeded, s; negative: in the past. `None`: beyond the
    /// forecast horizon. For an exceeded limit it is the time of the last session, because the time of the exceedance
    /// is not available.
    pub after_s: Option<f64>,
    /// 2.5 % quantile of that time, s.
    pub after_low_s: Option<f64>,
    /// 97.5 % quantile of that time, s; `None`: beyond the forecast horizon.
    pub after_high_s: Option<f64>,
    /// Median as a date, s since 1970 UTC.
    pub at_utc_s: Option<f64>,
    /// 2.5 % quantile as a date, s since 1970 UTC.
    pub at_low_utc_s: Option<f64>,
    /// 97.5 % quantile as a date, s since 1970 UTC.
    pub at_high_utc_s: Option<f64>,
    /// Offset since the last tensioning at the last session, rad.
    pub offset_rad: Gaussian,
    /// Elongation since the last tensioning, m.
    pub elongation_m: Option<Gaussian>,
    /// Strain since the first tensioning, ratio.
    pub strain_ratio: Option<Gaussian>,
    /// Number of sessions that the trend is based on.
    pub sessions: usize,
    /// Start of the first session, s since 1970 UTC.
    pub first_utc_s: f64,
    /// Start of the last session, s since 1970 UTC.
    pub last_utc_s: f64,
    /// Start of creep (tensioning or replacement), s since 1970 UTC.
    pub tensioned_utc_s: f64,
    /// Whether that time is specified; otherwise it is the start of the first session.
    pub tensioned_specified: bool,
}

/// Result for a tendon within the requested time.
enum DueState<'a> {
    WithoutLimit,
    Inconclusive,
    NotDue,
    Due(&'a JointTrend, Passage),
}

impl DueList {
    /// Builds the list from the current state of the robots.
    ///
    /// * `time_utc_s`: present time, s since 1970 UTC.
    /// * `within_s`: requested time from now, s.
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
            inconclusive: 0,
            without_limit: 0,
        };
        let mut due = Vec::new();
        for robot in robots {
            for tendon in &robot.tendons {
                match due_state(tendon, out.until_utc_s) {
                    DueState::WithoutLimit => out.without_limit += 1,
                    DueState::Inconclusive => out.inconclusive += 1,
                    DueState::NotDue => out.not_due += 1,
                    DueState::Due(trend, passage) => {
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

fn due_state(tendon: &TendonSnapshot, until_utc_s: f64) -> DueState<'_> {
    if tendon.limits.is_empty() {
        return DueState::WithoutLimit;
    }
    let Some(trend) = tendon.trend.as_deref() else {
        return DueState::Inconclusive;
    };
    match Passage::first(&Passage::all(trend)) {
        Some(first) if first.is_due(until_utc_s) => DueState::Due(trend, *first),
        Some(first) if first.state != LimitState::TooFewSessions => DueState::NotDue,
        _ => DueState::Inconclusive,
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
            tensioned_specified: trend.tensioned_specified,
        }
    }
}
