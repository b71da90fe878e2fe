//! Estimation of a baseline, and of a session relative to it.

use super::anchor;
use super::cables;
use super::context::Context;
use super::frozen_encoder;
use super::parts::Parts;
use super::poses::MIN_BASELINE_POSES;
use super::predictive::PredictiveCheck;
use super::recent::RecentCheck;
use super::recorder::{EncoderCorrection, Recorded, Window, read_parts};
use super::repeated_motion;
use super::result::{SessionEstimate, TemperatureSource, Verdict};
use super::segments::{Chained, Segments};
use super::summary::{summarise, utc_s};
use super::transmission_loss::{self, TransmissionLoss};
use super::warning::Warning;
use super::{independent_torque, sides, temperature, zero};
use crate::anchored;
use crate::baseline::Baseline;
use crate::cause::Cause;
use crate::error::{EstimateError, SessionError};
use crate::estimator::{SessionOptions, estimator, mean_temperature};
use crate::recording::Opened;
use crate::replay;
use crate::replay::{Estimate, Pass};
use crate::request::{Progress, Request};
use crate::warning::RecordingWarning;
use sinew_log::Frame;
use sinew_model::offset::{
    JointParameter, MapError, MapEstimator, Payload, Prior, SearchScope, SharedError,
    StateEstimate, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD, state_estimates, stated_payload,
};
use sinew_model::robot::Robot;
use sinew_model::tendons::Routings;
use sinew_model::{Gaussian, Z95};
use std::borrow::Cow;
use std::ops::ControlFlow;

/// Maximum pause between the end of a recording and the start of one that continues it, s.
const MAX_PAUSE_S: f64 = 60.0;

/// Options of the estimation of a baseline.
#[derive(Debug, Clone, Copy)]
pub struct Learning<'a> {
    /// Prior: an earlier baseline with the name of its file, of this robot before it was re-tensioned or of
    /// its type; `None`: tolerances in robot.toml.
    pub prior: Option<(&'a Baseline, &'a str)>,
    /// Whether a recorded motor torque is used.
    pub motor_torque: bool,
    /// Specified temperature during the recording, °C; `None`: as recorded.
    pub temperature_c: Option<Gaussian>,
    /// Indices of the joints whose ropes were re-tensioned without zeroing the encoders: their offsets are zero now,
    /// for any encoder zero. The offsets of the other joints are estimated jointly, and keep their previous
    /// reference. `None`: all ropes were tensioned, and the encoders were zeroed within the tolerance in robot.toml.
    pub tensioned: Option<&'a [usize]>,
    /// Whether the recording continues the one of the prior baseline, minutes later and with the same tension.
    /// No prior variance is reset then.
    pub continues: bool,
}

impl Default for Learning<'_> {
    fn default() -> Self {
        Self {
            prior: None,
            motor_torque: true,
            temperature_c: None,
            tensioned: None,
            continues: false,
        }
    }
}

/// Time relation of a recording to the previous session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Since {
    /// Start after a gap, in days. The prior variances of offsets and payload are reset; those of friction and the
    /// other parameters grow with the gap.
    Days(f64),
    /// Continuation of the previous recording without a gap; no prior variance is reset.
    Now,
}

/// Estimates a baseline from a recording made directly after tensioning with an empty gripper.
///
/// # Errors
/// Returns a [`SessionError`] if the recording or robot is invalid, if the prior baseline does not belong to the robot,
/// or if the estimate fails.
pub fn learn(
    request: &Request,
    window: Window,
    learning: &Learning<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Baseline, SessionEstimate), SessionError> {
    learn_runs(std::slice::from_ref(request), window, learning, progress)
}

