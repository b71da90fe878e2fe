//! Start of a tendon's clock, and later maintenance actions.

use super::error::AnalyzeError;
use super::records::SessionRecord;
use sinew_files::date::day_of;
use sinew_model::offset::TENSIONED_OFFSET_RAD;

/// Usual time between tensioning and baseline, s.
pub(super) const BASELINE_AFTER_S: f64 = 3600.0;
/// Standard deviation of the creep between tensioning and a baseline of unspecified time, rad.
const DEFAULT_BASELINE_STD_RAD: f64 = 0.5e-3;
/// Standard deviation of the level if the tensioning date is not specified, rad.
pub(super) const LEVEL_UNKNOWN_RAD: f64 = 30e-3;

/// Maintenance action specified by the operator.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Name of the joint; `None` for all joints.
    pub joint: Option<String>,
    /// Time of the action, s since 1970.
    pub time_utc_s: f64,
    /// Whether the rope was replaced; otherwise it was re-tensioned.
    pub replaced: bool,
}

/// Clock of a tendon's creep.
pub(super) struct Clock {
    /// Start of the clock, s since 1970.
    pub(super) start_utc_s: f64,
    /// Whether the start was specified by the user.
    pub(super) stated: bool,
    /// Time of the baseline, s after the start.
    pub(super) baseline_s: f64,
    /// Standard deviation of the offset at the baseline, rad.
    pub(super) level_std_rad: f64,
    /// Times of later tensionings, s since 1970.
    pub(super) tensioned: Vec<f64>,
}

/// Determines the clock of a joint and returns its records from the last replacement on, at least
/// one.
///
/// # Errors
/// Returns [`AnalyzeError::Later`] if an action is later than the last record, and
/// [`AnalyzeError::Replaced`] if no record follows the replacement.
pub(super) fn clock<'a>(
    name: &str,
    records: &'a [SessionRecord],
    stated: &[Stated],
) -> Result<(Clock, &'a [SessionRecord]), AnalyzeError> {
    let own = stated
        .iter()
        .filter(|s| s.joint.as_deref().is_none_or(|j| j == name));
    let last_utc_s = records.last().map_or(f64::INFINITY, |r| r.time_utc_s);
    if let Some(later) = own.clone().find(|s| s.time_utc_s > last_utc_s) {
        return Err(AnalyzeError::Later {
            joint: name.into(),
            day: day_of(later.time_utc_s),
            last: day_of(last_utc_s),
        });
    }
    let replaced = own
        .clone()
        .filter(|s| s.replaced)
        .map(|s| s.time_utc_s)
        .fold(f64::NEG_INFINITY, f64::max);
    let from = records.partition_point(|r| r.time_utc_s < replaced);
    let records = &records[from..];
    let Some(first) = records.first() else {
        return Err(AnalyzeError::Replaced {
            joint: name.into(),
            day: day_of(replaced),
        });
    };
    let mut tensioned: Vec<f64> = own
        .filter(|s| !s.replaced && s.time_utc_s > replaced)
        .map(|s| s.time_utc_s)
        .collect();
    if replaced.is_finite() {
        tensioned.push(replaced);
    }
    tensioned.sort_unstable_by(f64::total_cmp);
    let before = tensioned.partition_point(|t| *t <= first.time_utc_s);
    let later = tensioned.split_off(before);
    // A baseline recorded before the last tensioning is not valid after it.
    let since = tensioned.last().copied().unwrap_or(f64::NEG_INFINITY);
    let baseline = (first.baseline_time_utc_s).filter(|t| (since..=first.time_utc_s).contains(t));
    let (start_utc_s, baseline_utc_s, level_std_rad) = match (tensioned.first(), baseline) {
        (Some(start), Some(baseline)) => (*start, baseline, TENSIONED_OFFSET_RAD),
        (Some(start), None) => {
            let usual = since + BASELINE_AFTER_S;
            (
                *start,
                usual.min(first.time_utc_s),
                DEFAULT_BASELINE_STD_RAD,
            )
        }
        (None, Some(baseline)) => (baseline - BASELINE_AFTER_S, baseline, TENSIONED_OFFSET_RAD),
        (None, None) => {
            let first = first.time_utc_s;
            (first - BASELINE_AFTER_S, first, LEVEL_UNKNOWN_RAD)
        }
    };
    let clock = Clock {
        start_utc_s,
        stated: !tensioned.is_empty(),
        baseline_s: baseline_utc_s - start_utc_s,
        level_std_rad,
        tensioned: later,
    };
    Ok((clock, records))
}

/// Baseline that a record refers to, as far as the record states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Since<'a> {
    name: Option<&'a str>,
    time_utc_s: Option<f64>,
}

impl<'a> Since<'a> {
    pub(super) fn of(record: &'a SessionRecord) -> Self {
        Self {
            name: record.baseline.as_deref(),
            time_utc_s: record.baseline_time_utc_s,
        }
    }

    /// Whether two records certainly refer to different baselines.
    pub(super) fn differs(self, before: Self) -> bool {
        /// Tolerance of dates rounded by people, s.
        const MAX_DATE_DIFFERENCE_S: f64 = 2.0;
        match (self.time_utc_s, before.time_utc_s) {
            (Some(a), Some(b)) => (a - b).abs() > MAX_DATE_DIFFERENCE_S,
            _ => self.name.is_some() && before.name.is_some() && self.name != before.name,
        }
    }

    /// Combines the information of this and the previous record.
    pub(super) fn or(self, before: Self) -> Self {
        Self {
            name: self.name.or(before.name),
            time_utc_s: self.time_utc_s.or(before.time_utc_s),
        }
    }
}
