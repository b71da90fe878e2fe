//! Which joints get an estimate.

use super::result::JointRefusal;
use crate::error::EstimateError;
use crate::robot_dir::LoadedRobot;
use sinew_log::Channels;
use sinew_model::offset::{OffsetConfig, TorqueSource, VelocityFilter};
use std::fmt::Write as _;

/// Why a joint gets no estimate, one entry per joint; an error when none gets one.
pub(super) fn refusals(
    file: &str,
    config: &OffsetConfig,
    loaded: &LoadedRobot,
    (channels, without_encoder): (&Channels, &[usize]),
) -> Result<Vec<Option<JointRefusal>>, EstimateError> {
    let mut refused = Vec::new();
    let joints = loaded.robot.transmissions.iter().zip(&channels.joints);
    for (joint, (transmission, channel)) in joints.enumerate() {
        refused.push(match (transmission, config.source) {
            (None, _) if without_encoder.contains(&joint) => Some(JointRefusal::NoJointPosition),
            (None, _) => Some(JointRefusal::Rigid),
            (Some(_), _) if !channel.theta => Some(JointRefusal::NoMotorPosition),
            (Some(_), TorqueSource::TorqueSensor) if !channel.tau_el => {
                Some(JointRefusal::NoJointTorque)
            }
            (Some(_), TorqueSource::Motor) if !channel.tau_m => Some(JointRefusal::NoMotorTorque),
            (Some(t), TorqueSource::Motor) if t.motor_inertia_kg_m2.is_none() => {
                Some(JointRefusal::NoMotorInertia)
            }
            (Some(_), _) => None,
        });
    }
    if refused.iter().all(Option::is_some) {
        let mut why = "no joint can be estimated".to_string();
        for (name, reason) in loaded.robot.joint_names().iter().zip(&refused) {
            if let Some(reason) = reason {
                let _ = write!(why, "; {name}: {}", words(*reason));
            }
        }
        if !channels.any_has(sinew_log::Quantity::Theta) {
            why.push_str(
                ". Name the motor side with --motor-topic, --motor-interface or --mapping",
            );
        }
        return Err(EstimateError::Mismatch {
            file: file.into(),
            why,
        });
    }
    if config.velocity == VelocityFilter::Recorded && !channels.all_have(sinew_log::Quantity::Dq) {
        return Err(EstimateError::Mismatch {
            file: file.into(),
            why: "has no velocity for every joint; use --velocity-filter RAD_PER_S".into(),
        });
    }
    Ok(refused)
}

/// The same in an error's words.
fn words(refusal: JointRefusal) -> &'static str {
    match refusal {
        JointRefusal::Rigid => "rigid in robot.toml: it has no elastic transmission",
        JointRefusal::NoJointPosition => "its position is not recorded",
        JointRefusal::NoMotorPosition => "its motor position is not recorded",
        JointRefusal::NoJointTorque => "its joint torque is not recorded",
        JointRefusal::NoMotorTorque => "its motor torque is not recorded",
        JointRefusal::NoMotorInertia => "motor_inertia_kg_m2 is missing in robot.toml",
        JointRefusal::NoUsableFrame(_) => "no frame could be used",
    }
}
