//! The window of blocks that is estimated again and again, and the check of what came since.

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

/// Blocks that a window holds, s of them.
const WINDOW_S: f64 = 120.0;
/// Of a stand so much is held, s; later blocks replace each other, as they repeat what is known.
const STAND_S: f64 = 10.0;
/// A window is solved every so many blocks: 2 s.
const SOLVE_EVERY: u64 = 10;

/// A solved window; the next blocks are checked against it.
#[derive(Debug, Clone)]
struct Solution {
    solved: Solved,
    /// Middle of its last block, s.
    time_s: f64,
}

/// The online estimate of a session: the last blocks that carry information, estimated from the session's starting belief by the
/// estimator of whole recordings ([`crate::session::estimate`]).
///
/// [`Window::push`] takes a block and checks it against the last solution; [`Window::solve`] solves the window. Both
/// allocate: a worker's, not a control loop's.
#[derive(Debug)]
pub struct Window {
    robot: Arc<Robot>,
    baseline: Option<(Baseline, String)>,
    options: SessionOptions,
    name: String,
    recorded: Recorded,
    /// How the session follows on the baseline, where that is known better than from their times.
    since: Option<Since>,
    /// Whether blocks have left the window.
    slid: bool,
    is_due: bool,
    since_solved: u64,
    solution: Option<Box<Solution>>,
    error: Option<Arc<SessionError>>,
    answer: OnlineAnswer,
}

impl Window {
    /// Since `baseline`, with the name of its file, or against the zero of the encoders. `name`: of the session.
    ///
    /// # Errors
    /// [`SessionError`] when the baseline is of another robot.
    pub fn new(
        robot: impl Into<Arc<Robot>>,
        baseline: Option<(Baseline, String)>,
        options: &SessionOptions,
        name: &str,
    ) -> Result<Self, SessionError> {
        let robot = robot.into();
        if let Some((baseline, file)) = &baseline {
            baseline.belief(&robot, estimator(&robot, options).prior(), file)?;
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

    /// The window of a session of which it is known how it follows on the baseline.
    #[must_use]
    pub fn following(mut self, since: Since) -> Self {
        self.since = Some(since);
        self
    }

    /// The latest answer.
    pub fn answer(&self) -> &OnlineAnswer {
        &self.answer
    }

    /// What [`crate::session::estimate`] gives for the window's blocks, as of the last solution.
    pub fn estimate(&self) -> Option<&SessionEstimate> {
        self.solution.as_ref().map(|s| &s.solved.estimate)
    }

    /// The next baseline of the chain, as of the last solution.
    pub fn next(&self) -> Option<&Baseline> {
        self.solution.as_ref().map(|s| &s.solved.next)
    }

    /// Why the last window could not be solved; `None`: it was.
    pub fn error(&self) -> Option<&Arc<SessionError>> {
        self.error.as_ref()
    }

    /// The window, if it has been solved.
    ///
    /// # Errors
    /// Why it could not be.
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

    /// Blocks the window holds, and the memory they take, bytes.
    pub fn size(&self) -> (usize, usize) {
        let blocks = &self.recorded.blocks;
        (blocks.len(), blocks.iter().map(Block::bytes).sum())
    }

    /// Takes what was recorded since the last call, in order: blocks and the jumps of readings.
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
        if let Some(stated) = self.options.temperature_c {
            block.temperature_c = stated.mean;
        }
        self.answer.blocks += 1;
        self.answer.time_s = block.time_s;
        let blocks = &mut self.recorded.blocks;
        let repeats =
            block.stood_s > STAND_S && blocks.last().is_some_and(|last| last.stood_s > STAND_S);
        match blocks.last_mut() {
            Some(last) if repeats => {
                // Nor do jumps of readings meanwhile say anything: memory stays bounded.
                let stood = last.time_s..block.time_s;
                self.recorded.jumps.forget_within(stood);
                *last = block;
            }
            _ => {
                blocks.push(block);
                self.since_solved += 1;
                self.is_due |= self.since_solved >= SOLVE_EVERY;
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

    /// Drops blocks that no longer fit.
    fn slide(&mut self) {
        let block_s = FeatureConfig::default().block_s;
        let most = (WINDOW_S / block_s) as usize;
        let recorded = &mut self.recorded;
        let over = recorded.blocks.len().saturating_sub(most);
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

    /// Solves the window; the answer is that of its last block.
    pub fn solve(&mut self) {
        (self.is_due, self.since_solved) = (false, 0);
        let baseline = self.baseline.as_ref().map(|(b, file)| (b, file.as_str()));
        // What was known when the session began may have changed before the window begins.
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
                    joint.provisional = Some(Provisional::Refused);
                }
            }
        }
    }

    /// The answer from a solution and the blocks checked against it; `refused`: a later window could not be solved.
    fn update(answer: &mut OnlineAnswer, solution: &Solution, refused: bool) {
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
                Warning::ChangeMayEnd { joint, time_s, .. } if *joint == tendon.name => {
                    Some(Provisional::ChangeMayEnd { since_s: *time_s })
                }
                _ => None,
            });
            let rejected = estimate.warnings.iter().find_map(|warning| match warning {
                Warning::MuchLeftOut { share } => Some(Provisional::Rejected { share: *share }),
                _ => None,
            });
            let refused = refused.then_some(Provisional::Refused);
            *own = OnlineJoint {
                joint: own.joint,
                offset_rad: tendon.offset_rad,
                unknown_temperature_rad: unknown_rad.get(own.joint).copied().unwrap_or(0.0),
                stiffness_changed_probability: tendon
                    .stiffness_since_before
                    .map(|since| since.probability),
                provisional: may_end.or(rejected).or(refused),
            };
            let Some(step) = check.suspected(k) else {
                continue;
            };
            let known = tendon.offset_rad;
            let stepped = Gaussian::new(
                known.mean + step.mean_rad,
                known.deviation.hypot(step.deviation_rad),
            );
            if step.probability_beyond(known.half_width_95()) > NEGLIGIBLE {
                own.offset_rad = hull(known, stepped);
                own.provisional = Some(Provisional::Step {
                    since_s: step.since_s,
                    probability: step.probability,
                });
            }
        }
    }
}
