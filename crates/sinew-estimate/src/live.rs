//! Absolute offsets beside a running robot: samples in, offsets out, nothing allocated after construction.
//!
//! What a control loop, a Python session and the C interface step. `examples/live_offsets.rs` does the same with
//! frames of a recording.

use crate::baseline::Baseline;
use crate::error::SessionError;
use crate::feeder::{Fed, Feeder, FeederOptions, Refusal};
use crate::session::{self, SessionOptions};
use sinew_log::Frame;
use sinew_model::offset::{FeatureConfig, FeatureObserver, ForceEstimate, RecursiveOffsets};
use sinew_model::robot::Robot;
use sinew_model::{Gaussian, StepError};

/// What became of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stepped {
    /// It was taken.
    Taken,
    /// It was taken as the first one: at the start, or after a pause.
    Restarted,
    /// It was taken, and the offsets are new: those of a block of some 0.2 s that is complete, or, where work is
    /// [bounded](LiveOffsets::bound_work), of the block before.
    Updated,
    /// It was not taken, and changed nothing. Its time has passed all the same: the next `dt_s` counts from it.
    Refused(Refusal),
}

/// The absolute offsets of a robot since a baseline, sample by sample.
///
/// The sample that completes a block does all the block's work: milliseconds on an arm of seven joints. A loop that can't wait
/// that long [bounds](LiveOffsets::bound_work) the work of a call.
///
/// # Realtime
/// [`LiveOffsets::step`] and what reads: no allocation, lock, panic or clock.
#[derive(Debug, Clone)]
pub struct LiveOffsets {
    robot: Robot,
    before: Baseline,
    feeder: Feeder<FeatureObserver>,
    filter: RecursiveOffsets,
    frame: Frame,
    started: bool,
    /// Slices of a block's work that a call does; none: all at once.
    slices_per_step: Option<usize>,
    blocks_left_out: u64,
}

impl LiveOffsets {
    /// For `robot` since `baseline` (with the name of its file). All memory is allocated here.
    ///
    /// # Errors
    /// [`SessionError`] when the baseline is of another robot.
    pub fn new(
        robot: Robot,
        (baseline, file): (Baseline, &str),
        options: &SessionOptions,
    ) -> Result<Self, SessionError> {
        let filter = session::live(&robot, (&baseline, file), options)?;
        let features = FeatureObserver::new(&robot.arm, FeatureConfig::default());
        Ok(Self {
            feeder: Feeder::new(features, &robot.transmissions, FeederOptions::default()),
            frame: Frame::new(robot.arm.dof()),
            filter,
            before: baseline,
            started: false,
            slices_per_step: None,
            blocks_left_out: 0,
            robot,
        })
    }

