//! The online estimate over two sessions, assessed at every block.

use super::outcome::Assessment;
use super::simulated::Simulated;
use super::{ScenarioError, estimator};
use serde::{Deserialize, Serialize};
use sinew_estimate::online::{Window, replay};
use sinew_estimate::session::SessionEstimate;
use sinew_model::Gaussian;
use sinew_sim::protocol::Plan;

/// Maximum half-width of a 95 % interval to be useful, rad.
const USEFUL_RAD: f64 = 3e-3;
/// Maximum half-width of a 95 % interval to be accurate, rad, or as a multiple of that before the slip.
const RIGHT_RAD: f64 = 2e-3;
const RIGHT_RATIO: f64 = 1.3;
/// Calm: from this time on, s, and not within this time after a slip, s.
const CALM_FROM_S: f64 = 30.0;
const CALM_AFTER_S: f64 = 12.0;
/// Standard deviations above which an estimate is far from the truth.
const MAX_Z: f64 = 3.0;

/// Comparison of every online estimate of one recording with the truth at its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trajectory {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// One entry per elastic joint.
    pub joints: Vec<JointTrajectory>,
    /// Slips in the order of time.
    pub slips: Vec<SlipTrajectory>,
    /// Changes of a tendon that were reported with a probability of at least 0.9 and did not happen.
    pub false_changes: Vec<FalseChange>,
    /// Assessed time, s.
    pub exposure_s: f64,
    /// Processor time of all solutions and checks, s.
    pub processor_s: f64,
}

/// One joint: numbers of blocks.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointTrajectory {
    /// Name of the joint.
    pub name: String,
    /// First time at which the answer was useful, s; `None`: never.
    pub first_useful_s: Option<f64>,
    /// Number of assessed blocks.
    pub blocks: usize,
    /// Inside, settled, and narrower than 3 mrad.
    pub useful: usize,
    /// Number of provisional blocks.
    pub provisional: usize,
    /// Blocks of calm, and how many of them were provisional.
    pub calm: usize,
    /// Provisional while calm.
    pub calm_provisional: usize,
    /// Inside the 95 % interval.
    pub inside: usize,
    /// Outside, and settled.
    pub silent: usize,
    /// Number of blocks beyond three standard deviations and settled.
    pub far: usize,
    /// Longest time silent without a break, s.
    pub longest_silent_s: f64,
    /// Half widths of the 95 % intervals, rad.
    pub median_half_width_rad: f64,
}

/// Response of the online estimate to a slip; times since the slip, s.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlipTrajectory {
    /// Name of the joint.
    pub joint: String,
    /// Time of the slip, s.
    pub at_s: f64,
    /// Time until the estimate was last silently outside, within 30 s.
    pub silent_s: f64,
    /// Time until the interval contains the truth or the estimate is provisional, s.
    pub holds_s: Option<f64>,
    /// Time until it was accurate: inside, settled, narrow. `None`: not within 30 s.
    pub right_s: Option<f64>,
}

