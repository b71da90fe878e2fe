//! The online estimate over blocks that were recorded: what it would have said beside the running robot.

use super::answer::OnlineJoint;
use super::window::Window;
use crate::baseline::Baseline;
use crate::error::SessionError;
use crate::estimator::SessionOptions;
use crate::session::{Doubt, LiveBlock, LiveCourse, LiveTendon, Recorded};
use sinew_model::robot::Robot;

/// The online estimate over a recording: `each` sees the window after every block; the result is the window after the last one.
///
/// The window's schedule counts blocks, not seconds of a clock: a replay gives what the worker of a running robot gives that keeps up.
///
/// # Errors
/// [`SessionError`] when the baseline is of another robot.
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

/// [`replay`], as the result of a session holds it.
///
/// # Errors
/// [`SessionError`] where no window could be solved.
pub fn trajectory(
    robot: &Robot,
    recorded: &Recorded,
    baseline: Option<(&Baseline, &str)>,
    options: &SessionOptions,
    name: &str,
) -> Result<LiveCourse, SessionError> {
    let mut out = LiveCourse {
        joints: Vec::new(),
        external_force: None,
        in_doubt: true,
        doubts: Vec::new(),
        blocks: Vec::with_capacity(recorded.blocks.len()),
    };
    let mut each = |window: &Window| {
        let answer = window.answer();
        let (time_s, in_doubt) = (answer.time_s, answer.is_provisional());
        let goes_on = out
            .blocks
            .last()
            .is_some_and(|before: &LiveBlock| before.in_doubt);
        if in_doubt {
            match out.doubts.last_mut().filter(|_| goes_on) {
                Some(doubt) => doubt.to_s = time_s,
                None => out.doubts.push(Doubt {
                    from_s: time_s,
                    to_s: time_s,
                }),
            }
        }
        out.blocks.push(LiveBlock {
            time_s,
            weight: 1.0 - answer.contact_probability,
            offset_rad: answer.joints.iter().map(|own| own.offset_rad).collect(),
            in_doubt,
        });
    };
    let mut window = replay(robot, recorded, baseline, options, name, &mut each)?;
    if window.estimate().is_none() {
        // A recording shorter than the first window.
        window.solve();
    }
    let window = window.solved()?;
    let answer = window.answer();
    let tendon = |own: &OnlineJoint| LiveTendon {
        name: robot.tendon_name(own.joint).to_owned(),
        offset_rad: own.offset_rad,
        stiffness_changed_probability: own.stiffness_changed_probability,
    };
    Ok(LiveCourse {
        joints: answer.joints.iter().map(tendon).collect(),
        external_force: answer.external_force,
        in_doubt: answer.is_provisional(),
        ..out
    })
}