/// Estimates a baseline from several recordings made directly after tensioning, with a load each.
///
/// The first recording has an empty gripper, and determines the parameters of the arm as [`learn`]. The further ones add
/// loads for tendons with friction along their path.
///
/// # Errors
/// As [`learn`]; [`EstimateError::Mismatch`] for further recordings of a robot without such tendons.
pub fn learn_runs(
    requests: &[Request],
    window: Window,
    learning: &Learning<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Baseline, SessionEstimate), SessionError> {
    let Some((first, further)) = requests.split_first() else {
        return Err(EstimateError::Mismatch {
            file: "baseline".into(),
            reason: "no recording specified; specify at least one".into(),
        }
        .into());
    };
    let mut also = |_: &_| Ok(ControlFlow::Break(()));
    let name = first.name();
    let mut recordings = Vec::new();
    let mut learned: Option<Learned> = None;
    let mut whole = Parts::default();
    let mut opened = Opened::new(first)?;
    let part = (window, &[][..]);
    read_parts(
        first,
        &mut opened,
        part,
        progress,
        &mut also,
        &mut |robot, recorded| {
            let mut part = learn_part(robot, recorded, &name, learning, learned.take())?;
            whole.add(recorded, &mut part.estimate);
            learned = Some(part);
            if !robot.cables.is_empty() {
                recordings.push((recorded.clone(), name.clone()));
            }
            Ok(())
        },
    )?;
    let robot = &opened.loaded.robot;
    for request in further {
        if robot.cables.is_empty() {
            return Err(EstimateError::Mismatch {
                file: request.name(),
                reason: "is a further recording of a baseline, but robot.toml has no joint with friction_along_path = true, which alone requires several loads; specify one recording".into(),
            }
            .into());
        }
        let mut opened = Opened::new(request)?;
        read_parts(
            request,
            &mut opened,
            part,
            progress,
            &mut also,
            &mut |_, recorded| {
                recordings.push((recorded.clone(), request.name()));
                Ok(())
            },
        )?;
    }
    let (Some(Learned { mut baseline, .. }), Some(mut estimate)) = (learned, whole.finish()) else {
        return Err(SessionError::Map {
            file: name,
            error: MapError::NoData,
        });
    };
    baseline.cables = cables::learn(robot, &recordings)?;
    if let Some((recorded, name)) = recordings.first() {
        // The first recording relative to all of them, for the parameters in the result.
        let of = (recorded, name.as_str());
        cables::add(robot, of, Some((&baseline, name)), &mut estimate)?;
    }
    for (further, _) in recordings.iter().skip(1) {
        estimate.damaged |= further.damaged;
    }
    Ok((baseline, estimate))
}

/// Estimates a baseline from blocks, as [`learn`]; `name` is that of the recording in the result and in errors.
///
/// # Errors
/// As [`learn`], except for errors of the recording file.
pub fn learn_recorded(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    learning: &Learning<'_>,
) -> Result<(Baseline, SessionEstimate), SessionError> {
    let learned = learn_part(robot, recorded, name, learning, None)?;
    Ok((learned.baseline, learned.estimate))
}

/// Baseline from a recording up to the end of one of its parts.
struct Learned {
    baseline: Baseline,
    /// Result of the last part.
    estimate: SessionEstimate,
    chained: Chained,
}

