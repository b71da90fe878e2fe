//! Exclusion of joint encoders whose reading is frozen while their motor moves.

use super::recorder::Recorded;
use super::warning::Warning;
use sinew_model::offset::Block;
use sinew_model::robot::Robot;
use sinew_model::tendons::Routings;
use std::borrow::Cow;

/// Largest change of a filtered joint position between two blocks of a constant reading, rad: rounding of the filters.
pub(super) const MAX_CONSTANT_RAD: f64 = 1e-9;
/// Distance from the constant reading at which the joint still moved, rad: the filters settle from there.
const SETTLING_RAD: f64 = 0.01;
/// Smallest travel of the motor beyond which a constant reading is frozen, rad: no rope-driven joint deflects by more at
/// rest.
const MIN_MOTOR_TRAVEL_RAD: f64 = 0.3;

/// Excludes the joints with a frozen encoder from the blocks in which it is frozen, with one warning each.
///
/// The reading of a joint that is held or stuck is constant as well, while its motor bends the spring. The motor can bend
/// it by the effort limit of the joint at most, in both directions: beyond that travel the joint moves, and its encoder
/// does not.
pub(super) fn reject_frozen(robot: &Robot, recorded: &mut Cow<'_, Recorded>) -> Vec<Warning> {
    if Routings::of(&robot.transmissions).is_some() {
        return Vec::new();
    }
    let mut out = Vec::new();
    for joint in recorded.elastic.clone() {
        let stiffness = robot.transmissions[joint]
            .as_ref()
            .map(|t| t.stiffness_nm_per_rad);
        let effort_nm = robot.limits.get(joint).map_or(0.0, |limits| limits.effort);
        let held_rad = stiffness.map_or(0.0, |stiffness| 2.0 * effort_nm / stiffness);
        let held_rad = Some(held_rad).filter(|rad| rad.is_finite()).unwrap_or(0.0);
        let travel_rad = held_rad.max(MIN_MOTOR_TRAVEL_RAD);
        let Some(frozen) = frozen(&recorded.blocks, joint, travel_rad) else {
            continue;
        };
        out.push(Warning::JointSeized {
            joint: robot.tendon_name(joint).to_owned(),
            from_s: recorded.blocks[frozen.from].time_s,
            joint_travel_rad: 0.0,
            motor_travel_rad: frozen.motor_travel_rad,
        });
        let blocks = &mut recorded.to_mut().blocks[frozen.from..frozen.to];
        blocks.iter_mut().for_each(|block| block.exclude(joint));
    }
    out
}

/// Longest phase of a constant reading.
struct Frozen {
    /// First block, in which the filters may still settle.
    from: usize,
    /// Block after the last.
    to: usize,
    motor_travel_rad: f64,
}

/// Phase of a constant reading in which the motor travels farthest; `None` if it travels less than `travel_rad`.
fn frozen(blocks: &[Block], joint: usize, travel_rad: f64) -> Option<Frozen> {
    let q = |b: usize| blocks[b].turned[joint];
    let mut best: Option<Frozen> = None;
    let mut start = 0;
    for b in 1..=blocks.len() {
        if b < blocks.len() && (q(b) - q(b - 1)).abs() <= MAX_CONSTANT_RAD {
            continue;
        }
        let motor = blocks[start..b]
            .iter()
            .map(|k| k.turned[joint] + k.y[joint]);
        let range = motor.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        });
        let motor_travel_rad = range[1] - range[0];
        let least = best
            .as_ref()
            .map_or(travel_rad, |best| best.motor_travel_rad);
        if motor_travel_rad > least {
            let settled = q(start);
            let moving = (0..start)
                .rev()
                .find(|&k| (q(k) - settled).abs() > SETTLING_RAD);
            best = Some(Frozen {
                from: moving.unwrap_or(0),
                to: b,
                motor_travel_rad,
            });
        }
        start = b;
    }
    best
}
