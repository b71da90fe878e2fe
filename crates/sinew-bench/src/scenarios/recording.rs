//! One recording, simulated and assessed.

use super::paper::PaperMeans;
use super::simulated::Simulated;
use super::{End, EndScore, ScenarioError, Sessions, estimator};
use serde::{Deserialize, Serialize};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{
    Recorded, SessionError, SessionEstimate, TendonChange, Verdict, Warning,
};
use sinew_model::{Gaussian, Interval95};
use sinew_sim::protocol::Plan;

/// Result of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// Every elastic joint at the end of session B.
    pub joints: Vec<JointScore>,
    /// Slips of session C; empty if it was not simulated.
    pub steps: Vec<StepScore>,
    /// False sudden changes in B and C: the reported probability of each, 1 for
    /// changes reported before the recording.
    pub false_alarms: Vec<f64>,
    /// Time in which they were searched for, s.
    pub exposure_s: f64,
    /// Estimated minus true payload at the end of B, with the reported standard deviation.
    pub payload_error_kg: Gaussian,
    /// Share of B rejected as contact or disturbance.
    pub rejected_share: f64,
    /// Distinct poses of B.
    pub poses: usize,
    /// Warnings of baseline and estimate.
    pub warnings: Vec<Warning>,
    /// All joints at the end of B, and of C where it was estimated.
    pub ends: Vec<EndScore>,
}

/// One joint at the end of session B. Errors are estimate minus truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointScore {
    /// Name of the joint.
    pub name: String,
    /// True offset, rad.
    pub truth_rad: f64,
    /// Error of the estimate, with the reported standard deviation.
    pub error_rad: Gaussian,
    /// Whether the verdict on the tendon is conclusive.
    #[serde(alias = "can_tell")]
    pub is_conclusive: bool,
    /// Error of the paper's mean over B, rad.
    pub paper_error_rad: Option<f64>,
    /// Error of the difference between the paper's means over B and A, rad.
    pub paper_minus_baseline_error_rad: Option<f64>,
    /// Error of the mean over B with matched filters, rad.
    pub matched_error_rad: Option<f64>,
    /// Error of the difference between the means over B and A with matched filters, rad.
    pub matched_minus_baseline_error_rad: Option<f64>,
    /// Bayesian Cramér–Rao bound at this recording's truth, rad.
    pub bound_rad: Option<f64>,
}

/// Slip of session C.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepScore {
    /// Name of the joint.
    pub joint: String,
    /// Time of the slip, s.
    pub at_s: f64,
    /// True size, rad.
    pub size_rad: f64,
    /// Estimate with 20 s of recording after the slip; none if not found.
    pub found: Option<FoundStep>,
    /// Duration of recording after the slip that is sufficient to detect it, s.
    pub delay_s: Option<f64>,
}

/// Estimate of a slip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FoundStep {
    /// Size of the step, rad.
    pub size_rad: f64,
    /// Time of the change, s.
    pub time_s: f64,
    /// 95 % interval of the time, s.
    pub interval_95_s: Interval95,
    /// Reported probability of the slip.
    pub probability: f64,
}

impl FoundStep {
    fn of(change: &TendonChange) -> Self {
        let interval_s = change.interval_s;
        Self {
            size_rad: change.size_rad.map_or(0.0, |size| size.mean),
            time_s: change.time_s,
            interval_95_s: interval_s.unwrap_or(Interval95::new(change.time_s, change.time_s)),
            probability: stated(change),
        }
    }
}

/// Reported probability of a change; changes before the recording have none.
fn stated(change: &TendonChange) -> f64 {
    change.probability.unwrap_or(1.0)
}

impl StepScore {
    /// Returns the estimated minus the true size, rad; a slip not found counts as 0.
    pub fn error_rad(&self) -> f64 {
        self.found.map_or(0.0, |f| f.size_rad) - self.size_rad
    }

    /// Whether it happened within the reported interval; `None`: not found.
    pub fn is_time_inside(&self) -> Option<bool> {
        Some(self.found?.interval_95_s.contains(self.at_s))
    }
}

/// Recording time after a slip within which it must be found, s.
const MAX_DELAY_S: u32 = 20;
/// Maximum time difference of a reported change and a slip, s.
const MAX_TIME_ERROR_S: f64 = 5.0;

/// Simulates `plan` with `seed` and assesses the estimate.
///
/// # Errors
/// Returns a [`ScenarioError`] if the recording cannot be simulated or estimated.
pub fn record(plan: &Plan, seed: u64, sessions: Sessions) -> Result<Recording, ScenarioError> {
    let simulated = Simulated::new(plan, seed, sessions)?;
    let session_error = |error| ScenarioError::Session {
        scenario: plan.name.clone(),
        seed,
        error: Box::new(error),
    };
    let payload = plan.payload_unknown;
    let robot = &plan.robot;
    let (baseline, learned) =
        estimator::learn(robot, &simulated.sessions[0]).map_err(session_error)?;
    let (estimated, after_b) = estimator::watch(
        robot,
        &simulated.sessions[1],
        "session B",
        &baseline,
        payload,
    )
    .map_err(session_error)?;
    let mut out = assessed(plan, seed, &simulated, &estimated);
    out.warnings.extend(
        learned
            .warnings
            .iter()
            .filter(|w| **w != Warning::NoBaseline)
            .chain(&estimated.warnings)
            .cloned(),
    );
    out.ends.push(EndScore::of(
        End::B,
        robot,
        &simulated.truth_rad,
        &estimated,
    ));
    if sessions != Sessions::B {
        watch_c(plan, &simulated, &after_b, sessions, &mut out).map_err(session_error)?;
    }
    if sessions == Sessions::Chain {
        let mut window = estimator::online(robot, &baseline, payload).map_err(session_error)?;
        let ends = [
            (End::B, &simulated.truth_rad),
            (End::Chain, &simulated.truth_at_end_rad),
        ];
        for ((end, truth_rad), session) in ends.into_iter().zip(&simulated.sessions[1..]) {
            estimator::follow(&mut window, session);
            out.ends.push(EndScore::online(end, truth_rad, &window));
        }
    }
    Ok(out)
}