/// Estimates a baseline from a part of a recording that follows `before`, or from a whole recording.
fn learn_part(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    learning: &Learning<'_>,
    before: Option<Learned>,
) -> Result<Learned, SessionError> {
    let earlier = learning.prior;
    let options = SessionOptions {
        payload: Payload::Empty,
        motor_torque: learning.motor_torque,
        motor_current: false,
        temperature_c: learning.temperature_c,
        external_force_n: None,
        creep: false,
    };
    sides::check_scales(robot, recorded, name)?;
    let session = Session::new(robot, recorded, &options);
    if let Some(loss) = session.losses.first() {
        return Err(SessionError::TransmissionLost {
            file: name.into(),
            joint: robot.tendon_name(loss.joint).to_owned(),
            time_s: loss.since_s,
        });
    }
    let (recorded, estimator) = (&*session.recorded, &session.estimator);
    let prior = estimator.prior();
    sides::check(robot, prior, recorded, Payload::Empty, name)?;
    let mut start = prior.state_estimate(Payload::Empty, TENSIONED_OFFSET_RAD);
    let temperature_c = mean_temperature(&recorded.blocks);
    if let Some((previous, file)) = earlier {
        start = previous.state_estimate(robot, prior, file)?;
        if !learning.continues {
            state_estimates::age(prior, &mut start);
            prior.reset_payload(&mut start, Payload::Empty);
        }
    } else if learning.tensioned.is_some() {
        prior.hold_zero(&mut start);
    }
    match learning.tensioned {
        _ if learning.continues || before.is_some() => {}
        Some(joints) => {
            prior.reset_offsets(&mut start, UNKNOWN_OFFSET_RAD);
            for joint in joints {
                prior.tension(&mut start, *joint);
            }
            // The offsets of the other joints keep their reference temperature.
            if !start.temperature_c.is_finite() {
                start.temperature_c = temperature_c;
            }
        }
        None => {
            if earlier.is_some() {
                // The present state of the tendons at this temperature is the new zero.
                state_estimates::refer_to(prior, &mut start, temperature_c);
                prior.reset_offsets(&mut start, TENSIONED_OFFSET_RAD);
                prior.reset_zero(&mut start);
            }
            start.temperature_c = temperature_c;
        }
    }
    if let Some(before) = &before {
        start.clone_from(&before.chained.state_estimate);
    }
    let no_changes = SearchScope {
        offsets: false,
        payload: false,
        creep: false,
        continues: before.is_some(),
        onset: None,
    };
    let payload = Payload::Empty;
    let from = |start| {
        Segments::estimate(
            (robot, estimator),
            start,
            recorded,
            &[],
            payload,
            no_changes,
            name,
        )
    };
    // Only a new encoder zero is specified by robot.toml.
    let is_specified = earlier.is_none() && learning.tensioned.is_none() && before.is_none();
    let free_zero = match is_specified {
        true => zero::estimate_zero(robot, prior, &start, from)?,
        false => None,
    };
    let (mut segments, zero_warnings) = match free_zero {
        Some(estimate) => estimate,
        None => (from(start)?, Vec::new()),
    };
    let before_part = before.as_ref().map(|before| &before.chained);
    if let Some(before) = before_part {
        segments.follow(before);
    }
    let touched = anchor::readings(robot, recorded, estimator, &segments);
    let chained = segments.chained(before_part, touched);
    let mut baseline = Baseline::new(
        robot,
        vec![name.into()],
        recorded.end_time_ns,
        &chained.learned(prior),
        segments.noise(),
    );
    baseline.model_error = match &before {
        // That of the first part: the errors of further parts are not independent of it.
        Some(before) => before.baseline.model_error.clone(),
        None => {
            let model_error = segments.model_error(estimator, &recorded.blocks);
            model_error.map_err(|error| SessionError::Map {
                file: name.into(),
                error,
            })?
        }
    };
    baseline.temperature_std_k = learning.temperature_c.map_or(0.0, |t| t.std);
    match earlier {
        Some((previous, _)) if learning.continues => {
            baseline.recordings.clone_from(&previous.recordings);
            baseline.before.clone_from(&previous.before);
            baseline.zero_time_ns = previous.zero_time();
            baseline.model_error.clone_from(&previous.model_error);
        }
        Some((previous, _)) => baseline.before = previous.based_on(),
        None => {}
    }
    let mut estimate = session.summarise(&segments, name, None, &[], &[], (0.0, None));
    baseline.anchors.clone_from(&chained.touched);
    if let Some((previous, _)) = earlier.filter(|_| learning.continues) {
        anchored::keep(&mut baseline.anchors, &previous.anchors);
    }
    estimate.warnings.extend(zero_warnings);
    if estimate.poses < MIN_BASELINE_POSES {
        estimate.warnings.push(Warning::FewPosesOfBaseline {
            poses: estimate.poses,
        });
    }
    Ok(Learned {
        baseline,
        estimate,
        chained,
    })
}

/// Estimates the offsets of a recording since `baseline` (with the name of its file), or relative to the encoder zero.
///
/// The second result is the posterior as the next file of the chain, from the baseline and this recording.
///
/// # Errors
/// Returns [`SessionError::Baseline`] if the baseline does not belong to the robot, and another [`SessionError`] if the
/// recording or robot is invalid or the estimate fails.
pub fn estimate(
    request: &Request,
    window: Window,
    baseline: Option<(&Baseline, &str)>,
    options: &SessionOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<(SessionEstimate, Baseline), SessionError> {
    let mut also = |_: &_| Ok(ControlFlow::Break(()));
    let run = Run {
        request,
        window,
        baseline,
        options,
    };
    let mut opened = Opened::new(request)?;
    let found = run.estimate(&mut opened, &[], progress, &mut also, &mut |_| {})?;
    run.corrected(&opened.loaded.robot, found, progress)
}

/// Estimate of a recording file, part by part.
struct Run<'a> {
    request: &'a Request,
    window: Window,
    baseline: Option<(&'a Baseline, &'a str)>,
    options: &'a SessionOptions,
}

