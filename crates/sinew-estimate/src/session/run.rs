//! Learning a baseline, and estimating a session with it.

use super::anchor;
use super::context::Context;
use super::predictive::PredictiveCheck;
use super::recent::Given;
use super::recorder::{Blocks, Recorded, Window, read};
use super::result::{SessionEstimate, TemperatureSource};
use super::revisits;
use super::segments::Segments;
use super::summary::{summarise, utc_s};
use super::warning::Warning;
use super::{sides, temperature, witness, zero};
use crate::baseline::Baseline;
use crate::error::SessionError;
use crate::estimator::{SessionOptions, estimator, mean_temperature};
use crate::recording::Opened;
use crate::replay;
use crate::replay::{Estimate, Pass};
use crate::request::{Progress, Request};
use sinew_model::offset::{
    Belief, JointParameter, MapEstimator, Payload, Prior, SearchScope, SharedError,
    TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD, beliefs,
};
use sinew_model::robot::Robot;
use sinew_model::{Gaussian, Z95};
use std::borrow::Cow;
use std::ops::ControlFlow;

/// A recording that begins within this time of the last one's end goes on with it, s.
const CONTINUES_S: f64 = 60.0;
/// A baseline of fewer distinct poses spoils what is compared with it.
const POSES_OF_BASELINE: usize = 6;

/// How a baseline is learned.
#[derive(Debug, Clone, Copy)]
pub struct Learning<'a> {
    /// What is known already, a baseline with its file's name: of this robot before it was
    /// tensioned again, or of its type.
    pub known: Option<(&'a Baseline, &'a str)>,
    /// Whether a recorded motor torque is used.
    pub motor_torque: bool,
    /// Temperature during the recording, °C, where it is stated instead of recorded.
    pub temperature_c: Option<Gaussian>,
    /// Joints whose ropes were tensioned while the encoders stayed as they were: their offsets are zero now,
    /// wherever their encoders are. The other joints' offsets are estimated along, and go on counting from
    /// before. `None`: all were, and the encoders were zeroed then as well as robot.toml says.
    pub tensioned: Option<&'a [usize]>,
    /// Whether the recording goes on with the one that `known` was learned from: of one tensioning,
    /// minutes apart. Nothing is opened then.
    pub continues: bool,
}

impl Default for Learning<'_> {
    fn default() -> Self {
        Self {
            known: None,
            motor_torque: true,
            temperature_c: None,
            tensioned: None,
            continues: false,
        }
    }
}

/// What a recording has to do with those before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Since {
    /// It comes so many days later: offsets and payload are opened anew, friction and the rest may have
    /// changed as much as they do in that time.
    Days(f64),
    /// It goes on where the last one ended, and nothing is opened.
    Now,
}

/// Learns a baseline from a recording taken right after tensioning, the gripper empty.
///
/// # Errors
/// [`SessionError`].
pub fn learn(
    request: &Request,
    window: Window,
    learning: &Learning<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Baseline, SessionEstimate), SessionError> {
    let (loaded, recorded) = read(request, window, progress)?;
    learn_recorded(&loaded.robot, &recorded, &request.name(), learning)
}

