//! From the posterior to a session's result.

use super::changes;
use super::checks;
use super::context::Context;
use super::groups::Groups;
use super::inflation::{self, Inflation};
use super::poses::Poses;
use super::recorder::Recorded;
use super::rest_phase::RestPhase;
use super::result::{
    BlockEstimate, LimitState, MotorTorque, OUTLIER, PayloadChange, RejectedInterval,
    RetensionLimit, SegmentEstimate, SessionEstimate, TemperatureSource, TendonEstimate, Verdict,
};
use super::segments::Segments;
use super::torque_range::TorqueRange;
use super::warning::Warning;
use crate::estimator::mean_temperature;
use crate::nuisance::{NuisanceChange, owner};
use sinew_model::Gaussian;
use sinew_model::arm::JointKind;
use sinew_model::offset::excess_residual::excess_residual_rad;
use sinew_model::offset::{
    Block, ChangeKind, JointParameter, MapEstimate, MapEstimator, Prior, SharedError,
    UNKNOWN_OFFSET_RAD, lag_s,
};
use sinew_model::robot::Robot;
use sinew_model::tendons::TendonKind;
use sinew_model::transmission::Tendon;

/// Summarises the posterior of a recording as its result.
pub(super) fn summarise(
    context: &Context<'_>,
    recording: &str,
    baseline: Option<String>,
) -> SessionEstimate {
    let Context {
        estimator,
        robot,
        recorded,
        segments,
        ..
    } = *context;
    let prior = estimator.prior();
    let maps = || segments.estimates.iter().map(|(_, map)| map);
    let weights: Vec<f64> = maps().flat_map(|map| map.weights.iter().copied()).collect();
    let elastic: Vec<usize> = (0..robot.axes()).filter(|&i| prior.is_elastic(i)).collect();
    let rest_phases: Vec<Option<RestPhase>> = elastic
        .iter()
        .map(|&i| match context.loss(i) {
            None => RestPhase::at_end(context, i),
            Some(_) => None,
        })
        .collect();
    let groups = Groups::of(context);
    let (joints, inflations): (Vec<TendonEstimate>, Vec<Inflation>) =
        (elastic.iter().zip(&rest_phases))
            .map(|(&i, phase)| tendon(context, i, *phase, &groups))
            .unzip();
    let mut at_ends = segment_estimates(prior, recorded, segments, &elastic);
    let mut blocks = block_estimates(estimator, recorded, segments, &elastic);
    inflation::inflate_all(&inflations, &mut at_ends, &mut blocks);
    let rejected = weights.iter().filter(|w| **w < OUTLIER).count() as f64;
    let temperature = mean_temperature(&recorded.blocks);
    let reference = segments.before.temperature_c;
    let mut estimate = SessionEstimate {
        robot: robot.name.clone(),
        recording: recording.into(),
        baseline,
        baseline_time_utc_s: None,
        zero_std_rad: context.zero_std_rad,
        start_time_utc_s: utc_s(recorded.start_time_ns),
        duration_s: recorded.duration_s,
        temperature_c: temperature.is_finite().then_some(temperature),
        temperature_source: TemperatureSource::default(),
        reference_temperature_c: reference.is_finite().then_some(reference),
        joints,
        joint_offsets: groups.joint_offsets,
        unobservable: groups.unobservable,
        segments: at_ends,
        blocks,
        payload_kg: segments.state_estimate.entry(prior.payload_place()),
        payload_changes: maps().flat_map(|map| payload_changes(prior, map)).collect(),
        external_force: maps()
            .filter_map(|map| map.force)
            .max_by(|a, b| a.probability.total_cmp(&b.probability)),
        motor_torque: motor_torque(estimator, recorded),
        tension_used: (recorded.blocks.iter().flat_map(|b| &b.tension_nm)).any(|t| t.is_finite()),
        rejected_share: rejected / weights.len().max(1) as f64,
        rejected_intervals: rejected_intervals(&recorded.blocks, &weights),
        online: None,
        poses: Poses::of(&recorded.blocks).count(),
        nuisance: nuisance(prior, robot, segments),
        damaged: recorded.damaged,
        warnings: Vec::new(),
    };
    let mut far = far_from_prior(prior, robot, segments);
    // The parameters of a slack strand are not determined and need no warning.
    let slack = groups
        .slack
        .iter()
        .map(|strand| robot.tendon_name(strand.axis));
    let slack: Vec<&str> = slack.collect();
    far.retain(|warning| match warning {
        Warning::FarFromPrior { joint, .. } => {
            joint.as_deref().is_none_or(|name| !slack.contains(&name))
        }
        _ => true,
    });
    estimate.warnings = checks::warnings(context, &estimate, &inflations, far, &rest_phases);
    let delay = lag_s(
        prior,
        &segments.before,
        &segments.state_estimate,
        context.lag_s,
    );
    estimate.warnings.extend(delay.and_then(encoder_delay));
    estimate
}

