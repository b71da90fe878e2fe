//! The paper's motion, and the assumptions about it.
//!
//! The paper specifies one joint moving from 0 to 90° in four steps. It specifies neither the speed, nor the duration
//! of the rests, nor the observer's gain. The assumed values are:
//!
//! * moves of 1.0 s, which is slow for a light arm of this size;
//! * rests of 1.5 s, several oscillation periods of the arm on its springs, so that it is at rest at their end;
//! * a gain of 25 1/s, the largest of the usable gains (5 to 25 1/s).

use sinew_sim::scenario::{Controller, Draw, Motion, PerJoint};
use std::f64::consts::FRAC_PI_2;

/// Number of moves.
pub const STEPS: usize = 4;
/// Length of a move, s.
pub const MOVE_S: f64 = 1.0;
/// Rest before the first and after each move, s.
pub const PAUSE_S: f64 = 1.5;
/// Last angle, rad; the first is 0.
pub const TO_RAD: f64 = FRAC_PI_2;
/// Observer gain, 1/s.
pub const GAIN_PER_S: f64 = 25.0;
/// Length of the last part of a rest over which "at rest" is averaged, s: about one oscillation period of the arm on
/// its springs (0.6 s at the shoulder), because the oscillation would otherwise appear as an offset.
pub const REST_WINDOW_S: f64 = 0.5;
/// Length of the whole motion, s.
pub const LENGTH_S: f64 = PAUSE_S + STEPS as f64 * (MOVE_S + PAUSE_S);

/// Returns the motion of `joint`; the other joints remain at 0, where the arm hangs down.
pub fn motion(joint: &str) -> Motion {
    Motion::Staircase {
        joint: joint.into(),
        line: 0,
        from_rad: 0.0,
        to_rad: TO_RAD,
        steps: STEPS,
        move_s: Draw::Fixed(MOVE_S),
        pause_s: Draw::Fixed(PAUSE_S),
        pose_rad: PerJoint::default(),
        there_and_back: false,
        repeat: false,
    }
}

/// End of rest `k`, s; rest 0 is the one before the first move.
pub fn rest_end_s(k: usize) -> f64 {
    PAUSE_S + k as f64 * (MOVE_S + PAUSE_S)
}

/// Angle of rest `k`, rad.
pub fn rest_angle_rad(k: usize) -> f64 {
    TO_RAD * k as f64 / STEPS as f64
}

/// Returns the gains of the BioRob-like arm, or the default gains for another robot.
pub fn controller(joints: &[String]) -> Controller {
    const GAINS: [(&str, f64, f64); 4] = [
        ("shoulder_yaw", 60.0, 6.5),
        ("shoulder_pitch", 50.0, 5.6),
        ("elbow", 30.0, 2.4),
        ("wrist", 24.0, 0.9),
    ];
    let of = |gain: fn(&(&str, f64, f64)) -> f64| PerJoint {
        all: None,
        by_joint: GAINS
            .iter()
            .filter(|g| joints.iter().any(|j| j == g.0))
            .map(|g| (g.0.to_string(), 0, Draw::Fixed(gain(g))))
            .collect(),
    };
    Controller {
        stiffness_nm_per_rad: of(|g| g.1),
        damping_nm_s_per_rad: of(|g| g.2),
    }
}
