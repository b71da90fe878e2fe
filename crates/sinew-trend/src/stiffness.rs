//! Whether a failed strand took stiffness along.

use super::records::SessionRecord;
use super::result::JumpCause;
use sinew_model::Gaussian;

/// Sessions on either side that are compared.
const SESSIONS: usize = 10;
/// Sessions from which their scatter is worth more than what they state.
const ENOUGH: usize = 5;

/// Change of the stiffness over a time as a fraction of nominal: weighted means of up to ten sessions on
/// either side. `None` where fewer than two on a side state it.
pub(super) fn change(records: &[SessionRecord], time_utc_s: f64) -> Option<Gaussian> {
    let at = records.partition_point(|r| r.time_utc_s < time_utc_s);
    let before = mean(records[..at].iter().rev())?;
    let after = mean(records[at..].iter())?;
    let (a, b) = (before.deviation, after.deviation);
    Some(Gaussian::new(
        after.mean - before.mean,
        (a * a + b * b).sqrt(),
    ))
}

/// Weighted mean and its standard error. Sessions of one baseline share most of the error they state, which
/// their difference doesn't have: from five sessions on the scatter counts, before that the larger of both.
fn mean<'a>(records: impl Iterator<Item = &'a SessionRecord>) -> Option<Gaussian> {
    let values: Vec<Gaussian> = records
        .filter_map(|r| r.stiffness_ratio)
        .take(SESSIONS)
        .collect();
    if values.len() < 2 {
        return None;
    }
    let weight = |g: &Gaussian| 1.0 / (g.deviation * g.deviation);
    let sum: f64 = values.iter().map(weight).sum();
    let mean = values.iter().map(|g| g.mean * weight(g)).sum::<f64>() / sum;
    let n = values.len() as f64;
    let scatter = values.iter().map(|g| (g.mean - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let stated = 1.0 / sum.sqrt();
    // Scatter of few is known badly (Student's factor for five), and never as small as nothing.
    const STUDENT: f64 = 1.4;
    const LEAST: f64 = 0.05;
    let seen = STUDENT * (scatter / n).sqrt();
    let error = if values.len() < ENOUGH {
        stated.max(seen)
    } else {
        seen.max(LEAST * stated)
    };
    Some(Gaussian::new(mean, error))
}

/// What a sudden lengthening may be, by the change of stiffness that came with it.
pub(super) fn cause(change: Option<Gaussian>) -> JumpCause {
    /// A strand of a dozen carries about so much of the stiffness.
    const STRAND: f64 = 0.02;
    match change.map(Gaussian::interval_95) {
        Some(change) if change.high < 0.0 => JumpCause::StrandFailure,
        Some(change) if change.low > -STRAND => JumpCause::Slip,
        _ => JumpCause::Unknown,
    }
}
