//! Faults that come during a recording, and times that are drawn.

use super::biorob_like;
use crate::{Scenario, Simulation};
use sinew_log::Frame;

fn all(text: &str) -> Vec<Frame> {
    let scenario = Scenario::from_toml(text, "test.toml").expect("a scenario");
    let mut simulation = Simulation::new(&biorob_like(), &scenario).expect("a robot for it");
    let mut frames = Vec::new();
    while let Some(frame) = simulation.next_frame().expect("steps") {
        frames.push(frame.clone());
    }
    frames
}

/// The elbow swings; the shoulder pitch rests at 90°. No friction, 250 Hz.
fn swinging(more: &str) -> String {
    format!(
        "duration_s = 6\nsample_rate_hz = 250\n\
         joint_friction = {{ coulomb_nm = 0, viscous_nm_s_per_rad = 0.02 }}\n\
         motor_friction = {{ coulomb_nm = 0, viscous_nm_s_per_rad = 0.1 }}\n{more}\n\
         [motion]\nkind = \"staircase\"\njoint = \"elbow\"\nto_rad = 0.8\nsteps = 1\n\
         move_s = 1.0\npause_s = 0.4\nthere_and_back = true\nrepeat = true\n\
         pose_rad = {{ shoulder_pitch = 1.5707963 }}\n"
    )
}

#[test]
fn delayed_motor_encoder_records_past_position() {
    let plain = all(&swinging(""));
    let late = all(&swinging("encoder = { motor_delay_s = 0.1 }"));
    // 25 frames of 4 ms.
    for k in 25..plain.len() {
        assert_eq!(late[k].q, plain[k].q);
        for (shown, was) in late[k].theta.iter().zip(&plain[k - 25].theta) {
            assert!((shown - was).abs() < 1e-15);
        }
    }
    let between = all(&swinging("encoder = { motor_delay_s = 0.002 }"));
    let (a, b) = (plain[199].theta[2], plain[200].theta[2]);
    assert!((between[200].theta[2] - 0.5 * (a + b)).abs() < 1e-15);
}

#[test]
fn wrong_gear_ratio_scales_motor_position() {
    let plain = all(&swinging(""));
    let scaled = all(&swinging("encoder = { motor_scale_error = 0.02 }"));
    for (s, p) in scaled.iter().zip(&plain) {
        assert!((s.theta[2] - 1.02 * p.theta[2]).abs() < 1e-15);
        assert_eq!(s.q, p.q);
    }
}

#[test]
fn stiffness_loss_increases_spring_deflection() {
    let hold = |more: &str| {
        format!(
            "duration_s = 12\nsample_rate_hz = 100\n{more}\n\
             [motion]\nkind = \"hold\"\npose_rad = {{ shoulder_pitch = 1.5707963 }}\n\
             [record]\ntau_el = true\n\
             [truth]\nstiffness_later_factor = {{ shoulder_pitch = 0.92 }}\nstiffness_later_from_s = 2.0\n"
        )
    };
    let frames = all(&hold(
        "joint_friction = { coulomb_nm = 0 }\nmotor_friction = { coulomb_nm = 0 }",
    ));
    let stiffness = |f: &Frame| f.tau_el[1] / (f.theta[1] - f.q[1]);
    // 40 N·m/rad in the description.
    assert!((stiffness(&frames[190]) - 40.0).abs() < 1e-9);
    assert!((stiffness(&frames[1100]) - 0.92 * 40.0).abs() < 1e-9);
}

#[test]
fn seized_joint_rests_while_motor_moves() {
    let jam = "[[jams]]\njoint = \"elbow\"\ntorque_nm = 50\nfrom_s = 0.2\n";
    let frames = all(&(swinging("") + jam));
    let span = |of: &dyn Fn(&Frame) -> f64| {
        let values: Vec<f64> = frames[50..].iter().map(of).collect();
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
    };
    // The spring pulls with at most 20 N·m/rad · 0.8 rad: a third of the jam, which gives by less
    // than half its pre-sliding of 1 mrad.
    assert!(span(&|f| f.q[2]) < 5e-4, "{}", span(&|f| f.q[2]));
    assert!(span(&|f| f.theta[2]) > 0.3);
}

