//! Detection of step changes, which are not creep, for example a strand failure.

use super::Point;
use sinew_model::statistics::quantile;

/// Number of sessions compared before and after a change.
const WINDOW_SESSIONS: usize = 6;
/// Threshold of a step change, in standard deviations.
const MIN_STEP_STD: f64 = 6.0;
/// Maximum number of step changes of a tendon.
const MAX_STEPS: usize = 4;

/// Begins a new piece at each step change and returns their number.
///
/// Lines through the sessions before and after a time are extrapolated to it. Their difference is compared with the scatter
/// of the sessions and with the usual difference of such lines of this tendon, which is large for ropes that creep in steps of
/// work.
pub(super) fn part(points: &mut [Point], scatter_rad: f64) -> usize {
    for found in 0..MAX_STEPS {
        let Some(at) = largest(points, scatter_rad) else {
            return found;
        };
        points[at..].iter_mut().for_each(|p| p.piece += 1);
    }
    MAX_STEPS
}

/// Finds the largest change, if it is a step change.
fn largest(points: &[Point], scatter_rad: f64) -> Option<usize> {
    let last = points.len().checked_sub(WINDOW_SESSIONS)?;
    let points = &calmed(points);
    let steps: Vec<(usize, f64)> = (WINDOW_SESSIONS..=last)
        .filter(|&at| points[at - WINDOW_SESSIONS].piece == points[at + WINDOW_SESSIONS - 1].piece)
        .filter_map(|at| {
            let moment = 0.5 * (points[at - 1].log_age + points[at].log_age);
            let [before, after] = [
                &points[at - WINDOW_SESSIONS..at],
                &points[at..at + WINDOW_SESSIONS],
            ]
            .map(|some| drawn_on(some, moment));
            let ((y0, v0), (y1, v1)) = (before?, after?);
            Some((at, (y1 - y0).abs() / (v0 + v1).sqrt()))
        })
        .collect();
    let mut sizes: Vec<f64> = steps.iter().map(|s| s.1).collect();
    sizes.sort_by(f64::total_cmp);
    // Of a normal distribution half lies within 0.6745 standard deviations.
    let usual = scatter_rad.max(quantile(&sizes, 0.5) / 0.6745);
    let (at, size) = steps.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (size > MIN_STEP_STD * usual).then_some(at)
}

/// Median of each session and its neighbours, which removes single outliers.
fn calmed(points: &[Point]) -> Vec<Point> {
    let middle = |i: usize| {
        let near = &points[i.saturating_sub(1)..points.len().min(i + 2)];
        let mut offsets: Vec<f64> = (near.iter())
            .filter(|p| p.piece == points[i].piece)
            .map(|p| p.offset_rad)
            .collect();
        offsets.sort_by(f64::total_cmp);
        quantile(&offsets, 0.5)
    };
    let calm = |i: usize| Point {
        offset_rad: middle(i),
        ..points[i]
    };
    (0..points.len()).map(calm).collect()
}

/// A line through some sessions at a moment, and its variance for scatter of 1.
fn drawn_on(some: &[Point], log_age: f64) -> Option<(f64, f64)> {
    let n = some.len() as f64;
    let x = some.iter().map(|p| p.log_age).sum::<f64>() / n;
    let y = some.iter().map(|p| p.offset_rad).sum::<f64>() / n;
    let xx: f64 = some.iter().map(|p| (p.log_age - x).powi(2)).sum();
    let xy: f64 = some
        .iter()
        .map(|p| (p.log_age - x) * (p.offset_rad - y))
        .sum();
    let beyond = log_age - x;
    (xx > 0.0).then(|| (y + xy / xx * beyond, 1.0 / n + beyond * beyond / xx))
}
