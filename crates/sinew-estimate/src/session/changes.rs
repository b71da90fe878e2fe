//! Changes of a tendon: what they are, and what caused them.

use super::context::Context;
use super::late_step::{is_encoder, is_late};
use super::recorder::Recorded;
use super::result::{StiffnessSinceBefore, TendonChange, TendonChangeKind, TendonCreep};
use super::segments::Segments;
use crate::jumps::quickness;
use sinew_model::Gaussian;
use sinew_model::offset::{ChangeKind, JointParameter, MapEstimate, Prior};
use sinew_model::robot::Robot;

/// A change of stiffness since before the recording is an event from so many standard deviations on.
const SURE: f64 = 4.0;
/// Just before a change, s.
const BEFORE_S: f64 = 1e-3;

/// The changes of a joint's tendon, segment by segment.
pub(super) fn changes(context: &Context<'_>, joint: usize) -> Vec<TendonChange> {
    let Context {
        robot,
        recorded,
        segments,
        ..
    } = *context;
    let prior = context.estimator.prior();
    let mut out = Vec::new();
    for (from, map) in &segments.estimates {
        for (k, point) in map.changes.iter().enumerate() {
            match point.kind {
                ChangeKind::Offset(i) if i == joint => {
                    let mut change = slip(prior, map, k, joint);
                    find_cause(&mut change, robot, recorded, joint);
                    if is_encoder(&change) {
                        // Nothing else looks like that.
                        change.probability = map.posterior(point).map(|p| p.probability_not_noise);
                    }
                    let before = map.offset_at(prior, joint, point.at_s - BEFORE_S);
                    if is_retensioned(&change, before) {
                        change.kind = TendonChangeKind::Retensioned;
                    }
                    out.push(change);
                }
                ChangeKind::Compliance(i) if i == joint && with_slip(map, k).is_none() => {
                    let first_s = recorded.blocks.get(*from).map_or(0.0, |b| b.time_s);
                    out.extend(stiffness_alone(prior, map, k, joint, first_s));
                }
                _ => {}
            }
        }
    }
    // A contact that had not ended is none.
    for change in out.iter_mut().filter(|c| is_late(c, recorded)) {
        let lasts = context.lasts(joint, change);
        change.probability = change.probability.map(|p| lasts * p);
    }
    out
}

/// The change of the same joint's other parameter (offset or compliance) at the time of change `k`.
fn with_slip(map: &MapEstimate, k: usize) -> Option<usize> {
    let one = map.changes[k];
    map.changes.iter().position(|c| {
        c.at_s == one.at_s
            && match (one.kind, c.kind) {
                (ChangeKind::Offset(a), ChangeKind::Compliance(b))
                | (ChangeKind::Compliance(a), ChangeKind::Offset(b)) => a == b,
                _ => false,
            }
    })
}

/// A change of the offset and what happened to the stiffness with it.
fn slip(prior: &Prior, map: &MapEstimate, k: usize, joint: usize) -> TendonChange {
    let size = map.change(prior, k);
    let point = map.changes[k];
    let softer = with_slip(map, k).map(|k| map.change(prior, k));
    let posterior = map.posterior(&point);
    TendonChange {
        kind: kind(size, softer),
        time_s: posterior.map_or(point.at_s, |p| p.time_s),
        interval_s: posterior.map(|p| p.interval_s),
        probability: posterior.map(|p| p.probability),
        size_rad: Some(size),
        stiffness_change_ratio: softer.map(|softer| change_ratio(prior, map, joint, softer)),
        cause: None,
    }
}

/// What a change of an offset is, by its size and the compliance it brought.
fn kind(slip: Gaussian, softer: Option<Gaussian>) -> TendonChangeKind {
    match softer {
        Some(softer) if softer.mean > 0.0 && softer.is_nonzero_95() => {
            TendonChangeKind::StrandFailure
        }
        Some(_) if !slip.is_nonzero_95() => TendonChangeKind::SlipOrStrandFailure,
        _ => TendonChangeKind::Slip,
    }
}

/// A change of stiffness alone; `None` for one since before `first_s` that isn't sure.
fn stiffness_alone(
    prior: &Prior,
    map: &MapEstimate,
    k: usize,
    joint: usize,
    first_s: f64,
) -> Option<TendonChange> {
    let softening = map.change(prior, k);
    let point = &map.changes[k];
    let before = point.at_s <= first_s;
    if before && softening.mean.abs() < SURE * softening.deviation {
        return None;
    }
    let posterior = map.posterior(point);
    Some(TendonChange {
        kind: match (softening.mean > 0.0, before) {
            (true, true) => TendonChangeKind::SofterSinceBefore,
            (false, true) => TendonChangeKind::StifferSinceBefore,
            (true, false) => TendonChangeKind::StrandFailure,
            (false, false) => TendonChangeKind::Stiffer,
        },
        time_s: posterior.map_or(point.at_s.max(0.0), |p| p.time_s),
        interval_s: posterior.map(|p| p.interval_s),
        probability: posterior.map(|p| p.probability),
        size_rad: None,
        stiffness_change_ratio: Some(change_ratio(prior, map, joint, softening)),
        cause: None,
    })
}

