//! Learning a baseline and watching with it.

use super::blocks::{AbsoluteError, Recorded, Window, read};
use super::file::Baseline;
use crate::estimate::{Progress, Request};
use serde::Serialize;
use sinew_model::offset::{
    Block, FeatureConfig, MapEstimate, MapEstimator, OffsetSpan, Prior, Tolerances, step_candidates,
};
use sinew_model::robot::Robot;

/// 97.5 % quantile of the normal distribution.
const Z95: f64 = 1.96;
/// Offsets right after tensioning are zero by definition, up to this, rad.
const TENSIONED_RAD: f64 = 1e-5;
/// What an offset may be before anything is known, rad (one standard deviation).
const UNKNOWN_RAD: f64 = 0.03;
/// An interval wider than this can't tell stretch from nothing, mrad.
const USELESS_MRAD: f64 = 5.0;
/// A step is reported when it is this many standard deviations from zero, and not below 1 mrad.
const STEP_SURE: f64 = 5.0;
const STEP_LEAST_RAD: f64 = 1e-3;

/// Offsets since the baseline.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Absolute {
    /// The recording.
    pub recording: String,
    /// Recording of the baseline; `None`: data-sheet priors only.
    pub baseline: Option<String>,
    /// Length of the recording used, s.
    pub duration_s: f64,
    /// One entry per elastic joint.
    pub joints: Vec<AbsoluteJoint>,
    /// Payload estimated along, kg, and half its 95 % interval.
    pub payload_kg: [f64; 2],
    /// Share of the time left out as contact or disturbance.
    pub left_out_share: f64,
    /// The longest such stretches.
    pub left_out: Vec<LeftOut>,
    /// Distinct poses the arm stood or passed at, as far as gravity tells them apart.
    pub poses: usize,
    /// Whether part of the file was lost.
    pub damaged: bool,
    /// What the reader should know.
    pub warnings: Vec<String>,
}

/// One tendon since its baseline.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbsoluteJoint {
    /// Joint.
    pub name: String,
    /// Offset at the end of the recording, mrad.
    pub offset_mrad: f64,
    /// Half of its 95 % interval, mrad.
    pub interval_95_mrad: f64,
    /// Elongation, mm; `None` without tendon geometry.
    pub elongation_mm: Option<f64>,
    /// Half of its 95 % interval, mm.
    pub interval_95_mm: Option<f64>,
    /// "longer", "shorter", "unchanged" or "can't tell".
    pub verdict: String,
    /// Sudden changes within the recording.
    pub steps: Vec<Step>,
    /// Stiffness as the recording sees it over nominal, % and half its 95 % interval.
    pub stiffness_change_percent: [f64; 2],
}

/// A sudden change of an offset.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Step {
    /// When, s from the start of the recording, to about 2 s.
    pub time_s: f64,
    /// By how much, mrad.
    pub size_mrad: f64,
    /// Half of its 95 % interval, mrad.
    pub interval_95_mrad: f64,
}

/// A stretch that was left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// From, s.
    pub from_s: f64,
    /// To, s.
    pub to_s: f64,
}

/// Learns a baseline from a recording taken right after tensioning, the gripper empty.
///
/// # Errors
/// [`AbsoluteError`].
pub fn learn(
    request: &Request,
    window: Window,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Baseline, Absolute), AbsoluteError> {
    let (loaded, recorded) = read(request, window, &FeatureConfig::default(), progress)?;
    let file = request.log.display().to_string();
    learn_recorded(&loaded.robot, &recorded, &file)
}

/// [`learn`] from blocks; `name` of the recording for the answer and errors.
///
/// # Errors
/// [`AbsoluteError`].
pub fn learn_recorded(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
) -> Result<(Baseline, Absolute), AbsoluteError> {
    let estimator = estimator(robot, &FeatureConfig::default());
    let mut start = estimator.prior().nuisance(false);
    start.temperature_c = mean_temperature(&recorded.blocks);
    let spans = spans(robot, TENSIONED_RAD);
    let map = estimator
        .solve(&start, &spans, &recorded.blocks)
        .map_err(|error| AbsoluteError::Map {
            file: name.into(),
            error,
        })?;
    let baseline = Baseline::new(robot, name.into(), &map.nuisance);
    let mut said = said(&estimator, robot, recorded, &spans, &map, name.into(), None);
    if said.poses < 6 {
        said.warnings.push(format!(
            "only {} distinct poses: a baseline of few poses spoils what is compared with it; move every joint through its range in a dozen poses",
            said.poses
        ));
    }
    Ok((baseline, said))
}

