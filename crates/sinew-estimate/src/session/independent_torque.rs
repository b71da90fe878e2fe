//! Validation of recorded motor torques and tensions as independent measurements of the spring torque.

use super::recorder::Recorded;
use super::warning::{MotorTorqueError, Warning};
use sinew_model::offset::Block;
use sinew_model::robot::Robot;
use sinew_model::tendons::Routings;
use sinew_model::transmission::Friction;
use std::borrow::Cow;

/// Range of the regression slope of a motor torque or tension on the spring torque that is accepted.
///
/// Outside this range the channel is another quantity, or has another unit or sign: errors of the stiffness are at most
/// 20 %, those of a torque constant are smaller.
const VALID_SLOPE: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// Result of the comparison of a motor torque or tension with the spring torque.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Finding {
    /// Channel that is not recorded.
    Absent,
    /// Channel of constant value.
    Constant,
    /// Spring torque that changed by less than the friction of the drive.
    Untested,
    /// Motor torque that does negative work, J.
    NegativeWork(f64),
    /// Channel that follows the spring torque.
    Agrees,
    /// Channel that does not follow the spring torque, with its regression slope; 1 is expected.
    Contradicts(f64),
}

/// Channel that measures the load of a tendon independently of its extension.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Channel {
    MotorTorque,
    Tension,
}

/// Rejects invalid motor torques (if `motor_torque`) and invalid tensions, and returns one warning per rejected
/// channel.
///
/// The spring transmits the whole load of the link, so the torque of the drive follows `K (θ − q)` with a slope of one
/// except for friction and inertia, for any load or contact. The tension of a tendon that is not slack does the same.
/// If the channel of one joint is inconsistent, the channels of other joints that cannot be tested are rejected too,
/// because they share sign and unit.
pub(super) fn reject_invalid(
    robot: &Robot,
    recorded: &mut Cow<'_, Recorded>,
    motor_torque: bool,
) -> Vec<Warning> {
    let mut out = Vec::new();
    if motor_torque {
        out.extend(reject_channel(robot, recorded, Channel::MotorTorque));
    }
    if robot.has_joint_equations() {
        out.extend(reject_channel(robot, recorded, Channel::Tension));
    }
    out
}

fn reject_channel(
    robot: &Robot,
    recorded: &mut Cow<'_, Recorded>,
    channel: Channel,
) -> Vec<Warning> {
    let findings: Vec<(usize, Finding)> = (recorded.elastic.iter())
        .map(|&i| (i, finding(robot, recorded, i, channel)))
        .collect();
    let is_inconsistent =
        |f: &Finding| matches!(f, Finding::Contradicts(_) | Finding::NegativeWork(_));
    let any = findings.iter().any(|(_, f)| is_inconsistent(f));
    let mut out = Vec::new();
    for (axis, finding) in findings {
        let fault = match finding {
            Finding::Constant => MotorTorqueError::Constant,
            Finding::Contradicts(slope) => MotorTorqueError::Contradicts { slope },
            Finding::NegativeWork(work_j) => MotorTorqueError::NegativeWork { work_j },
            Finding::Untested if any => MotorTorqueError::Untested,
            Finding::Absent | Finding::Untested | Finding::Agrees => continue,
        };
        for block in &mut recorded.to_mut().blocks {
            let column = match channel {
                Channel::MotorTorque => &mut block.motor_torque,
                Channel::Tension => &mut block.tension_nm,
            };
            if let Some(value) = column.get_mut(axis) {
                *value = f64::NAN;
            }
        }
        let joint = robot.tendon_name(axis).to_owned();
        out.push(match channel {
            Channel::MotorTorque => Warning::MotorTorqueRejected { joint, fault },
            Channel::Tension => Warning::TensionRejected { joint, fault },
        });
    }
    out
}

