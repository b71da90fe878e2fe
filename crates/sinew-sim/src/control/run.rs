//! Run and score of a scenario.

use super::detection::{Detection, DetectionSample};
use super::score::{AFTERMATH_S, ContactScore, JointTally, SETTLED_S, Score};
use crate::scenario::{Correction, FrictionSpec, PerJoint, Scenario, SpecifiedOffset, Truth};
use crate::{SimulateError, Simulation, TrueState};
use serde::Serialize;
use sinew_files::JsonDocument;
use sinew_files::{Fault, Located};
use sinew_model::correction::JointCorrection;
use sinew_model::robot::Robot;

/// Truth of a simulated recording, and its control score if requested.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Simulated {
    /// Truth as written to the file of the recording.
    #[serde(flatten)]
    pub truth: crate::Truth,
    /// The scenario without and with its correction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control: Option<Comparison>,
}

impl JsonDocument for Simulated {
    const SCHEMA: &'static str = "sinew/simulate/2";
}

/// Scores of a scenario without and with its correction.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// Neither the set-points nor the external torque corrected.
    pub without: Score,
    /// Score with the scenario's `[correction]`.
    pub with: Score,
}

/// Contacts with another sensitivity.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sensitivity {
    /// Factor on the threshold.
    pub threshold_factor: f64,
    /// Contact detection with the correction.
    pub contacts: ContactScore,
}

/// Score of one run, with scores at other detector sensitivities.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outcome {
    /// Score with the thresholds of the scenario.
    pub score: Score,
    /// Score for each requested threshold factor.
    pub sensitivities: Vec<Sensitivity>,
}