/// [`learn`] from blocks; `name` of the recording for the result and errors.
///
/// # Errors
/// [`SessionError`].
pub fn learn_recorded(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    learning: &Learning<'_>,
) -> Result<(Baseline, SessionEstimate), SessionError> {
    let known = learning.known;
    let options = SessionOptions {
        payload: Payload::Empty,
        motor_torque: learning.motor_torque,
        motor_current: false,
        temperature_c: learning.temperature_c,
        external_force_n: None,
        creep: false,
    };
    let session = Session::new(robot, recorded, &options);
    let (recorded, estimator) = (&*session.recorded, &session.estimator);
    let prior = estimator.prior();
    sides::check(robot, prior, recorded, Payload::Empty, name)?;
    let mut start = prior.belief(Payload::Empty, TENSIONED_OFFSET_RAD);
    let temperature_c = mean_temperature(&recorded.blocks);
    if let Some((known, file)) = known {
        start = known.belief(robot, prior, file)?;
        if !learning.continues {
            beliefs::age(prior, &mut start);
            prior.open_payload(&mut start, Payload::Empty);
        }
    } else if learning.tensioned.is_some() {
        prior.hold_zero(&mut start);
    }
    match learning.tensioned {
        _ if learning.continues => {}
        Some(joints) => {
            prior.open_offsets(&mut start, UNKNOWN_OFFSET_RAD);
            for joint in joints {
                prior.tension(&mut start, *joint);
            }
            // The others' offsets stay those of the temperature they were.
            if !start.temperature_c.is_finite() {
                start.temperature_c = temperature_c;
            }
        }
        None => {
            if known.is_some() {
                // Zero is what the tendons are now, at this temperature.
                beliefs::refer_to(prior, &mut start, temperature_c);
                prior.open_offsets(&mut start, TENSIONED_OFFSET_RAD);
                prior.open_zero(&mut start);
            }
            start.temperature_c = temperature_c;
        }
    }
    let nothing = SearchScope {
        offsets: false,
        payload: false,
        creep: false,
        continues: false,
        onset: None,
    };
    let payload = Payload::Empty;
    let from = |start| Segments::estimate(estimator, start, recorded, &[], payload, nothing, name);
    // Only a fresh zero is a matter of what robot.toml says.
    let stated = known.is_none() && learning.tensioned.is_none();
    let opened = match stated {
        true => zero::opened(robot, prior, &start, from)?,
        false => None,
    };
    let (segments, not_zeroed) = match opened {
        Some(opened) => opened,
        None => (from(start)?, Vec::new()),
    };
    let mut baseline = Baseline::new(
        robot,
        vec![name.into()],
        recorded.end_time_ns,
        &segments.learned(prior),
        segments.noise(),
    );
    baseline.temperature_deviation_k = learning.temperature_c.map_or(0.0, |t| t.deviation);
    match known {
        Some((known, _)) if learning.continues => {
            baseline.recordings.clone_from(&known.recordings);
            baseline.before.clone_from(&known.before);
            baseline.zero_time_ns = known.zero_time();
        }
        Some((known, _)) => baseline.before = known.rests_on(),
        None => {}
    }
    let mut estimate = session.summarise(&segments, name, None, &[], &[], 0.0);
    baseline.anchors = anchor::readings(robot, recorded, estimator, &segments);
    if let Some((known, _)) = known.filter(|_| learning.continues) {
        anchor::keep(&mut baseline.anchors, &known.anchors);
    }
    estimate.warnings.extend(not_zeroed);
    if estimate.poses < POSES_OF_BASELINE {
        estimate.warnings.push(Warning::FewPosesOfBaseline {
            poses: estimate.poses,
        });
    }
    Ok((baseline, estimate))
}