/// Time of a recording's clock in s since 1970 UTC; `None` if the clock has no date.
pub(super) fn utc_s(time_ns: i64) -> Option<f64> {
    /// Start of the year 2000, ns: a clock before it has no date.
    const YEAR_2000_NS: i64 = 946_684_800_000_000_000;
    (time_ns > YEAR_2000_NS).then_some(time_ns as f64 * 1e-9)
}

/// Systematic error of an offset: the part from the baseline, and `constant_rad`, which is constant over all blocks and
/// thus over all sessions. No part exceeds the whole error.
fn systematic_error(
    baseline: Option<&SharedError>,
    constant_rad: f64,
    offset: Gaussian,
) -> SharedError {
    let baseline = baseline.copied().unwrap_or(SharedError {
        baseline_rad: offset.std,
        drift_rad: 0.0,
    });
    let shared = SharedError {
        baseline_rad: baseline.baseline_rad.hypot(constant_rad),
        ..baseline
    };
    shared.at_most(offset.std)
}

fn tendon(
    context: &Context<'_>,
    joint: usize,
    phase: Option<RestPhase>,
    groups: &Groups,
) -> (TendonEstimate, Inflation) {
    let Context {
        robot,
        recorded,
        segments,
        ..
    } = *context;
    let prior = context.estimator.prior();
    let at = |p: JointParameter| segments.state_estimate.entry(prior.place(joint, p));
    let offset = at(JointParameter::Offset);
    let mut changes = match groups.unattributed.contains(&joint) {
        // One of several tendons changed, and the recording does not determine which one.
        true => Vec::new(),
        false => changes::changes(context, joint),
    };
    let loss = context.loss(joint);
    let noise_rad = noise_rad(context, joint);
    let excess_residual_rad = excess_residual_rad(noise_rad);
    let added_rad = context.added_rad.get(joint).copied().unwrap_or_default();
    let constant_rad = excess_residual_rad.hypot(added_rad);
    let inflation = Inflation::new(context, joint, &changes, constant_rad).with_rest_phase(phase);
    let mut offset_rad = inflation.inflate(offset, recorded.end_s());
    // A strand that is slack has a bound, not a normal distribution.
    let slack = groups.slack.iter().find(|strand| strand.axis == joint);
    // Neither has a tendon that transmits no torque.
    if slack.is_some() || loss.is_some() {
        offset_rad.std = offset_rad.std.hypot(UNKNOWN_OFFSET_RAD);
    }
    let lower_bound_rad = slack.and_then(|strand| strand.lower_bound_rad);
    let transmission = robot.transmissions[joint].as_ref();
    let tendon = transmission.and_then(|t| t.tendon.as_ref());
    let stiffness = transmission.map_or(0.0, |t| t.stiffness_nm_per_rad);
    let compliance = at(JointParameter::Compliance);
    let zero = at(JointParameter::Zero).mean;
    let pull = transmission.and_then(|t| t.routing.as_ref()?.pull.as_ref());
    let pretension_nm = pull.map_or(0.0, |pull| pull.pretension_nm);
    let least_nm = match pull.map(|pull| pull.kind) {
        Some(TendonKind::Strand) => 0.0,
        _ => f64::NEG_INFINITY,
    };
    // Torque of the spring from its deflection, corrected for the estimated offset.
    let torques = recorded.blocks.iter().map(|b| {
        let torque = stiffness / (1.0 + compliance.mean) * (b.y[joint] - offset.mean - zero);
        (pretension_nm + torque).max(least_nm)
    });
    let through = |f: &dyn Fn(&Tendon, f64) -> f64| {
        let of = |t| Gaussian::new(f(t, offset_rad.mean), f(t, offset_rad.std));
        tendon.map(of)
    };
    changes.extend(loss.map(|loss| loss.change()));
    let is_undetermined = groups.held_out.contains(&joint) || slack.is_some() || loss.is_some();
    let verdict = match is_undetermined {
        _ if loss.is_some() => Verdict::TransmissionLost,
        true => Verdict::Inconclusive,
        false => Verdict::of(offset_rad, context.is_elongation),
    };
    let held_out =
        is_undetermined || (verdict == Verdict::Inconclusive && excess_residual_rad > 0.0);
    let estimate = TendonEstimate {
        name: robot.tendon_name(joint).to_owned(),
        slides: robot.arm.joint_kind(joint) == Some(JointKind::Prismatic),
        offset_rad,
        systematic_error: Some(systematic_error(
            context.shared.get(joint),
            constant_rad,
            offset_rad,
        )),
        elongation_m: through(&Tendon::elongation_m),
        strain_ratio: through(&Tendon::strain),
        verdict,
        retension: tendon.and_then(|t| retension(t, offset_rad, held_out)),
        changes,
        // Relative to robot.toml: the whole difference of the compliance from nominal is the change.
        stiffness_change_ratio: changes::stiffness_change_ratio(compliance.mean, compliance),
        stiffness_change: match slack {
            None => changes::stiffness_change(segments, joint),
            Some(_) => None,
        },
        creep: changes::creep(recorded, segments, joint),
        slack_rad: prior
            .is_antagonistic(joint)
            .then(|| at(JointParameter::Slack)),
        torque_nm: range(torques),
        noise_rad,
        excess_residual_rad,
        lower_bound_m: tendon
            .zip(lower_bound_rad)
            .map(|(t, least)| t.elongation_m(least)),
        lower_bound_rad,
        slack_share: slack.map(|strand| strand.share),
        anchored: None,
    };
    (estimate, inflation)
}

