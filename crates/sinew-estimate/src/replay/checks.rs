//! Check which joints of a recording can be estimated.

use super::result::JointError;
use crate::error::EstimateError;
use crate::robot_dir::LoadedRobot;
use sinew_log::Channels;
use sinew_model::offset::{OffsetConfig, TorqueSource, VelocityFilter};
use std::fmt::Write as _;

/// Returns for each joint the reason why it cannot be estimated, or `None`.
///
/// # Errors
/// Returns [`EstimateError::Mismatch`] if no joint can be estimated, or if the recorded velocities are required but
/// missing.
pub(super) fn joint_errors(
    file: &str,
    config: &OffsetConfig,
    loaded: &LoadedRobot,
    (channels, without_encoder): (&Channels, &[usize]),
) -> Result<Vec<Option<JointError>>, EstimateError> {
    let mut errors = Vec::new();
    let joints = loaded.robot.transmissions.iter().zip(&channels.joints);
    for (joint, (transmission, channel)) in joints.enumerate() {
        errors.push(match (transmission, config.source) {
            (None, _) if without_encoder.contains(&joint) => Some(JointError::NoJointPosition),
            (None, _) if loaded.robot.cable(joint).is_some() => Some(JointError::FrictionAlongPath),
            (None, _) => Some(JointError::Rigid),
            (Some(_), _) if loaded.robot.pulling_tendon(joint).is_some() => {
                Some(JointError::JointEquations)
            }
            (Some(_), _) if !channel.theta => Some(JointError::NoMotorPosition),
            (Some(_), TorqueSource::TorqueSensor) if !channel.tau_el => {
                Some(JointError::NoJointTorque)
            }
            (Some(_), TorqueSource::Motor) if !channel.tau_m => Some(JointError::NoMotorTorque),
            (Some(t), TorqueSource::Motor) if t.motor_inertia_kg_m2.is_none() => {
                Some(JointError::NoMotorInertia)
            }
            (Some(_), _) => None,
        });
    }
    // The absolute method estimates these.
    let is_estimated = |error: &Option<JointError>| {
        matches!(
            error,
            Some(JointError::JointEquations | JointError::FrictionAlongPath)
        )
    };
    if errors.iter().all(Option::is_some) && !errors.iter().any(is_estimated) {
        let mut reason = "no joint can be estimated".to_string();
        for (i, error) in errors.iter().enumerate() {
            let name = loaded.robot.axis_name(i);
            if let Some(error) = error {
                let _ = write!(reason, "; {name}: {}", message(*error));
            }
        }
        if !channels.any_has(sinew_log::Quantity::Theta) {
            reason.push_str(
                ". Specify the motor positions with --motor-topic, --motor-interface or --mapping",
            );
        }
        return Err(EstimateError::Mismatch {
            file: file.into(),
            reason,
        });
    }
    if config.velocity == VelocityFilter::Recorded && !channels.all_have(sinew_log::Quantity::Dq) {
        return Err(EstimateError::Mismatch {
            file: file.into(),
            reason: "has no velocity of some joints; set --velocity-filter RAD_PER_S".into(),
        });
    }
    Ok(errors)
}

/// Text of a joint error in messages.
fn message(error: JointError) -> &'static str {
    match error {
        JointError::Rigid => "rigid in robot.toml: it has no elastic transmission",
        JointError::NoJointPosition => "its position is not recorded",
        JointError::NoMotorPosition => "its motor position is not recorded",
        JointError::NoJointTorque => "its joint torque is not recorded",
        JointError::NoMotorTorque => "its motor torque is not recorded",
        JointError::NoMotorInertia => "motor_inertia_kg_m2 is missing in robot.toml",
        JointError::FrictionAlongPath => {
            "friction acts along the path of its tendon, which this method does not contain"
        }
        JointError::JointEquations => "it is coupled with other tendons at a joint",
        JointError::NoUsableFrame(_) => "no frame could be used",
    }
}