/// Which of rope and encoders slipped.
fn find_cause(change: &mut TendonChange, robot: &Robot, recorded: &Recorded, joint: usize) {
    let nearest = recorded
        .blocks
        .partition_point(|b| b.time_s < change.time_s)
        .min(recorded.blocks.len().saturating_sub(1));
    let (Some(block), Some(t), TendonChangeKind::Slip, Some(size)) = (
        recorded.blocks.get(nearest),
        &robot.transmissions[joint],
        change.kind,
        change.size_rad,
    ) else {
        return;
    };
    let (stiffness, inertia) = (t.stiffness_nm_per_rad, t.motor_inertia_kg_m2);
    let quickness = quickness(&robot.arm, &block.q, joint, stiffness, inertia);
    let cause = recorded.jumps.cause(joint, change.time_s, size, quickness);
    change.cause = Some(cause);
}

/// Whether somebody tensioned the rope: a slip took away at least half of the offset there was `before`,
/// and was no encoder's. Ropes don't shorten.
fn is_retensioned(change: &TendonChange, before: Gaussian) -> bool {
    const MUCH: f64 = 0.5;
    change.size_rad.is_some_and(|size| {
        let gone = -size.mean;
        change.kind == TendonChangeKind::Slip
            && !is_encoder(change)
            && before.mean > before.half_width_95()
            && gone > size.half_width_95()
            && gone > MUCH * before.mean
    })
}

/// Stiffness gained, relative, where the compliance over nominal rose by `softening` to `after`:
/// `K/K_before − 1 = −softening/(1 + after)`.
pub(super) fn gained_ratio(after: f64, softening: Gaussian) -> Gaussian {
    let (softer, deviation) = (softening.mean, softening.deviation);
    let (before, after) = (1.0 + after - softer, 1.0 + after);
    Gaussian::new(-softer / after, deviation * before / (after * after))
}

/// The same for a change within a recording.
fn change_ratio(prior: &Prior, map: &MapEstimate, joint: usize, softening: Gaussian) -> Gaussian {
    let place = prior.place(joint, JointParameter::Compliance);
    gained_ratio(map.belief(prior).entry(place).mean, softening)
}

/// Whether a joint's stiffness has changed since before the recording: sought by its first segment.
pub(super) fn stiffness_since_before(
    prior: &Prior,
    segments: &Segments,
    joint: usize,
) -> Option<StiffnessSinceBefore> {
    let (_, map) = segments.estimates.first()?;
    let since = (*map.stiffness_changes.get(joint)?)?;
    let place = prior.place(joint, JointParameter::Compliance);
    let mean = map.belief(prior).entry(place).mean;
    // The mean is over both; after a change the compliance is this.
    let after = mean + (1.0 - since.probability) * since.softening.mean;
    Some(StiffnessSinceBefore {
        probability: since.probability,
        change_ratio: gained_ratio(after, since.softening),
    })
}

/// How a joint's offset moved evenly, segment by segment.
pub(super) fn creep(recorded: &Recorded, segments: &Segments, joint: usize) -> Option<TendonCreep> {
    let (mut moved_rad, mut variance, mut probability) = (0.0, 0.0, 0.0);
    for (from, map) in &segments.estimates {
        let (Some(creep), Some(first)) = (
            map.creep.get(joint).copied().flatten(),
            recorded.blocks.get(*from),
        ) else {
            continue;
        };
        let long_s = map.end_s - first.time_s;
        moved_rad += long_s * creep.rate_rad_per_s.mean;
        variance += (long_s * creep.rate_rad_per_s.deviation).powi(2);
        probability = creep.probability.max(probability);
    }
    let moved_rad = Gaussian::new(moved_rad, variance.sqrt());
    let over_s = recorded.duration_s;
    (probability > 0.0 && over_s > 0.0).then(|| TendonCreep {
        probability,
        moved_rad,
        rate_rad_per_s: Gaussian::new(moved_rad.mean / over_s, moved_rad.deviation / over_s),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_called_what_is_sure_of_it() {
        let g = Gaussian::new;
        let cases = [
            (g(5.0, 0.3), None, TendonChangeKind::Slip),
            (g(5.0, 0.3), Some(g(0.02, 0.02)), TendonChangeKind::Slip),
            (g(5.0, 0.3), Some(g(-0.06, 0.02)), TendonChangeKind::Slip),
            (
                g(2.0, 1.5),
                Some(g(0.06, 0.02)),
                TendonChangeKind::StrandFailure,
            ),
            (
                g(2.0, 1.5),
                Some(g(0.02, 0.02)),
                TendonChangeKind::SlipOrStrandFailure,
            ),
        ];
        for (slip, softer, expected) in cases {
            assert_eq!(kind(slip, softer), expected);
        }
    }

    #[test]
    fn a_loss_is_of_the_stiffness_there_was() {
        // 20 % softer than nominal, then 8 % of that lost.
        let (before, after) = (1.25, 1.25 / 0.92);
        let change = |softer: f64| gained_ratio(before + softer - 1.0, Gaussian::new(softer, 0.01));
        let lost = change(after - before);
        assert!((lost.mean + 0.08).abs() < 1e-14, "{lost:?}");
        let slope = (lost.mean - change(after - before + 1e-6).mean) / 1e-6;
        assert!((lost.deviation - 0.01 * slope).abs() < 1e-6, "{lost:?}");
    }
}