    /// From now on every call does a small, fixed part of a block's work, so that it is done within the time of the next
    /// block: the answers are the same, 0.2 s later. Returns how many slices that are; a slice is `O(d²)` of `d` parameters.
    ///
    /// * `period_max_s`: the longest time between samples while all is well, s. Where samples come at longer ones, a block
    ///   that finds the one before undone is [left out](LiveOffsets::blocks_left_out).
    ///
    /// # Errors
    /// [`StepError::TimeStep`] when that is no time step; nothing has changed.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn bound_work(&mut self, period_max_s: f64) -> Result<usize, StepError> {
        if !(period_max_s > 0.0 && period_max_s.is_finite()) {
            return Err(StepError::TimeStep);
        }
        // One sample less: the filters' start takes it, and rounding.
        let samples = (FeatureConfig::default().block_s / period_max_s).floor() - 1.0;
        let slices = self.filter.slices_per_block();
        let slices = slices.div_ceil((samples.max(1.0)) as usize);
        self.slices_per_step = Some(slices);
        Ok(slices)
    }

    /// Blocks that were left out because work on the one before wasn't done: 0 unless samples come at longer times than
    /// [stated](LiveOffsets::bound_work).
    pub fn blocks_left_out(&self) -> u64 {
        self.blocks_left_out
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Takes a sample, `dt_s` after the one before; of the first that doesn't matter.
    ///
    /// * `q`, `theta`: `n` each, joint and motor positions, rad. A rigid joint's motor position doesn't matter.
    /// * `tau_m`: `n` or empty, motor torque, N·m; NaN where it isn't known.
    /// * `temperature_c`: °C; NaN where it isn't known.
    ///
    /// # Errors
    /// [`StepError::Length`], [`StepError::TimeStep`]; the state is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn step(
        &mut self,
        dt_s: f64,
        q: &[f64],
        theta: &[f64],
        tau_m: &[f64],
        temperature_c: f64,
    ) -> Result<Stepped, StepError> {
        const NS_PER_S: f64 = 1e9;
        let n = self.frame.q.len();
        let torque_fits = tau_m.is_empty() || tau_m.len() == n;
        if q.len() != n || theta.len() != n || !torque_fits {
            return Err(StepError::Length);
        }
        if self.started {
            if !(dt_s > 0.0 && dt_s <= NS_PER_S) {
                return Err(StepError::TimeStep);
            }
            let step_ns = ((dt_s * NS_PER_S).round() as i64).max(1);
            self.frame.time_ns = self.frame.time_ns.saturating_add(step_ns);
        }
        self.started = true;
        self.frame.q.copy_from_slice(q);
        self.frame.theta.copy_from_slice(theta);
        match tau_m {
            [] => self.frame.tau_m.fill(f64::NAN),
            stated => self.frame.tau_m.copy_from_slice(stated),
        }
        self.frame.temperature_c = temperature_c;
        let fed = self.feeder.frame(&self.frame);
        let complete = fed.output() == Some(true);
        let updated = match self.slices_per_step {
            None if complete => {
                self.filter.step(self.feeder.observer().block())?;
                true
            }
            None => false,
            Some(slices) => {
                if complete && !self.filter.begin(self.feeder.observer().block())? {
                    self.blocks_left_out = self.blocks_left_out.saturating_add(1);
                }
                // Of a sample that is refused too: its time has passed.
                let was_busy = self.filter.is_busy();
                self.filter.advance(slices);
                was_busy && !self.filter.is_busy()
            }
        };
        Ok(match fed {
            Fed::Refused(why) => Stepped::Refused(why),
            _ if updated => Stepped::Updated,
            Fed::Taken(_) => Stepped::Taken,
            Fed::Restarted(_) => Stepped::Restarted,
        })
    }

    /// Samples that follow don't go on where the last one was: the filters start anew, what is known stays.
    pub fn interrupt(&mut self) {
        self.frame.segment = self.frame.segment.wrapping_add(1);
    }

    /// The offset of a joint since the baseline, rad; NaN for one there isn't.
    pub fn offset(&self, joint: usize) -> Gaussian {
        self.filter.offset(joint)
    }

    /// Whether the offsets are in doubt: the first half minute, a contact, a slip not settled yet.
    pub fn is_provisional(&self) -> bool {
        self.filter.is_provisional()
    }

    /// Probability that a joint's stiffness has changed since the baseline.
    pub fn stiffness_changed(&self, joint: usize) -> f64 {
        self.filter.stiffness_changed(joint)
    }

    /// What a temperature that isn't known, now or in the baseline, adds to the deviation of a joint's offset, rad; 0 where both are
    /// known. The interval holds it: it is the tolerance of robot.toml, so warmth far beyond that reads as stretch.
    pub fn unknown_temperature_rad(&self, joint: usize) -> f64 {
        self.filter.unknown_temperature_rad(joint)
    }

    /// A constant force from outside at the tool, as far as it is known; `None`: none is looked for, as robot.toml or the
    /// session's options say.
    pub fn external_force(&self) -> Option<ForceEstimate> {
        self.filter.external_force()
    }

    /// How fast offsets may move, rad/s, a standard deviation: 0 of ropes that don't creep, such as steel. It is 1 mrad a minute
    /// unless this says otherwise, before the first sample.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] where it is no deviation, [`StepError::Started`] after the first block, some 0.2 s; nothing has
    /// changed.
    pub fn expect_creep(&mut self, deviation_rad_per_s: f64) -> Result<(), StepError> {
        self.filter.expect_creep(deviation_rad_per_s)
    }

    /// What is known now as the baseline of the next session: `recording` names this one, which ended at
    /// `end_time_ns`.
    ///
    /// # Errors
    /// [`SessionError::Provisional`] while the offsets are in doubt.
    pub fn save(&self, recording: &str, end_time_ns: i64) -> Result<Baseline, SessionError> {
        let end = (recording, end_time_ns);
        session::live_saved(&self.robot, &self.before, &self.filter, end)
    }
}
