//! The posterior in words and units.

use super::answer::{
    Absolute, AbsoluteJoint, Course, LeftOut, Moved, PayloadChange, Step, Stretch,
};
use super::blocks::Recorded;
use super::doubt::{self, Doubt};
use super::jumps::quickness;
use super::stiffness;
use super::watch::{Watched, mean_temperature};
use sinew_model::Gaussian;
use sinew_model::offset::{Block, ChangeKind, JointParameter, MapEstimate, MapEstimator, Prior};
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;

/// 97.5 % quantile of the normal distribution.
pub(super) const Z95: f64 = 1.96;
/// An interval wider than this can't tell stretch from nothing, mrad.
const USELESS_MRAD: f64 = 5.0;

/// What is said of a recording.
pub(super) fn said(
    estimator: &MapEstimator,
    robot: &Robot,
    recorded: &Recorded,
    watched: &Watched,
    recording: &str,
    baseline: Option<String>,
) -> Absolute {
    let prior = estimator.prior();
    let poses = distinct_poses(&recorded.blocks);
    let weights: Vec<f64> = watched
        .stretches
        .iter()
        .flat_map(|(_, map)| map.weights.iter().copied())
        .collect();
    let elastic: Vec<usize> = (0..robot.arm.dof())
        .filter(|&i| prior.is_elastic(i))
        .collect();
    let (joints, doubts): (Vec<AbsoluteJoint>, Vec<Doubt>) = elastic
        .iter()
        .map(|&i| said_of_joint(prior, robot, recorded, watched, i))
        .unzip();
    let offsets_of = |map: &MapEstimate| -> (Vec<f64>, Vec<f64>) {
        elastic
            .iter()
            .map(|&i| {
                let Gaussian { mean, deviation } = map.offset(prior, i);
                (1e3 * mean, 1e3 * Z95 * deviation)
            })
            .unzip()
    };
    let mut series: Vec<Stretch> = watched
        .stretches
        .iter()
        .map(|(from, map)| {
            let (offset_mrad, interval_95_mrad) = offsets_of(map);
            Stretch {
                from_s: recorded.blocks[*from].time_s,
                to_s: recorded.blocks[from + map.weights.len() - 1].time_s,
                offset_mrad,
                interval_95_mrad,
            }
        })
        .collect();
    let mut course = course(estimator, recorded, watched, &elastic);
    doubt::widen(&doubts, &mut series, &mut course);
    let mut payload_changes = Vec::new();
    for (_, map) in &watched.stretches {
        for (k, change) in map.changes.iter().enumerate() {
            if change.kind == ChangeKind::Payload {
                let Gaussian {
                    mean: size,
                    deviation,
                } = map.change(prior, k);
                let posterior = map.posterior(change);
                payload_changes.push(PayloadChange {
                    time_s: posterior.map_or(change.at_s, |p| p.time_s),
                    between_s: posterior.map(|p| [p.interval_s.low, p.interval_s.high]),
                    probability: posterior.map(|p| p.probability),
                    change_kg: size,
                    interval_95_kg: Z95 * deviation,
                });
            }
        }
    }
    let motor_torque = estimator.uses_motor_torque()
        && recorded
            .blocks
            .iter()
            .any(|b| b.motor_torque.iter().any(|t| t.is_finite()));
    let Gaussian {
        mean: mass,
        deviation: mass_deviation,
    } = watched.belief.entry(prior.payload_place());
    let out = weights.iter().filter(|w| **w < HALF).count() as f64;
    let temperature = mean_temperature(&recorded.blocks);
    /// Clocks before the year 2000 don't tell the date.
    const YEAR_2000_NS: i64 = 946_684_800_000_000_000;
    let mut said = Absolute {
        robot: robot.name.clone(),
        recording: recording.into(),
        baseline,
        start_time_utc_s: (recorded.start_time_ns > YEAR_2000_NS)
            .then_some(recorded.start_time_ns as f64 * 1e-9),
        duration_s: recorded.duration_s,
        temperature_c: temperature.is_finite().then_some(temperature),
        reference_temperature_c: watched
            .before
            .temperature_c
            .is_finite()
            .then_some(watched.before.temperature_c),
        joints,
        series,
        course,
        payload_kg: [mass, Z95 * mass_deviation],
        payload_changes,
        motor_torque,
        motor_current: motor_torque && recorded.motor_current,
        left_out_share: out / weights.len().max(1) as f64,
        left_out: left_out(&recorded.blocks, &weights),
        poses,
        noise_mrad: noise(watched, &elastic),
        nuisance: nuisance(prior, robot, watched),
        damaged: recorded.damaged,
        warnings: Vec::new(),
    };
    said.warnings = super::warnings::warnings(&said, &doubts, recorded);
    said.warnings.extend(stiffness::suspected(&said.joints));
    said
}

