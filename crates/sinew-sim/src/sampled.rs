//! Values drawn for a robot and a recording before the simulation.

use super::error::SimulateError;
use super::friction::Friction;
use super::paths::Paths;
use super::plant::{Drive, EndStop};
use super::scenario::{
    FrictionSpec, Offset, OffsetKind, Owner, PerJoint, Scenario, Shape, interpolate,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use sinew_files::{Fault, Located, names};
use sinew_model::arm::{Arm, BodyInertia};
use sinew_model::robot::Robot;
use sinew_model::transmission::{Friction as Described, Transmission};

/// Drawn offset of a tendon or encoder.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledOffset {
    /// Joint of the encoder that slipped, or of the tendon.
    pub joint: usize,
    pub kind: OffsetKind,
    pub size_rad: f64,
    pub shape: Shape,
}

/// Drawn load on a link.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledPayload {
    pub link: String,
    pub mass_kg: f64,
    pub com_m: [f64; 3],
    pub attach_s: f64,
    pub release_s: f64,
}

/// Temperature and its effects, drawn.
#[derive(Debug, Clone)]
pub struct SampledTemperature {
    pub(super) reference_c: f64,
    profile_c: Vec<(f64, f64)>,
    pub change_k: f64,
    change_from_to_s: (f64, f64),
    pub(super) reading_error_k: f64,
    pub(super) reading_error_from_s: f64,
    pub stiffness_per_k: Vec<f64>,
    pub drift_rad_per_k: Vec<f64>,
}

impl SampledTemperature {
    /// °C at `t`, s.
    pub(super) fn at(&self, t: f64) -> f64 {
        let base = if self.profile_c.is_empty() {
            self.reference_c
        } else {
            interpolate(&self.profile_c, t)
        };
        let (from, to) = self.change_from_to_s;
        let share = if t <= from {
            0.0
        } else if t >= to {
            1.0
        } else {
            (t - from) / (to - from)
        };
        // A change from 0 to 0 s is complete from the start.
        let share = if to == 0.0 { 1.0 } else { share };
        base + share * self.change_k
    }
}

/// Names that values of a scenario are given by.
///
/// A robot with an equation per joint has values of joints, tendons and motors under their own names. On every other robot all have the
/// name of the joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Names {
    /// One per joint.
    pub(super) joints: Vec<String>,
    /// Name of the tendon of each axis, or of its joint.
    pub(super) tendons: Vec<String>,
    /// Name of the motor of each axis, or of its joint.
    pub(super) motors: Vec<String>,
    /// Whether each axis has a tendon.
    has_tendon: Vec<bool>,
}

impl Names {
    pub(super) fn of(robot: &Robot) -> Self {
        let joints = robot.joint_names().to_vec();
        let (tendons, motors) = match robot.has_joint_equations() {
            true => (robot.tendon_names(), robot.motor_names()),
            false => (joints.clone(), joints.clone()),
        };
        Self {
            has_tendon: robot.transmissions.iter().map(Option::is_some).collect(),
            joints,
            tendons,
            motors,
        }
    }

    /// Returns the valid names of an owner.
    fn valid_names(&self, owner: Owner) -> Vec<&str> {
        let driven = |names: &'_ Vec<String>| -> Vec<usize> {
            (0..names.len()).filter(|i| self.has_tendon[*i]).collect()
        };
        let names = match owner {
            Owner::Joint => return self.joints.iter().map(String::as_str).collect(),
            Owner::Tendon => &self.tendons,
            Owner::Motor => &self.motors,
        };
        let mut valid: Vec<&str> = driven(names)
            .into_iter()
            .map(|i| names[i].as_str())
            .collect();
        valid.dedup();
        valid
    }
}

/// Whether tendons of a robot cross several joints, or have names of their own.
pub(super) fn has_routings(robot: &Robot) -> bool {
    let mut transmissions = robot.transmissions.iter().flatten();
    transmissions.any(|t| t.routing.is_some())
}

/// Joint whose encoder has slipped, or that the tendon of an offset is paired with.
pub(super) fn offset_owner(robot: &Robot, offset: &Offset) -> Option<usize> {
    if offset.kind == OffsetKind::JointEncoder {
        return robot.arm.joint_index(&offset.joint);
    }
    let tendons = robot.tendon_names();
    tendons.iter().position(|name| *name == offset.joint)
}

pub(super) fn unknown(
    robot: &Robot,
    scenario: &Scenario,
    line: u64,
    what: &'static str,
    name: &str,
) -> SimulateError {
    let (tendons, motors) = (robot.tendon_names(), robot.motor_names());
    let valid: Vec<&str> = match what {
        "link" => robot.arm.link_names().collect(),
        "tendon" => tendons.iter().map(String::as_str).collect(),
        "motor" => motors.iter().map(String::as_str).collect(),
        _ => robot.joint_names().iter().map(String::as_str).collect(),
    };
    let hint = names::hint(name, &valid);
    let problem = format!("{what} '{name}' is not in robot '{}'{hint}", robot.name);
    let problem = format!("{problem} it has {}", valid.join(", "));
    Located::new(&scenario.file, Fault::UnknownName, problem)
        .line(line)
        .into()
}