/// Offsets of a recording since `baseline` (with the file's name), or against the encoders' zero.
///
/// The second result is the chain's next file: what the baseline knew and this recording taught.
///
/// # Errors
/// [`SessionError`].
pub fn estimate(
    request: &Request,
    window: Window,
    baseline: Option<(&Baseline, &str)>,
    options: &SessionOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<(SessionEstimate, Baseline), SessionError> {
    let (loaded, recorded) = read(request, window, progress)?;
    let file = request.name();
    estimate_recorded(&loaded.robot, &recorded, &file, baseline, options)
}

/// [`estimate`], and the paper's estimate ([`replay::run`]) of the same frames: the recording is read
/// once. `also` may add to the result what it makes of the blocks. A CSV file asked for is written last.
///
/// # Errors
/// [`SessionError`]; no file has been written then.
pub fn estimate_with_replay(
    request: &Request,
    window: Window,
    baseline: Option<(&Baseline, &str)>,
    options: &SessionOptions,
    also: &dyn Fn(&Robot, &Recorded, &mut SessionEstimate) -> Result<(), SessionError>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Estimate, SessionEstimate, Baseline), SessionError> {
    let reference = replay::reference(request, progress)?;
    let mut opened = Opened::new(request)?;
    let mut pass = Pass::new(request, &opened)?;
    let mut blocks = Blocks::new(request, window, &opened)?;
    opened.each_frame(false, progress, |frame| {
        pass.frame(frame)?;
        blocks.frame(frame);
        Ok(ControlFlow::Continue(()))
    })?;
    let recorded = blocks.finish(&opened)?;
    let file = request.name();
    let robot = &opened.loaded.robot;
    let (mut session, next) = estimate_recorded(robot, &recorded, &file, baseline, options)?;
    also(robot, &recorded, &mut session)?;
    let mut paper = pass.finish(opened)?;
    if let Some(reference) = reference {
        replay::compare(&mut paper, &reference);
    }
    Ok((paper, session, next))
}

/// [`estimate`] from blocks; `name` of the recording for the result and errors.
///
/// Both sides are taken as stamped together, unless friction is such at every joint as one side's lag would show:
/// then the lag is estimated along, and a warning says so.
///
/// A stated payload or force is believed unless the recording contradicts it: where much fits nothing with it, and half
/// as much without, it is estimated instead, and a warning says so.
///
/// # Errors
/// [`SessionError`].
pub fn estimate_recorded(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    baseline: Option<(&Baseline, &str)>,
    options: &SessionOptions,
) -> Result<(SessionEstimate, Baseline), SessionError> {
    let since = match continues(baseline.map(|(baseline, _)| baseline), recorded) {
        true => Since::Now,
        false => Since::Days(1.0),
    };
    estimate_stretch(robot, recorded, name, (baseline, since), options)
}

/// Whether a recording goes on where the last one of `baseline` ended.
pub(crate) fn continues(baseline: Option<&Baseline>, recorded: &Recorded) -> bool {
    baseline.is_some_and(|baseline| {
        let pause_s = (recorded.start_time_ns - baseline.end_time_ns) as f64 * 1e-9;
        // A baseline's own offsets are zero by definition: what follows it is opened anew.
        (-0.5..CONTINUES_S).contains(&pause_s) && baseline.recordings.len() > 1
    })
}

/// [`estimate_recorded`] by somebody who knows what the recording has to do with the baseline.
///
/// # Errors
/// [`SessionError`].
pub fn estimate_stretch(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    baseline: (Option<(&Baseline, &str)>, Since),
    options: &SessionOptions,
) -> Result<(SessionEstimate, Baseline), SessionError> {
    let solved = solve_stretch(robot, recorded, name, baseline, options)?;
    Ok((solved.estimate, solved.next))
}

/// An estimate with what it was made with.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub(crate) estimate: SessionEstimate,
    /// The chain's next file.
    pub(crate) next: Baseline,
    pub(crate) estimator: MapEstimator,
    /// The last seconds against the estimate, for blocks that come after them.
    pub(crate) check: PredictiveCheck,
    /// What a temperature that is not known adds to the deviation of every joint's offset, rad; empty: it is known.
    pub(crate) unknown_temperature_rad: Vec<f64>,
}

/// [`estimate_stretch`], with the posterior and the estimator that made it.
pub(crate) fn solve_stretch(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    baseline: (Option<(&Baseline, &str)>, Since),
    options: &SessionOptions,
) -> Result<Solved, SessionError> {
    /// More than this that fits nothing makes a stated payload suspect, rad.
    const SUSPECT_RAD: f64 = 2e-3;
    let worst = |solved: &Solved| {
        let misfits = solved.estimate.joints.iter().map(|j| j.misfit_rad);
        misfits.fold(0.0, f64::max)
    };
    let estimate_as_stated = |options: &SessionOptions| {
        let as_one = estimate_with_lag(robot, recorded, name, baseline, options, 0.0)?;
        let late = as_one
            .estimate
            .warnings
            .iter()
            .find_map(|warning| match warning {
                Warning::SidesOutOfStep { motor_late_s } => Some(motor_late_s.mean.abs()),
                _ => None,
            });
        match late {
            None => Ok(as_one),
            Some(late_s) => estimate_with_lag(robot, recorded, name, baseline, options, late_s),
        }
    };
    let stated = estimate_as_stated(options)?;
    let suspect_rad = worst(&stated);
    if suspect_rad < SUSPECT_RAD {
        return Ok(stated);
    }
    // One statement alone first, then both.
    let (payload, force) = (
        options.payload != Payload::Unknown,
        options.external_force_n.is_some(),
    );
    let doubts = [(payload, false), (false, force), (payload, force)];
    let mut doubted = Vec::new();
    for (payload, force) in doubts {
        if !(payload || force) || doubted.contains(&(payload, force)) {
            continue;
        }
        doubted.push((payload, force));
        let mut open = *options;
        if payload {
            open.payload = Payload::Unknown;
        }
        if force {
            open.external_force_n = None;
        }
        let mut opened = estimate_as_stated(&open)?;
        if worst(&opened) > 0.5 * suspect_rad {
            continue;
        }
        let said = &mut opened.estimate;
        if payload {
            let payload_kg = said.payload_kg;
            said.warnings
                .push(Warning::PayloadContradicted { payload_kg });
        }
        if force {
            let found = said.external_force.map(|found| found.force_n);
            said.warnings
                .push(Warning::ExternalForceContradicted { force_n: found });
        }
        return Ok(opened);
    }
    Ok(stated)
}

