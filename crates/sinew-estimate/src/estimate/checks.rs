//! Whether recording, robot and request go together.

use super::request::{EstimateError, Request};
use crate::robot_dir::LoadedRobot;
use sinew_log::{Channels, Recording};
use sinew_model::offset::{OffsetConfig, TorqueSource, VelocityFilter};
use std::fmt::Write as _;

/// Every moving joint needs a position; others of the recording are left alone, with a word.
pub(super) fn match_joints(
    file: &str,
    names: &[String],
    recording: &Recording,
    warnings: &mut Vec<String>,
) -> Result<(), EstimateError> {
    let known = recording.joints();
    let missing: Vec<&str> = names
        .iter()
        .filter(|n| !known.contains(n))
        .map(String::as_str)
        .collect();
    if !missing.is_empty() {
        return Err(EstimateError::Mismatch {
            file: file.into(),
            why: format!(
                "has no position of joint {}, which the robot has; it has {}. Name it in a mapping file (--mapping), or hold it with locked_at_rad in robot.toml",
                quoted(&missing),
                quoted(&known.iter().map(String::as_str).collect::<Vec<_>>()),
            ),
        });
    }
    let extra: Vec<&str> = known
        .iter()
        .filter(|k| !names.contains(k))
        .map(String::as_str)
        .collect();
    if !extra.is_empty() {
        warnings.push(format!(
            "joint {} of the recording is not in the robot and was left out",
            quoted(&extra)
        ));
    }
    Ok(())
}

/// Why a joint gets no estimate, one entry per joint; an error when none gets one.
pub(super) fn refusals(
    file: &str,
    config: &OffsetConfig,
    loaded: &LoadedRobot,
    channels: &Channels,
) -> Result<Vec<Option<String>>, EstimateError> {
    let mut refused = Vec::new();
    for (transmission, channel) in loaded.robot.transmissions.iter().zip(&channels.joints) {
        refused.push(match transmission {
            None => Some("rigid in robot.toml: it has no elastic transmission".to_string()),
            Some(_) if !channel.theta => Some("its motor position is not recorded".into()),
            Some(_) if config.source == TorqueSource::TorqueSensor && !channel.tau_el => {
                Some("its joint torque is not recorded".into())
            }
            Some(_) if config.source == TorqueSource::Motor && !channel.tau_m => {
                Some("its motor torque is not recorded".into())
            }
            Some(t) if config.source == TorqueSource::Motor && t.motor_inertia_kg_m2.is_none() => {
                Some("motor_inertia_kg_m2 is missing in robot.toml".into())
            }
            Some(_) => None,
        });
    }
    if refused.iter().all(Option::is_some) {
        let mut why = "no joint can be estimated".to_string();
        for (name, reason) in loaded.robot.joint_names().iter().zip(&refused) {
            if let Some(reason) = reason {
                let _ = write!(why, "; {name}: {reason}");
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

pub(super) fn check_injections(
    request: &Request,
    loaded: &LoadedRobot,
) -> Result<(), EstimateError> {
    for injection in &request.injections {
        let place = loaded.robot.arm.joint_index(&injection.joint);
        let Some(i) = place else {
            return Err(EstimateError::Injection(format!(
                "the robot has no joint '{}'; it has {}",
                injection.joint,
                loaded.robot.joint_names().join(", ")
            )));
        };
        if loaded.robot.transmissions[i].is_none() {
            return Err(EstimateError::Injection(format!(
                "joint '{}' is rigid",
                injection.joint
            )));
        }
        if !injection.offset_rad.is_finite() || injection.from_s.is_some_and(|t| !t.is_finite()) {
            return Err(EstimateError::Injection(format!(
                "offset {} rad at '{}' must be a finite number",
                injection.offset_rad, injection.joint
            )));
        }
    }
    Ok(())
}

fn quoted(names: &[&str]) -> String {
    const SHOWN: usize = 12;
    let mut text = names
        .iter()
        .take(SHOWN)
        .map(|n| format!("'{n}'"))
        .collect::<Vec<_>>()
        .join(", ");
    if names.len() > SHOWN {
        let _ = write!(text, " and {} more", names.len() - SHOWN);
    }
    if names.is_empty() {
        text.push_str("none");
    }
    text
}