/// Every joint and link the scenario names must be the robot's.
pub(super) fn check_names(robot: &Robot, scenario: &Scenario) -> Result<(), SimulateError> {
    let names = Names::of(robot);
    for (owner, name, line) in scenario.owners_named() {
        if !names.valid_names(owner).contains(&name) {
            let what = match owner {
                Owner::Tendon if robot.has_joint_equations() => "tendon",
                Owner::Motor if robot.has_joint_equations() => "motor",
                _ => "joint",
            };
            return Err(unknown(robot, scenario, line, what, name));
        }
    }
    for offset in &scenario.offsets {
        if offset_owner(robot, offset).is_none() {
            let is_tendon = offset.kind != OffsetKind::JointEncoder && has_routings(robot);
            let what = if is_tendon { "tendon" } else { "joint" };
            return Err(unknown(robot, scenario, offset.line, what, &offset.joint));
        }
    }
    for (name, line) in scenario.links_named() {
        if !robot.arm.link_names().any(|l| l == name) {
            return Err(unknown(robot, scenario, line, "link", name));
        }
    }
    Ok(())
}

/// Transmissions by axis; `None` where there is a joint that only tendons of other axes pull.
pub(super) fn transmissions<'a>(
    robot: &'a Robot,
    paths: Option<&Paths>,
) -> Result<Vec<Option<&'a Transmission>>, SimulateError> {
    (robot.transmissions.iter().enumerate())
        .map(|(i, t)| {
            let robot_error = |reason| SimulateError::Robot {
                robot: robot.name.clone(),
                joint: robot.axis_name(i).to_owned(),
                reason,
            };
            let Some(t) = t.as_ref() else {
                if paths.is_some_and(|paths| paths.joint(i).is_some()) {
                    return Ok(None);
                }
                return Err(robot_error("is rigid; the simulator needs stiffness_nm_per_rad, or lock the joint with locked_at_rad"));
            };
            if t.motor_inertia_kg_m2.is_some_and(|i| i > 0.0) {
                Ok(Some(t))
            } else if t.routing.is_some() {
                Err(robot_error("has a tendon whose motor has no inertia above 0, which the simulator needs: inertia_kg_m2 in [motors], or the joint's motor_inertia_kg_m2"))
            } else {
                Err(robot_error("has no motor_inertia_kg_m2 above 0, which the simulator needs"))
            }
        })
        .collect()
}

/// True model of the arm.
pub(super) fn true_arm(
    robot: &Robot,
    scenario: &Scenario,
    rng: &mut ChaCha8Rng,
) -> Result<Arm, SimulateError> {
    let names = robot.joint_names();
    let n = names.len();
    let (one, zero) = (vec![1.0; n], vec![0.0; n]);
    let t = &scenario.truth;
    let mass = t.mass_factor.sample(names, &one, rng);
    let com = t.com_factor.sample(names, &one, rng);
    let across = t.com_across_fraction.sample(names, &zero, rng);
    let inertia = t.inertia_factor.sample(names, &one, rng);
    let mut arm = robot.arm.clone();
    for i in 0..n {
        let angle: f64 = rng.random::<f64>() * std::f64::consts::TAU;
        if [mass[i], com[i], inertia[i]] == [1.0; 3] && across[i] == 0.0 {
            continue;
        }
        let Some(body) = arm.body(i) else { continue };
        let factor = mass[i] * inertia[i];
        arm = arm.with_body(
            i,
            BodyInertia {
                mass: body.mass * mass[i],
                com: shifted(body.com, com[i], across[i], angle),
                inertia: body.inertia.map(|row| row.map(|x| x * factor)),
            },
        )?;
    }
    Ok(arm)
}

/// `com` made longer by `along` and moved across by a fraction of its length, at `angle`.
fn shifted(com: [f64; 3], along: f64, across: f64, angle: f64) -> [f64; 3] {
    let length = (com[0] * com[0] + com[1] * com[1] + com[2] * com[2]).sqrt();
    if length == 0.0 {
        return com;
    }
    let u = com.map(|x| x / length);
    // Any vector not along `u`: the axis it has least of.
    let least = (0..3)
        .min_by(|&a, &b| u[a].abs().total_cmp(&u[b].abs()))
        .unwrap_or(0);
    let mut e = [0.0; 3];
    e[least] = 1.0;
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let v = cross(u, e);
    let norm = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let v = v.map(|x| x / norm);
    let w = cross(u, v);
    let (sin, cos) = libm::sincos(angle);
    std::array::from_fn(|k| along * com[k] + across * length * (cos * v[k] + sin * w[k]))
}