/// The largest of the stretches' noise, per elastic joint, mrad.
fn noise(watched: &Watched, elastic: &[usize]) -> Vec<f64> {
    elastic
        .iter()
        .map(|&i| {
            let noise = watched.stretches.iter().map(|(_, map)| map.noise_rad[i]);
            1e3 * noise.fold(0.0, f64::max)
        })
        .collect()
}

fn said_of_joint(
    prior: &Prior,
    robot: &Robot,
    recorded: &Recorded,
    watched: &Watched,
    joint: usize,
) -> (AbsoluteJoint, Doubt) {
    let at = |p: JointParameter| watched.belief.entry(prior.place(joint, p));
    let Gaussian {
        mean: offset,
        deviation,
    } = at(JointParameter::Offset);
    let mut steps = Vec::new();
    for (from, map) in &watched.stretches {
        for (k, change) in map.changes.iter().enumerate() {
            match change.kind {
                ChangeKind::Offset(i) if i == joint => {
                    let mut step = step(prior, map, (k, joint));
                    tell_cause(&mut step, robot, recorded, joint);
                    if doubt::is_encoder(&step) {
                        // Nothing else looks like that.
                        step.probability = map.posterior(change).map(|p| p.probability_not_noise);
                    }
                    tell_tensioning(
                        &mut step,
                        map.offset_at(prior, joint, change.at_s - BEFORE_S),
                    );
                    steps.push(step);
                }
                ChangeKind::Compliance(i) if i == joint && !stiffness::with_slip(map, k) => {
                    let first_s = recorded.blocks.get(*from).map_or(0.0, |b| b.time_s);
                    steps.extend(stiffness::alone(prior, map, (k, i), first_s));
                }
                _ => {}
            }
        }
    }
    doubt::lessen(&mut steps, recorded);
    let doubt = Doubt::of(prior, recorded, watched, joint, &steps);
    let offset_mrad = 1e3 * offset;
    let interval_95_mrad = doubt.widen(1e3 * Z95 * deviation, recorded.end_s());
    let interval = 1e-3 * interval_95_mrad;
    let verdict = if !(interval_95_mrad <= USELESS_MRAD) {
        "can't tell"
    } else if offset_mrad.abs() <= interval_95_mrad {
        "unchanged"
    } else if offset_mrad > 0.0 {
        "longer"
    } else {
        "shorter"
    };
    let transmission = robot.transmissions[joint].as_ref();
    let tendon = transmission.and_then(|t| t.tendon.as_ref());
    let stiffness = transmission.map_or(0.0, |t| t.stiffness_nm_per_rad);
    let compliance = at(JointParameter::Compliance);
    let zero = at(JointParameter::Zero).mean;
    let slack = prior.is_antagonistic(joint).then(|| {
        let Gaussian { mean, deviation } = at(JointParameter::Slack);
        [1e3 * mean, 1e3 * Z95 * deviation]
    });
    // The spring's deflection, up to the offset that is estimated.
    let torques = recorded
        .blocks
        .iter()
        .map(|b| stiffness / (1.0 + compliance.mean) * (b.y[joint] - offset - zero));
    let (least, most) = torques.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| {
        (a.min(t), b.max(t))
    });
    let said = AbsoluteJoint {
        name: robot.joint_names()[joint].clone(),
        offset_mrad,
        interval_95_mrad,
        elongation_mm: tendon.map(|t| 1e3 * t.elongation_m(offset)),
        interval_95_mm: tendon.map(|t| 1e3 * t.elongation_m(interval)),
        verdict: verdict.into(),
        retension_at_mm: tendon.and_then(|t| t.retension_at_m).map(|m| 1e3 * m),
        limit_passed: tendon.and_then(|t| passed(t, offset, interval)),
        steps,
        // Against robot.toml: all of the compliance over nominal is the change.
        stiffness_change_percent: stiffness::gained_percent(compliance.mean, compliance),
        stiffness_since_before: stiffness::since(prior, watched, joint),
        slack_mrad: slack,
        torque_range_nm: [least, most],
    };
    (said, doubt)
}

