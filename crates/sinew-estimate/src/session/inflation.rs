//! Widening of the intervals for errors that the posterior does not contain.

use super::context::Context;
use super::recorder::Recorded;
use super::rest_phase::RestPhase;
use super::result::{BlockEstimate, SegmentEstimate, TendonChange};
use super::segments::Segments;
use sinew_model::offset::{JointParameter, Prior};
use sinew_model::{Gaussian, Z95};

/// Contributions that widen the interval of one joint.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Inflation {
    /// Uncertain changes near the end: time (s) and size (rad).
    late: Vec<(f64, f64)>,
    /// Half-width of the 95 % interval for the unknown load history of a viscoelastic rope, rad.
    pub(super) creep_95_rad: f64,
    /// Standard deviation of errors that are constant over all blocks, rad: temperature and excess residual.
    pub(super) constant_rad: f64,
}

impl Inflation {
    pub(super) fn new(
        context: &Context<'_>,
        joint: usize,
        changes: &[TendonChange],
        constant_rad: f64,
    ) -> Self {
        let Context {
            recorded, segments, ..
        } = *context;
        let prior = context.estimator.prior();
        let late = changes.iter().filter(|c| context.may_end(joint, c));
        let late = late.map(|c| (c.time_s, c.size_rad.map_or(0.0, |size| size.mean.abs())));
        Self {
            late: late.collect(),
            creep_95_rad: creep_95_rad(prior, recorded, segments, joint),
            constant_rad,
        }
    }

    /// Widens the interval if the final rest phase is inconsistent with stiction: the interval then covers a slip there
    /// and none.
    pub(super) fn with_rest_phase(mut self, phase: Option<RestPhase>) -> Self {
        let inconsistent = phase.filter(RestPhase::exceeds_stiction);
        self.late
            .extend(inconsistent.map(|phase| (phase.from_s, phase.largest_rad())));
        self
    }

    /// Returns an offset (rad) at `time_s` with the widened standard deviation; late changes add to the half-width of
    /// its 95 % interval.
    pub(super) fn inflate(&self, offset: Gaussian, time_s: f64) -> Gaussian {
        let late = self.late.iter().filter(|(at_s, _)| *at_s <= time_s);
        let constant = self.constant_rad.hypot(self.creep_95_rad / Z95);
        let std = offset.std.hypot(constant);
        Gaussian::new(
            offset.mean,
            std + late.map(|(_, size)| size).sum::<f64>() / Z95,
        )
    }
}

/// Widens the offsets of all segments and blocks in the same way as those of the joints.
pub(super) fn inflate_all(
    inflations: &[Inflation],
    segments: &mut [SegmentEstimate],
    blocks: &mut [BlockEstimate],
) {
    let all = |offsets: &mut [Gaussian], time_s: f64| {
        for (offset, inflation) in offsets.iter_mut().zip(inflations) {
            *offset = inflation.inflate(*offset, time_s);
        }
    };
    for segment in segments {
        all(&mut segment.offset_rad, segment.to_s);
    }
    for block in blocks {
        all(&mut block.offset_rad, block.time_s);
    }
}

/// Half-width of the 95 % interval of a joint's offset for the unknown load history of a viscoelastic rope, rad.
///
/// A rope with a relaxation time of half a minute is assumed to be in equilibrium when a recording begins. One that
/// was unloaded before shows `1 − (T/t)(1 − e^{−t/T})` of its viscoelastic share after a time `t`, 0.57 after a minute.
/// The relative error of the share is therefore at most 0.43, and the error of the offset is that share of the mean
/// deflection.
fn creep_95_rad(prior: &Prior, recorded: &Recorded, segments: &Segments, joint: usize) -> f64 {
    const MAX_RELATIVE_ERROR: f64 = 0.43;
    /// Minimum viscoelastic share of the deflection; below it the rope is elastic.
    const MIN_SHARE: f64 = 0.01;
    /// Minimum z-score of the viscoelastic share; below it the rope is elastic.
    const MIN_Z_SCORE: f64 = 3.0;
    let at = |p: JointParameter| segments.state_estimate.entry(prior.place(joint, p));
    let share = at(JointParameter::Viscoelastic);
    if !(share.mean.abs() > MIN_SHARE && share.mean.abs() > MIN_Z_SCORE * share.std) {
        return 0.0;
    }
    let offset = at(JointParameter::Offset).mean;
    let squares = recorded.blocks.iter().map(|b| {
        let slow = b.y_slow[joint] - offset;
        slow * slow
    });
    let mean = squares.sum::<f64>() / recorded.blocks.len().max(1) as f64;
    MAX_RELATIVE_ERROR * share.mean.abs() * mean.sqrt()
}