impl Run<'_> {
    /// Estimates an opened recording. `also` processes every frame; `each` processes every part.
    fn estimate(
        &self,
        opened: &mut Opened,
        corrections: &[EncoderCorrection],
        progress: &mut dyn FnMut(Progress),
        also: &mut dyn FnMut(&Frame) -> Result<ControlFlow<()>, EstimateError>,
        each: &mut dyn FnMut(&Recorded),
    ) -> Result<(SessionEstimate, Baseline), SessionError> {
        let &Self {
            request,
            window,
            baseline,
            options,
        } = self;
        let name = request.name();
        let mut whole = Parts::default();
        let mut last: Option<Solved> = None;
        let part = (window, corrections);
        read_parts(
            request,
            opened,
            part,
            progress,
            also,
            &mut |robot, recorded| {
                each(recorded);
                // Every part starts at the baseline: the model errors of a motion that repeats are the same in all parts, so
                // that a posterior of several parts would be too narrow.
                let since = since(baseline.map(|(baseline, _)| baseline), recorded);
                let start = (baseline, since);
                let mut solved = solve_stretch(robot, recorded, &name, start, options)?;
                cables::add(robot, (recorded, &name), baseline, &mut solved.estimate)?;
                whole.add(recorded, &mut solved.estimate);
                last = Some(solved);
                Ok(())
            },
        )?;
        match (whole.finish(), last) {
            (Some(estimate), Some(last)) => Ok((estimate, last.next)),
            _ => Err(SessionError::Map {
                file: name,
                error: MapError::NoData,
            }),
        }
    }

    /// Repeats an estimate with the poses corrected, if the encoder of a joint slipped.
    fn corrected(
        &self,
        robot: &Robot,
        found: (SessionEstimate, Baseline),
        progress: &mut dyn FnMut(Progress),
    ) -> Result<(SessionEstimate, Baseline), SessionError> {
        let corrections = encoder_corrections(robot, &found.0);
        if corrections.is_empty() {
            return Ok(found);
        }
        let mut also = |_: &_| Ok(ControlFlow::Break(()));
        let mut opened = Opened::new(self.request)?;
        self.estimate(&mut opened, &corrections, progress, &mut also, &mut |_| {})
    }
}

/// Corrections of the poses of the arm for the slips of joint encoders in an estimate.
///
/// After such a slip gravity is computed at the wrong pose, which changes the apparent size of the slip and the
/// apparent stiffness; the recording is read again with the corrections.
fn encoder_corrections(robot: &Robot, found: &SessionEstimate) -> Vec<EncoderCorrection> {
    // A joint that shares tendons with others has no position of its own to correct.
    if Routings::of(&robot.transmissions).is_some() {
        return Vec::new();
    }
    let slips = found.joints.iter().flat_map(|joint| {
        let own = joint.changes.iter();
        let own = own.filter(|c| c.cause == Some(Cause::JointEncoder));
        own.map(|c| (joint.name.as_str(), c))
    });
    slips
        .filter_map(|(name, change)| {
            Some(EncoderCorrection {
                joint: robot.tendon_index(name)?,
                from_s: change.time_s,
                size_rad: change.size_rad?.mean,
            })
        })
        .collect()
}

/// Estimates the offsets of a recording as [`estimate`], and by the method of the paper ([`replay::run`]) in the same
/// pass. `each` processes every part, for further results.
///
/// A requested CSV file is written last.
///
/// # Errors
/// As [`estimate`] and [`replay::run`]; no file has been written in that case.
pub fn estimate_with_replay(
    request: &Request,
    window: Window,
    baseline: Option<(&Baseline, &str)>,
    options: &SessionOptions,
    each: &mut dyn FnMut(&Robot, &Recorded),
    progress: &mut dyn FnMut(Progress),
) -> Result<(Estimate, SessionEstimate, Baseline), SessionError> {
    let reference = replay::reference(request, progress)?;
    let mut opened = Opened::new(request)?;
    let mut pass = Pass::new(request, &opened)?;
    let run = Run {
        request,
        window,
        baseline,
        options,
    };
    let robot = &opened.loaded.robot.clone();
    let mut also = |frame: &Frame| {
        pass.frame(frame)?;
        Ok(ControlFlow::Continue(()))
    };
    let mut each = |recorded: &Recorded| each(robot, recorded);
    let found = run.estimate(&mut opened, &[], progress, &mut also, &mut each)?;
    let (session, next) = run.corrected(robot, found, progress)?;
    let mut paper = pass.finish(opened)?;
    if let Some(reference) = reference {
        replay::compare(&mut paper, &reference);
    }
    // The uncorrected offset of a lost transmission is the distance between motor and joint.
    let is_lost = |name: &str| {
        let mut joints = session.joints.iter();
        joints.any(|j| j.name == name && j.verdict == Verdict::TransmissionLost)
    };
    paper.warnings.retain(|warning| match warning {
        RecordingWarning::ImplausibleOffset { joint, .. } => !is_lost(joint),
        _ => true,
    });
    Ok((paper, session, next))
}