/// Takes every sample of a run.
type OnSample<'a> = &'a mut dyn FnMut(&TrueState, DetectionSample<'_>);

/// Runs a scenario without and with its correction.
///
/// The run without correction has no known offset; everything else is as in the scenario, including the thresholds,
/// which are those of a robot with assumed nominal ropes.
///
/// # Errors
/// Returns a [`SimulateError`] if the scenario has no correction or cannot be simulated.
pub fn compare(robot: &Robot, scenario: &Scenario) -> Result<Comparison, SimulateError> {
    if scenario.correction.offset == SpecifiedOffset::Nothing {
        let problem =
            "offset is missing; set it to \"true\", or to \"stated\" with offset_rad or estimate";
        let located = Located::new(&scenario.file, Fault::MissingKey, problem);
        return Err(located.key("correction").into());
    }
    let noise = noise_nm(robot, scenario)?;
    let mut blind = scenario.clone();
    blind.correction.offset = SpecifiedOffset::Nothing;
    blind.correction.offset_rad = PerJoint::default();
    blind.correction.offset_error_rad = PerJoint::default();
    Ok(Comparison {
        without: run(robot, &blind, &noise)?,
        with: run(robot, scenario, &noise)?,
    })
}

/// Runs a scenario with the correction it states, and scores it.
///
/// * `noise_nm`: noise of the external torque, one per joint, of [`noise_nm()`].
///
/// # Errors
/// [`SimulateError`].
pub fn run(robot: &Robot, scenario: &Scenario, noise_nm: &[f64]) -> Result<Score, SimulateError> {
    Ok(run_with_detectors(robot, scenario, noise_nm, &[], &mut |_, _| {})?.score)
}

/// Runs like [`run`], with further detectors whose thresholds are scaled by `factors`, and calls `on_sample` with
/// every frame.
///
/// # Errors
/// Returns a [`SimulateError`] if the scenario cannot be simulated.
pub fn run_with_detectors(
    robot: &Robot,
    scenario: &Scenario,
    noise_nm: &[f64],
    factors: &[f64],
    on_sample: OnSample<'_>,
) -> Result<Outcome, SimulateError> {
    let mut simulation = Simulation::new(robot, scenario)?;
    let names = simulation.joint_names().to_vec();
    let n = names.len();
    let corrections: Vec<JointCorrection> =
        (0..n).map(|i| simulation.correction_at(i, 0.0)).collect();
    let all: Vec<f64> = std::iter::once(1.0)
        .chain(factors.iter().copied())
        .collect();
    let mut detection = Detection::new(
        robot,
        &corrections,
        &scenario.contact_detection,
        noise_nm,
        &all,
    )?;
    let from_s = detection.settling_time_s();
    let mut tallies = vec![JointTally::default(); n];
    let mut stood_s = 0.0;
    let mut last_touch_s = f64::NEG_INFINITY;
    let dt = 1.0 / scenario.sample_rate_hz;
    while let Some(frame) = simulation.next_frame()? {
        let (q, theta) = (frame.q.clone(), frame.theta.clone());
        let truth = simulation.true_state();
        let t = truth.time_s;
        if simulation.correction_changes() {
            for i in 0..n {
                detection.set_correction(i, &simulation.correction_at(i, t))?;
            }
        }
        detection
            .step(t, &q, &theta)
            .map_err(|e| SimulateError::Diverged {
                time_s: t,
                reason: e.to_string(),
            })?;
        if truth.tau_ext.iter().any(|x| *x != 0.0) {
            last_touch_s = t;
        }
        let at_rest = truth.dq_d.iter().all(|x| *x == 0.0);
        stood_s = if at_rest { stood_s + dt } else { 0.0 };
        let sample = detection.sample();
        if t - last_touch_s >= AFTERMATH_S {
            for (i, tally) in tallies.iter_mut().enumerate() {
                tally.position(truth.q[i] - truth.q_d[i], stood_s >= SETTLED_S);
                if t >= from_s {
                    tally.torque(sample.tau_ext[i], truth.tau_ext[i], sample.threshold[i]);
                }
            }
        }
        on_sample(truth, sample);
    }
    let end_s = simulation.duration_s();
    let contacts: Vec<(f64, f64)> = simulation
        .contacts()
        .begun
        .iter()
        .map(|c| (c.start_s, c.start_s + c.duration_s))
        .collect();
    let mut sensitivities = detection.finish(end_s).map(|(factor, alarms)| Sensitivity {
        threshold_factor: factor,
        contacts: ContactScore::of(&alarms, &contacts, from_s, end_s),
    });
    // The first one is the scenario's own.
    let own = sensitivities.next().map(|s| s.contacts);
    Ok(Outcome {
        score: Score {
            joints: tallies
                .iter()
                .zip(&names)
                .map(|(tally, name)| tally.score(name))
                .collect(),
            contacts: own.unwrap_or_else(|| ContactScore::of(&[], &contacts, from_s, end_s)),
        },
        sensitivities: sensitivities.collect(),
    })
}

/// Noise of the external torque due to the sensors alone, N·m per joint.
///
/// Uses `noise_nm` of the scenario if specified. Otherwise the scenario is run without contacts, payload,
/// stretch, friction and model error, and the standard deviation of the estimate is used: the value of a
/// robot directly after commissioning without contact.
///
/// # Errors
/// [`SimulateError`].
pub fn noise_nm(robot: &Robot, scenario: &Scenario) -> Result<Vec<f64>, SimulateError> {
    let given = &scenario.contact_detection.noise_nm;
    let n = robot.arm.dof();
    let mut quiet = scenario.clone();
    quiet.contacts.clear();
    quiet.random_contacts = None;
    quiet.payloads.clear();
    quiet.offsets.clear();
    quiet.truth = Truth::default();
    quiet.joint_friction = FrictionSpec::none();
    quiet.motor_friction = FrictionSpec::none();
    quiet.correction = Correction::default();
    // Long enough for a dozen poses of a random motion.
    const MAX_NOISE_RUN_S: f64 = 30.0;
    quiet.duration_s = quiet.duration_s.map(|d| d.min(MAX_NOISE_RUN_S));
    let mut frictionless = robot.clone();
    for t in frictionless.transmissions.iter_mut().flatten() {
        t.joint_friction = Default::default();
    }
    let measured = if given.all.is_some() {
        vec![0.0; n]
    } else {
        let score = run(&frictionless, &quiet, &vec![0.0; n])?;
        let joints = score.joints.iter();
        joints.map(|j| j.torque_error_rms_nm).collect()
    };
    // The noise of a scenario may be drawn; nothing else depends on this stream.
    let mut rng = crate::scenario::rng(scenario.seed, crate::scenario::Stream::Correction);
    Ok(given.sample(robot.joint_names(), &measured, &mut rng))
}
