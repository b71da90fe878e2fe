//! Whether a failed strand took stiffness along.

use super::analyze::Z95;
use super::records::SessionRecord;
use super::result::With95;

/// Sessions on either side that are compared.
const SESSIONS: usize = 10;
/// Sessions from which their scatter is worth more than what they state.
const ENOUGH: usize = 5;

/// Change of the stiffness over a moment, % and half its 95 % interval: weighted means of up to ten
/// sessions on either side. `None` where fewer than two on a side state it.
pub(super) fn change(records: &[SessionRecord], time_utc_s: f64) -> Option<With95> {
    let at = records.partition_point(|r| r.time_utc_s < time_utc_s);
    let before = mean(records[..at].iter().rev())?;
    let after = mean(records[at..].iter())?;
    let half = (before[1] * before[1] + after[1] * after[1]).sqrt();
    Some([after[0] - before[0], Z95 * half])
}

/// Weighted mean and its standard error. Sessions of one baseline share most of the error they state, which
/// their difference doesn't have: from five sessions on the scatter counts, before that the larger of both.
fn mean<'a>(records: impl Iterator<Item = &'a SessionRecord>) -> Option<[f64; 2]> {
    let values: Vec<[f64; 2]> = records
        .filter_map(|r| r.stiffness_percent)
        .take(SESSIONS)
        .collect();
    if values.len() < 2 {
        return None;
    }
    let weight = |i: f64| 1.0 / (i * i);
    let sum: f64 = values.iter().map(|[_, i]| weight(*i)).sum();
    let mean = values.iter().map(|[v, i]| v * weight(*i)).sum::<f64>() / sum;
    let n = values.len() as f64;
    let scatter = values.iter().map(|[v, _]| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let stated = 1.0 / (sum.sqrt() * Z95);
    // Scatter of few is known badly (Student's factor for five), and never as small as nothing.
    const STUDENT: f64 = 1.4;
    const LEAST: f64 = 0.05;
    let seen = STUDENT * (scatter / n).sqrt();
    let error = if values.len() < ENOUGH {
        stated.max(seen)
    } else {
        seen.max(LEAST * stated)
    };
    Some([mean, error])
}

/// What a sudden lengthening may be.
pub(super) fn meaning(change: Option<With95>) -> String {
    /// A strand of a dozen carries about so much of the stiffness, %.
    const STRAND_PERCENT: f64 = 2.0;
    match change {
        Some([c, half]) if c + half < 0.0 => {
            format!("the stiffness fell too ({c:.1} ± {half:.1} %): a strand has failed?")
        }
        Some([c, half]) if c - half > -STRAND_PERCENT => {
            format!(
                "the stiffness stayed ({c:.1} ± {half:.1} %): a slip of rope, clamp or encoder?"
            )
        }
        _ => {
            "a failed strand, a slip of rope or clamp, or of an encoder; the stiffness doesn't tell"
                .into()
        }
    }
}
