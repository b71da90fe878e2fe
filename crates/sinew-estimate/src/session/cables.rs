//! Tendons with friction along their path: their part of a baseline, and of the result of a session.

use super::changes::stiffness_change_ratio;
use super::recorder::Recorded;
use super::result::{SessionEstimate, TendonChange, TendonChangeKind, TendonEstimate, Verdict};
use super::summary::{range, retension};
use super::warning::Warning;
use crate::baseline::Baseline;
use crate::cable::{CableBaseline, CableEstimate, CableLimit, CablePrior, CableSample};
use crate::cable::{MIN_REVERSALS, motor_ratio, reversals};
use crate::error::{EstimateError, SessionError, SidesFault};
use sinew_model::Gaussian;
use sinew_model::arm::JointKind;
use sinew_model::offset::{Block, SharedError, UNKNOWN_OFFSET_RAD};
use sinew_model::robot::{Cable, Robot};
use sinew_model::transmission::Tendon;

/// Estimates the parameters of all tendons with friction along their path from the recordings of a baseline, each
/// with its name.
///
/// # Errors
/// Returns [`EstimateError::Mismatch`] for a recording without a torque or with too few reversals of such a joint, and
/// [`EstimateError::Sides`] if its motor has a wrong unit, gear ratio or sign.
pub(super) fn learn(
    robot: &Robot,
    recordings: &[(Recorded, String)],
) -> Result<Vec<CableBaseline>, SessionError> {
    let mismatch = |file: &str, reason: String| EstimateError::Mismatch {
        file: file.to_owned(),
        reason,
    };
    let mut out = Vec::new();
    for cable in &robot.cables {
        let joint = robot.axis_name(cable.axis);
        let prior = prior(cable);
        let mut all = Vec::new();
        for (recorded, file) in recordings {
            let samples = samples(robot, recorded, cable.axis);
            check_ratio(joint, &samples, file)?;
            let found = reversals(prior, &samples);
            if found < MIN_REVERSALS {
                return Err(mismatch(file, format!(
                    "joint '{joint}' has {found} complete reversals, expected at least {MIN_REVERSALS} in each recording of a baseline, because friction acts along the path of its tendon: move it to and fro over its whole working range"
                )).into());
            }
            all.push(samples);
        }
        let all: Vec<&[CableSample]> = all.iter().map(Vec::as_slice).collect();
        let file = recordings.first().map_or("", |(_, file)| file);
        let learned = CableBaseline::learn(joint, prior, &all).ok_or_else(|| {
            mismatch(
                file,
                format!("the parameters of the tendon of joint '{joint}' have no solution; check its positions and torques with sinew log info"),
            )
        })?;
        out.push(learned);
    }
    Ok(out)
}

/// Checks that the motor of a joint has the unit, gear ratio and sign of the joint.
///
/// # Errors
/// Returns [`EstimateError::Sides`] with the ratio.
fn check_ratio(joint: &str, samples: &[CableSample], file: &str) -> Result<(), EstimateError> {
    match motor_ratio(joint, samples) {
        None => Ok(()),
        Some(ratio) => Err(EstimateError::Sides {
            file: file.to_owned(),
            fault: SidesFault::Ratio {
                ratios: vec![ratio],
            },
        }),
    }
}

/// Adds the results of the tendons with friction along their path to the result of a session; `file` is the name of its
/// recording.
///
/// # Errors
/// Returns [`SessionError::Baseline`] if the baseline was estimated with another stiffness or friction of such a tendon,
/// and [`EstimateError::Sides`] if its motor has a wrong unit, gear ratio or sign.
pub(super) fn add(
    robot: &Robot,
    (recorded, file): (&Recorded, &str),
    baseline: Option<(&Baseline, &str)>,
    estimate: &mut SessionEstimate,
) -> Result<(), SessionError> {
    for cable in &robot.cables {
        let joint = robot.axis_name(cable.axis);
        // A monitor and a simulation record no samples.
        if !recorded.cables.iter().any(|(axis, _)| *axis == cable.axis) {
            continue;
        }
        let samples = samples(robot, recorded, cable.axis);
        check_ratio(joint, &samples, file)?;
        let learned = baseline.and_then(|(baseline, _)| {
            let mut cables = baseline.cables.iter();
            cables.find(|learned| learned.joint == joint)
        });
        let wrong = |reason: String| SessionError::Baseline {
            file: baseline.map_or_else(String::new, |(_, file)| file.to_owned()),
            reason: format!("{reason} of joint '{joint}'; create it again with sinew baseline"),
        };
        let found = match learned {
            None => None,
            Some(learned) if learned.prior != prior(cable) => {
                return Err(wrong(
                    "was estimated with another stiffness_nm_per_rad or motor_friction".into(),
                ));
            }
            Some(learned) => {
                let found = learned.estimate(&samples);
                let found = found.ok_or_else(|| wrong("contains invalid parameters".into()))?;
                Some((learned, found))
            }
        };
        insert(robot, cable, &samples, found, estimate);
    }
    Ok(())
}

