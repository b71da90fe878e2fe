//! One recording, simulated and judged.

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

/// How one recording came out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// Scenario.
    pub scenario: String,
    /// Seed of everything drawn.
    pub seed: u64,
    /// Every elastic joint at the end of session B.
    pub joints: Vec<JointScore>,
    /// The slips of session C; empty when it was left out.
    pub steps: Vec<StepScore>,
    /// Sudden changes reported where there was none, in B and C: the probability stated of each, 1 of
    /// what is reported of the time before.
    pub false_alarms: Vec<f64>,
    /// Time they were looked for, s.
    pub watched_s: f64,
    /// Payload estimated less the true one at the end of B, with the deviation stated.
    pub payload_error_kg: Gaussian,
    /// Share of B left out as contact or disturbance.
    pub left_out_share: f64,
    /// Distinct poses of B.
    pub poses: usize,
    /// What baseline and estimate warned of.
    pub warnings: Vec<Warning>,
    /// All joints at the end of B, and of C where it was estimated.
    pub ends: Vec<EndScore>,
}

/// One joint at the end of session B. Errors are estimate less truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointScore {
    /// Joint.
    pub name: String,
    /// True offset, rad.
    pub truth_rad: f64,
    /// Error of the estimate, with the deviation stated.
    pub error_rad: Gaussian,
    /// Whether the estimate says whether the tendon has changed.
    pub can_tell: bool,
    /// Error of the paper's mean over B, rad.
    pub paper_error_rad: Option<f64>,
    /// The same minus its mean over A.
    pub paper_minus_baseline_error_rad: Option<f64>,
    /// Error of the mean over B with matched filters, rad.
    pub matched_error_rad: Option<f64>,
    /// The same minus its mean over A.
    pub matched_minus_baseline_error_rad: Option<f64>,
    /// Bayesian Cramér–Rao bound at this recording's truth, rad.
    pub bound_rad: Option<f64>,
}

/// A slip of session C.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepScore {
    /// Joint.
    pub joint: String,
    /// When, s.
    pub at_s: f64,
    /// True size, rad.
    pub size_rad: f64,
    /// As it was found with 20 s after it; none: not found.
    pub found: Option<FoundStep>,
    /// Seconds of recording after the slip from which on it is found.
    pub delay_s: Option<f64>,
}

/// What was found of a slip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FoundStep {
    /// Size, rad.
    pub size_rad: f64,
    /// Time of the change, s.
    pub time_s: f64,
    /// It lies within, s.
    pub interval_95_s: Interval95,
    /// Probability stated.
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

/// Probability stated of a change; what was before the recording comes without one.
fn stated(change: &TendonChange) -> f64 {
    change.probability.unwrap_or(1.0)
}

impl StepScore {
    /// Size found less true size, rad; a slip not found was taken for none.
    pub fn error_rad(&self) -> f64 {
        self.found.map_or(0.0, |f| f.size_rad) - self.size_rad
    }

    /// Whether it happened within the interval stated; `None`: not found.
    pub fn is_time_inside(&self) -> Option<bool> {
        Some(self.found?.interval_95_s.contains(self.at_s))
    }
}

/// A slip must be found with this much recording after it, s.
const WITHIN_S: u32 = 20;
/// A change reported further from a slip than this is another one, s.
const SAME_S: f64 = 5.0;

/// Simulates `plan` with `seed` and judges the estimate.
///
/// # Errors
/// [`ScenarioError`].
pub fn record(plan: &Plan, seed: u64, sessions: Sessions) -> Result<Recording, ScenarioError> {
    let simulated = Simulated::new(plan, seed, sessions)?;
    let refused = |error| ScenarioError::Session {
        scenario: plan.name.clone(),
        seed,
        error: Box::new(error),
    };
    let payload = plan.payload_unknown;
    let robot = &plan.robot;
    let (baseline, learned) = estimator::learn(robot, &simulated.sessions[0]).map_err(refused)?;
    let (watched, after_b) = estimator::watch(
        robot,
        &simulated.sessions[1],
        "session B",
        &baseline,
        payload,
    )
    .map_err(refused)?;
    let mut out = judged(plan, seed, &simulated, &watched);
    out.warnings.extend(
        learned
            .warnings
            .iter()
            .filter(|w| **w != Warning::NoBaseline)
            .chain(&watched.warnings)
            .cloned(),
    );
    out.ends
        .push(EndScore::of(End::B, robot, &simulated.truth_rad, &watched));
    if sessions != Sessions::B {
        watch_c(plan, &simulated, &after_b, sessions, &mut out).map_err(refused)?;
    }
    if sessions == Sessions::Chain {
        let mut window = estimator::online(robot, &baseline, payload).map_err(refused)?;
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
fn judged(plan: &Plan, seed: u64, simulated: &Simulated, watched: &SessionEstimate) -> Recording {
    let joints = watched
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
                error_rad: Gaussian::new(
                    joint.offset_rad.mean - truth_rad,
                    joint.offset_rad.deviation,
                ),
                can_tell: joint.verdict != Verdict::CannotTell,
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
        false_alarms: (watched.joints.iter())
            .flat_map(|j| j.changes.iter().map(stated))
            .collect(),
        watched_s: simulated.sessions[1].duration_s,
        payload_error_kg: Gaussian::new(
            watched.payload_kg.mean - simulated.payload_kg,
            watched.payload_kg.deviation,
        ),
        left_out_share: watched.left_out_share,
        poses: watched.poses,
        warnings: Vec::new(),
        ends: Vec::new(),
    }
}

/// Session C: its end, what is found of the slips, how soon, and what is reported besides.
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
        // C goes on where B ended, as one recording would.
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
            .find(|s| (s.time_s - at_s).abs() < SAME_S)?;
        Some(FoundStep::of(step))
    };
    for &(joint, at_s, size_rad) in &simulated.slips {
        let name = &names[joint];
        let found = reported(&until(at_s + f64::from(WITHIN_S))?, name, at_s);
        let mut delay_s = None;
        if found.is_some() {
            // Found with `late` seconds, not with `early`: halved to a second, as if what is found
            // once stayed found.
            let (mut early, mut late) = (0, WITHIN_S);
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
        let known = |time_s: f64| {
            out.steps
                .iter()
                .any(|s| s.joint == joint.name && (s.at_s - time_s).abs() < SAME_S)
        };
        let false_ones = joint.changes.iter().filter(|s| !known(s.time_s));
        let false_ones: Vec<f64> = false_ones.map(stated).collect();
        out.false_alarms.extend(false_ones);
    }
    out.watched_s += whole.duration_s;
    Ok(())
}