/// [`estimate_recorded`], whatever is stated taken as true, and the lag between the sides as `0 ± lag_s`.
fn estimate_with_lag(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    (baseline, since): (Option<(&Baseline, &str)>, Since),
    options: &SessionOptions,
    lag_s: f64,
) -> Result<Solved, SessionError> {
    let session = Session::new(robot, recorded, options);
    let (recorded, estimator) = (&*session.recorded, &session.estimator);
    let prior = estimator.prior();
    sides::check(robot, prior, recorded, options.payload, name)?;
    let (mut change_k, mut added_rad) = (0.0, Vec::new());
    // What every session since the baseline begins with.
    let common: Belief;
    let mut start = match baseline {
        Some((baseline, file)) => {
            let mut belief = baseline.belief(robot, prior, file)?;
            common = belief.clone();
            let source = session.temperature;
            match since {
                Since::Now => {
                    change_k = baseline.change_deviation_k;
                    // The stiffness is as wide already; the zero's drift never is in a belief.
                    added_rad = beliefs::unknown_temperature(prior, &mut belief.clone(), change_k);
                }
                Since::Days(days) => {
                    change_k = temperature::change_deviation_k(robot, baseline, source, options);
                    beliefs::age_by(prior, &mut belief, days);
                    added_rad = open(prior, &mut belief, options, change_k);
                    let to_c = mean_temperature(&recorded.blocks);
                    temperature::expect_retraction(robot, prior, &mut belief, to_c);
                }
            }
            belief
        }
        None => {
            let mut fresh = prior.belief(options.payload, UNKNOWN_OFFSET_RAD);
            prior.hold_zero(&mut fresh);
            fresh.temperature_c = mean_temperature(&recorded.blocks);
            common = fresh.clone();
            fresh
        }
    };
    prior.open_lag(&mut start, lag_s);
    let everything = SearchScope {
        offsets: true,
        payload: true,
        creep: options.creep,
        continues: baseline.is_some() && since == Since::Now,
        onset: None,
    };
    let payload = options.payload;
    // Since a baseline of like motion what the model gets wrong cancels. Without one it is all of what is read.
    let visits = match baseline {
        Some(_) => Vec::new(),
        None => revisits::visits(&recorded.blocks),
    };
    let mut segments = Segments::estimate(
        estimator, start, recorded, &visits, payload, everything, name,
    )?;
    let given = Given {
        estimator,
        recorded,
        visits: &visits,
        payload,
        scope: everything,
    };
    let checked = given.check_recent(&mut segments);
    let check = checked.map_err(|error| SessionError::Map {
        file: name.into(),
        error,
    })?;
    let mut recordings = baseline.map_or_else(Vec::new, |(b, _)| b.recordings.clone());
    let first = recordings.first().cloned();
    recordings.push(name.into());
    let mut next = Baseline::new(
        robot,
        recordings,
        recorded.end_time_ns,
        &segments.learned(prior),
        segments.noise(),
    );
    if let Some((baseline, _)) = baseline {
        next.before.clone_from(&baseline.before);
        next.zero_time_ns = baseline.zero_time();
        next.temperature_deviation_k = baseline.temperature_deviation_k;
        next.change_deviation_k = change_k;
        next.anchors.clone_from(&baseline.anchors);
    }
    let shared = segments.shared_errors(prior, &common, everything.continues, name)?;
    let mut estimate = session.summarise(&segments, name, first, &added_rad, &shared, lag_s);
    estimate.baseline_time_utc_s = next.zero_time_ns.and_then(utc_s);
    let touched = anchor::readings(robot, recorded, estimator, &segments);
    anchor::apply(robot, &touched, baseline.map(|(b, _)| b), &mut estimate);
    // What an anchor takes off is taken off the shared part, too.
    for joint in &mut estimate.joints {
        let whole_rad = joint.offset_rad.deviation;
        joint.shared_error = joint.shared_error.map(|part| part.at_most(whole_rad));
    }
    let unknown = session.temperature == TemperatureSource::Unknown
        || baseline.is_some_and(|(b, _)| b.temperature_c.is_none());
    let most = (added_rad.iter().enumerate()).max_by(|a, b| a.1.total_cmp(b.1));
    if let Some((joint, added_rad)) = most.filter(|(_, added)| unknown && **added > 0.0) {
        estimate.warnings.push(Warning::TemperatureUnknown {
            deviation_k: change_k,
            joint: robot.tendon_name(joint).to_owned(),
            half_width_95_rad: Z95 * added_rad,
        });
    }
    if let (Some(now_c), Some(then_c)) = (estimate.temperature_c, estimate.reference_temperature_c)
    {
        let drift = |i: usize| {
            let at = prior.place(i, JointParameter::Drift);
            segments.belief.entry(at).deviation
        };
        let width = |i: usize| {
            let name = robot.tendon_name(i);
            let joint = estimate.joints.iter().find(|j| j.name == name);
            joint.map_or(f64::INFINITY, |j| j.offset_rad.half_width_95())
        };
        let warning = temperature::unknown_drift(robot, drift, width, now_c - then_c);
        estimate.warnings.extend(warning);
    }
    Ok(Solved {
        estimate,
        next,
        check,
        estimator: session.estimator,
        unknown_temperature_rad: match unknown {
            true => added_rad,
            false => Vec::new(),
        },
    })
}