/// Prior of a tendon by robot.toml.
fn prior(cable: &Cable) -> CablePrior {
    CablePrior {
        compliance_rad_per_nm: 1.0 / cable.transmission.stiffness_nm_per_rad,
        drive_friction_nm: cable.transmission.motor_friction.coulomb_nm,
    }
}

/// Samples of a joint with torques: those of its sensor if any is recorded, otherwise by the described masses.
fn samples(robot: &Robot, recorded: &Recorded, axis: usize) -> Vec<CableSample> {
    let own = recorded.cables.iter().find(|(of, _)| *of == axis);
    let mut out = own.map_or_else(Vec::new, |(_, samples)| samples.samples.clone());
    if !out.iter().any(|sample| sample.torque_nm.is_finite()) {
        let torques = described_torques(robot, &recorded.blocks, axis);
        for sample in &mut out {
            sample.torque_nm = interpolated(&torques, sample.time_s);
        }
    }
    out.retain(|sample| sample.torque_nm.is_finite());
    out
}

/// Torque at a joint by the described masses, N·m, at the times of the blocks, s.
fn described_torques(robot: &Robot, blocks: &[Block], axis: usize) -> Vec<(f64, f64)> {
    let base = robot.arm.base_parameters();
    let described = base.of(&robot.arm.inertial_parameters());
    let of = |block: &Block| {
        let row = block.phi.chunks_exact(described.len().max(1)).nth(axis)?;
        let torque_nm = sinew_model::cholesky::dot(row, &described);
        Some((block.time_s, torque_nm))
    };
    blocks.iter().filter_map(of).collect()
}

/// Value at a time by linear interpolation; NaN outside the points.
fn interpolated(points: &[(f64, f64)], time_s: f64) -> f64 {
    let next = points.partition_point(|(at_s, _)| *at_s < time_s);
    match (
        next.checked_sub(1).and_then(|i| points.get(i)),
        points.get(next),
    ) {
        (Some((t0, x0)), Some((t1, x1))) => x0 + (x1 - x0) * (time_s - t0) / (t1 - t0),
        _ => f64::NAN,
    }
}

