//! From the posterior to a session's result.

use super::changes;
use super::checks;
use super::context::Context;
use super::inflation::{self, Inflation};
use super::poses::Poses;
use super::recorder::Recorded;
use super::result::{
    BlockEstimate, LeftOut, LimitState, MotorTorque, OUTLIER, PayloadChange, RetensionLimit,
    SegmentEstimate, SessionEstimate, TemperatureSource, TendonEstimate, Verdict,
};
use super::segments::Segments;
use super::stand::Stand;
use super::torque_range::TorqueRange;
use super::warning::Warning;
use crate::estimator::mean_temperature;
use crate::nuisance::NuisanceChange;
use sinew_model::Gaussian;
use sinew_model::arm::JointKind;
use sinew_model::offset::misfit::misfit_rad;
use sinew_model::offset::{
    Block, ChangeKind, JointParameter, MapEstimate, MapEstimator, Prior, SharedError, lag_s,
};
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;

/// The result of a recording.
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
    let elastic: Vec<usize> = (0..robot.arm.dof())
        .filter(|&i| prior.is_elastic(i))
        .collect();
    let stands: Vec<Option<Stand>> = elastic.iter().map(|&i| Stand::at_end(context, i)).collect();
    let (joints, inflations): (Vec<TendonEstimate>, Vec<Inflation>) = (elastic.iter().zip(&stands))
        .map(|(&i, stand)| tendon(context, i, *stand))
        .unzip();
    let mut at_ends = segment_estimates(prior, recorded, segments, &elastic);
    let mut blocks = block_estimates(estimator, recorded, segments, &elastic);
    inflation::inflate_all(&inflations, &mut at_ends, &mut blocks);
    let out = weights.iter().filter(|w| **w < OUTLIER).count() as f64;
    let temperature = mean_temperature(&recorded.blocks);
    let reference = segments.before.temperature_c;
    let mut estimate = SessionEstimate {
        robot: robot.name.clone(),
        recording: recording.into(),
        baseline,
        baseline_time_utc_s: None,
        start_time_utc_s: utc_s(recorded.start_time_ns),
        duration_s: recorded.duration_s,
        temperature_c: temperature.is_finite().then_some(temperature),
        temperature_source: TemperatureSource::default(),
        reference_temperature_c: reference.is_finite().then_some(reference),
        joints,
        segments: at_ends,
        blocks,
        payload_kg: segments.belief.entry(prior.payload_place()),
        payload_changes: maps().flat_map(|map| payload_changes(prior, map)).collect(),
        external_force: maps()
            .filter_map(|map| map.force)
            .max_by(|a, b| a.probability.total_cmp(&b.probability)),
        motor_torque: motor_torque(estimator, recorded),
        left_out_share: out / weights.len().max(1) as f64,
        left_out: left_out(&recorded.blocks, &weights),
        live: None,
        poses: Poses::of(&recorded.blocks).count(),
        nuisance: nuisance(prior, robot, segments),
        damaged: recorded.damaged,
        warnings: Vec::new(),
    };
    let far = far_from_prior(prior, robot, segments);
    estimate.warnings = checks::warnings(context, &estimate, &inflations, far, &stands);
    let late = lag_s(prior, &segments.before, &segments.belief, context.lag_s);
    estimate.warnings.extend(late.and_then(out_of_step));
    estimate
}

/// Seconds since 1970 of a recording's clock, where that tells the date.
pub(super) fn utc_s(time_ns: i64) -> Option<f64> {
    /// Clocks before the year 2000 don't.
    const YEAR_2000_NS: i64 = 946_684_800_000_000_000;
    (time_ns > YEAR_2000_NS).then_some(time_ns as f64 * 1e-9)
}

/// What of an offset's error other sessions have too: the baseline's part, and `constant_rad`, which looks the same
/// in every block and so in every session. No part exceeds the whole.
fn shared_error(known: Option<&SharedError>, constant_rad: f64, offset: Gaussian) -> SharedError {
    let known = known.copied().unwrap_or(SharedError {
        baseline_rad: offset.deviation,
        drift_rad: 0.0,
    });
    let shared = SharedError {
        baseline_rad: known.baseline_rad.hypot(constant_rad),
        ..known
    };
    shared.at_most(offset.deviation)
}

