//! Sudden changes of a tendon: classification and cause.

use super::context::Context;
use super::encoder_slips::cause;
use super::late_step::{is_encoder, is_late};
use super::recorder::Recorded;
use super::result::{StiffnessSinceBefore, TendonChange, TendonChangeKind, TendonCreep};
use super::segments::Segments;
use sinew_model::Gaussian;
use sinew_model::offset::{ChangeKind, JointParameter, MapEstimate, Prior};

/// Minimum probability of a stiffness change before the recording to be reported as an event.
const MIN_PROBABILITY: f64 = 0.95;
/// Time before a change at which the previous offset is evaluated, s.
const BEFORE_S: f64 = 1e-3;

/// Changes of the tendon of a joint in all segments, in the order of time.
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
                    let size = map.change(prior, k);
                    let cause = cause(robot, recorded, joint, (change.time_s, size));
                    if map.encoder_slips.contains(point) {
                        // No contact makes an encoder reading step, and no strand does.
                        change.kind = TendonChangeKind::Slip;
                        change.stiffness_change_ratio = None;
                        change.probability = map.posterior(point).map(|p| p.probability_not_noise);
                    }
                    if change.kind == TendonChangeKind::Slip {
                        change.cause = cause;
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
    // A contact that has not ended is not a change of the tendon.
    for change in out.iter_mut().filter(|c| is_late(c, recorded)) {
        let lasts = context.lasts(joint, change);
        change.probability = change.probability.map(|p| lasts * p);
    }
    out
}

/// Index of the simultaneous change of the other parameter (offset or compliance) of the same joint as change `k`.
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

/// Change `k` of the offset, with the simultaneous change of the stiffness.
fn slip(prior: &Prior, map: &MapEstimate, k: usize, joint: usize) -> TendonChange {
    let size = map.change(prior, k);
    let point = map.changes[k];
    let compliance = with_slip(map, k).map(|k| map.change(prior, k));
    let posterior = map.posterior(&point);
    TendonChange {
        kind: kind(size, compliance),
        time_s: posterior.map_or(point.at_s, |p| p.time_s),
        interval_s: posterior.map(|p| p.interval_s),
        probability: posterior.map(|p| p.probability),
        size_rad: Some(size),
        stiffness_change_ratio: compliance
            .map(|increase| change_ratio(prior, map, joint, increase)),
        cause: None,
    }
}

/// Classifies a change of an offset by its size and the simultaneous increase of the compliance. A tendon that loses a
/// strand does not become shorter.
fn kind(slip: Gaussian, compliance: Option<Gaussian>) -> TendonChangeKind {
    let is_shorter = slip.mean < 0.0 && slip.is_nonzero_95();
    match compliance {
        Some(_) if is_shorter => TendonChangeKind::Slip,
        Some(increase) if increase.mean > 0.0 && increase.is_nonzero_95() => {
            TendonChangeKind::StrandFailure
        }
        Some(_) if !slip.is_nonzero_95() => TendonChangeKind::SlipOrStrandFailure,
        _ => TendonChangeKind::Slip,
    }
}

/// Change `k` of the stiffness alone; `None` for an improbable one before `first_s`, the start of the recording in s.
fn stiffness_alone(
    prior: &Prior,
    map: &MapEstimate,
    k: usize,
    joint: usize,
    first_s: f64,
) -> Option<TendonChange> {
    let increase = map.change(prior, k);
    let point = &map.changes[k];
    let before = point.at_s <= first_s;
    let since = map.stiffness_changes.get(joint).copied().flatten();
    let since = since.filter(|_| before);
    if before && since.is_none_or(|since| since.probability < MIN_PROBABILITY) {
        return None;
    }
    let posterior = map.posterior(point);
    Some(TendonChange {
        kind: match (increase.mean > 0.0, before) {
            (true, true) => TendonChangeKind::StiffnessLoss,
            (false, true) => TendonChangeKind::StiffnessIncrease,
            (true, false) => TendonChangeKind::StrandFailure,
            (false, false) => TendonChangeKind::Stiffer,
        },
        time_s: posterior.map_or(point.at_s.max(0.0), |p| p.time_s),
        interval_s: posterior.map(|p| p.interval_s),
        probability: since
            .map(|since| since.probability)
            .or(posterior.map(|p| p.probability)),
        size_rad: None,
        stiffness_change_ratio: Some(change_ratio(prior, map, joint, increase)),
        cause: None,
    })
}

