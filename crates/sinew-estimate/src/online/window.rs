//! Sliding window of blocks with periodic solutions, and the check of the blocks since the last one.

use super::answer::{OnlineAnswer, OnlineJoint, Provisional, hull};
use crate::baseline::Baseline;
use crate::error::SessionError;
use crate::estimator::{SessionOptions, estimator};
use crate::session::{
    NEGLIGIBLE, Recorded, SessionEstimate, Since, Solved, Warning, continues, solve_stretch,
};
use sinew_model::Gaussian;
use sinew_model::offset::{Block, FeatureConfig};
use sinew_model::robot::Robot;
use std::sync::Arc;

/// Length of the window, s.
const WINDOW_S: f64 = 120.0;
/// Maximum length of a rest phase in the window, s. Later blocks of the phase replace each other, as they add no
/// information.
const MAX_REST_S: f64 = 10.0;
/// Number of blocks between solutions, 2 s.
const BLOCKS_PER_SOLUTION: u64 = 10;

/// Solution of a window, against which the next blocks are checked.
#[derive(Debug, Clone)]
struct Solution {
    solved: Solved,
    /// Time at the middle of its last block, s.
    time_s: f64,
}

/// Online estimate of a session: the latest blocks that carry information, estimated from the session's prior by the
/// estimator of whole recordings ([`crate::session::estimate`]).
///
/// [`Window::push`] adds a block and checks it against the latest solution; [`Window::solve`] solves the window. Both
/// allocate, so call them in a worker, not in a control loop.
#[derive(Debug)]
pub struct Window {
    robot: Arc<Robot>,
    baseline: Option<(Baseline, String)>,
    options: SessionOptions,
    name: String,
    recorded: Recorded,
    /// Time relation of the session to the baseline, if specified; otherwise derived from their times.
    since: Option<Since>,
    /// Whether blocks have already been dropped from the window.
    slid: bool,
    is_due: bool,
    since_solved: u64,
    solution: Option<Box<Solution>>,
    error: Option<Arc<SessionError>>,
    answer: OnlineAnswer,
}

impl Window {
    /// Creates a window since `baseline`, with the name of its file, or relative to the encoder zero. `name` is the
    /// name of the session.
    ///
    /// # Errors
    /// Returns [`SessionError`] if the baseline belongs to another robot.
    pub fn new(
        robot: impl Into<Arc<Robot>>,
        baseline: Option<(Baseline, String)>,
        options: &SessionOptions,
        name: &str,
    ) -> Result<Self, SessionError> {
        let robot = robot.into();
        if let Some((baseline, file)) = &baseline {
            baseline.state_estimate(&robot, estimator(&robot, options).prior(), file)?;
        }
        let recorded = Recorded::empty(&robot);
        Ok(Self {
            answer: OnlineAnswer::starting(&recorded.elastic),
            recorded,
            robot,
            baseline,
            options: *options,
            name: name.into(),
            since: None,
            slid: false,
            is_due: false,
            since_solved: 0,
            solution: None,
            error: None,
        })
    }

    /// Sets the time relation of the session to the baseline.
    #[must_use]
    pub fn following(mut self, since: Since) -> Self {
        self.since = Some(since);
        self
    }

    /// Returns the latest answer.
    pub fn answer(&self) -> &OnlineAnswer {
        &self.answer
    }

    /// Returns the estimate of the window's blocks as of the latest solution, as from [`crate::session::estimate`].
    pub fn estimate(&self) -> Option<&SessionEstimate> {
        self.solution.as_ref().map(|s| &s.solved.estimate)
    }

    /// Returns the next baseline of the chain, as of the latest solution.
    pub fn next(&self) -> Option<&Baseline> {
        self.solution.as_ref().map(|s| &s.solved.next)
    }

    /// Returns the error of the latest attempt to solve the window; `None` if it was solved.
    pub fn error(&self) -> Option<&Arc<SessionError>> {
        self.error.as_ref()
    }

    /// Returns the window if it has been solved.
    ///
    /// # Errors
    /// Returns the error of the first attempt to solve it otherwise.
    pub(super) fn solved(mut self) -> Result<Self, SessionError> {
        let unsolved = self.error.take_if(|_| self.solution.is_none());
        match unsolved.and_then(Arc::into_inner) {
            Some(error) => Err(error),
            None => Ok(self),
        }
    }

    /// Whether a solution is due.
    pub fn is_due(&self) -> bool {
        self.is_due
    }

    /// Returns the number of blocks in the window, and their memory, bytes.
    pub fn size(&self) -> (usize, usize) {
        let blocks = &self.recorded.blocks;
        (blocks.len(), blocks.iter().map(Block::bytes).sum())
    }

    /// Adds the data recorded since the last call, in order: blocks and steps of positions.
    pub fn push(&mut self, part: &Recorded) {
        if self.answer.blocks == 0 {
            self.recorded.start_time_ns = part.start_time_ns;
        }
        self.recorded.end_time_ns = part.end_time_ns;
        self.recorded.motor_current |= part.motor_current;
        self.recorded.frames_missing += part.frames_missing;
        self.recorded.jumps.append(&part.jumps);
        for block in &part.blocks {
            self.push_block(block.clone());
        }
    }

