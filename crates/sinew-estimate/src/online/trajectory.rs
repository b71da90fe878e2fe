//! Online estimate over recorded blocks, as it would have been on the running robot.

use super::answer::OnlineJoint;
use super::window::Window;
use crate::baseline::Baseline;
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

/// Computes the online estimate by [`replay`] as part of a session's result.
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
    let mut out = OnlineTrajectory {
        joints: Vec::new(),
        external_force: None,
        provisional: true,
        provisional_intervals: Vec::new(),
        blocks: Vec::with_capacity(recorded.blocks.len()),
    };
    let mut each = |window: &Window| {
        let answer = window.answer();
        let (time_s, provisional) = (answer.time_s, answer.is_provisional());
        let continues = out
            .blocks
            .last()
            .is_some_and(|before: &OnlineBlock| before.provisional);
        if provisional {
            match out.provisional_intervals.last_mut().filter(|_| continues) {
                Some(interval) => interval.to_s = time_s,
                None => out.provisional_intervals.push(ProvisionalInterval {
                    from_s: time_s,
                    to_s: time_s,
                }),
            }
        }
        out.blocks.push(OnlineBlock {
            time_s,
            weight: 1.0 - answer.contact_probability,
            offset_rad: answer.joints.iter().map(|own| own.offset_rad).collect(),
            provisional,
        });
    };
    let mut window = replay(robot, recorded, baseline, options, name, &mut each)?;
    if window.estimate().is_none() {
        // A recording shorter than the first window.
        window.solve();
    }
    let window = window.solved()?;
    let answer = window.answer();
    let tendon = |own: &OnlineJoint| OnlineTendon {
        name: robot.tendon_name(own.joint).to_owned(),
        offset_rad: own.offset_rad,
        stiffness_changed_probability: own.stiffness_changed_probability,
    };
    Ok(OnlineTrajectory {
        joints: answer.joints.iter().map(tendon).collect(),
        external_force: answer.external_force,
        provisional: answer.is_provisional(),
        ..out
    })
}