/// Simulates `plan` with `seed` and assesses the online estimate over B and C.
///
/// # Errors
/// Returns a [`ScenarioError`] if the recording cannot be simulated or estimated.
pub fn trajectory(plan: &Plan, seed: u64) -> Result<Trajectory, ScenarioError> {
    let simulated = Simulated::as_one(plan, seed)?;
    let session_error = |error| ScenarioError::Session {
        scenario: plan.name.clone(),
        seed,
        error: Box::new(error),
    };
    let robot = &plan.robot;
    let (baseline, _) = estimator::learn(robot, &simulated.sessions[0]).map_err(session_error)?;
    let recorded = &simulated.sessions[1];
    let from_s = recorded.blocks.first().map_or(0.0, |b| b.time_s);
    let names = &robot.tendon_names();
    let mut assessments: Vec<JointAssessment> = (recorded.elastic.iter())
        .map(|i| JointAssessment::new(names[*i].clone()))
        .collect();
    let mut slips: Vec<SlipAssessment> = (simulated.slips.iter())
        .map(|(joint, at_s, _)| SlipAssessment::new(*joint, *at_s))
        .collect();
    let options = estimator::options(plan.payload_unknown);
    let begun = cpu_time::ProcessTime::now();
    let mut truth = simulated.truth_of_blocks_rad.iter();
    let (mut changes, mut solved_s) = (ChangeAssessment::default(), f64::NEG_INFINITY);
    let mut each = |window: &Window| {
        let answer = window.answer();
        if let Some(estimate) = window.estimate().filter(|_| answer.solved_s > solved_s) {
            solved_s = answer.solved_s;
            changes.take(estimate, solved_s, &simulated.slips, names);
        }
        let time_s = answer.time_s;
        let Some(truth_rad) = truth.next() else {
            return;
        };
        let calm = time_s - from_s >= CALM_FROM_S
            && !(simulated.slips.iter())
                .any(|(_, at_s, _)| (*at_s..at_s + CALM_AFTER_S).contains(&time_s));
        for (assessment, own) in assessments.iter_mut().zip(&answer.joints) {
            let offset = own.offset_rad;
            let error = Gaussian::new(offset.mean - truth_rad[own.joint], offset.std);
            let settled = own.provisional.is_none();
            assessment.take(time_s - from_s, error, settled, calm);
            for slip in slips.iter_mut().filter(|s| s.joint == own.joint) {
                slip.take(time_s, error, settled);
            }
        }
    };
    let window = replay(
        robot,
        recorded,
        Some((&baseline, "session A")),
        &options,
        "sessions B and C",
        &mut each,
    )
    .map_err(session_error)?;
    let processor_s = begun.elapsed().as_secs_f64();
    drop(window);
    Ok(Trajectory {
        scenario: plan.name.clone(),
        seed,
        false_changes: changes.false_changes,
        exposure_s: recorded.duration_s,
        joints: assessments
            .into_iter()
            .map(JointAssessment::finish)
            .collect(),
        slips: slips.into_iter().map(|s| s.finish(names)).collect(),
        processor_s,
    })
}

impl Assessment for Trajectory {
    fn key(&self) -> (&str, u64) {
        (&self.scenario, self.seed)
    }
}

/// Reported change of a tendon that did not happen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FalseChange {
    /// Name of the joint.
    pub joint: String,
    /// Estimated time of the change, s.
    pub at_s: f64,
    /// End of the window that reported it first, s.
    pub reported_s: f64,
    /// Probability that was reported.
    pub probability: f64,
    /// Step of the offset, rad; `None` for a change of the stiffness only.
    pub size_rad: Option<f64>,
}

/// Assessment of the changes of every solution.
#[derive(Default)]
struct ChangeAssessment {
    false_changes: Vec<FalseChange>,
}

impl ChangeAssessment {
    /// Reported changes this near are one, and one this near to a slip, or with it in the interval of its time, is that slip, s.
    const MAX_TIME_ERROR_S: f64 = 3.0;
    /// Less probable ones are no report.
    const REPORTED: f64 = 0.9;

    fn take(
        &mut self,
        estimate: &SessionEstimate,
        solved_s: f64,
        slips: &[(usize, f64, f64)],
        names: &[String],
    ) {
        for joint in &estimate.joints {
            for change in &joint.changes {
                let Some(probability) = change.probability.filter(|p| *p >= Self::REPORTED) else {
                    continue;
                };
                let near = |at_s: f64| (change.time_s - at_s).abs() < Self::MAX_TIME_ERROR_S;
                // A contact can hide the time of a slip; the interval of its time then covers the contact.
                let dated = |at_s: f64| {
                    near(at_s)
                        || (change.interval_s).is_some_and(|i| (i.low..=i.high).contains(&at_s))
                };
                let happened = slips.iter().any(|(slipped, at_s, _)| {
                    names[*slipped] == joint.name && *at_s <= solved_s && dated(*at_s)
                });
                let reported = self
                    .false_changes
                    .iter()
                    .any(|reported| reported.joint == joint.name && near(reported.at_s));
                if !(happened || reported) {
                    self.false_changes.push(FalseChange {
                        joint: joint.name.clone(),
                        at_s: change.time_s,
                        reported_s: solved_s,
                        probability,
                        size_rad: change.size_rad.map(|size| size.mean),
                    });
                }
            }
        }
    }
}