/// Whether the elongation at which to tension again is passed, as far as the interval tells.
fn passed(tendon: &Tendon, offset: f64, interval: f64) -> Option<bool> {
    let limit = tendon.retension_at_m?;
    let [least, most] = [offset - interval, offset + interval].map(|x| tendon.elongation_m(x));
    if least > limit {
        Some(true)
    } else if most < limit {
        Some(false)
    } else {
        None
    }
}

/// Every block with the estimate at its time.
fn course(
    estimator: &MapEstimator,
    recorded: &Recorded,
    watched: &Watched,
    elastic: &[usize],
) -> Vec<Course> {
    let prior = estimator.prior();
    let mut out = Vec::with_capacity(recorded.blocks.len());
    let mut residuals = vec![0.0; prior.joints()];
    for (from, map) in &watched.stretches {
        for (b, weight) in map.weights.iter().enumerate() {
            let block = &recorded.blocks[from + b];
            estimator.residuals(map, block, &mut residuals);
            let (mut offset_mrad, mut interval_95_mrad) = (Vec::new(), Vec::new());
            for &i in elastic {
                let Gaussian { mean, deviation } = map.offset_at(prior, i, block.time_s);
                offset_mrad.push(1e3 * mean);
                interval_95_mrad.push(1e3 * Z95 * deviation);
            }
            out.push(Course {
                time_s: block.time_s,
                weight: *weight,
                block_mrad: elastic
                    .iter()
                    .zip(&offset_mrad)
                    .map(|(&i, offset)| offset + 1e3 * residuals[i])
                    .collect(),
                offset_mrad,
                interval_95_mrad,
            });
        }
    }
    out
}

/// Which of rope and encoders slipped.
fn tell_cause(step: &mut Step, robot: &Robot, recorded: &Recorded, joint: usize) {
    let nearest = recorded
        .blocks
        .partition_point(|b| b.time_s < step.time_s)
        .min(recorded.blocks.len().saturating_sub(1));
    let (Some(block), Some(t)) = (recorded.blocks.get(nearest), &robot.transmissions[joint]) else {
        return;
    };
    if step.kind != "slip" {
        return;
    }
    let (stiffness, inertia) = (t.stiffness_nm_per_rad, t.motor_inertia_kg_m2);
    let quickness = quickness(&robot.arm, &block.q, joint, stiffness, inertia);
    let size = [1e-3 * step.size_mrad, 1e-3 * step.interval_95_mrad];
    let cause = recorded.jumps.cause(joint, step.time_s, size, quickness);
    step.cause = cause.name().into();
    step.cause_said = cause.sentence().into();
}

/// Just before a change, s.
const BEFORE_S: f64 = 1e-3;

/// A slip that takes away at least half of the offset there was, and was no encoder's, is somebody who
/// tensioned the rope: ropes don't shorten.
fn tell_tensioning(step: &mut Step, before: Gaussian) {
    const MUCH: f64 = 0.5;
    let (before_mrad, unsure_mrad) = (1e3 * before.mean, 1e3 * Z95 * before.deviation);
    let gone_mrad = -step.size_mrad;
    if step.kind == "slip"
        && !doubt::is_encoder(step)
        && before_mrad > unsure_mrad
        && gone_mrad > step.interval_95_mrad
        && gone_mrad > MUCH * before_mrad
    {
        step.kind = "re-tensioned".into();
        step.cause_said =
            "most of the offset went: it was tensioned again; make a new baseline".into();
    }
}

/// What a change of an offset is, by its size and the compliance it brought, and how that is said where
/// it needs no look at the readings.
fn kind(slip: Gaussian, softer: Option<Gaussian>) -> (&'static str, &'static str) {
    match softer {
        Some(softer) if softer.mean > 0.0 && softer.is_nonzero_95() => {
            ("strand failure", "a strand has failed")
        }
        Some(_) if !slip.is_nonzero_95() => (
            "slip or strand failure",
            "a slip or a failed strand: can't be told",
        ),
        _ => ("slip", ""),
    }
}