/// Residual of a tendon, robust standard deviation, rad; in a group with one equation per joint, the maximum over its
/// joints.
fn noise_rad(context: &Context<'_>, axis: usize) -> f64 {
    let most = |axis: usize| {
        let maps = context.segments.estimates.iter();
        maps.map(|(_, map)| map.noise_rad[axis]).fold(0.0, f64::max)
    };
    let routing = context.robot.transmissions[axis]
        .as_ref()
        .and_then(|t| t.routing.as_ref());
    match routing.and_then(|routing| routing.pull.as_ref()) {
        None => most(axis),
        Some(pull) => pull
            .joints
            .iter()
            .map(|j| most(j.joint))
            .fold(0.0, f64::max),
    }
}

/// Range of a sequence of torques, N·m.
fn range(torques: impl Iterator<Item = f64>) -> TorqueRange {
    let (min, max) = torques.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| {
        (a.min(t), b.max(t))
    });
    TorqueRange { min, max }
}

/// Tests whether the 95 % interval of the elongation exceeds the re-tensioning limit; `None` without a limit.
///
/// The error due to an excess residual may exceed its size: if `held_out`, the test is inconclusive like the verdict.
fn retension(tendon: &Tendon, offset_rad: Gaussian, held_out: bool) -> Option<RetensionLimit> {
    let limit = tendon.retension_at_m?;
    let interval = offset_rad.interval_95();
    let [least, most] = [interval.low, interval.high].map(|x| tendon.elongation_m(x));
    Some(RetensionLimit {
        elongation_m: limit,
        state: if held_out {
            LimitState::Inconclusive
        } else if least > limit {
            LimitState::Passed
        } else if most < limit {
            LimitState::NotPassed
        } else {
            LimitState::Inconclusive
        },
    })
}

