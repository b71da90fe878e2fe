//! Learning a baseline and watching with it.

use super::answer::Absolute;
use super::blocks::{AbsoluteError, Blocks, Recorded, Window, read};
use super::file::Baseline;
use super::said::said;
use crate::estimate;
use crate::estimate::{Estimate, Opened, Pass, Progress, Request};
use crate::executor::Pool;
use sinew_model::offset::{
    Belief, Block, FeatureConfig, MapError, MapEstimate, MapEstimator, Payload, Prior,
    RecursiveOffsets, SearchScope, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD, beliefs,
};
use sinew_model::robot::Robot;
use std::ops::ControlFlow;

/// A recording that begins within this time of the last one's end goes on with it, s.
const CONTINUES_S: f64 = 60.0;
/// Long recordings are estimated stretch by stretch, each from the last one's posterior, s.
const STRETCH_S: f64 = 120.0;

/// How a recording is watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WatchOptions {
    /// What may be in the gripper.
    pub payload: Payload,
    /// Whether a recorded motor torque is used.
    pub motor_torque: bool,
    /// Whether that is a current times a torque constant, which is known less well; a recording that
    /// says so needs no word here.
    pub motor_current: bool,
}

impl Default for WatchOptions {
    fn default() -> Self {
        Self {
            payload: Payload::Unknown,
            motor_torque: true,
            motor_current: false,
        }
    }
}

impl WatchOptions {
    /// For what was recorded.
    fn of(self, recorded: &Recorded) -> Self {
        Self {
            motor_current: self.motor_current || recorded.motor_current,
            ..self
        }
    }
}

/// How a baseline is learned.
#[derive(Debug, Clone, Copy)]
pub struct Learning<'a> {
    /// What is known already, a baseline with its file's name: of this robot before it was
    /// tensioned again, or of its type.
    pub known: Option<(&'a Baseline, &'a str)>,
    /// Whether a recorded motor torque is used.
    pub motor_torque: bool,
}

impl Default for Learning<'_> {
    fn default() -> Self {
        Self {
            known: None,
            motor_torque: true,
        }
    }
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
    learn_from(request, window, &Learning::default(), progress)
}

/// [`learn`], as `learning` says.
///
/// # Errors
/// [`AbsoluteError`].
pub fn learn_from(
    request: &Request,
    window: Window,
    learning: &Learning<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Baseline, Absolute), AbsoluteError> {
    let (loaded, recorded) = read(request, window, progress)?;
    let file = request.log.display().to_string();
    learn_recorded_from(&loaded.robot, &recorded, &file, learning)
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
    learn_recorded_from(robot, recorded, name, &Learning::default())
}

/// [`learn_from`] from blocks; `name` of the recording for the answer and errors.
///
/// # Errors
/// [`AbsoluteError`].
pub fn learn_recorded_from(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    learning: &Learning<'_>,
) -> Result<(Baseline, Absolute), AbsoluteError> {
    let known = learning.known;
    let options = WatchOptions {
        payload: Payload::Empty,
        motor_torque: learning.motor_torque,
        motor_current: false,
    }
    .of(recorded);
    let estimator = estimator(robot, &options);
    let prior = estimator.prior();
    let mut start = prior.belief(Payload::Empty, TENSIONED_OFFSET_RAD);
    let temperature_c = mean_temperature(&recorded.blocks);
    if let Some((known, file)) = known {
        start = known.belief(robot, prior, file)?;
        beliefs::age(prior, &mut start);
        // Zero is what the tendons are now, at this temperature.
        beliefs::refer_to(prior, &mut start, temperature_c);
        prior.open_offsets(&mut start, TENSIONED_OFFSET_RAD);
        prior.open_zero(&mut start);
        prior.open_payload(&mut start, Payload::Empty);
    }
    start.temperature_c = temperature_c;
    let nothing = SearchScope {
        offsets: false,
        payload: false,
        continues: false,
    };
    let watched = stretches(&estimator, start, recorded, &options, nothing, name)?;
    let mut baseline = Baseline::new(
        robot,
        vec![name.into()],
        recorded.end_time_ns,
        &watched.belief,
        watched.noise(),
    );
    baseline.before = known.map_or_else(Vec::new, |(known, _)| known.rests_on());
    let mut said = said(&estimator, robot, recorded, &watched, name, None);
    if said.poses < 6 {
        said.warnings.push(format!(
            "only {} distinct poses: a baseline of few poses spoils what is compared with it; move every joint through its range in a dozen poses",
            said.poses
        ));
    }
    Ok((baseline, said))
}