/// Estimates the offsets from blocks, as [`estimate`]; `name` is that of the recording in the result and in errors.
///
/// Motor and joint encoders are assumed to have common time stamps. If the friction of all joints indicates a delay,
/// the delay is estimated jointly, with [`Warning::EncoderDelay`].
///
/// A stated payload is a hypothesis with prior odds of 20 to 1: it is used if its posterior probability is at least 0.95,
/// and estimated otherwise, with a warning if it is less probable than not. A stated force is estimated instead if the
/// excess residual is large with it and at most half as large without it, with a warning.
///
/// # Errors
/// As [`estimate`], except for errors of the recording file.
pub fn estimate_recorded(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    baseline: Option<(&Baseline, &str)>,
    options: &SessionOptions,
) -> Result<(SessionEstimate, Baseline), SessionError> {
    let since = since(baseline.map(|(baseline, _)| baseline), recorded);
    estimate_segment(robot, recorded, name, (baseline, since), options)
}

/// Time relation of a recording to the last one of `baseline`.
fn since(baseline: Option<&Baseline>, recorded: &Recorded) -> Since {
    match continues(baseline, recorded) {
        true => Since::Now,
        false => Since::Days(1.0),
    }
}

/// Whether a recording continues the last one of `baseline` without a long pause.
pub(crate) fn continues(baseline: Option<&Baseline>, recorded: &Recorded) -> bool {
    baseline.is_some_and(|baseline| {
        let pause_s = (recorded.start_time_ns - baseline.end_time_ns) as f64 * 1e-9;
        // The offsets of a baseline itself are zero by definition, so a recording after it is a new session.
        (-0.5..MAX_PAUSE_S).contains(&pause_s) && baseline.recordings.len() > 1
    })
}

/// Estimates the offsets as [`estimate_recorded`], with the time relation of the recording to the baseline specified by
/// the caller.
///
/// # Errors
/// As [`estimate_recorded`].
pub fn estimate_segment(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    baseline: (Option<(&Baseline, &str)>, Since),
    options: &SessionOptions,
) -> Result<(SessionEstimate, Baseline), SessionError> {
    let mut solved = solve_stretch(robot, recorded, name, baseline, options)?;
    cables::add(robot, (recorded, name), baseline.0, &mut solved.estimate)?;
    Ok((solved.estimate, solved.next))
}

/// Estimate of a recording with its posterior, estimator and predictive check.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub(crate) estimate: SessionEstimate,
    /// Posterior as the next file of the chain.
    pub(crate) next: Baseline,
    pub(crate) estimator: MapEstimator,
    /// Check of the last seconds against the estimate, for later blocks.
    pub(crate) check: PredictiveCheck,
    /// Standard deviation of each joint's offset due to an unknown temperature, rad; empty if the temperature is
    /// available.
    pub(crate) unknown_temperature_rad: Vec<f64>,
    /// Logarithm of the Bayes factor for the stated payload against an unknown one; 0 if none was compared.
    ln_stated_payload: f64,
}

/// Estimates as [`estimate_segment`], and returns the posterior and the estimator too.
pub(crate) fn solve_stretch(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    baseline: (Option<(&Baseline, &str)>, Since),
    options: &SessionOptions,
) -> Result<Solved, SessionError> {
    let estimate_as_specified = |options: &SessionOptions, stated: Option<Payload>| {
        let solve =
            |lag_s| estimate_with_lag(robot, recorded, name, baseline, options, (lag_s, stated));
        let simultaneous = solve(0.0)?;
        let delay = simultaneous
            .estimate
            .warnings
            .iter()
            .find_map(|warning| match warning {
                Warning::EncoderDelay { motor_delay_s } => Some(motor_delay_s.mean.abs()),
                _ => None,
            });
        match delay {
            None => Ok(simultaneous),
            Some(delay_s) => solve(delay_s),
        }
    };
    // A recording that continues another one has the payload of its posterior.
    let stated = Some(options.payload)
        .filter(|payload| *payload != Payload::Unknown && baseline.1 != Since::Now);
    let mut options = *options;
    let mut solved = None;
    if let Some(stated) = stated {
        let free = SessionOptions {
            payload: Payload::Unknown,
            ..options
        };
        let mut unknown = estimate_as_specified(&free, Some(stated))?;
        let probability = misstatement_probability(unknown.ln_stated_payload);
        // A probability that is not a number does not confirm the statement.
        if !(probability <= MAX_MISSTATEMENT_PROBABILITY) {
            options = free;
            if probability > 0.5 {
                let payload_kg = unknown.estimate.payload_kg;
                unknown
                    .estimate
                    .warnings
                    .push(Warning::PayloadInconsistent {
                        payload_kg,
                        probability,
                    });
            }
            solved = Some(unknown);
        }
    }
    let specified = match solved {
        Some(solved) => solved,
        None => estimate_as_specified(&options, None)?,
    };
    without_inconsistent_force(&options, specified, |options| {
        estimate_as_specified(options, None)
    })
}