/// Whether a slip is a re-tensioning: it reduced the offset `before` it by at least half, and is not of an encoder.
///
/// Ropes do not shorten without re-tensioning.
fn is_retensioned(change: &TendonChange, before: Gaussian) -> bool {
    const MIN_REDUCTION_RATIO: f64 = 0.5;
    change.size_rad.is_some_and(|size| {
        let reduction = -size.mean;
        change.kind == TendonChangeKind::Slip
            && !is_encoder(change)
            && before.mean > before.half_width_95()
            && reduction > size.half_width_95()
            && reduction > MIN_REDUCTION_RATIO * before.mean
    })
}

/// Relative change of the stiffness if the relative compliance increased by `increase` to `after`:
/// `K/K_before − 1 = −increase/(1 + after)`.
pub(super) fn stiffness_change_ratio(after: f64, increase: Gaussian) -> Gaussian {
    let (mean, std) = (increase.mean, increase.std);
    let (before, after) = (1.0 + after - mean, 1.0 + after);
    Gaussian::new(-mean / after, std * before / (after * after))
}

/// Relative change of the stiffness within a recording if the relative compliance increased by `increase`.
fn change_ratio(prior: &Prior, map: &MapEstimate, joint: usize, increase: Gaussian) -> Gaussian {
    let index = prior.place(joint, JointParameter::Compliance);
    stiffness_change_ratio(map.state_estimate(prior).entry(index).mean, increase)
}

/// Probability and size of a stiffness change of a joint before the recording, from the first segment; `None` if not
/// evaluated.
pub(super) fn stiffness_change(segments: &Segments, joint: usize) -> Option<StiffnessSinceBefore> {
    let (_, map) = segments.estimates.first()?;
    let since = (*map.stiffness_changes.get(joint)?)?;
    Some(StiffnessSinceBefore {
        probability: since.probability,
        change_ratio: since.change_ratio,
    })
}

/// Drift of the offset of a joint at a constant rate per segment, summed over the recording.
pub(super) fn creep(recorded: &Recorded, segments: &Segments, joint: usize) -> Option<TendonCreep> {
    let (mut drift_rad, mut variance, mut probability) = (0.0, 0.0, 0.0);
    for (from, map) in &segments.estimates {
        let (Some(creep), Some(first)) = (
            map.creep.get(joint).copied().flatten(),
            recorded.blocks.get(*from),
        ) else {
            continue;
        };
        let long_s = map.end_s - first.time_s;
        drift_rad += long_s * creep.rate_rad_per_s.mean;
        variance += (long_s * creep.rate_rad_per_s.std).powi(2);
        probability = creep.probability.max(probability);
    }
    let drift_rad = Gaussian::new(drift_rad, variance.sqrt());
    let over_s = recorded.duration_s;
    (probability > 0.0 && over_s > 0.0).then(|| TendonCreep {
        probability,
        drift_rad,
        rate_rad_per_s: Gaussian::new(drift_rad.mean / over_s, drift_rad.std / over_s),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn change_kind_requires_significant_stiffness_loss() {
        let g = Gaussian::new;
        let cases = [
            (g(5.0, 0.3), None, TendonChangeKind::Slip),
            (g(5.0, 0.3), Some(g(0.02, 0.02)), TendonChangeKind::Slip),
            (g(5.0, 0.3), Some(g(-0.06, 0.02)), TendonChangeKind::Slip),
            (g(-5.0, 0.3), Some(g(0.06, 0.02)), TendonChangeKind::Slip),
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
        for (slip, compliance, expected) in cases {
            assert_eq!(kind(slip, compliance), expected);
        }
    }

    #[test]
    fn stiffness_change_ratio_refers_to_previous_stiffness() {
        // Stiffness of 80 % of nominal, then a loss of 8 % of it.
        let (before, after) = (1.25, 1.25 / 0.92);
        let change = |increase: f64| {
            stiffness_change_ratio(before + increase - 1.0, Gaussian::new(increase, 0.01))
        };
        let lost = change(after - before);
        assert!((lost.mean + 0.08).abs() < 1e-14, "{lost:?}");
        let slope = (lost.mean - change(after - before + 1e-6).mean) / 1e-6;
        assert!((lost.std - 0.01 * slope).abs() < 1e-6, "{lost:?}");
    }
}