/// A step and what happened to the stiffness with it.
fn step(prior: &Prior, map: &MapEstimate, (k, joint): (usize, usize)) -> Step {
    let step = map.change(prior, k);
    let change = map.changes[k];
    let softer = map.changes.iter().position(|c| {
        matches!((c.kind, change.kind), (ChangeKind::Compliance(a), ChangeKind::Offset(b)) if a == b)
            && c.at_s == change.at_s
    });
    let softer = softer.map(|k| map.change(prior, k));
    let (kind, cause_said) = kind(step, softer);
    let posterior = map.posterior(&change);
    Step {
        time_s: posterior.map_or(change.at_s, |p| p.time_s),
        between_s: posterior.map(|p| [p.interval_s.low, p.interval_s.high]),
        probability: posterior.map(|p| p.probability),
        size_mrad: 1e3 * step.mean,
        interval_95_mrad: 1e3 * Z95 * step.deviation,
        stiffness_change_percent: softer
            .map(|softer| stiffness::change_percent(prior, map, joint, softer)),
        kind: kind.into(),
        cause: String::new(),
        cause_said: cause_said.into(),
    }
}

/// Everything estimated along, before and after.
fn nuisance(prior: &Prior, robot: &Robot, watched: &Watched) -> Vec<Moved> {
    /// What is held fixed isn't estimated.
    const FIXED: f64 = 1e-8;
    let names = robot.joint_names();
    (0..prior.dimension())
        .filter_map(|k| {
            let entry = prior.describe(k)?;
            let before = watched.before.entry(k);
            let after = watched.belief.entry(k);
            let offset = entry.joint.is_some_and(|i| {
                prior.is_elastic(i) && k == prior.place(i, JointParameter::Offset)
            });
            if offset || before.deviation < FIXED {
                return None;
            }
            Some(Moved {
                joint: entry.joint.map_or_else(String::new, |i| names[i].clone()),
                name: entry.name.into(),
                unit: entry.unit.into(),
                prior: [before.mean, before.deviation],
                posterior: [after.mean, after.deviation],
                moved: after.deviation < 0.8 * before.deviation
                    || (after.mean - before.mean).abs() > before.deviation,
            })
        })
        .collect()
}

/// A block of less weight counts as left out.
const HALF: f64 = 0.5;

/// Stretches of at least a second that were mostly left out, the longest first, at most 20.
fn left_out(blocks: &[Block], weights: &[f64]) -> Vec<LeftOut> {
    let mut found: Vec<LeftOut> = Vec::new();
    for (block, _) in blocks.iter().zip(weights).filter(|(_, w)| **w < HALF) {
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

/// How many poses differ by more than 0.2 rad in some joint, greedily.
fn distinct_poses(blocks: &[Block]) -> usize {
    const APART_RAD: f64 = 0.2;
    let mut poses: Vec<&[f64]> = Vec::new();
    for block in blocks {
        let new = poses.iter().all(|pose| {
            pose.iter()
                .zip(&block.q)
                .any(|(a, b)| (a - b).abs() > APART_RAD)
        });
        if new && poses.len() < 100 {
            poses.push(&block.q);
        }
    }
    poses.len()
}

#[cfg(test)]
mod tests {
    use super::{Gaussian, kind};

    #[test]
    fn a_change_is_called_what_is_sure_of_it() {
        let named = |slip, softer| kind(slip, softer).0;
        assert_eq!(named(Gaussian::new(5.0, 0.3), None), "slip");
        assert_eq!(
            named(Gaussian::new(5.0, 0.3), Some(Gaussian::new(0.02, 0.02))),
            "slip"
        );
        assert_eq!(
            named(Gaussian::new(5.0, 0.3), Some(Gaussian::new(-0.06, 0.02))),
            "slip"
        );
        assert_eq!(
            named(Gaussian::new(2.0, 1.5), Some(Gaussian::new(0.06, 0.02))),
            "strand failure"
        );
        assert_eq!(
            named(Gaussian::new(2.0, 1.5), Some(Gaussian::new(0.02, 0.02))),
            "slip or strand failure"
        );
    }
}