/// Drives by axis, but for the pretension of strands, which is as described.
pub(super) fn drives(
    scenario: &Scenario,
    names: &Names,
    nominal: &[Option<&Transmission>],
    paths: Option<&Paths>,
    rng: &mut ChaCha8Rng,
) -> Vec<Drive> {
    let (axes, dof) = (nominal.len(), names.joints.len());
    let (one, zero) = (vec![1.0; axes], vec![0.0; axes]);
    let t = &scenario.truth;
    let mut draw =
        |spec: &PerJoint, names: &[String], defaults: &[f64]| spec.sample(names, defaults, rng);
    let stiffness = draw(&t.stiffness_factor, &names.tendons, &one);
    let inertia = draw(&t.motor_inertia_factor, &names.motors, &one);
    let cubic = draw(&t.spring_cubic_per_rad2, &names.tendons, &zero);
    let creep = draw(&t.viscoelastic_fraction, &names.tendons, &zero);
    let creep_time = draw(&t.viscoelastic_time_s, &names.tendons, &vec![30.0; axes]);
    let mut friction = |spec: &FrictionSpec, names: &[String], of: &[Described]| {
        let dry: Vec<f64> = of.iter().map(|of| of.coulomb_nm).collect();
        let viscous: Vec<f64> = of.iter().map(|of| of.viscous_nm_s_per_rad).collect();
        let coulomb = draw(&spec.coulomb_nm, names, &dry);
        let share = draw(&spec.torque_fraction, names, &zero);
        let viscous = draw(&spec.viscous_nm_s_per_rad, names, &viscous);
        let presliding = draw(&spec.presliding_rad, names, &vec![1e-3; of.len()]);
        (0..of.len())
            .map(|i| Friction {
                coulomb_nm: coulomb[i],
                torque_fraction: share[i],
                viscous_nm_s_per_rad: viscous[i],
                presliding_rad: presliding[i],
            })
            .collect::<Vec<_>>()
    };
    let of_joints: Vec<Described> = (0..dof)
        .map(|j| match paths.and_then(|paths| paths.joint(j)) {
            Some(joint) => joint.friction,
            None => nominal[j].map_or_else(Default::default, |t| t.joint_friction),
        })
        .collect();
    let of_motors = nominal.iter();
    let of_motors: Vec<Described> = of_motors
        .map(|t| t.map_or_else(Default::default, |t| t.motor_friction))
        .collect();
    let joint = friction(&scenario.joint_friction, &names.joints, &of_joints);
    let motor = friction(&scenario.motor_friction, &names.motors, &of_motors);
    (0..axes)
        .map(|i| {
            let tendon = nominal[i];
            let stiffness_nm_per_rad = tendon.map_or(1.0, |t| t.stiffness_nm_per_rad);
            let of_joint = match paths.and_then(|paths| paths.joint(i)) {
                Some(joint) => joint.stiffness_nm_per_rad,
                None => stiffness_nm_per_rad,
            };
            let inertia_kg_m2 = tendon.map_or(1.0, |t| t.motor_inertia_kg_m2.unwrap_or(0.0));
            Drive {
                stiffness_nm_per_rad: stiffness_nm_per_rad * stiffness[i],
                pretension_nm: paths.map_or(0.0, |paths| paths.pretension_nm(i)),
                cubic_per_rad2: cubic[i],
                viscoelastic_fraction: creep[i],
                viscoelastic_time_s: creep_time[i],
                motor_inertia_kg_m2: inertia_kg_m2 * inertia[i],
                joint_friction: joint.get(i).copied().unwrap_or_default(),
                motor_friction: match tendon {
                    Some(_) => motor[i],
                    // The axis has no motor, whatever the scenario specifies for all joints.
                    None => Friction::default(),
                },
                stops: match names.joints.get(i) {
                    Some(joint) => end_stops(scenario, joint, of_joint),
                    None => [None; 2],
                },
            }
        })
        .collect()
}

/// Returns the lower and the upper end stop of a joint; 1000 times as stiff as its spring by default.
fn end_stops(scenario: &Scenario, joint: &str, spring_nm_per_rad: f64) -> [Option<EndStop>; 2] {
    const STIFFER: f64 = 1000.0;
    [false, true].map(|is_upper| {
        let mut own = scenario.stops.iter();
        let stop = own.find(|s| s.joint == *joint && s.is_upper == is_upper)?;
        let stiffness = stop.stiffness_nm_per_rad;
        Some(EndStop {
            at_rad: stop.at_rad,
            is_upper,
            stiffness_nm_per_rad: stiffness.unwrap_or(STIFFER * spring_nm_per_rad),
        })
    })
}

pub(super) fn draw_temperature(
    scenario: &Scenario,
    tendons: &[String],
    rng: &mut ChaCha8Rng,
) -> SampledTemperature {
    let t = &scenario.temperature;
    let zero = vec![0.0; tendons.len()];
    SampledTemperature {
        reference_c: t.reference_c,
        profile_c: t.profile_c.clone().unwrap_or_default(),
        change_k: t.change_k.sample(rng),
        change_from_to_s: t.change_from_to_s,
        reading_error_k: t.reading_error_k.sample(rng),
        reading_error_from_s: t.reading_error_from_s,
        stiffness_per_k: t.stiffness_per_k.sample(tendons, &zero, rng),
        drift_rad_per_k: t.zero_drift_rad_per_k.sample(tendons, &zero, rng),
    }
}