#[test]
fn drawn_slip_leaves_earlier_frames_unchanged() {
    let slip = |at: &str, seed: u64| {
        let text = swinging(&format!(
            "seed = {seed}\nencoder = {{ motor_noise_rad = 0.0002 }}"
        )) + &format!(
            "[[offsets]]\njoint = \"shoulder_pitch\"\nkind = \"physical\"\nrad = 0.1\nshape = \"step\"\nat_s = {at}\n"
        );
        all(&text)
    };
    let first_apart = |a: &[Frame], b: &[Frame]| {
        let apart = a.iter().zip(b).position(|(a, b)| a.theta != b.theta);
        apart.map(|k| k as f64 / 250.0)
    };
    let drawn = "{ min = 1.0, max = 3.0 }";
    // Against a slip after the end: the same noise, frame by frame, until the slip.
    let times: Vec<f64> = (1..6)
        .map(|seed| first_apart(&slip(drawn, seed), &slip("100.0", seed)).unwrap())
        .collect();
    assert!(times.iter().all(|t| (1.0..3.01).contains(t)), "{times:?}");
    assert!(
        times.windows(2).any(|p| (p[0] - p[1]).abs() > 0.1),
        "{times:?}"
    );
}

#[test]
fn temperature_error_starts_at_specified_time() {
    let frames = all(&(swinging("")
        + "[record]\ntemperature = true\n\
           [temperature]\nreference_c = 20.0\nreading_error_k = 0.5\nreading_error_from_s = 3.0\n"));
    assert_eq!(frames[10].temperature_c, 20.0);
    assert_eq!(frames[1000].temperature_c, 20.5);
}

#[test]
fn drawn_moves_and_rests_vary_and_end_on_time() {
    let text = |repeat: bool| {
        format!(
            "seed = 5\nsample_rate_hz = 250\n{}[motion]\nkind = \"waypoints\"\nrepeat = {repeat}\n\
             [[motion.waypoints]]\npose_rad = {{ wrist = 0.5 }}\nmove_s = {{ min = 0.5, max = 1.0 }}\n\
             pause_s = {{ min = 0.5, max = 1.0 }}\n\
             [[motion.waypoints]]\npose_rad = {{ wrist = 0.0 }}\nmove_s = 0.5\n",
            if repeat { "duration_s = 9\n" } else { "" }
        )
    };
    // A move and a pause drawn, and half a second.
    let length_s = all(&text(false)).len() as f64 / 250.0;
    assert!((1.5..2.5).contains(&length_s), "{length_s}");
    let wrist: Vec<f64> = all(&text(true)).iter().map(|f| f.q[3]).collect();
    let rises: Vec<usize> = (1..wrist.len())
        .filter(|&k| wrist[k - 1] < 0.25 && wrist[k] >= 0.25)
        .collect();
    let rounds: Vec<usize> = rises.windows(2).map(|p| p[1] - p[0]).collect();
    assert!(
        rounds.len() >= 2 && rounds.iter().any(|r| r.abs_diff(rounds[0]) > 5),
        "{rounds:?}"
    );
}

/// Events do not change the drawn robot: its encoders, sensors and friction are those of the same seed without them.
/// A recording with a slip and a load is identical until they occur.
#[test]
fn events_leave_drawn_robot_unchanged() {
    let robot = "robot_seed = 3\n\
         encoder = { once_per_turn_rad = { mean = 0, std = 3e-4 }, twice_per_turn_rad = 1e-4, motor_scale_error = { min = -0.01, max = 0.01 } }\n\
         motor_torque = { offset_nm = { min = -0.1, max = 0.1 } }\n\
         torque_sensor = { offset_nm = { min = -0.1, max = 0.1 } }\n\
         record = { tau_m = true, tau_el = true }\n\
         truth = { stiffness_later_factor = { min = 0.9, max = 1.0 }, stiffness_later_from_s = 1.0 }\n";
    let happens = "[[offsets]]\njoint = \"elbow\"\nkind = \"physical\"\nrad = { min = 0.002, max = 0.01 }\nshape = \"step\"\nat_s = { min = 3.0, max = 4.0 }\n\
         [[payloads]]\nlink = \"hand\"\nmass_kg = { min = 0.1, max = 0.5 }\nattach_s = 3.0\n";
    let plain = all(&swinging(robot));
    let same = all(&(swinging(robot) + happens));
    let end = plain.len();
    let read = |f: &Frame| [&f.q, &f.theta, &f.tau_el, &f.tau_m].map(Clone::clone);
    for k in 0..end / 2 {
        assert_eq!(read(&same[k]), read(&plain[k]), "frame {k}");
    }
    assert_ne!(read(&same[end - 1]), read(&plain[end - 1]));
}
