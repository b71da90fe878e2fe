//! Channels with a wrong sign, unit or encoder: each is an error, or a warning that names the joint and the cause.

use crate::support;

use sinew_estimate::session::{
    self, MotorTorqueError, SessionError, SessionEstimate, SessionOptions, Warning,
};
use sinew_log::Frame;
use support::{biorob_like, work_session_with};

const JOINTS: [&str; 4] = ["shoulder_yaw", "shoulder_pitch", "elbow", "wrist"];
/// Start of the session after the baseline, s.
const SESSION_S: f64 = 60.0;

/// Estimate of session B of the example, whose frames `change` changes; the baseline is unchanged.
fn estimate(mut change: impl FnMut(&mut Frame, f64)) -> Result<SessionEstimate, SessionError> {
    let robot = biorob_like();
    let parts = work_session_with(&robot, 340, |frame, t_s| {
        if t_s >= SESSION_S {
            change(frame, t_s);
        }
    });
    let learning = session::Learning::default();
    let (baseline, _) = session::learn_recorded(&robot, &parts[0], "A", &learning)?;
    let with = Some((&baseline, "baseline"));
    let options = SessionOptions::default();
    session::estimate_recorded(&robot, &parts[1], "B", with, &options).map(|found| found.0)
}

/// A motor encoder that is frozen during a session is excluded from its onset on.
#[test]
fn frozen_motor_encoder_is_excluded() {
    for joint in 0..JOINTS.len() {
        let mut held = None;
        let found = estimate(|frame, t_s| {
            if t_s >= 85.0 {
                frame.theta[joint] = *held.get_or_insert(frame.theta[joint]);
            }
        });
        let found = found.unwrap();
        let frozen = found.warnings.iter().find_map(|warning| match warning {
            Warning::MotorEncoderFrozen { joint, from_s, .. } => Some((joint.clone(), *from_s)),
            _ => None,
        });
        let own = &found.joints[joint];
        println!("{}: {frozen:?} {:?}", own.name, own.changes);
        let (name, from_s) = frozen.unwrap();
        assert!(
            name == own.name && (from_s - 85.0).abs() < 2.0,
            "{name} {from_s}"
        );
        assert_eq!(own.changes, [], "{name}");
    }
}

/// A motor channel that is zero throughout is an error that names the joint and the line of the mapping.
#[test]
fn constant_motor_position_is_error() {
    for joint in 0..JOINTS.len() {
        for value in [0.0, 0.4] {
            let found = estimate(|frame, _| frame.theta[joint] = value);
            let error = found.unwrap_err().to_string();
            for words in [
                format!("'{}' at {value:.4} rad", JOINTS[joint]),
                format!("[joints.{}] theta = ", JOINTS[joint]),
            ] {
                assert!(error.contains(&words), "{error}");
            }
        }
    }
}

/// Motor channels of two joints that are exchanged are an error that names both.
#[test]
fn exchanged_motors_are_error() {
    for (one, other) in [(1, 2), (0, 3)] {
        let found = estimate(|frame, _| frame.theta.swap(one, other));
        let error = found.unwrap_err().to_string();
        let names = format!("'{}' and '{}'", JOINTS[one], JOINTS[other]);
        assert!(error.contains(&names), "{error}");
    }
}

/// A joint position that is zero throughout is named once, and no warning has an empty torque range.
#[test]
fn constant_joint_position_is_warned_of_once() {
    let found = estimate(|frame, _| frame.q[2] = 0.0).unwrap();
    let mut seized = Vec::new();
    for warning in &found.warnings {
        match warning {
            Warning::JointSeized { joint, .. } => seized.push(joint.as_str()),
            Warning::TorqueRangeSmall { joint, torque_nm } => {
                assert!(torque_nm.min <= torque_nm.max, "{joint}: {torque_nm:?}");
            }
            _ => (),
        }
    }
    assert_eq!(seized, [JOINTS[2]]);
}

/// Joint positions in another unit are an error, and no lost transmission.
#[test]
fn joint_positions_in_turns_or_degrees_are_error() {
    let found = estimate(|frame, _| frame.q.iter_mut().for_each(|q| *q /= std::f64::consts::TAU));
    let error = found.unwrap_err().to_string();
    assert!(error.contains("gear_ratio = 6."), "{error}");
    let found = estimate(|frame, _| frame.q.iter_mut().for_each(|q| *q = q.to_degrees()));
    let error = found.unwrap_err().to_string();
    assert!(error.contains("q = { …, unit = \"deg\" }"), "{error}");
}

/// The mirror image of an arm loads its springs equally, but it is beyond the limits, and the torques of its drives contradict
/// their motion or their springs.
#[test]
fn opposite_sign_of_both_sides_is_warned_of() {
    let reverse = |frame: &mut Frame, joint: usize| {
        frame.q[joint] = -frame.q[joint];
        frame.theta[joint] = -frame.theta[joint];
    };
    let beyond = |found: &SessionEstimate| -> Vec<(String, bool)> {
        let beyond = found.warnings.iter().filter_map(|warning| match warning {
            Warning::BeyondLimits {
                joint,
                opposite_is_within,
                ..
            } => Some((joint.clone(), *opposite_is_within)),
            _ => None,
        });
        beyond.collect()
    };
    let work = |found: &SessionEstimate| -> Vec<String> {
        let negative = found.warnings.iter().filter_map(|warning| match warning {
            Warning::MotorTorqueRejected {
                joint,
                fault: MotorTorqueError::NegativeWork { .. } | MotorTorqueError::Contradicts { .. },
            } => Some(joint.clone()),
            _ => None,
        });
        negative.collect()
    };
    let healthy = estimate(|_, _| {}).unwrap();
    assert!(beyond(&healthy).is_empty() && work(&healthy).is_empty());
    let all = estimate(|frame, _| (0..JOINTS.len()).for_each(|joint| reverse(frame, joint)));
    let all = all.unwrap();
    let expected = [1, 2].map(|joint| (JOINTS[joint].to_owned(), true));
    assert_eq!(beyond(&all), expected, "{:?}", all.warnings);
    let yaw = estimate(|frame, _| reverse(frame, 0)).unwrap();
    assert_eq!(beyond(&yaw), [], "{:?}", yaw.warnings);
    assert_eq!(work(&yaw), [JOINTS[0]], "{:?}", yaw.warnings);
}
