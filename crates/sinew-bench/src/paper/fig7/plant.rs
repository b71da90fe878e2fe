//! True model of the elbow.

use super::super::staircase::{LENGTH_S, controller, motion};
use super::JOINT;
use sinew_model::robot::Robot;
use sinew_sim::Scenario;
use sinew_sim::scenario::{
    Draw, Encoder, FrictionSpec, Offset, OffsetKind, PerJoint, Shape, Temperature, Truth,
};

/// One trial. From trial to trial the robot is the same, but its friction and temperature are not quite.
pub(super) struct Day {
    pub(super) seed: u64,
    /// Factor on the joint's Coulomb friction.
    pub(super) friction_factor: f64,
    pub(super) temperature_difference_k: f64,
    /// Length the rope has gained, as motor position, rad.
    pub(super) relaxed_rad: f64,
    /// True over described stiffness.
    pub(super) stiffness_factor: f64,
    /// True over described masses.
    pub(super) mass_factor: f64,
}

/// Errors of the description of the size of those in Fig. 6, in the direction given in the paper: the described
/// stiffness
/// is too small, and the described torque too large.
pub(super) const STIFFER: f64 = 1.2;
pub(super) const LIGHTER: f64 = 0.9;

/// Noise of the motor position, standard deviation, rad; assumed.
pub(super) const MOTOR_NOISE_RAD: f64 = 2e-4;

impl Default for Day {
    fn default() -> Self {
        Self {
            seed: 1,
            friction_factor: 1.0,
            temperature_difference_k: 0.0,
            relaxed_rad: 0.0,
            stiffness_factor: STIFFER,
            mass_factor: LIGHTER,
        }
    }
}

/// True model of the elbow.
pub(super) fn scenario(robot: &Robot, day: &Day) -> Scenario {
    let share = |value: f64| PerJoint::fixed(value);
    let coulomb = robot
        .joint_names()
        .iter()
        .zip(&robot.transmissions)
        .filter_map(|(name, t)| {
            let nominal = t.as_ref()?.joint_friction.coulomb_nm;
            Some((name.clone(), 0, Draw::Fixed(nominal * day.friction_factor)))
        })
        .collect();
    Scenario {
        name: "fig7".into(),
        duration_s: Some(LENGTH_S),
        sample_rate_hz: 500.0,
        seed: day.seed,
        robot_seed: Some(7),
        controller: controller(robot.joint_names()),
        motion: motion(JOINT),
        truth: Truth {
            stiffness_factor: share(day.stiffness_factor),
            mass_factor: share(day.mass_factor),
            com_factor: share(0.98),
            inertia_factor: share(1.15),
            spring_cubic_per_rad2: share(2.0),
            viscoelastic_fraction: share(0.03),
            viscoelastic_time_s: share(20.0),
            ..Truth::default()
        },
        // As described, and a part that grows with the load.
        joint_friction: FrictionSpec {
            coulomb_nm: PerJoint {
                all: None,
                by_joint: coulomb,
            },
            torque_fraction: share(0.02),
            ..FrictionSpec::default()
        },
        motor_friction: FrictionSpec {
            torque_fraction: share(0.1),
            ..FrictionSpec::default()
        },
        encoder: Encoder {
            joint_bits: Some(13),
            once_per_turn_rad: share(3e-4),
            twice_per_turn_rad: share(3e-4),
            motor_resolution_rad: 6e-5,
            motor_noise_rad: MOTOR_NOISE_RAD,
            ..Encoder::default()
        },
        temperature: Temperature {
            change_k: Draw::Fixed(day.temperature_difference_k),
            stiffness_per_k: share(-0.002),
            zero_drift_rad_per_k: share(5e-5),
            ..Temperature::default()
        },
        offsets: vec![Offset {
            later_s: Draw::Fixed(0.0),
            joint: JOINT.into(),
            line: 0,
            kind: OffsetKind::Physical,
            size_rad: Draw::Fixed(day.relaxed_rad),
            shape: Shape::Constant,
        }],
        ..Scenario::default()
    }
}
