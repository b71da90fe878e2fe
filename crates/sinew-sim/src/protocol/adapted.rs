//! The protocol on another robot: its scenarios are transferred from the joints and links of the BioRob-like arm to
//! those of that robot.
//!
//! | | BioRob-like arm | another |
//! |---|---|---|
//! | poses | as listed | middle of the URDF's limits ± 40 % of them, at most ± 1.2 rad |
//! | controller | as listed | the simulator's own |
//! | friction | half to one and a half of nominal | the same; of a default if robot.toml specifies none |
//! | error of the motor torque | 0.02 N·m | a thousandth of the stiffness, times a rad |
//! | payload | 0 to 0.5 kg at `tool` | 0 to twice `payload_mean_kg`, at the link furthest out |
//! | contacts | 2 to 15 N at `tool` | 0.14 to 1 of the moving weight, there |
//! | offsets of 10 mrad, slips | shoulder pitch, elbow | the two joints that gravity loads most |

use super::texts::set;
use sinew_model::arm::{ArmWorkspace, JointKind};
use sinew_model::robot::Robot;
use sinew_model::transmission::{Friction, Transmission};
use toml::{Table, Value};

/// Scenarios that apply to any robot; the others refer to specific joints and poses.
pub(super) const ADAPTABLE: [&str; 5] = ["S5", "S6", "S7", "S8", "S8b"];

/// Poses reach so far from the middle of a joint's limits, of these …
const REACH: f64 = 0.4;
/// … and at most so far, rad or m.
const MAX_RANGE_RAD: f64 = 1.2;
const MAX_RANGE_M: f64 = 0.3;
/// Offset, ripple and noise of a motor torque, relative to the stiffness, rad.
const MOTOR_TORQUE: f64 = 1e-3;
/// Range of the contact forces, relative to the weight of the moving masses.
const CONTACT: [f64; 2] = [0.14, 1.0];

/// Puts `robot` in the place of the BioRob-like arm in one of the [`ADAPTABLE`] scenarios.
///
/// # Errors
/// Returns a message if the robot has no joint to estimate, or if a group of tendons has an equation per joint.
pub(super) fn adapt(table: &mut Table, robot: &Robot) -> Result<(), String> {
    if robot.has_joint_equations() {
        return Err(format!(
            "{} has tendons that share joints, as strands do, which the protocol does not support; write a scenario for sinew simulate",
            robot.name
        ));
    }
    let ranges = ranges(robot);
    let elastic: Vec<(&str, &Transmission)> = (robot.joint_names().iter())
        .zip(&robot.transmissions)
        .filter_map(|(name, t)| Some((name.as_str(), t.as_ref()?)))
        .collect();
    if elastic.is_empty() {
        return Err(format!(
            "{} has no elastic joint; set stiffness_nm_per_rad of its joints in robot.toml",
            robot.name
        ));
    }
    let each = |of: &dyn Fn(&Transmission) -> Value| -> Value {
        let entries = elastic.iter().map(|(name, t)| (name.to_string(), of(t)));
        Value::Table(entries.collect())
    };
    let around = |nominal: f64| between(0.5 * nominal, 1.5 * nominal);

    table.remove("controller");
    let poses = robot.joint_names().iter().zip(&ranges);
    let poses = poses.map(|(name, [lo, hi])| (name.clone(), between(*lo, *hi)));
    set(table, "motion", "range_rad", Value::Table(poses.collect()));
    let of_joint = |t: &Transmission| {
        t.joint_friction
            .or_default(t.stiffness_nm_per_rad, Friction::DEFAULT_JOINT_RAD)
    };
    let of_drive = |t: &Transmission| {
        t.motor_friction
            .or_default(t.stiffness_nm_per_rad, Friction::DEFAULT_DRIVE_RAD)
    };
    let joint = "joint_friction";
    let coulomb = |t: &Transmission| around(of_joint(t).coulomb_nm);
    let viscous = |t: &Transmission| around(of_joint(t).viscous_nm_s_per_rad);
    let drive = |t: &Transmission| around(of_drive(t).coulomb_nm);
    set(table, joint, "coulomb_nm", each(&coulomb));
    set(table, joint, "viscous_nm_s_per_rad", each(&viscous));
    set(table, "motor_friction", "coulomb_nm", each(&drive));
    let share = |t: &Transmission| Value::Float(rounded(MOTOR_TORQUE * motor_stiffness(t)));
    let spread = |t: &Transmission| Value::Table(Table::from_iter([("std".into(), share(t))]));
    set(table, "motor_torque", "offset_nm", each(&spread));
    set(table, "motor_torque", "ripple_nm", each(&share));
    // One number for all joints: that of the softest.
    let softest = elastic.iter().map(|(_, t)| motor_stiffness(t));
    let noise = rounded(MOTOR_TORQUE * softest.fold(f64::INFINITY, f64::min));
    set(table, "motor_torque", "noise_nm", Value::Float(noise));

    let (link, weight_n) = (tip(robot), weight_n(robot));
    if let Some(Value::Array(payloads)) = table.get_mut("payloads") {
        let most = 2.0 * robot.tolerances.payload_kg.mean;
        for payload in payloads.iter_mut().filter_map(Value::as_table_mut) {
            payload.insert("link".into(), Value::String(link.clone()));
            payload.insert("mass_kg".into(), between(0.0, most));
        }
    }
    if table.contains_key("random_contacts") {
        let force = CONTACT.map(|share| share * weight_n);
        set(
            table,
            "random_contacts",
            "force_n",
            between(force[0], force[1]),
        );
        set(table, "random_contacts", "link", Value::String(link));
    }
    let offsets = offsets(&elastic, &main_joints(robot, &ranges));
    table.insert("offsets".into(), Value::Array(offsets));
    Ok(())
}