/// Offsets of a recording since `baseline` (with the file's name), or against the encoders' zero.
///
/// The second answer is the chain's next file: what the baseline knew and this recording taught.
///
/// # Errors
/// [`AbsoluteError`].
pub fn watch(
    request: &Request,
    window: Window,
    baseline: Option<(&Baseline, &str)>,
    options: &WatchOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Absolute, Baseline), AbsoluteError> {
    let (loaded, recorded) = read(request, window, progress)?;
    let file = request.log.display().to_string();
    watch_recorded(&loaded.robot, &recorded, &file, baseline, options)
}

/// [`watch`], and the paper's estimate ([`estimate::run`]) of the same frames: the recording is read
/// once. A CSV file asked for is written last.
///
/// # Errors
/// [`AbsoluteError`]; no file has been written then.
pub fn watch_beside_paper(
    request: &Request,
    window: Window,
    baseline: Option<(&Baseline, &str)>,
    options: &WatchOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Estimate, Absolute, Baseline), AbsoluteError> {
    let reference = estimate::reference(request, progress)?;
    let mut opened = Opened::new(request)?;
    let mut pass = Pass::new(request, &opened)?;
    let mut blocks = Blocks::new(request, window, &opened)?;
    opened.each_frame(false, progress, |frame| {
        pass.frame(frame)?;
        blocks.frame(frame);
        Ok(ControlFlow::Continue(()))
    })?;
    let recorded = blocks.finish(&opened)?;
    let file = request.log.display().to_string();
    let robot = &opened.loaded.robot;
    let (said, next) = watch_recorded(robot, &recorded, &file, baseline, options)?;
    let mut paper = pass.finish(opened)?;
    if let Some(reference) = reference {
        estimate::compare(&mut paper, &reference);
    }
    Ok((paper, said, next))
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
    options: &WatchOptions,
) -> Result<(Absolute, Baseline), AbsoluteError> {
    let options = &options.of(recorded);
    let estimator = estimator(robot, options);
    let prior = estimator.prior();
    let mut continues = false;
    let start = match baseline {
        Some((baseline, file)) => {
            let mut belief = baseline.belief(robot, prior, file)?;
            let pause_s = (recorded.start_time_ns - baseline.end_time_ns) as f64 * 1e-9;
            // A baseline's own offsets are zero by definition: what follows it is opened anew.
            continues = (-0.5..CONTINUES_S).contains(&pause_s) && baseline.recordings.len() > 1;
            if !continues {
                open(prior, &mut belief, options);
            }
            belief
        }
        None => {
            let mut fresh = prior.belief(options.payload, UNKNOWN_OFFSET_RAD);
            prior.hold_zero(&mut fresh);
            fresh.temperature_c = mean_temperature(&recorded.blocks);
            fresh
        }
    };
    let everything = SearchScope {
        offsets: true,
        payload: true,
        continues,
    };
    let watched = stretches(&estimator, start, recorded, options, everything, name)?;
    let mut recordings = baseline.map_or_else(Vec::new, |(b, _)| b.recordings.clone());
    let first = recordings.first().cloned();
    recordings.push(name.into());
    let mut next = Baseline::new(
        robot,
        recordings,
        recorded.end_time_ns,
        &watched.belief,
        watched.noise(),
    );
    next.before = baseline.map_or_else(Vec::new, |(b, _)| b.before.clone());
    let said = said(&estimator, robot, recorded, &watched, name, first);
    Ok((said, next))
}

/// The recursive form since `baseline` (with the file's name), for a robot that runs: blocks of a
/// [`FeatureObserver`](sinew_model::offset::FeatureObserver) with [`FeatureConfig::default`] go into
/// [`RecursiveOffsets::step`].
///
/// Allocates here only. `examples/live_offsets.rs` runs it sample by sample.
///
/// # Errors
/// [`AbsoluteError`] when the baseline is of another robot.
pub fn live(
    robot: &Robot,
    (baseline, file): (&Baseline, &str),
    options: &WatchOptions,
) -> Result<RecursiveOffsets, AbsoluteError> {
    let estimator = estimator(robot, options);
    let mut belief = baseline.belief(robot, estimator.prior(), file)?;
    open(estimator.prior(), &mut belief, options);
    let mut filter =
        RecursiveOffsets::new(estimator, belief).map_err(|error| AbsoluteError::Map {
            file: file.into(),
            error,
        })?;
    filter.expect_noise(&baseline.noise_rad, &baseline.motor_noise_nm);
    Ok(filter)
}

