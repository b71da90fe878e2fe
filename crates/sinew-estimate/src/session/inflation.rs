//! What the posterior does not know about itself, and by how much an interval is wider for it.

use super::context::Context;
use super::recorder::Recorded;
use super::result::{BlockEstimate, SegmentEstimate, TendonChange};
use super::segments::Segments;
use super::stand::Stand;
use sinew_model::offset::{JointParameter, Prior};
use sinew_model::{Gaussian, Z95};

/// What widens the interval of one joint.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Inflation {
    /// Changes that may end, or may have come: when, s, and how large, rad.
    late: Vec<(f64, f64)>,
    /// Half a 95 % interval for what a viscoelastic rope followed before the recordings, rad.
    pub(super) creep_95_rad: f64,
    /// What is unknown and looks the same in every block, rad: temperature, and what fits nothing.
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

    /// What a stand at the end reads off, and friction can't hold, may have come to stay: the interval holds both.
    pub(super) fn with_stand(mut self, stand: Option<Stand>) -> Self {
        let off = stand.filter(Stand::is_more_than_friction);
        self.late
            .extend(off.map(|stand| (stand.from_s, stand.largest_rad())));
        self
    }

    /// An offset at a time, as unsure as it is: what adds to half a 95 % interval is in the deviation.
    pub(super) fn inflate(&self, offset: Gaussian, time_s: f64) -> Gaussian {
        let come = self.late.iter().filter(|(at_s, _)| *at_s <= time_s);
        let constant = self.constant_rad.hypot(self.creep_95_rad / Z95);
        let deviation = offset.deviation.hypot(constant);
        Gaussian::new(
            offset.mean,
            deviation + come.map(|(_, size)| size).sum::<f64>() / Z95,
        )
    }
}

/// Inflates what is said over time as the joints' own intervals are.
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

/// A rope that follows its load with a memory of half a minute is taken for settled when a
/// recording begins. One that hung slack before shows `1 − (T/t)(1 − e^{−t/T})` of its share in a
/// time `t`, 0.57 in a minute, so the share is off by at most 0.43 of itself, and the offset by
/// that much of the mean deflection.
fn creep_95_rad(prior: &Prior, recorded: &Recorded, segments: &Segments, joint: usize) -> f64 {
    const OFF: f64 = 0.43;
    /// Less than this, or less sure, is no viscoelastic rope.
    const LEAST_SHARE: f64 = 0.01;
    const SURE: f64 = 3.0;
    let at = |p: JointParameter| segments.belief.entry(prior.place(joint, p));
    let share = at(JointParameter::Viscoelastic);
    if !(share.mean.abs() > LEAST_SHARE && share.mean.abs() > SURE * share.deviation) {
        return 0.0;
    }
    let offset = at(JointParameter::Offset).mean;
    let squares = recorded.blocks.iter().map(|b| {
        let slow = b.y_slow[joint] - offset;
        slow * slow
    });
    let mean = squares.sum::<f64>() / recorded.blocks.len().max(1) as f64;
    OFF * share.mean.abs() * mean.sqrt()
}
