//! Sudden changes of an offset, found in the residuals of an estimate that knows of none.

use super::features::Block;
use alloc::vec::Vec;

/// A moment at which one joint's residual changes its level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepCandidate {
    /// Joint.
    pub joint: usize,
    /// When, s.
    pub time_s: f64,
    /// By how much, rad.
    pub size_rad: f64,
    /// Size over what the residual's medians scatter.
    pub strength: f64,
}

/// Length of the medians that are compared, s: longer than a contact, shorter than a session.
const MEDIAN_S: f64 = 12.0;
/// Least data on each side, blocks: 8 s, so that a contact is a minority.
const ENOUGH: usize = 40;

/// The strongest change of level of each joint's residual; joints without enough data have none.
///
/// The median over up to 12 s before a moment is compared with that after it: contacts of a few
/// seconds don't move medians, a slip of the rope does for good. The candidate is only that: the
/// caller estimates again with a step there and keeps it if its size is sure.
///
/// * `residuals_rad`: row-major `blocks × n`.
pub fn step_candidates(
    blocks: &[Block],
    residuals_rad: &[f64],
    noise_rad: &[f64],
) -> Vec<StepCandidate> {
    let n = noise_rad.len();
    let mut found = Vec::new();
    let mut sorted = Vec::new();
    for joint in 0..n {
        let mut best: Option<StepCandidate> = None;
        let series: Vec<f64> = residuals_rad
            .iter()
            .skip(joint)
            .step_by(n)
            .copied()
            .collect();
        for (at, block) in blocks.iter().enumerate() {
            let from = blocks[..at].partition_point(|b| b.time_s < block.time_s - MEDIAN_S);
            let to = at + blocks[at..].partition_point(|b| b.time_s < block.time_s + MEDIAN_S);
            let (before, after) = (&series[from..at], &series[at..to]);
            if before.len() < ENOUGH || after.len() < ENOUGH {
                continue;
            }
            let mut level = |values: &[f64]| {
                sorted.clear();
                sorted.extend_from_slice(values);
                sorted.sort_by(f64::total_cmp);
                sorted[sorted.len() / 2]
            };
            let size_rad = level(after) - level(before);
            // A median of m correlated blocks scatters by about 1.25 σ √(5/m).
            let count = before.len().min(after.len()) as f64;
            let scatter = 1.25 * noise_rad[joint] * libm::sqrt(10.0 / count);
            let strength = size_rad.abs() / scatter;
            if best.is_none_or(|b| strength > b.strength) {
                best = Some(StepCandidate {
                    joint,
                    time_s: block.time_s,
                    size_rad,
                    strength,
                });
            }
        }
        found.extend(best);
    }
    found
}