/// Prior odds that a stated value is wrong. Engineering estimate.
const MISSTATEMENT_ODDS: f64 = 1.0 / 20.0;
/// Maximum probability of a misstatement at which the stated value is used. Above it the value is estimated, of which
/// the stated one is a special case: the estimate is valid either way, and less precise.
const MAX_MISSTATEMENT_PROBABILITY: f64 = 0.05;

/// Posterior probability that a stated value is wrong; `ln_factor` is the logarithm of the Bayes factor for it.
fn misstatement_probability(ln_factor: f64) -> f64 {
    // Odds of a right statement: finite where those of a misstatement overflow.
    1.0 / (1.0 + ln_factor.exp() / MISSTATEMENT_ODDS)
}

/// Replaces an estimate with a specified external force by one in which the force is estimated, if the excess residual is
/// large with the specified force and at most half as large without it.
fn without_inconsistent_force(
    options: &SessionOptions,
    specified: Solved,
    estimate: impl Fn(&SessionOptions) -> Result<Solved, SessionError>,
) -> Result<Solved, SessionError> {
    /// Minimum excess residual for a specified force to be tested, rad.
    const MIN_EXCESS_RESIDUAL_RAD: f64 = 2e-3;
    let worst = |solved: &Solved| {
        let residuals = solved.estimate.joints.iter().map(|j| j.excess_residual_rad);
        residuals.fold(0.0, f64::max)
    };
    let residual_rad = worst(&specified);
    if options.external_force_n.is_none() || residual_rad < MIN_EXCESS_RESIDUAL_RAD {
        return Ok(specified);
    }
    let mut solved = estimate(&SessionOptions {
        external_force_n: None,
        ..*options
    })?;
    if worst(&solved) > 0.5 * residual_rad {
        return Ok(specified);
    }
    let force_n = solved.estimate.external_force.map(|force| force.force_n);
    let warnings = &mut solved.estimate.warnings;
    // A payload that was inconsistent with the force may be consistent without it.
    warnings.extend(
        (specified.estimate.warnings.into_iter())
            .filter(|w| matches!(w, Warning::PayloadInconsistent { .. })),
    );
    warnings.push(Warning::ExternalForceInconsistent { force_n });
    Ok(solved)
}

