//! Exclusion of encoders whose reading is frozen while the other side of their tendon moves.

use super::recorder::Recorded;
use super::warning::Warning;
use crate::error::ConstantMotor;
use sinew_model::arm::JointKind;
use sinew_model::offset::Block;
use sinew_model::robot::Robot;
use sinew_model::tendons::Routings;
use std::borrow::Cow;

/// Largest change of a filtered position between two blocks of a constant reading, rad: rounding of the filters.
pub(super) const MAX_CONSTANT_RAD: f64 = 1e-9;
/// Distance from the constant reading at which the encoder still moved, rad: the filters settle from there.
const SETTLING_RAD: f64 = 0.01;
/// Smallest travel of the other side beyond which a constant reading is frozen, rad: no rope-driven joint deflects by more
/// at rest.
const MIN_OTHER_TRAVEL_RAD: f64 = 0.3;

/// Side of a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Joint,
    Motor,
}

impl Side {
    const BOTH: [Self; 2] = [Self::Joint, Self::Motor];

    fn other(self) -> Self {
        match self {
            Self::Joint => Self::Motor,
            Self::Motor => Self::Joint,
        }
    }

    /// Filtered position of a joint or its motor, rad.
    fn position_rad(self, block: &Block, joint: usize) -> f64 {
        match self {
            Self::Joint => block.turned[joint],
            Self::Motor => block.turned[joint] + block.y[joint],
        }
    }
}

/// Excludes the joints with a frozen encoder from the blocks in which it is frozen, with one warning each. A motor position
/// that is constant in all blocks is an error ([`constant_motors`]) and is not excluded.
///
/// The reading of a joint that is held or stuck is constant as well, while its motor bends the spring; and so is that of a
/// motor with a brake, while a load bends the spring. The spring can be bent by the effort limit of the joint at most, in
/// both directions: beyond that travel the other side moves, and its encoder does not.
pub(super) fn reject_frozen(robot: &Robot, recorded: &mut Cow<'_, Recorded>) -> Vec<Warning> {
    if Routings::of(&robot.transmissions).is_some() {
        return Vec::new();
    }
    let mut out = Vec::new();
    for joint in recorded.elastic.clone() {
        for side in Side::BOTH {
            let Some(frozen) = frozen(robot, &recorded.blocks, joint, side) else {
                continue;
            };
            let from_s = recorded.blocks[frozen.from].time_s;
            let name = robot.tendon_name(joint).to_owned();
            out.push(match side {
                Side::Joint => Warning::JointSeized {
                    joint: name,
                    from_s,
                    joint_travel_rad: 0.0,
                    motor_travel_rad: frozen.other_travel_rad,
                },
                Side::Motor if frozen.is_whole(&recorded.blocks) => continue,
                Side::Motor => Warning::MotorEncoderFrozen {
                    joint: name,
                    from_s,
                    motor_rad: frozen.reading_rad,
                    joint_travel_rad: frozen.other_travel_rad,
                },
            });
            let blocks = &mut recorded.to_mut().blocks[frozen.from..frozen.to];
            blocks.iter_mut().for_each(|block| block.exclude(joint));
        }
    }
    out
}

/// Motors whose position is constant in all blocks while their joints travel farther than a spring can be bent.
pub(super) fn constant_motors(robot: &Robot, recorded: &Recorded) -> Vec<ConstantMotor> {
    if Routings::of(&robot.transmissions).is_some() {
        return Vec::new();
    }
    let motors = recorded.elastic.iter().filter_map(|&joint| {
        let frozen = frozen(robot, &recorded.blocks, joint, Side::Motor)?;
        frozen.is_whole(&recorded.blocks).then(|| ConstantMotor {
            joint: robot.tendon_name(joint).to_owned(),
            motor_rad: frozen.reading_rad,
            joint_travel_rad: frozen.other_travel_rad,
            slides: robot.arm.joint_kind(joint) == Some(JointKind::Prismatic),
        })
    });
    motors.collect()
}

/// Phase of a constant reading.
struct Frozen {
    /// First block, in which the filters may still settle.
    from: usize,
    /// Block after the last.
    to: usize,
    /// Constant reading, rad.
    reading_rad: f64,
    /// Travel of the other side, rad.
    other_travel_rad: f64,
}

impl Frozen {
    /// Whether the reading is constant in all blocks.
    fn is_whole(&self, blocks: &[Block]) -> bool {
        self.from == 0 && self.to == blocks.len()
    }
}

/// Largest travel of one side of a tendon while the other is held, rad: twice the deflection of the spring by the effort limit.
pub(super) fn held_travel_rad(robot: &Robot, joint: usize) -> f64 {
    let stiffness = robot.transmissions[joint]
        .as_ref()
        .map(|t| t.stiffness_nm_per_rad);
    let effort_nm = robot.limits.get(joint).map_or(0.0, |limits| limits.effort);
    let bent_rad = stiffness.map_or(0.0, |stiffness| 2.0 * effort_nm / stiffness);
    let bent_rad = Some(bent_rad).filter(|rad| rad.is_finite()).unwrap_or(0.0);
    bent_rad.max(MIN_OTHER_TRAVEL_RAD)
}

/// Phase of a constant reading of one side in which the other side travels farthest; `None` if it travels less than the
/// spring can be bent.
fn frozen(robot: &Robot, blocks: &[Block], joint: usize, side: Side) -> Option<Frozen> {
    let travel_rad = held_travel_rad(robot, joint);
    let reading = |b: usize| side.position_rad(&blocks[b], joint);
    let mut best: Option<Frozen> = None;
    let mut start = 0;
    for b in 1..=blocks.len() {
        if b < blocks.len() && (reading(b) - reading(b - 1)).abs() <= MAX_CONSTANT_RAD {
            continue;
        }
        let other = blocks[start..b]
            .iter()
            .map(|block| side.other().position_rad(block, joint));
        let range = other.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        });
        let other_travel_rad = range[1] - range[0];
        let least = best
            .as_ref()
            .map_or(travel_rad, |best| best.other_travel_rad);
        if other_travel_rad > least && reading(start).is_finite() {
            let settled = reading(start);
            let moving = (0..start)
                .rev()
                .find(|&k| (reading(k) - settled).abs() > SETTLING_RAD);
            best = Some(Frozen {
                from: moving.unwrap_or(0),
                to: b,
                reading_rad: settled,
                other_travel_rad,
            });
        }
        start = b;
    }
    best
}