/// Assessment of one joint.
struct JointAssessment {
    out: JointTrajectory,
    widths: Vec<f64>,
    silent_since_s: Option<f64>,
}

impl JointAssessment {
    fn new(name: String) -> Self {
        Self {
            out: JointTrajectory {
                name,
                ..JointTrajectory::default()
            },
            widths: Vec::new(),
            silent_since_s: None,
        }
    }

    fn take(&mut self, time_s: f64, error: Gaussian, settled: bool, calm: bool) {
        let out = &mut self.out;
        let is_finite = error.is_finite();
        let inside = is_finite && !error.is_nonzero_95();
        let useful = inside && settled && error.half_width_95() <= USEFUL_RAD;
        out.blocks += 1;
        out.useful += usize::from(useful);
        out.provisional += usize::from(!settled);
        out.calm += usize::from(calm);
        out.calm_provisional += usize::from(calm && !settled);
        out.inside += usize::from(inside);
        let silent = settled && !inside;
        out.silent += usize::from(silent);
        out.far += usize::from(settled && !(error.mean.abs() <= MAX_Z * error.std));
        if useful && out.first_useful_s.is_none() {
            out.first_useful_s = Some(time_s);
        }
        match (silent, self.silent_since_s) {
            (true, None) => self.silent_since_s = Some(time_s),
            (true, Some(from_s)) => {
                out.longest_silent_s = out.longest_silent_s.max(time_s - from_s);
            }
            (false, _) => self.silent_since_s = None,
        }
        if is_finite {
            self.widths.push(error.half_width_95());
        }
    }

    fn finish(mut self) -> JointTrajectory {
        let median = sinew_model::statistics::upper_median(&mut self.widths);
        JointTrajectory {
            median_half_width_rad: median.unwrap_or(f64::NAN),
            ..self.out
        }
    }
}

/// Assessment of one slip.
struct SlipAssessment {
    joint: usize,
    at_s: f64,
    /// Half width before it, rad.
    before_rad: f64,
    silent_s: f64,
    holds_s: Option<f64>,
    right_s: Option<f64>,
}

impl SlipTrajectory {
    /// Evaluated time after a slip, s.
    pub(super) const FOLLOWED_S: f64 = 30.0;
}

impl SlipAssessment {
    fn new(joint: usize, at_s: f64) -> Self {
        Self {
            joint,
            at_s,
            before_rad: f64::INFINITY,
            silent_s: 0.0,
            holds_s: None,
            right_s: None,
        }
    }

    fn take(&mut self, time_s: f64, error: Gaussian, settled: bool) {
        let since_s = time_s - self.at_s;
        let width = error.half_width_95();
        if since_s < 0.0 {
            if settled {
                self.before_rad = width;
            }
            return;
        }
        if since_s > SlipTrajectory::FOLLOWED_S {
            return;
        }
        let inside = error.is_finite() && !error.is_nonzero_95();
        if settled && !inside && self.right_s.is_none() {
            self.silent_s = since_s;
        }
        if (inside || !settled) && self.holds_s.is_none() {
            self.holds_s = Some(since_s);
        }
        let narrow = width <= RIGHT_RAD.max(RIGHT_RATIO * self.before_rad);
        if inside && settled && narrow && self.right_s.is_none() && since_s > 1.0 {
            self.right_s = Some(since_s);
        }
    }

    fn finish(self, names: &[String]) -> SlipTrajectory {
        SlipTrajectory {
            joint: names[self.joint].clone(),
            at_s: self.at_s,
            silent_s: self.silent_s,
            holds_s: self.holds_s,
            right_s: self.right_s,
        }
    }
}