/// Offsets at the end of each segment.
fn segment_estimates(
    prior: &Prior,
    recorded: &Recorded,
    segments: &Segments,
    elastic: &[usize],
) -> Vec<SegmentEstimate> {
    let estimates = segments.estimates.iter();
    estimates
        .map(|(from, map)| SegmentEstimate {
            from_s: recorded.blocks[*from].time_s,
            to_s: recorded.blocks[from + map.weights.len() - 1].time_s,
            offset_rad: elastic.iter().map(|&i| map.offset(prior, i)).collect(),
        })
        .collect()
}

/// Estimates of all blocks at their times.
fn block_estimates(
    estimator: &MapEstimator,
    recorded: &Recorded,
    segments: &Segments,
    elastic: &[usize],
) -> Vec<BlockEstimate> {
    let prior = estimator.prior();
    let mut out = Vec::with_capacity(recorded.blocks.len());
    let n = prior.joints().max(1);
    for (from, map) in &segments.estimates {
        let blocks = &recorded.blocks[*from..from + map.weights.len()];
        let residuals = estimator.residuals(map, blocks);
        let weighted = blocks.iter().zip(&map.weights);
        for ((block, weight), residuals) in weighted.zip(residuals.chunks_exact(n)) {
            let offset_rad: Vec<Gaussian> = elastic
                .iter()
                .map(|&i| map.offset_at(prior, i, block.time_s))
                .collect();
            let pairs = elastic.iter().zip(&offset_rad);
            out.push(BlockEstimate {
                time_s: block.time_s,
                weight: *weight,
                block_rad: pairs.map(|(&i, o)| o.mean + residuals[i]).collect(),
                offset_rad,
            });
        }
    }
    out
}

fn payload_changes(prior: &Prior, map: &MapEstimate) -> Vec<PayloadChange> {
    let changes = map.changes.iter().enumerate();
    changes
        .filter(|(_, point)| point.kind == ChangeKind::Payload)
        .map(|(k, point)| {
            let posterior = map.posterior(point);
            PayloadChange {
                time_s: posterior.map_or(point.at_s, |p| p.time_s),
                interval_s: posterior.map(|p| p.interval_s),
                probability: posterior.map(|p| p.probability),
                change_kg: map.change(prior, k),
            }
        })
        .collect()
}

fn motor_torque(estimator: &MapEstimator, recorded: &Recorded) -> MotorTorque {
    let mut torques = recorded.blocks.iter().flat_map(|b| &b.motor_torque);
    if !(estimator.uses_motor_torque() && torques.any(|t| t.is_finite())) {
        MotorTorque::Unused
    } else if recorded.motor_current {
        MotorTorque::FromCurrent
    } else {
        MotorTorque::Measured
    }
}

/// Prior and posterior of each nuisance parameter.
fn nuisance(prior: &Prior, robot: &Robot, segments: &Segments) -> Vec<NuisanceChange> {
    entries(prior, segments)
        .filter_map(|(k, before)| {
            let after = segments.state_estimate.entry(k);
            let entry = prior.describe(k)?;
            Some(NuisanceChange::new(&entry, robot, [before, after]))
        })
        .collect()
}

/// Warnings for parameters whose posterior mean is far from the prior.
fn far_from_prior(prior: &Prior, robot: &Robot, segments: &Segments) -> Vec<Warning> {
    /// Maximum z-score of a posterior mean against its prior without a warning.
    const MAX_Z_SCORE: f64 = 3.5;
    entries(prior, segments)
        .filter_map(|(k, before)| {
            let entry = prior.describe(k)?;
            // A slip of an encoder explains the change of its zero.
            let slipped = entry.joint.is_some_and(|i| {
                k == prior.place(i, JointParameter::Zero) && segments.has_encoder_slip(i)
            });
            if slipped {
                return None;
            }
            let z_score = (segments.state_estimate.entry(k).mean - before.mean).abs() / before.std;
            let is_scale = |i: usize| k == prior.place(i, JointParameter::MotorScale);
            (z_score > MAX_Z_SCORE).then(|| Warning::FarFromPrior {
                joint: entry.joint.map(|i| owner(&entry, robot, i).to_owned()),
                name: entry.name.into(),
                is_motor_torque_scale: entry.joint.is_some_and(is_scale),
                stds: z_score,
            })
        })
        .collect()
}