/// Session B against its truth.
fn assessed(
    plan: &Plan,
    seed: u64,
    simulated: &Simulated,
    estimated: &SessionEstimate,
) -> Recording {
    let joints = estimated
        .joints
        .iter()
        .filter_map(|joint| {
            let i = plan.robot.tendon_index(&joint.name)?;
            let truth_rad = simulated.truth_rad[i];
            let [lagging, matched] = &simulated.means;
            let plain = |m: &PaperMeans| Some(m.mean_rad(1, i)? - truth_rad);
            let minus = |m: &PaperMeans| Some(plain(m)? - m.mean_rad(0, i)?);
            Some(JointScore {
                name: joint.name.clone(),
                truth_rad,
                error_rad: Gaussian::new(joint.offset_rad.mean - truth_rad, joint.offset_rad.std),
                is_conclusive: joint.verdict != Verdict::Inconclusive,
                paper_error_rad: plain(lagging),
                paper_minus_baseline_error_rad: minus(lagging),
                matched_error_rad: plain(matched),
                matched_minus_baseline_error_rad: minus(matched),
                bound_rad: simulated.bound_rad.as_ref().map(|b| b[i]),
            })
        })
        .collect();
    Recording {
        scenario: plan.name.clone(),
        seed,
        joints,
        steps: Vec::new(),
        // Nothing slips within B.
        false_alarms: (estimated.joints.iter())
            .flat_map(|j| j.changes.iter().map(stated))
            .collect(),
        exposure_s: simulated.sessions[1].duration_s,
        payload_error_kg: Gaussian::new(
            estimated.payload_kg.mean - simulated.payload_kg,
            estimated.payload_kg.std,
        ),
        rejected_share: estimated.rejected_share,
        poses: estimated.poses,
        warnings: Vec::new(),
        ends: Vec::new(),
    }
}

/// Evaluates session C: the offsets at its end, the detected slips with their delays, and false detections.
fn watch_c(
    plan: &Plan,
    simulated: &Simulated,
    baseline: &Baseline,
    sessions: Sessions,
    out: &mut Recording,
) -> Result<(), SessionError> {
    let whole = &simulated.sessions[2];
    let names = &plan.robot.tendon_names();
    let until = |end_s: f64| -> Result<SessionEstimate, SessionError> {
        let part = Recorded {
            blocks: whole
                .blocks
                .iter()
                .filter(|b| b.time_s <= end_s)
                .cloned()
                .collect(),
            ..whole.clone()
        };
        // Session C continues from the end of B, as one recording would.
        estimator::watch(
            &plan.robot,
            &part,
            "session C",
            baseline,
            plan.payload_unknown,
        )
        .map(|(estimate, _)| estimate)
    };
    let estimate = until(f64::INFINITY)?;
    out.ends.push(EndScore::of(
        End::Chain,
        &plan.robot,
        &simulated.truth_at_end_rad,
        &estimate,
    ));
    if sessions == Sessions::Chain {
        return Ok(());
    }
    let reported = |estimate: &SessionEstimate, name: &str, at_s: f64| -> Option<FoundStep> {
        let joint = estimate.joints.iter().find(|j| j.name == name)?;
        let step = joint
            .changes
            .iter()
            .find(|s| (s.time_s - at_s).abs() < MAX_TIME_ERROR_S)?;
        Some(FoundStep::of(step))
    };
    for &(joint, at_s, size_rad) in &simulated.slips {
        let name = &names[joint];
        let found = reported(&until(at_s + f64::from(MAX_DELAY_S))?, name, at_s);
        let mut delay_s = None;
        if found.is_some() {
            // Found with `late` seconds, not with `early`: halved to a second, as if what is found
            // once stayed found.
            let (mut early, mut late) = (0, MAX_DELAY_S);
            while late - early > 1 {
                let middle = (early + late) / 2;
                match reported(&until(at_s + f64::from(middle))?, name, at_s) {
                    Some(_) => late = middle,
                    None => early = middle,
                }
            }
            delay_s = Some(f64::from(late));
        }
        out.steps.push(StepScore {
            joint: name.clone(),
            at_s,
            size_rad,
            found,
            delay_s,
        });
    }
    for joint in &estimate.joints {
        let is_slip = |time_s: f64| {
            out.steps
                .iter()
                .any(|s| s.joint == joint.name && (s.at_s - time_s).abs() < MAX_TIME_ERROR_S)
        };
        let false_ones = joint.changes.iter().filter(|s| !is_slip(s.time_s));
        let false_ones: Vec<f64> = false_ones.map(stated).collect();
        out.false_alarms.extend(false_ones);
    }
    out.exposure_s += whole.duration_s;
    Ok(())
}