fn finding(robot: &Robot, recorded: &Recorded, axis: usize, channel: Channel) -> Finding {
    /// Minimum tension, relative to the largest one; below it a strand may be slack.
    const MIN_TENSION_RATIO: f64 = 0.1;
    let Some(transmission) = &robot.transmissions[axis] else {
        return Finding::Absent;
    };
    let stiffness = transmission.stiffness_nm_per_rad;
    let routings = Routings::of(&robot.transmissions);
    let spring_nm = |block: &Block| match (&routings, channel) {
        (None, _) => stiffness * block.y[axis],
        (Some(routings), Channel::MotorTorque) => pulled_nm(robot, routings, block, axis),
        (Some(routings), Channel::Tension) => stiffness * routings.pull_rad(axis, block.y[axis]),
    };
    let measured = |block: &Block| match channel {
        Channel::MotorTorque => block.motor_torque[axis],
        Channel::Tension => block.tension_nm.get(axis).copied().unwrap_or(f64::NAN),
    };
    let mut pairs: Vec<(f64, f64)> = (recorded.blocks.iter())
        .map(|b| (spring_nm(b), measured(b)))
        .filter(|(_, measured)| measured.is_finite())
        .collect();
    let Some(&(_, first)) = pairs.first() else {
        return Finding::Absent;
    };
    /// Relative change below which a channel is constant up to rounding.
    const MAX_CONSTANT_RATIO: f64 = 1e-9;
    if pairs
        .iter()
        .all(|(_, u)| (u - first).abs() <= MAX_CONSTANT_RATIO * first.abs())
    {
        return Finding::Constant;
    }
    if channel == Channel::Tension {
        let most = pairs.iter().fold(0.0_f64, |most, (_, t)| most.max(t.abs()));
        pairs.retain(|(_, tension)| tension.abs() > MIN_TENSION_RATIO * most);
    }
    let count = pairs.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (spring, measured) = (mean(&|p| p.0), mean(&|p| p.1));
    let variance = mean(&|p| (p.0 - spring).powi(2));
    let friction = (transmission.motor_friction).or_default(stiffness, Friction::DEFAULT_DRIVE_RAD);
    if !(variance.sqrt() > friction.coulomb_nm) {
        let work_j = match channel {
            Channel::MotorTorque if routings.is_none() => {
                negative_work_j(&recorded.blocks, axis, friction.coulomb_nm, stiffness)
            }
            Channel::MotorTorque | Channel::Tension => None,
        };
        return work_j.map_or(Finding::Untested, Finding::NegativeWork);
    }
    let slope = mean(&|p| (p.0 - spring) * (p.1 - measured)) / variance;
    // A slack strand pulls less than its extension indicates.
    let may_be_slack = channel == Channel::MotorTorque
        && robot.pulling_tendon(axis).is_some()
        && slope > 0.0
        && slope < *VALID_SLOPE.start();
    match VALID_SLOPE.contains(&slope) || may_be_slack {
        true => Finding::Agrees,
        false => Finding::Contradicts(slope),
    }
}

/// Work of a motor torque over a recording, J, if it is negative by more than the load can have stored.
///
/// Over a recording the drive does the work of its friction, `F_c ∫|dθ|`, and that of the load between the first and the last
/// pose, which is at most the largest load times the range of the motor. A wrong sign of the torque, or of both positions,
/// reverses the work.
fn negative_work_j(blocks: &[Block], axis: usize, coulomb_nm: f64, stiffness: f64) -> Option<f64> {
    /// Minimum magnitude of negative work, relative to the work of the nominal friction: friction varies by less.
    const MIN_FRICTION_SHARE: f64 = 0.5;
    let motor_rad = |block: &Block| block.turned[axis] + block.y[axis];
    let (mut work_j, mut travel_rad) = (0.0, 0.0);
    for pair in blocks.windows(2) {
        let step_rad = motor_rad(&pair[1]) - motor_rad(&pair[0]);
        let torque_nm = 0.5 * (pair[0].motor_torque[axis] + pair[1].motor_torque[axis]);
        if (step_rad * torque_nm).is_finite() {
            work_j += torque_nm * step_rad;
            travel_rad += step_rad.abs();
        }
    }
    let finite = || blocks.iter().filter(|block| block.y[axis].is_finite());
    let load_nm = finite().fold(0.0, |most: f64, b| most.max(stiffness * b.y[axis].abs()));
    let ends = finite().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], b| {
        [low.min(motor_rad(b)), high.max(motor_rad(b))]
    });
    let stored_j = load_nm * (ends[1] - ends[0]);
    let least_j = MIN_FRICTION_SHARE * coulomb_nm * travel_rad + stored_j;
    (least_j > 0.0 && work_j < -least_j).then_some(work_j)
}

/// Load of the tendons of one motor by their nominal stiffness, N·m in the coordinate of the first of them.
fn pulled_nm(robot: &Robot, routings: &Routings, block: &Block, axis: usize) -> f64 {
    let same = (0..robot.axes()).filter(|other| routings.motor_axis(*other) == axis);
    same.fold(0.0, |sum, other| {
        let transmission = robot.transmissions[other].as_ref();
        let stiffness = transmission.map_or(0.0, |t| t.stiffness_nm_per_rad);
        let share = routings.drive_ratio(other) / routings.drive_ratio(axis);
        sum + share * stiffness * routings.pull_rad(other, block.y[other])
    })
}
