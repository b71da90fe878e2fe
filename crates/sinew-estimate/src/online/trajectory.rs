//! Online estimate over recorded blocks, as it would have been on the running robot.

use super::answer::OnlineJoint;
use super::window::Window;
use crate::baseline::Baseline;
use crate::decimated::Decimated;
use crate::error::SessionError;
use crate::estimator::SessionOptions;
use crate::session::{OnlineBlock, OnlineTendon, OnlineTrajectory, ProvisionalInterval, Recorded};
use sinew_model::robot::Robot;

/// Computes the online estimate over a recording. `each` is called with the window after every block; returns the
/// window after the last block.
///
/// The schedule of the window counts blocks, not time: a replay gives the same result as a worker without delay on the
/// running robot.
///
/// # Errors
/// Returns [`SessionError`] if the baseline belongs to another robot.
pub fn replay(
    robot: &Robot,
    recorded: &Recorded,
    baseline: Option<(&Baseline, &str)>,
    options: &SessionOptions,
    name: &str,
    each: &mut dyn FnMut(&Window),
) -> Result<Window, SessionError> {
    let baseline = baseline.map(|(baseline, file)| (baseline.clone(), file.to_owned()));
    let mut window = Window::new(robot.clone(), baseline, options, name)?;
    for part in recorded.parts() {
        window.push(&part);
        if window.is_due() {
            window.solve();
        }
        each(&window);
    }
    Ok(window)
}

/// Computes the online estimate over a recording as part of a session's result.
///
/// # Errors
/// Returns [`SessionError`] if no window could be solved.
pub fn trajectory(
    robot: &Robot,
    recorded: &Recorded,
    baseline: Option<(&Baseline, &str)>,
    options: &SessionOptions,
    name: &str,
) -> Result<OnlineTrajectory, SessionError> {
    let mut builder = TrajectoryBuilder::new(robot, baseline, options, name)?;
    builder.push(recorded);
    builder.finish()
}

/// Online estimate over the parts of a recording.
#[derive(Debug)]
pub(crate) struct TrajectoryBuilder {
    robot: Robot,
    window: Window,
    intervals: Vec<ProvisionalInterval>,
    blocks: Decimated<OnlineBlock>,
    was_provisional: bool,
}

impl TrajectoryBuilder {
    /// Creates the estimate before the first part.
    ///
    /// # Errors
    /// Returns [`SessionError`] if the baseline belongs to another robot.
    pub(crate) fn new(
        robot: &Robot,
        baseline: Option<(&Baseline, &str)>,
        options: &SessionOptions,
        name: &str,
    ) -> Result<Self, SessionError> {
        let baseline = baseline.map(|(baseline, file)| (baseline.clone(), file.to_owned()));
        Ok(Self {
            window: Window::new(robot.clone(), baseline, options, name)?,
            robot: robot.clone(),
            intervals: Vec::new(),
            blocks: Decimated::default(),
            was_provisional: false,
        })
    }

    /// Processes the next part.
    pub(crate) fn push(&mut self, recorded: &Recorded) {
        for part in recorded.parts() {
            self.window.push(&part);
            if self.window.is_due() {
                self.window.solve();
            }
            self.record();
        }
    }

    fn record(&mut self) {
        let answer = self.window.answer();
        let (time_s, provisional) = (answer.time_s, answer.is_provisional());
        if provisional {
            match self.intervals.last_mut().filter(|_| self.was_provisional) {
                Some(interval) => interval.to_s = time_s,
                None => self.intervals.push(ProvisionalInterval {
                    from_s: time_s,
                    to_s: time_s,
                }),
            }
        }
        self.was_provisional = provisional;
        self.blocks.push(OnlineBlock {
            time_s,
            weight: 1.0 - answer.contact_probability,
            offset_rad: answer.joints.iter().map(|own| own.offset_rad).collect(),
            provisional,
        });
    }

    /// Returns the estimate after the last part.
    ///
    /// # Errors
    /// Returns [`SessionError`] if no window could be solved.
    pub(crate) fn finish(mut self) -> Result<OnlineTrajectory, SessionError> {
        if self.window.estimate().is_none() {
            // A recording shorter than the first window.
            self.window.solve();
        }
        let window = self.window.solved()?;
        let answer = window.answer();
        let tendon = |own: &OnlineJoint| OnlineTendon {
            name: self.robot.tendon_name(own.joint).to_owned(),
            offset_rad: own.offset_rad,
            stiffness_changed_probability: own.stiffness_changed_probability,
        };
        Ok(OnlineTrajectory {
            joints: answer.joints.iter().map(tendon).collect(),
            external_force: answer.external_force,
            provisional: answer.is_provisional(),
            provisional_intervals: self.intervals,
            blocks: self.blocks.into_vec(),
        })
    }
}