fn tendon(
    context: &Context<'_>,
    joint: usize,
    stand: Option<Stand>,
) -> (TendonEstimate, Inflation) {
    let Context {
        robot,
        recorded,
        segments,
        ..
    } = *context;
    let prior = context.estimator.prior();
    let at = |p: JointParameter| segments.belief.entry(prior.place(joint, p));
    let offset = at(JointParameter::Offset);
    let changes = changes::changes(context, joint);
    let noise = segments.estimates.iter();
    let noise_rad = noise
        .map(|(_, map)| map.noise_rad[joint])
        .fold(0.0, f64::max);
    let misfit_rad = misfit_rad(noise_rad);
    let added_rad = context.added_rad.get(joint).copied().unwrap_or_default();
    let constant_rad = misfit_rad.hypot(added_rad);
    let inflation = Inflation::new(context, joint, &changes, constant_rad).with_stand(stand);
    let offset_rad = inflation.inflate(offset, recorded.end_s());
    let transmission = robot.transmissions[joint].as_ref();
    let tendon = transmission.and_then(|t| t.tendon.as_ref());
    let stiffness = transmission.map_or(0.0, |t| t.stiffness_nm_per_rad);
    let compliance = at(JointParameter::Compliance);
    let zero = at(JointParameter::Zero).mean;
    // The spring's deflection, up to the offset that is estimated.
    let torques = recorded
        .blocks
        .iter()
        .map(|b| stiffness / (1.0 + compliance.mean) * (b.y[joint] - offset.mean - zero));
    let through = |f: &dyn Fn(&Tendon, f64) -> f64| {
        let of = |t| Gaussian::new(f(t, offset_rad.mean), f(t, offset_rad.deviation));
        tendon.map(of)
    };
    let verdict = Verdict::of(offset_rad);
    let withheld = verdict == Verdict::CannotTell && misfit_rad > 0.0;
    let estimate = TendonEstimate {
        name: robot.tendon_name(joint).to_owned(),
        slides: robot.arm.joint_kind(joint) == Some(JointKind::Prismatic),
        offset_rad,
        shared_error: Some(shared_error(
            context.shared.get(joint),
            constant_rad,
            offset_rad,
        )),
        elongation_m: through(&Tendon::elongation_m),
        strain_ratio: through(&Tendon::strain),
        verdict,
        retension: tendon.and_then(|t| retension(t, offset_rad, withheld)),
        changes,
        // Against robot.toml: all of the compliance over nominal is the change.
        stiffness_change_ratio: changes::gained_ratio(compliance.mean, compliance),
        stiffness_since_before: changes::stiffness_since_before(prior, segments, joint),
        creep: changes::creep(recorded, segments, joint),
        slack_rad: prior
            .is_antagonistic(joint)
            .then(|| at(JointParameter::Slack)),
        torque_nm: range(torques),
        noise_rad,
        misfit_rad,
        anchored: None,
    };
    (estimate, inflation)
}

/// Smallest and largest of some torques.
fn range(torques: impl Iterator<Item = f64>) -> TorqueRange {
    let (min, max) = torques.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| {
        (a.min(t), b.max(t))
    });
    TorqueRange { min, max }
}

/// Whether the elongation at which to tension again is passed, as far as the interval tells.
///
/// What fits nothing may be off by more than its size: where the verdict is `withheld` for that, so is this.
fn retension(tendon: &Tendon, offset_rad: Gaussian, withheld: bool) -> Option<RetensionLimit> {
    let limit = tendon.retension_at_m?;
    let interval = offset_rad.interval_95();
    let [least, most] = [interval.low, interval.high].map(|x| tendon.elongation_m(x));
    Some(RetensionLimit {
        elongation_m: limit,
        state: if withheld {
            LimitState::CannotTell
        } else if least > limit {
            LimitState::Passed
        } else if most < limit {
            LimitState::NotPassed
        } else {
            LimitState::CannotTell
        },
    })
}

/// Offsets at the end of every segment.
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

