//! Change of the stiffness at an event, and the cause it indicates.

use super::records::SessionRecord;
use super::result::StepCause;
use sinew_model::Gaussian;

/// Maximum number of sessions on either side of an event.
const SESSIONS: usize = 10;
/// Minimum number of sessions for their scatter to replace the reported error.
const MIN_SESSIONS_FOR_SCATTER: usize = 5;

/// Change of the stiffness at a time as a fraction of nominal: weighted means of up to ten sessions
/// on either side. `None` if fewer than two on a side report it.
pub(super) fn change(records: &[SessionRecord], time_utc_s: f64) -> Option<Gaussian> {
    let at = records.partition_point(|r| r.time_utc_s < time_utc_s);
    let before = mean(records[..at].iter().rev())?;
    let after = mean(records[at..].iter())?;
    let (a, b) = (before.std, after.std);
    Some(Gaussian::new(
        after.mean - before.mean,
        (a * a + b * b).sqrt(),
    ))
}

/// Weighted mean and its standard error. Sessions of one baseline share most of their reported
/// error, which cancels in their difference: from five sessions on the scatter counts, before that
/// the larger of both.
fn mean<'a>(records: impl Iterator<Item = &'a SessionRecord>) -> Option<Gaussian> {
    let values: Vec<Gaussian> = records
        .filter_map(|r| r.stiffness_ratio)
        .take(SESSIONS)
        .collect();
    if values.len() < 2 {
        return None;
    }
    let weight = |g: &Gaussian| 1.0 / (g.std * g.std);
    let sum: f64 = values.iter().map(weight).sum();
    let mean = values.iter().map(|g| g.mean * weight(g)).sum::<f64>() / sum;
    let n = values.len() as f64;
    let scatter = values.iter().map(|g| (g.mean - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let stated = 1.0 / sum.sqrt();
    // The scatter of few sessions is uncertain (Student's factor for five), and has a lower bound.
    const STUDENT: f64 = 1.4;
    const MIN_STD_ERROR_SHARE: f64 = 0.05;
    let seen = STUDENT * (scatter / n).sqrt();
    let error = if values.len() < MIN_SESSIONS_FOR_SCATTER {
        stated.max(seen)
    } else {
        seen.max(MIN_STD_ERROR_SHARE * stated)
    };
    Some(Gaussian::new(mean, error))
}

/// Cause of a sudden elongation by the simultaneous change of stiffness.
pub(super) fn cause(change: Option<Gaussian>) -> StepCause {
    /// Approximate share of the stiffness per strand of a dozen.
    const STRAND: f64 = 0.02;
    match change.map(Gaussian::interval_95) {
        Some(change) if change.high < 0.0 => StepCause::StrandFailure,
        Some(change) if change.low > -STRAND => StepCause::Slip,
        _ => StepCause::Unknown,
    }
}