/// Offsets of a recording since `baseline`; `payload`: whether the gripper may hold something.
///
/// # Errors
/// [`AbsoluteError`].
pub fn watch(
    request: &Request,
    window: Window,
    baseline: Option<(&Baseline, &str)>,
    payload: bool,
    progress: &mut dyn FnMut(Progress),
) -> Result<Absolute, AbsoluteError> {
    let (loaded, recorded) = read(request, window, &FeatureConfig::default(), progress)?;
    let file = request.log.display().to_string();
    watch_recorded(&loaded.robot, &recorded, &file, baseline, payload)
}

/// [`watch`] from blocks; `name` of the recording for the answer and errors.
///
/// # Errors
/// [`AbsoluteError`].
pub fn watch_recorded(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    baseline: Option<(&Baseline, &str)>,
    payload: bool,
) -> Result<Absolute, AbsoluteError> {
    let estimator = estimator(robot, &FeatureConfig::default());
    let file = name.to_string();
    let mut start = match baseline {
        Some((baseline, name)) => baseline.nuisance(robot, estimator.prior().dimension(), name)?,
        None => {
            let mut fresh = estimator.prior().nuisance(false);
            fresh.temperature_c = mean_temperature(&recorded.blocks);
            fresh
        }
    };
    estimator.prior().reopen_payload(&mut start, payload);
    let solve = |spans: &[OffsetSpan]| {
        estimator
            .solve(&start, spans, &recorded.blocks)
            .map_err(|error| AbsoluteError::Map {
                file: file.clone(),
                error,
            })
    };
    let mut spans = spans(robot, UNKNOWN_RAD);
    let plain = spans.len();
    let mut map = solve(&spans)?;
    // Slips: candidates of all joints are tried together, and those that aren't sure go again.
    const ROUNDS: usize = 3;
    for _ in 0..ROUNDS {
        let before = spans.len();
        for candidate in step_candidates(&recorded.blocks, &map.residuals_rad, &map.noise_rad) {
            const WORTH_TRYING: f64 = 2.0;
            let known = spans[plain..]
                .iter()
                .any(|s| s.joint == candidate.joint && (s.from_s - candidate.time_s).abs() < 5.0);
            if candidate.strength > WORTH_TRYING
                && candidate.size_rad.abs() > STEP_LEAST_RAD
                && robot.transmissions[candidate.joint].is_some()
                && !known
            {
                spans.push(OffsetSpan {
                    joint: candidate.joint,
                    from_s: candidate.time_s,
                    to_s: f64::INFINITY,
                    mean_rad: 0.0,
                    deviation_rad: UNKNOWN_RAD,
                });
            }
        }
        if spans.len() == before {
            break;
        }
        map = solve(&spans)?;
        let kept: Vec<OffsetSpan> = spans
            .iter()
            .enumerate()
            .filter(|&(k, _)| {
                k < plain
                    || (map.offsets_rad[k].abs() > STEP_SURE * map.deviations_rad[k]
                        && map.offsets_rad[k].abs() > STEP_LEAST_RAD)
            })
            .map(|(_, s)| *s)
            .collect();
        if kept.len() < spans.len() {
            spans = kept;
            map = solve(&spans)?;
        }
    }
    Ok(said(
        &estimator,
        robot,
        recorded,
        &spans,
        &map,
        file,
        baseline.map(|(b, _)| b.recording.clone()),
    ))
}

/// The estimator of a robot. The payload is expected half as far again from the last joint as that
/// body's own centre of mass, where a gripper holds things.
fn estimator(robot: &Robot, config: &FeatureConfig) -> MapEstimator {
    let last = robot.arm.dof().saturating_sub(1);
    let at = robot
        .arm
        .body(last)
        .map_or([0.0; 3], |b| b.com.map(|c| 1.5 * c));
    let prior = Prior::new(
        &robot.arm,
        &robot.transmissions,
        last,
        at,
        Tolerances::default(),
    );
    MapEstimator::new(prior, config)
}