/// Every block with the estimate at its time.
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
        let said = blocks.iter().zip(&map.weights);
        for ((block, weight), residuals) in said.zip(residuals.chunks_exact(n)) {
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

/// Everything estimated along, before and after.
fn nuisance(prior: &Prior, robot: &Robot, segments: &Segments) -> Vec<NuisanceChange> {
    entries(prior, segments)
        .filter_map(|(k, before)| {
            let after = segments.belief.entry(k);
            let entry = prior.describe(k)?;
            Some(NuisanceChange::new(&entry, robot, [before, after]))
        })
        .collect()
}

/// Parameters that are far from what was believed.
fn far_from_prior(prior: &Prior, robot: &Robot, segments: &Segments) -> Vec<Warning> {
    const FAR: f64 = 3.5;
    entries(prior, segments)
        .filter_map(|(k, before)| {
            let entry = prior.describe(k)?;
            let off = (segments.belief.entry(k).mean - before.mean).abs() / before.deviation;
            let is_scale = |i: usize| k == prior.place(i, JointParameter::MotorScale);
            (off > FAR).then(|| Warning::FarFromPrior {
                joint: entry.joint.map(|i| robot.tendon_name(i).to_owned()),
                name: entry.name.into(),
                is_motor_torque_scale: entry.joint.is_some_and(is_scale),
                deviations: off,
            })
        })
        .collect()
}

/// A lag that friction doesn't explain.
fn out_of_step(motor_late_s: Gaussian) -> Option<Warning> {
    /// Less is a control cycle.
    const LEAST_S: f64 = 1e-3;
    const SURE: f64 = 3.0;
    let size = motor_late_s.mean.abs();
    (size > LEAST_S && size > SURE * motor_late_s.deviation)
        .then_some(Warning::SidesOutOfStep { motor_late_s })
}

/// Places of the state that are estimated along with the offsets, and what was believed of them.
fn entries<'a>(
    prior: &'a Prior,
    segments: &'a Segments,
) -> impl Iterator<Item = (usize, Gaussian)> + 'a {
    /// What is held fixed isn't estimated.
    const FIXED: f64 = 1e-8;
    let is_offset = |k: usize| {
        let joint = prior.describe(k).and_then(|entry| entry.joint);
        joint.is_some_and(|i| prior.is_elastic(i) && k == prior.place(i, JointParameter::Offset))
    };
    (0..prior.dimension())
        .map(|k| (k, segments.before.entry(k)))
        .filter(move |(k, before)| !is_offset(*k) && !(before.deviation < FIXED))
}

/// Times of at least a second that were mostly left out, the longest first, at most 20.
fn left_out(blocks: &[Block], weights: &[f64]) -> Vec<LeftOut> {
    let mut found: Vec<LeftOut> = Vec::new();
    for (block, _) in blocks.iter().zip(weights).filter(|(_, w)| **w < OUTLIER) {
        match found.last_mut() {
            Some(last) if block.time_s - last.to_s < 0.5 => last.to_s = block.time_s + 0.1,
            _ => found.push(LeftOut {
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

    /// A tendon on a pulley of 20 mm that is tensioned again at 0.4 mm: 20 mrad.
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
    fn a_limit_is_passed_when_the_whole_interval_is_beyond_it() {
        let state = |offset_mrad: f64, withheld: bool| {
            let offset = Gaussian::new(1e-3 * offset_mrad, 1e-3 / Z95);
            retension(&tendon(), offset, withheld).unwrap().state
        };
        for (offset_mrad, expected) in [
            (18.9, LimitState::NotPassed),
            (19.1, LimitState::CannotTell),
            (20.0, LimitState::CannotTell),
            (20.9, LimitState::CannotTell),
            (21.1, LimitState::Passed),
        ] {
            assert_eq!(state(offset_mrad, false), expected, "{offset_mrad}");
            assert_eq!(state(offset_mrad, true), LimitState::CannotTell);
        }
    }

    #[test]
    fn what_is_shared_holds_what_is_constant_and_is_no_more_than_the_whole() {
        let offset = Gaussian::new(0.0, 1e-3);
        let known = SharedError {
            baseline_rad: 0.3e-3,
            drift_rad: 0.2e-3,
        };
        let found = shared_error(Some(&known), 0.4e-3, offset);
        assert!((found.baseline_rad - 0.5e-3).abs() < 1e-12 && found.drift_rad == 0.2e-3);
        assert_eq!(shared_error(Some(&known), 2e-3, offset).baseline_rad, 1e-3);
        assert_eq!(shared_error(None, 0.0, offset).baseline_rad, 1e-3);
    }
}
