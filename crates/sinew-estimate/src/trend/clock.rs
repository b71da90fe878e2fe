//! When a tendon's clock began, and what was done to it since.

use super::error::AnalyzeError;
use super::records::SessionRecord;
use sinew_files::date::day_of;

/// Baselines are learned about so long after tensioning, s.
const BASELINE_AFTER_S: f64 = 3600.0;

/// Something somebody did, on a day.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Joint; `None`: all.
    pub joint: Option<String>,
    /// When, s since 1970.
    pub time_utc_s: f64,
    /// Whether the rope was replaced; else it was tensioned.
    pub replaced: bool,
}

/// The clock of a tendon's creep.
pub(super) struct Clock {
    /// Its start, s since 1970.
    pub(super) start_utc_s: f64,
    /// Whether somebody stated it.
    pub(super) stated: bool,
    /// Baseline, s after the start.
    pub(super) baseline_s: f64,
    /// Later tensionings, s since 1970.
    pub(super) tensioned: Vec<f64>,
}

/// The clock of a joint, and its records from then on: at least one.
///
/// # Errors
/// [`AnalyzeError::Replaced`].
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
    let clock = match (tensioned.first(), tensioned.last()) {
        (Some(start), Some(last)) => Clock {
            start_utc_s: *start,
            stated: true,
            baseline_s: (last - start + BASELINE_AFTER_S).min(first.time_utc_s - start),
            tensioned: later,
        },
        _ => Clock {
            start_utc_s: first.time_utc_s - BASELINE_AFTER_S,
            stated: false,
            baseline_s: BASELINE_AFTER_S,
            tensioned: later,
        },
    };
    Ok((clock, records))
}