    fn push_block(&mut self, mut block: Block) {
        if let Some(specified) = self.options.temperature_c {
            block.temperature_c = specified.mean;
        }
        self.answer.blocks += 1;
        self.answer.time_s = block.time_s;
        let blocks = &mut self.recorded.blocks;
        let repeats = block.stood_s > MAX_REST_S
            && blocks.last().is_some_and(|last| last.stood_s > MAX_REST_S);
        match blocks.last_mut() {
            Some(last) if repeats => {
                // Steps of positions meanwhile add no information either; removing them bounds the memory.
                let at_rest = last.time_s..block.time_s;
                self.recorded.jumps.forget_within(at_rest);
                *last = block;
            }
            _ => {
                blocks.push(block);
                self.since_solved += 1;
                self.is_due |= self.since_solved >= BLOCKS_PER_SOLUTION;
            }
        }
        self.slide();
        if let Some(solution) = &mut self.solution {
            let Solved {
                check, estimator, ..
            } = &mut solution.solved;
            check.take(estimator, &self.recorded.blocks, 1);
            Self::update(&mut self.answer, solution, self.error.is_some());
        }
    }

    /// Drops blocks beyond the length of the window.
    fn slide(&mut self) {
        let block_s = FeatureConfig::default().block_s;
        let max_blocks = (WINDOW_S / block_s) as usize;
        let recorded = &mut self.recorded;
        let over = recorded.blocks.len().saturating_sub(max_blocks);
        if over > 0 {
            recorded.blocks.drain(..over);
            self.slid = true;
            let from_s = recorded.blocks[0].time_s - 0.5 * block_s;
            recorded.jumps.forget_before(from_s);
            let start_s = recorded.end_s() + 0.5 * block_s - from_s;
            recorded.start_time_ns = recorded.end_time_ns - (start_s * 1e9) as i64;
        }
        recorded.duration_s = (recorded.end_time_ns - recorded.start_time_ns) as f64 * 1e-9;
    }

    /// Solves the window; the answer refers to its last block.
    pub fn solve(&mut self) {
        (self.is_due, self.since_solved) = (false, 0);
        let baseline = self.baseline.as_ref().map(|(b, file)| (b, file.as_str()));
        // The prior at the start of the session may be outdated at the start of the window.
        let continues = || continues(baseline.map(|(b, _)| b), &self.recorded);
        let since = match self.since {
            Some(since) => since,
            None if !self.slid && continues() => Since::Now,
            None => Since::Days(1.0),
        };
        let solved = solve_stretch(
            &self.robot,
            &self.recorded,
            &self.name,
            (baseline, since),
            &self.options,
        );
        match solved {
            Ok(solved) => {
                let time_s = self.recorded.end_s();
                let solution = Box::new(Solution { solved, time_s });
                Self::update(&mut self.answer, &solution, false);
                (self.solution, self.error) = (Some(solution), None);
            }
            Err(error) => {
                self.error = Some(Arc::new(error));
                for joint in &mut self.answer.joints {
                    joint.provisional = Some(Provisional::NotSolved);
                }
            }
        }
    }

    /// Updates the answer from a solution and the blocks checked against it. `has_failed`: a later window could not be
    /// solved.
    fn update(answer: &mut OnlineAnswer, solution: &Solution, has_failed: bool) {
        let Solved {
            estimate,
            unknown_temperature_rad: unknown_rad,
            check,
            ..
        } = &solution.solved;
        answer.solved_s = solution.time_s;
        answer.external_force = estimate.external_force;
        answer.contact_probability = check.contact_probability();
        for (k, (own, tendon)) in (answer.joints.iter_mut().zip(&estimate.joints)).enumerate() {
            let may_end = estimate.warnings.iter().find_map(|warning| match warning {
                Warning::ChangeNearEnd { joint, time_s, .. } if *joint == tendon.name => {
                    Some(Provisional::ChangeNearEnd { since_s: *time_s })
                }
                _ => None,
            });
            let rejected = estimate.warnings.iter().find_map(|warning| match warning {
                Warning::MuchRejected { share } => Some(Provisional::Rejected { share: *share }),
                _ => None,
            });
            let failed = has_failed.then_some(Provisional::NotSolved);
            *own = OnlineJoint {
                joint: own.joint,
                offset_rad: tendon.offset_rad,
                unknown_temperature_rad: unknown_rad.get(own.joint).copied().unwrap_or(0.0),
                stiffness_changed_probability: tendon
                    .stiffness_change
                    .map(|since| since.probability),
                provisional: may_end.or(rejected).or(failed),
            };
            let Some(step) = check.suspected(k) else {
                continue;
            };
            let before = tendon.offset_rad;
            let after = Gaussian::new(before.mean + step.mean_rad, before.std.hypot(step.std_rad));
            if step.probability_beyond(before.half_width_95()) > NEGLIGIBLE {
                own.offset_rad = hull(before, after);
                own.provisional = Some(Provisional::Step {
                    since_s: step.since_s,
                    probability: step.probability,
                });
            }
        }
    }
}
