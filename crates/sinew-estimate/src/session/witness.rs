//! Whether a recorded motor torque can be a witness of what the spring carries.

use super::recorder::Recorded;
use super::warning::{Warning, WitnessFault};
use sinew_model::robot::Robot;
use sinew_model::transmission::Friction;
use std::borrow::Cow;

/// Of the spring's torque, the least and the most share that a motor torque may show before it is another
/// quantity, another unit or another sign. Stiffness is off by a fifth at most, a torque constant by less.
const AGREES: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// What a motor torque shows beside the spring's.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Finding {
    /// It is not recorded.
    Absent,
    /// It never changed.
    Constant,
    /// The spring's torque changed by less than the drive's friction.
    Untested,
    /// It follows the spring's.
    Agrees,
    /// It doesn't: its slope over the spring's torque.
    Contradicts(f64),
}

/// Leaves out the motor torques that can't be any, and says which.
///
/// The spring passes on whatever the link carries, so the drive's torque follows `K (θ − q)` with a slope of one but
/// for friction and inertia, whatever load or contact there is. Where one joint's contradicts, what can't be
/// tested of the others is left out too: they share sign and unit.
pub(super) fn leave_out_false(robot: &Robot, recorded: &mut Cow<'_, Recorded>) -> Vec<Warning> {
    let findings: Vec<(usize, Finding)> = (recorded.elastic.iter())
        .map(|&i| (i, finding(robot, recorded, i)))
        .collect();
    let contradicted = |f: &Finding| matches!(f, Finding::Contradicts(_));
    let any = findings.iter().any(|(_, f)| contradicted(f));
    let mut out = Vec::new();
    for (joint, finding) in findings {
        let fault = match finding {
            Finding::Constant => WitnessFault::Constant,
            Finding::Contradicts(slope) => WitnessFault::Contradicts { slope },
            Finding::Untested if any => WitnessFault::Untested,
            Finding::Absent | Finding::Untested | Finding::Agrees => continue,
        };
        for block in &mut recorded.to_mut().blocks {
            block.motor_torque[joint] = f64::NAN;
        }
        out.push(Warning::MotorTorqueLeftOut {
            joint: robot.tendon_name(joint).to_owned(),
            fault,
        });
    }
    out
}

fn finding(robot: &Robot, recorded: &Recorded, joint: usize) -> Finding {
    let Some(transmission) = &robot.transmissions[joint] else {
        return Finding::Absent;
    };
    let stiffness = transmission.stiffness_nm_per_rad;
    let pairs: Vec<(f64, f64)> = (recorded.blocks.iter())
        .map(|b| (stiffness * b.y[joint], b.motor_torque[joint]))
        .filter(|(_, motor)| motor.is_finite())
        .collect();
    let Some(&(_, first)) = pairs.first() else {
        return Finding::Absent;
    };
    /// A channel's last digits.
    const NOTHING: f64 = 1e-9;
    if pairs
        .iter()
        .all(|(_, u)| (u - first).abs() <= NOTHING * first.abs())
    {
        return Finding::Constant;
    }
    let count = pairs.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (spring, motor) = (mean(&|p| p.0), mean(&|p| p.1));
    let variance = mean(&|p| (p.0 - spring).powi(2));
    let friction =
        (transmission.motor_friction).or_guessed(stiffness, Friction::GUESSED_OF_DRIVE_RAD);
    if !(variance.sqrt() > friction.coulomb_nm) {
        return Finding::Untested;
    }
    let slope = mean(&|p| (p.0 - spring) * (p.1 - motor)) / variance;
    match AGREES.contains(&slope) {
        true => Finding::Agrees,
        false => Finding::Contradicts(slope),
    }
}