/// Torque in N·m where the motor's is recorded, of one rad of the tendon's coordinate.
fn motor_stiffness(t: &Transmission) -> f64 {
    let ratio = t.routing.as_ref().map(|routing| routing.drive_ratio.abs());
    ratio.map_or(t.stiffness_nm_per_rad, |ratio| {
        ratio * t.stiffness_nm_per_rad
    })
}

/// Offsets from session B on, and the slips of C.
fn offsets(elastic: &[(&str, &Transmission)], main: &[String]) -> Vec<Value> {
    let offset = |joint: &str, at_s: Value, rad: Value| {
        let own = elastic.iter().find(|(name, _)| *name == joint);
        let routing = own.and_then(|(_, t)| t.routing.as_ref());
        // Variants refer to the tendons by this key.
        let tendon = routing.map_or(joint, |routing| &routing.tendon);
        Value::Table(Table::from_iter([
            ("joint".into(), Value::String(tendon.into())),
            ("kind".into(), Value::String("physical".into())),
            ("shape".into(), Value::String("step".into())),
            ("at_s".into(), at_s),
            ("rad".into(), rad),
        ]))
    };
    let since = elastic.iter().map(|(name, _)| {
        let rad = if main.iter().any(|m| m == name) {
            Value::Float(0.010)
        } else {
            between(0.0, 0.012)
        };
        offset(name, Value::Float(60.0), rad)
    });
    let when = [between(128.0, 132.0), between(140.0, 148.0)];
    let slips = main.iter().zip(when);
    let slips = slips.map(|(name, at_s)| offset(name, at_s, Value::Float(0.005)));
    since.chain(slips).collect()
}

/// Poses of every joint, rad or m.
fn ranges(robot: &Robot) -> Vec<[f64; 2]> {
    let limits = robot.limits.iter().enumerate();
    limits
        .map(|(i, limit)| {
            let most = match robot.arm.joint_kind(i) {
                Some(JointKind::Prismatic) => MAX_RANGE_M,
                _ => MAX_RANGE_RAD,
            };
            let width = limit.upper - limit.lower;
            let (middle, half) = if width.is_finite() && width > 0.0 {
                let middle = 0.5 * (limit.upper + limit.lower);
                (middle, most.min(REACH * width))
            } else {
                (0.0, most)
            };
            [rounded(middle - half), rounded(middle + half)]
        })
        .collect()
}

/// The two elastic joints that gravity loads most over the poses, or the one there is.
fn main_joints(robot: &Robot, ranges: &[[f64; 2]]) -> Vec<String> {
    /// Poses without a pattern.
    const POSES: usize = 64;
    /// A step of this share of the range from pose to pose, another for every joint.
    const STEP: f64 = 0.754_877_666;
    let n = robot.arm.dof();
    let (mut ws, still) = (ArmWorkspace::new(&robot.arm), vec![0.0; n]);
    let mut squares = vec![0.0; n];
    for pose in 1..=POSES {
        let joints = ranges.iter().enumerate();
        let q: Vec<f64> = joints
            .map(|(i, [lo, hi])| lo + (hi - lo) * (pose as f64 * STEP.powi(i as i32 + 1)).fract())
            .collect();
        if let Ok(torque) = robot.arm.bias_torque(&mut ws, &q, &still) {
            for (sum, tau) in squares.iter_mut().zip(torque) {
                *sum += tau * tau;
            }
        }
    }
    let mut elastic: Vec<usize> = (0..n)
        .filter(|&i| robot.transmissions[i].is_some())
        .collect();
    elastic.sort_by(|&a, &b| squares[b].total_cmp(&squares[a]));
    elastic.truncate(2);
    // From the base outwards, as in the protocol.
    elastic.sort_unstable();
    let names = robot.joint_names();
    elastic.into_iter().map(|i| names[i].clone()).collect()
}

/// Returns the outermost link behind the last joint, to which payloads and contacts apply.
fn tip(robot: &Robot) -> String {
    let last = robot.arm.dof().saturating_sub(1);
    let far = |at: [f64; 3]| at.iter().map(|x| x * x).sum::<f64>();
    let links = robot.arm.links_of(last);
    let furthest = links.max_by(|a, b| {
        let [a, b] = [a, b].map(|(_, pose)| far(pose.translation));
        a.total_cmp(&b)
    });
    furthest.map_or_else(String::new, |(name, _)| name.into())
}

/// Weight of all moving masses, N.
fn weight_n(robot: &Robot) -> f64 {
    let arm = &robot.arm;
    let first = (0..arm.dof()).filter(|&i| arm.parent(i).is_none());
    let mass: f64 = first.filter_map(|i| arm.subtree_mass(i)).sum();
    let gravity = arm.gravity().iter().map(|g| g * g).sum::<f64>().sqrt();
    mass * gravity
}

fn between(min: f64, max: f64) -> Value {
    Value::Table(Table::from_iter([
        ("min".into(), Value::Float(rounded(min))),
        ("max".into(), Value::Float(rounded(max))),
    ]))
}

/// Rounds to four digits, because the files are read and edited by people.
fn rounded(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}