/// Estimates with the specified values and a prior of `0 ± lag_s` (one standard deviation) for the time offset of the
/// encoders. `stated`: payload whose evidence against the unknown one of `options` is computed.
fn estimate_with_lag(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    (baseline, since): (Option<(&Baseline, &str)>, Since),
    options: &SessionOptions,
    (lag_s, stated): (f64, Option<Payload>),
) -> Result<Solved, SessionError> {
    sides::check_scales(robot, recorded, name)?;
    let mut session = Session::new(robot, recorded, options);
    let prior = &session.estimator.prior().clone();
    sides::check(robot, prior, &session.recorded, options.payload, name)?;
    let recorded = &*session.recorded;
    let (mut change_k, mut added_rad) = (0.0, Vec::new());
    // Prior that all sessions since the baseline have in common.
    let common: StateEstimate;
    let mut start = match baseline {
        Some((baseline, file)) => {
            let mut state_estimate = baseline.state_estimate(robot, prior, file)?;
            common = state_estimate.clone();
            let source = session.temperature;
            match since {
                Since::Now => {
                    change_k = baseline.change_std_k;
                    // The variance of the stiffness includes it already; the drift of the zero is never in a state estimate.
                    added_rad = state_estimates::unknown_temperature(
                        prior,
                        &mut state_estimate.clone(),
                        change_k,
                    );
                }
                Since::Days(days) => {
                    change_k = temperature::change_std_k(robot, baseline, source, options);
                    state_estimates::age_by(prior, &mut state_estimate, days);
                    added_rad = reset_variances(prior, &mut state_estimate, options, change_k);
                    let to_c = mean_temperature(&recorded.blocks);
                    temperature::expect_retraction(robot, prior, &mut state_estimate, to_c);
                }
            }
            state_estimate
        }
        None => {
            let mut fresh = prior.state_estimate(options.payload, UNKNOWN_OFFSET_RAD);
            prior.hold_zero(&mut fresh);
            fresh.temperature_c = mean_temperature(&recorded.blocks);
            common = fresh.clone();
            let zero_rad = robot.tolerances.zero_rad;
            if zero_rad > 0.0 {
                // Elongation since the encoders were zeroed, at a temperature that is not stated.
                change_k = temperature::since_zeroing_std_k(robot, session.temperature, options);
                let drift = state_estimates::unknown_temperature(prior, &mut fresh, change_k);
                let error = drift.into_iter().enumerate();
                added_rad = error
                    .map(|(i, drift)| match prior.is_elastic(i) {
                        true => drift.hypot(zero_rad),
                        false => 0.0,
                    })
                    .collect();
            }
            fresh
        }
    };
    prior.open_lag(&mut start, lag_s);
    let model_error = baseline.and_then(|(baseline, _)| {
        let then = baseline.model_error.as_ref()?;
        Some(session.estimator.aged_model_error(then, &common, &start))
    });
    let estimator = session.estimator.with_model_error(model_error.clone());
    session.estimator = estimator.with_independent_rounds(baseline.is_some());
    let estimator = &session.estimator;
    let continues = baseline.is_some() && since == Since::Now;
    let everything = SearchScope {
        offsets: true,
        payload: true,
        creep: options.creep,
        continues,
        onset: None,
    };
    let payload = options.payload;
    let visits = repeated_motion::visits(&recorded.blocks);
    let mut segments = Segments::estimate(
        (robot, estimator),
        start,
        recorded,
        &visits,
        payload,
        everything,
        name,
    )?;
    let recent = RecentCheck {
        robot,
        estimator,
        recorded,
        visits: &visits,
        payload,
        scope: everything,
    };
    let checked = recent.check_recent(&mut segments);
    let check = checked.map_err(|error| SessionError::Map {
        file: name.into(),
        error,
    })?;
    let touched = anchor::readings(robot, recorded, estimator, &segments);
    let chained = segments.chained(None, touched);
    let mut recordings = baseline.map_or_else(Vec::new, |(b, _)| b.recordings.clone());
    let first = recordings.first().cloned();
    recordings.push(name.into());
    let mut next = Baseline::new(
        robot,
        recordings,
        recorded.end_time_ns,
        &chained.learned(prior),
        segments.noise(),
    );
    if let Some((baseline, _)) = baseline {
        next.before.clone_from(&baseline.before);
        next.zero_time_ns = baseline.zero_time();
        next.temperature_std_k = baseline.temperature_std_k;
        next.change_std_k = change_k;
        next.model_error = model_error;
        next.anchors.clone_from(&baseline.anchors);
        next.cables.clone_from(&baseline.cables);
    }
    let shared = segments.shared_errors(prior, &common, continues, name)?;
    let stated_rad = Some(robot.tolerances.zero_rad);
    let zero_std_rad = stated_rad.filter(|rad| baseline.is_none() && *rad > 0.0);
    let errors = (lag_s, zero_std_rad);
    let mut estimate = session.summarise(&segments, name, first, &added_rad, &shared, errors);
    estimate.baseline_time_utc_s = next.zero_time_ns.and_then(utc_s);
    let references = &chained.touched;
    anchor::apply(robot, references, baseline.map(|(b, _)| b), &mut estimate);
    // A reference measurement that reduces the error reduces its systematic part too.
    for joint in &mut estimate.joints {
        let whole_rad = joint.offset_rad.std;
        joint.systematic_error = joint.systematic_error.map(|part| part.at_most(whole_rad));
    }
    let unknown = session.temperature == TemperatureSource::Unknown
        || baseline.is_some_and(|(b, _)| b.temperature_c.is_none());
    let unknown = unknown && baseline.is_some();
    let most = (added_rad.iter().enumerate()).max_by(|a, b| a.1.total_cmp(b.1));
    if let Some((joint, added_rad)) = most.filter(|(_, added)| unknown && **added > 0.0) {
        estimate.warnings.push(Warning::TemperatureUnknown {
            std_k: change_k,
            joint: robot.tendon_name(joint).to_owned(),
            half_width_95_rad: Z95 * added_rad,
        });
    }
    if let (Some(now_c), Some(then_c)) = (estimate.temperature_c, estimate.reference_temperature_c)
    {
        let drift = |i: usize| {
            let at = prior.place(i, JointParameter::Drift);
            segments.state_estimate.entry(at).std
        };
        let width = |i: usize| {
            let name = robot.tendon_name(i);
            let joint = estimate.joints.iter().find(|j| j.name == name);
            joint.map_or(f64::INFINITY, |j| j.offset_rad.half_width_95())
        };
        let warning = temperature::unknown_drift(robot, drift, width, now_c - then_c);
        estimate.warnings.extend(warning);
    }
    let ln_stated_payload = match (stated, segments.estimates.first()) {
        (Some(stated), Some((_, map))) => {
            let found = stated_payload::ln_bayes_factor(prior, &segments.before, map, stated);
            found.map_err(|error| SessionError::Map {
                file: name.into(),
                error,
            })?
        }
        _ => 0.0,
    };
    Ok(Solved {
        estimate,
        next,
        check,
        ln_stated_payload,
        estimator: session.estimator,
        unknown_temperature_rad: match unknown {
            true => added_rad,
            false => Vec::new(),
        },
    })
}