/// Inserts the result of a tendon in the order of the joints.
fn insert(
    robot: &Robot,
    cable: &Cable,
    samples: &[CableSample],
    found: Option<(&CableBaseline, CableEstimate)>,
    estimate: &mut SessionEstimate,
) {
    let name = robot.axis_name(cable.axis).to_owned();
    let unknown = Gaussian::new(0.0, UNKNOWN_OFFSET_RAD);
    let found_rad = found.as_ref().map(|(_, found)| found.offset_rad);
    let offset_rad = found_rad.unwrap_or(unknown);
    let limits = match &found {
        Some((_, found)) => found.limits.clone(),
        None => vec![CableLimit::NoBaseline],
    };
    let compliance = found
        .as_ref()
        .map(|(learned, _)| learned.compliance_change());
    let step = found.as_ref().and_then(|(_, found)| found.step);
    let change = step.map(|step| TendonChange {
        kind: TendonChangeKind::Slip,
        time_s: step.time_s,
        interval_s: Some(step.interval_s),
        probability: Some(step.probability),
        size_rad: Some(step.size_rad),
        stiffness_change_ratio: None,
        cause: None,
    });
    let verdict = verdict(offset_rad, &limits);
    let tendon = cable.transmission.tendon.as_ref();
    let through = |f: &dyn Fn(&Tendon, f64) -> f64| {
        let of = |t| Gaussian::new(f(t, offset_rad.mean), f(t, offset_rad.std));
        tendon.map(of)
    };
    let joint = TendonEstimate {
        name: name.clone(),
        slides: robot.arm.joint_kind(cable.axis) == Some(JointKind::Prismatic),
        offset_rad,
        systematic_error: found.as_ref().map(|(_, found)| {
            let shared = SharedError {
                baseline_rad: found.shared_std_rad,
                drift_rad: 0.0,
            };
            shared.at_most(offset_rad.std)
        }),
        elongation_m: through(&Tendon::elongation_m),
        strain_ratio: through(&Tendon::strain),
        verdict,
        retension: tendon.and_then(|t| retension(t, offset_rad, !limits.is_empty())),
        changes: Vec::from_iter(change),
        stiffness_change_ratio: compliance.map_or(Gaussian::default(), |compliance| {
            stiffness_change_ratio(compliance.mean, compliance)
        }),
        stiffness_change: None,
        creep: None,
        slack_rad: None,
        torque_nm: range(samples.iter().map(|s| s.torque_nm)),
        noise_rad: found
            .as_ref()
            .map_or(0.0, |(learned, _)| learned.noise_rad()),
        excess_residual_rad: 0.0,
        slack_share: None,
        lower_bound_rad: None,
        lower_bound_m: None,
        anchored: None,
    };
    let at = (0..cable.axis).filter(|axis| {
        let name = robot.tendon_name(*axis);
        estimate.joints.iter().any(|joint| joint.name == name)
    });
    let at = at.count();
    estimate.joints.insert(at, joint);
    let before_rad = |time_s: f64| match step {
        Some(step) if time_s < step.time_s => offset_rad.mean - step.size_rad.mean,
        _ => offset_rad.mean,
    };
    for segment in &mut estimate.segments {
        let mean = before_rad(segment.to_s);
        segment
            .offset_rad
            .insert(at, Gaussian::new(mean, offset_rad.std));
    }
    let trace = found.map_or_else(Vec::new, |(_, found)| found.trace);
    let trace: Vec<(f64, f64)> = trace.iter().map(|t| (t.time_s, t.residual_rad)).collect();
    for block in &mut estimate.blocks {
        let mean = before_rad(block.time_s);
        block
            .block_rad
            .insert(at, interpolated(&trace, block.time_s));
        block
            .offset_rad
            .insert(at, Gaussian::new(mean, offset_rad.std));
    }
    let warnings = limits.into_iter().map(|reason| Warning::CableInconclusive {
        joint: name.clone(),
        reason,
    });
    estimate.warnings.extend(warnings);
}

/// Verdict on the elongation of a tendon with friction along its path.
///
/// Its interval rarely becomes as narrow as a conclusive one of other tendons; one that excludes zero is a detection none
/// the less, as it contains the model's errors by the evidence of the baseline.
fn verdict(offset_rad: Gaussian, limits: &[CableLimit]) -> Verdict {
    match offset_rad.is_nonzero_95() {
        _ if !limits.is_empty() => Verdict::Inconclusive,
        true if offset_rad.mean > 0.0 => Verdict::Elongated,
        true => Verdict::Shortened,
        false => Verdict::of(offset_rad, true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdict_excluded_zero_is_detected_unless_limited() {
        let wide = Gaussian::new(20e-3, 4e-3);
        assert_eq!(verdict(wide, &[]), Verdict::Elongated);
        assert_eq!(verdict(wide.scaled(-1.0), &[]), Verdict::Shortened);
        let limits = [CableLimit::Reversals { reversals: 0 }];
        assert_eq!(verdict(wide, &limits), Verdict::Inconclusive);
        let zero = |std| verdict(Gaussian::new(1e-3, std), &[]);
        assert_eq!(zero(4e-3), Verdict::Inconclusive);
        assert_eq!(zero(2e-3), Verdict::NoChangeDetected);
    }

    #[test]
    fn interpolated_between_points_is_linear() {
        let points = [(0.0, 1.0), (2.0, 5.0)];
        assert_eq!(interpolated(&points, 0.5), 2.0);
        assert!(interpolated(&points, -0.1).is_nan() && interpolated(&points, 2.1).is_nan());
        assert!(interpolated(&[], 0.0).is_nan());
    }
}