/// One span per elastic joint over the whole recording.
fn spans(robot: &Robot, deviation_rad: f64) -> Vec<OffsetSpan> {
    (0..robot.arm.dof())
        .filter(|&joint| robot.transmissions[joint].is_some())
        .map(|joint| OffsetSpan {
            joint,
            from_s: f64::NEG_INFINITY,
            to_s: f64::INFINITY,
            mean_rad: 0.0,
            deviation_rad,
        })
        .collect()
}

fn mean_temperature(blocks: &[Block]) -> f64 {
    blocks.iter().map(|b| b.temperature_c).sum::<f64>() / blocks.len().max(1) as f64
}

/// The posterior in words and units.
fn said(
    estimator: &MapEstimator,
    robot: &Robot,
    recorded: &Recorded,
    spans: &[OffsetSpan],
    map: &MapEstimate,
    recording: String,
    baseline: Option<String>,
) -> Absolute {
    let poses = distinct_poses(&recorded.blocks);
    let mut joints = Vec::new();
    for (joint, name) in robot.joint_names().iter().enumerate() {
        let Some(transmission) = &robot.transmissions[joint] else {
            continue;
        };
        // The offset at the end: the whole-recording span and every step of this joint. Variances
        // add; that they are correlated negatively makes this an upper bound.
        let (mut offset, mut variance) = (0.0, 0.0);
        let mut steps = Vec::new();
        for (k, span) in spans.iter().enumerate().filter(|(_, s)| s.joint == joint) {
            offset += map.offsets_rad[k];
            variance += map.deviations_rad[k].powi(2);
            if span.from_s.is_finite() {
                steps.push(Step {
                    time_s: span.from_s,
                    size_mrad: 1e3 * map.offsets_rad[k],
                    interval_95_mrad: 1e3 * Z95 * map.deviations_rad[k],
                });
            }
        }
        let interval = Z95 * variance.sqrt();
        let (offset_mrad, interval_95_mrad) = (1e3 * offset, 1e3 * interval);
        let verdict = if interval_95_mrad > USELESS_MRAD {
            "can't tell"
        } else if offset_mrad.abs() <= interval_95_mrad {
            "unchanged"
        } else if offset_mrad > 0.0 {
            "longer"
        } else {
            "shorter"
        };
        let tendon = transmission.tendon.as_ref();
        let [compliance, deviation] = estimator.prior().compliance(&map.nuisance, joint);
        joints.push(AbsoluteJoint {
            name: name.clone(),
            offset_mrad,
            interval_95_mrad,
            elongation_mm: tendon.map(|t| 1e3 * t.elongation_m(offset)),
            interval_95_mm: tendon.map(|t| 1e3 * t.elongation_m(interval)),
            verdict: verdict.into(),
            steps,
            stiffness_change_percent: [
                100.0 * (1.0 / (1.0 + compliance) - 1.0),
                100.0 * Z95 * deviation,
            ],
        });
    }
    let mut warnings = Vec::new();
    if poses < 3 {
        warnings.push(format!(
            "only {poses} distinct pose(s): a payload or a wrong mass can't be told from stretch; three or four poses that change every joint's torque would help"
        ));
    }
    if baseline.is_none() {
        warnings.push(
            "without a baseline the offsets are against the encoders' zero and rest on data-sheet tolerances"
                .into(),
        );
    }
    if recorded.frames_missing > 0 {
        warnings.push(format!(
            "{} frames without every position were left out",
            recorded.frames_missing
        ));
    }
    let left_out = stretches(&recorded.blocks, &map.weights);
    let blocks = recorded.blocks.len().max(1) as f64;
    let out = map.weights.iter().filter(|w| **w < HALF).count() as f64;
    let [mass, mass_deviation] = estimator.prior().payload_kg(&map.nuisance);
    Absolute {
        recording,
        baseline,
        duration_s: recorded.duration_s,
        joints,
        payload_kg: [mass, Z95 * mass_deviation],
        left_out_share: out / blocks,
        left_out,
        poses,
        damaged: recorded.damaged,
        warnings,
    }
}

/// A block of less weight counts as left out.
const HALF: f64 = 0.5;

/// Stretches of at least a second that were mostly left out, the longest first, at most 20.
fn stretches(blocks: &[Block], weights: &[f64]) -> Vec<LeftOut> {
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