/// Warning for an encoder delay that friction does not explain.
fn encoder_delay(motor_delay_s: Gaussian) -> Option<Warning> {
    /// Minimum delay to be reported, s: a control cycle.
    const MIN_DELAY_S: f64 = 1e-3;
    /// Minimum z-score of the delay to be reported.
    const MIN_Z_SCORE: f64 = 3.0;
    let size = motor_delay_s.mean.abs();
    (size > MIN_DELAY_S && size > MIN_Z_SCORE * motor_delay_s.std)
        .then_some(Warning::EncoderDelay { motor_delay_s })
}

/// Indices of the nuisance parameters in the state, with their priors.
fn entries<'a>(
    prior: &'a Prior,
    segments: &'a Segments,
) -> impl Iterator<Item = (usize, Gaussian)> + 'a {
    /// Maximum standard deviation of a fixed parameter, which is not estimated.
    const MAX_FIXED_STD: f64 = 1e-8;
    let is_offset = |k: usize| {
        let joint = prior.describe(k).and_then(|entry| entry.joint);
        joint.is_some_and(|i| prior.is_elastic(i) && k == prior.place(i, JointParameter::Offset))
    };
    (0..prior.dimension())
        .map(|k| (k, segments.before.entry(k)))
        .filter(move |(k, before)| !is_offset(*k) && !(before.std < MAX_FIXED_STD))
}

/// Rejected intervals of at least one second, in descending order of length, at most 20.
fn rejected_intervals(blocks: &[Block], weights: &[f64]) -> Vec<RejectedInterval> {
    let mut found: Vec<RejectedInterval> = Vec::new();
    for (block, _) in blocks.iter().zip(weights).filter(|(_, w)| **w < OUTLIER) {
        match found.last_mut() {
            Some(last) if block.time_s - last.to_s < 0.5 => last.to_s = block.time_s + 0.1,
            _ => found.push(RejectedInterval {
                from_s: block.time_s - 0.1,
                to_s: block.time_s + 0.1,
            }),
        }
    }
    found.retain(|s| s.to_s - s.from_s >= 1.0);
    found.sort_by(|a, b| (b.to_s - b.from_s).total_cmp(&(a.to_s - a.from_s)));
    found.truncate(20);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_model::Z95;

    /// Tendon on a pulley of 20 mm radius with a re-tensioning limit of 0.4 mm, which is 20 mrad.
    fn tendon() -> Tendon {
        Tendon {
            joint_pulley_radius_m: 0.02,
            length_m: 0.5,
            antagonistic: false,
            guides: Vec::new(),
            rope: None,
            pretension_n: None,
            retension_at_m: Some(0.4e-3),
            replace_at_strain: None,
            frame_expansion_per_k: None,
        }
    }

    #[test]
    fn retension_interval_above_limit_is_passed() {
        let state = |offset_mrad: f64, held_out: bool| {
            let offset = Gaussian::new(1e-3 * offset_mrad, 1e-3 / Z95);
            retension(&tendon(), offset, held_out).unwrap().state
        };
        for (offset_mrad, expected) in [
            (18.9, LimitState::NotPassed),
            (19.1, LimitState::Inconclusive),
            (20.0, LimitState::Inconclusive),
            (20.9, LimitState::Inconclusive),
            (21.1, LimitState::Passed),
        ] {
            assert_eq!(state(offset_mrad, false), expected, "{offset_mrad}");
            assert_eq!(state(offset_mrad, true), LimitState::Inconclusive);
        }
    }

    #[test]
    fn systematic_error_includes_constant_and_is_bounded() {
        let offset = Gaussian::new(0.0, 1e-3);
        let baseline = SharedError {
            baseline_rad: 0.3e-3,
            drift_rad: 0.2e-3,
        };
        let found = systematic_error(Some(&baseline), 0.4e-3, offset);
        assert!((found.baseline_rad - 0.5e-3).abs() < 1e-12 && found.drift_rad == 0.2e-3);
        assert_eq!(
            systematic_error(Some(&baseline), 2e-3, offset).baseline_rad,
            1e-3
        );
        assert_eq!(systematic_error(None, 0.0, offset).baseline_rad, 1e-3);
    }
}