/// Resets the prior variances of offsets and payload for a new session, with a temperature change of `change_k`
/// (standard deviation, K). Returns the resulting standard deviation of each joint's offset, rad.
fn reset_variances(
    prior: &Prior,
    state_estimate: &mut StateEstimate,
    options: &SessionOptions,
    change_k: f64,
) -> Vec<f64> {
    prior.reset_offsets(state_estimate, UNKNOWN_OFFSET_RAD);
    prior.reset_payload(state_estimate, options.payload);
    state_estimates::unknown_temperature(prior, state_estimate, change_k)
}

/// Recording without its invalid channels, and the estimator for it.
struct Session<'a> {
    robot: &'a Robot,
    recorded: Cow<'a, Recorded>,
    estimator: MapEstimator,
    temperature: TemperatureSource,
    /// Transmissions that were lost; their blocks from the onset on are excluded.
    losses: Vec<TransmissionLoss>,
    rejected: Vec<Warning>,
}

impl<'a> Session<'a> {
    fn new(robot: &'a Robot, recorded: &'a Recorded, options: &SessionOptions) -> Self {
        let mut recorded = Cow::Borrowed(recorded);
        if options.temperature_c.is_some() {
            temperature::apply_specified(recorded.to_mut(), options);
        }
        let options = &SessionOptions {
            motor_current: options.motor_current || recorded.motor_current,
            ..*options
        };
        let estimator = estimator(robot, options);
        let losses = transmission_loss::detect(robot, &estimator, &recorded, options.payload);
        for loss in &losses {
            loss.exclude(recorded.to_mut());
        }
        let mut rejected = frozen_encoder::reject_frozen(robot, &mut recorded);
        rejected.extend(independent_torque::reject_invalid(
            robot,
            &mut recorded,
            options.motor_torque,
        ));
        Self {
            robot,
            estimator,
            losses,
            temperature: temperature::source(&recorded, options),
            recorded,
            rejected,
        }
    }

    /// Creates the result. `added_rad`: standard deviation of each joint's offset from errors that are constant over
    /// all blocks; `shared`: systematic error from the baseline; `lag_s`: prior standard deviation of the time offset
    /// between the encoders, s; `zero_std_rad`: that of the encoder zeros, rad, if offsets are elongations because of it.
    fn summarise(
        &self,
        segments: &Segments,
        name: &str,
        baseline: Option<String>,
        added_rad: &[f64],
        shared: &[SharedError],
        (lag_s, zero_std_rad): (f64, Option<f64>),
    ) -> SessionEstimate {
        let context = Context {
            estimator: &self.estimator,
            robot: self.robot,
            recorded: &self.recorded,
            segments,
            added_rad,
            shared,
            lag_s,
            is_elongation: baseline.is_some() || zero_std_rad.is_some(),
            zero_std_rad,
            losses: &self.losses,
        };
        let mut estimate = summarise(&context, name, baseline);
        estimate.temperature_source = self.temperature;
        estimate.warnings.extend(self.rejected.iter().cloned());
        estimate
    }
}