/// What a baseline knows, in another recording: offsets may be anything, the gripper hold something else, and the
/// temperature be another by `change_k`, a standard deviation. Returns what that leaves unknown of every joint's
/// offset, rad.
fn open(prior: &Prior, belief: &mut Belief, options: &SessionOptions, change_k: f64) -> Vec<f64> {
    prior.open_offsets(belief, UNKNOWN_OFFSET_RAD);
    prior.open_payload(belief, options.payload);
    beliefs::unknown_temperature(prior, belief, change_k)
}

/// A recording as far as it can be believed, and the estimator that goes with it.
struct Session<'a> {
    robot: &'a Robot,
    recorded: Cow<'a, Recorded>,
    estimator: MapEstimator,
    temperature: TemperatureSource,
    left_out: Vec<Warning>,
}

impl<'a> Session<'a> {
    fn new(robot: &'a Robot, recorded: &'a Recorded, options: &SessionOptions) -> Self {
        let mut recorded = Cow::Borrowed(recorded);
        if options.temperature_c.is_some() {
            temperature::state(recorded.to_mut(), options);
        }
        let left_out = match options.motor_torque {
            true => witness::leave_out_false(robot, &mut recorded),
            false => Vec::new(),
        };
        let options = &SessionOptions {
            motor_current: options.motor_current || recorded.motor_current,
            ..*options
        };
        Self {
            robot,
            estimator: estimator(robot, options),
            temperature: temperature::source(&recorded, options),
            recorded,
            left_out,
        }
    }

    /// The result; `added_rad`: what is unknown of every joint's offset and looks the same in every block;
    /// `shared`: what of its error comes with the baseline; `lag_s`: by how much the lag between the sides was opened.
    fn summarise(
        &self,
        segments: &Segments,
        name: &str,
        baseline: Option<String>,
        added_rad: &[f64],
        shared: &[SharedError],
        lag_s: f64,
    ) -> SessionEstimate {
        let context = Context {
            estimator: &self.estimator,
            robot: self.robot,
            recorded: &self.recorded,
            segments,
            added_rad,
            shared,
            lag_s,
        };
        let mut estimate = summarise(&context, name, baseline);
        estimate.temperature_source = self.temperature;
        estimate.warnings.extend(self.left_out.iter().cloned());
        estimate
    }
}