/// What `filter`, which [`live`] began from `before`, knows by `end_time_ns` of `recording`, as the next of the chain:
/// for the next [`live`] or [`watch`].
///
/// # Errors
/// [`AbsoluteError::InDoubt`] while the filter doubts what it believes.
pub fn live_saved(
    robot: &Robot,
    before: &Baseline,
    filter: &RecursiveOffsets,
    (recording, end_time_ns): (&str, i64),
) -> Result<Baseline, AbsoluteError> {
    if filter.is_provisional() {
        return Err(AbsoluteError::InDoubt {
            recording: recording.into(),
        });
    }
    let belief = filter.belief().map_err(|error| AbsoluteError::Map {
        file: recording.into(),
        error,
    })?;
    let mut recordings = before.recordings.clone();
    recordings.push(recording.into());
    let noise = filter.noise().map(<[f64]>::to_vec);
    let mut next = Baseline::new(robot, recordings, end_time_ns, &belief, noise);
    next.before.clone_from(&before.before);
    Ok(next)
}

/// What a baseline knows, some time later: offsets may be anything, and the gripper hold something
/// else.
fn open(prior: &Prior, belief: &mut Belief, options: &WatchOptions) {
    beliefs::age(prior, belief);
    prior.open_offsets(belief, UNKNOWN_OFFSET_RAD);
    prior.open_payload(belief, options.payload);
}

/// A recording estimated stretch by stretch.
pub(super) struct Watched {
    /// Before the first stretch.
    pub(super) before: Belief,
    /// After the last.
    pub(super) belief: Belief,
    /// Estimate of every stretch, with the index of its first block.
    pub(super) stretches: Vec<(usize, MapEstimate)>,
}

impl Watched {
    /// Noise of the last stretch's link (rad) and motor (N·m) equations, per joint.
    fn noise(&self) -> [Vec<f64>; 2] {
        let last = self.stretches.last();
        last.map_or_else(Default::default, |(_, map)| {
            [map.noise_rad.clone(), map.motor_noise_nm.clone()]
        })
    }
}

/// Estimates stretch by stretch, each from what the last one left.
fn stretches(
    estimator: &MapEstimator,
    start: Belief,
    recorded: &Recorded,
    options: &WatchOptions,
    scope: SearchScope,
    name: &str,
) -> Result<Watched, AbsoluteError> {
    let failed = |error: MapError| AbsoluteError::Map {
        file: name.into(),
        error,
    };
    let blocks = &recorded.blocks;
    let mut belief = start.clone();
    let mut out = Vec::new();
    let mut from = 0;
    while from < blocks.len() {
        // The last stretch is never a short one: what is left over joins the one before.
        let end_s = blocks[from].time_s + STRETCH_S;
        let mut to = from + blocks[from..].partition_point(|b| b.time_s < end_s);
        if blocks
            .last()
            .is_some_and(|b| b.time_s < end_s + 0.5 * STRETCH_S)
        {
            to = blocks.len();
        }
        let scope = SearchScope {
            continues: scope.continues || from > 0,
            ..scope
        };
        let map = estimator
            .search(&belief, &blocks[from..to], options.payload, scope)
            .map_err(failed)?;
        belief = map.belief(estimator.prior());
        out.push((from, map));
        from = to;
    }
    if out.is_empty() {
        return Err(failed(MapError::NoData));
    }
    Ok(Watched {
        before: start,
        belief,
        stretches: out,
    })
}

/// The estimator of a robot. The payload is expected half as far again from the last joint as that
/// body's own centre of mass, where a gripper holds things.
pub fn estimator(robot: &Robot, options: &WatchOptions) -> MapEstimator {
    let last = robot.arm.dof().saturating_sub(1);
    let at = robot
        .arm
        .body(last)
        .map_or([0.0; 3], |b| b.com.map(|c| 1.5 * c));
    let mut tolerances = robot.tolerances;
    if options.motor_current {
        tolerances.motor_torque = tolerances.motor_current;
    }
    let prior = Prior::new(&robot.arm, &robot.transmissions, last, at, tolerances);
    MapEstimator::new(prior, &FeatureConfig::default())
        .with_motor_torque(options.motor_torque)
        .with_executor(&Pool)
}

pub(super) fn mean_temperature(blocks: &[Block]) -> f64 {
    blocks.iter().map(|b| b.temperature_c).sum::<f64>() / blocks.len().max(1) as f64
}
