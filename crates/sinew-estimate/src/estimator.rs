//! The estimator of a robot's sessions, and what is known of a session besides its recording.

use crate::executor::Pool;
use sinew_model::Gaussian;
use sinew_model::offset::{Block, ExternalForce, FeatureConfig, MapEstimator, Payload, Prior};
use sinew_model::robot::Robot;

/// How a session is estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SessionOptions {
    /// What may be in the gripper.
    pub payload: Payload,
    /// Whether a recorded motor torque is used.
    pub motor_torque: bool,
    /// Whether that is a current times a torque constant, which is known less well; a recording that
    /// says so needs no word here.
    pub motor_current: bool,
    /// Temperature during the recording, °C, where it is stated instead of recorded.
    pub temperature_c: Option<Gaussian>,
    /// A constant force from outside at the tool, along the axes of the base, N, where it is stated.
    pub external_force_n: Option<[Gaussian; 3]>,
    /// Whether ropes may creep within the recording: not those of steel.
    pub creep: bool,
}

impl Default for SessionOptions {
    fn default() -> Self {
        Self {
            payload: Payload::Unknown,
            motor_torque: true,
            motor_current: false,
            temperature_c: None,
            external_force_n: None,
            creep: true,
        }
    }
}

/// The estimator of a robot. The payload is expected half as far again from the last joint as that
/// body's own centre of mass, where a gripper holds things.
pub fn estimator(robot: &Robot, options: &SessionOptions) -> MapEstimator {
    let last = robot.arm.dof().saturating_sub(1);
    let at = robot
        .arm
        .body(last)
        .map_or([0.0; 3], |b| b.com.map(|c| 1.5 * c));
    let mut tolerances = robot.tolerances;
    if options.motor_current {
        tolerances.motor_torque = tolerances.motor_current;
    }
    let force = match options.external_force_n {
        Some(force_n) => Some(ExternalForce {
            force_n,
            is_stated: true,
        }),
        None => ExternalForce::possible(robot.tolerances.external_force_n),
    };
    let prior = Prior::new(&robot.arm, &robot.transmissions, last, at, tolerances);
    MapEstimator::new(prior, &FeatureConfig::default())
        .with_motor_torque(options.motor_torque)
        .with_external_force(&robot.arm, force)
        .with_executor(&Pool)
}

/// Mean temperature of a recording's blocks, °C; NaN where it isn't recorded.
pub(crate) fn mean_temperature(blocks: &[Block]) -> f64 {
    blocks.iter().map(|b| b.temperature_c).sum::<f64>() / blocks.len().max(1) as f64
}
