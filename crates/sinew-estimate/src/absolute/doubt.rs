//! What the posterior does not know about itself, and by how much an interval is wider for it.

use super::answer::{Course, Step, Stretch};
use super::blocks::Recorded;
use super::watch::Watched;
use sinew_model::offset::{JointParameter, Prior};

/// A contact longer than this looks like something that happened for good, s.
pub(super) const LASTING_S: f64 = 8.0;
/// Causes of a slip that no contact looks like.
const TOLD: [&str; 2] = ["motor encoder", "joint encoder"];

/// Whether a change may be a contact that had not ended yet: it came late, and no encoder slipped.
pub(super) fn may_end(step: &Step, recorded: &Recorded) -> bool {
    step.probability.is_some()
        && !is_encoder(step)
        && recorded.duration_s > 0.0
        && recorded.end_s() - step.time_s < LASTING_S
}

/// Whether an encoder's reading jumped: no contact looks like that, nor a rope.
pub(super) fn is_encoder(step: &Step) -> bool {
    TOLD.contains(&step.cause.as_str())
}

/// What may be a contact that had not ended is half as likely.
pub(super) fn lessen(steps: &mut [Step], recorded: &Recorded) {
    const LASTS: f64 = 0.5;
    for step in steps.iter_mut().filter(|s| may_end(s, recorded)) {
        step.probability = step.probability.map(|p| LASTS * p);
    }
}

/// What widens the interval of one joint.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Doubt {
    /// Changes that may end: when, s, and how large, mrad.
    late: Vec<(f64, f64)>,
    /// Half an interval for what a viscoelastic rope followed before the recordings, mrad.
    pub(super) creeping_mrad: f64,
}

impl Doubt {
    pub(super) fn of(
        prior: &Prior,
        recorded: &Recorded,
        watched: &Watched,
        joint: usize,
        steps: &[Step],
    ) -> Self {
        let late = steps.iter().filter(|s| may_end(s, recorded));
        Self {
            late: late.map(|s| (s.time_s, s.size_mrad.abs())).collect(),
            creeping_mrad: creeping_mrad(prior, recorded, watched, joint),
        }
    }

    /// Half an interval, mrad, at a time.
    pub(super) fn widen(&self, interval_95_mrad: f64, time_s: f64) -> f64 {
        let come = self.late.iter().filter(|(at_s, _)| *at_s <= time_s);
        interval_95_mrad.hypot(self.creeping_mrad) + come.map(|(_, size)| size).sum::<f64>()
    }
}

/// Widens what is said over time as the joints' own intervals are.
pub(super) fn widen(doubts: &[Doubt], series: &mut [Stretch], course: &mut [Course]) {
    let all = |intervals: &mut [f64], time_s: f64| {
        for (interval, doubt) in intervals.iter_mut().zip(doubts) {
            *interval = doubt.widen(*interval, time_s);
        }
    };
    for stretch in series {
        all(&mut stretch.interval_95_mrad, stretch.to_s);
    }
    for point in course {
        all(&mut point.interval_95_mrad, point.time_s);
    }
}

/// A rope that follows its load with a memory of half a minute is taken for settled when a
/// recording begins. One that hung slack before shows `1 − (T/t)(1 − e^{−t/T})` of its share in a
/// time `t`, 0.57 in a minute, so the share is off by at most 0.43 of itself, and the offset by
/// that much of the mean deflection.
fn creeping_mrad(prior: &Prior, recorded: &Recorded, watched: &Watched, joint: usize) -> f64 {
    const OFF: f64 = 0.43;
    /// Less than this, or less sure, is no viscoelastic rope.
    const LEAST_SHARE: f64 = 0.01;
    const SURE: f64 = 3.0;
    let viscoelastic = watched
        .belief
        .entry(prior.place(joint, JointParameter::Viscoelastic));
    let (share, deviation) = (viscoelastic.mean, viscoelastic.deviation);
    if !(share.abs() > LEAST_SHARE && share.abs() > SURE * deviation) {
        return 0.0;
    }
    let offset = watched
        .belief
        .entry(prior.place(joint, JointParameter::Offset))
        .mean;
    let squares = recorded.blocks.iter().map(|b| {
        let slow = b.y_slow[joint] - offset;
        slow * slow
    });
    let mean = squares.sum::<f64>() / recorded.blocks.len().max(1) as f64;
    1e3 * OFF * share.abs() * mean.sqrt()
}
