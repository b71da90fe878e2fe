//! Estimator of a robot's sessions, and the options of a session.

use crate::executor::Pool;
use sinew_model::Gaussian;
use sinew_model::offset::{Block, ExternalForce, FeatureConfig, MapEstimator, Payload, Prior};
use sinew_model::robot::Robot;

/// Options of a session estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SessionOptions {
    /// Payload in the gripper: empty, unknown or specified.
    pub payload: Payload,
    /// Whether recorded motor torque is used.
    pub motor_torque: bool,
    /// Whether the motor torque is current times a torque constant, which has a larger tolerance. Not needed for a
    /// recording that already declares it.
    pub motor_current: bool,
    /// Temperature during the recording, °C, if specified instead of recorded.
    pub temperature_c: Option<Gaussian>,
    /// Constant external force at the tool in the base frame, N, if specified.
    pub external_force_n: Option<[Gaussian; 3]>,
    /// Whether ropes may creep within the recording; false for steel ropes.
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

/// Creates the estimator of a robot. The payload's centre of mass is assumed at 1.5 times the distance of the last
/// body's centre of mass from the last joint, approximately in the gripper.
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
            is_specified: true,
        }),
        None => ExternalForce::possible(robot.tolerances.external_force_n),
    };
    let prior = Prior::new(&robot.arm, &robot.transmissions, last, at, tolerances);
    MapEstimator::new(prior, &FeatureConfig::default())
        .with_motor_torque(options.motor_torque)
        .with_external_force(&robot.arm, force)
        .with_executor(&Pool)
}

/// Mean temperature of a recording's blocks, °C; NaN if not recorded.
pub(crate) fn mean_temperature(blocks: &[Block]) -> f64 {
    blocks.iter().map(|b| b.temperature_c).sum::<f64>() / blocks.len().max(1) as f64
}
