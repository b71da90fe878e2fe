//! Assembly of frames from messages: by name, by stamp, in order, across gaps and clock steps.

use crate::support::*;
use sinew_log::{EventKind, Mapping, OpenOptions, Quantity};

fn times(frames: &[sinew_log::Frame]) -> Vec<i64> {
    frames
        .iter()
        .map(|frame| (frame.time_ns - START_NS) / MS)
        .collect()
}

/// A plain recording at 100 Hz: q counts up in 0.01 rad, theta is 0.5 rad ahead.
fn plain(bag: &mut Bag, steps: std::ops::Range<i64>) {
    for step in steps {
        let time = START_NS + 10 * step * MS;
        let q = 0.01 * step as f64;
        bag.joint(time, &[("a", q), ("b", -q)]);
        bag.motor(time, &[("b", 0.5 - q), ("a", 0.5 + q)]);
    }
}

#[test]
fn messages_are_joined_by_name_and_stamp() {
    let mut bag = Bag::new();
    plain(&mut bag, 0..20);
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 20);
    for (step, frame) in frames.iter().enumerate() {
        let q = 0.01 * step as f64;
        assert_eq!(frame.q, [q, -q]);
        assert_eq!(frame.theta, [0.5 + q, 0.5 - q]);
        assert!(frame.dq.iter().all(|value| value.is_nan()));
    }
    assert_eq!(health.messages, 40);
    assert!(!health.is_lossy());
}

#[test]
fn between_motor_samples_the_motor_side_is_interpolated() {
    let mut bag = Bag::new();
    for step in 0..10 {
        let time = START_NS + 20 * step * MS;
        bag.motor(time, &[("a", step as f64)]);
        bag.joint(time + 5 * MS, &[("a", 0.0)]);
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    for (step, frame) in frames.iter().take(9).enumerate() {
        assert!(
            (frame.theta[0] - (step as f64 + 0.25)).abs() < 1e-12,
            "{frame:?}"
        );
    }
    // After the last motor sample there is nothing to interpolate to.
    assert!(frames[9].theta[0].is_nan());
    assert_eq!(health.frames_without_motor_side, 1);
}

#[test]
fn motor_samples_too_far_away_are_not_used() {
    let mut bag = Bag::new();
    for step in 0..10 {
        bag.motor(START_NS + 200 * step * MS, &[("a", step as f64)]);
        bag.joint(START_NS + (200 * step + 100) * MS, &[("a", 0.0)]);
    }
    let (frames, _) = read_bytes(&bag.bytes(), "a.mcap");
    assert!(frames.iter().all(|frame| frame.theta[0].is_nan()));
}

#[test]
fn interpolation_goes_the_short_way_round() {
    let mut bag = Bag::new();
    let angle = |step: i64| {
        let turned = 3.0 + 0.02 * step as f64;
        // As an encoder of one turn gives it, in -pi..pi.
        turned - std::f64::consts::TAU * (turned / std::f64::consts::TAU).round()
    };
    for step in 0..20 {
        bag.motor(START_NS + 10 * step * MS, &[("a", angle(step))]);
        bag.joint(START_NS + (10 * step + 5) * MS, &[("a", angle(step))]);
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    for (step, frame) in frames.iter().take(19).enumerate() {
        let expected = 3.0 + 0.02 * (step as f64 + 0.5);
        assert!(
            (frame.theta[0] - expected).abs() < 1e-12,
            "{step}: {frame:?}"
        );
    }
    let wraps: Vec<_> = health
        .unwrapped
        .iter()
        .map(|w| (w.quantity, w.count))
        .collect();
    assert_eq!(wraps, [(Quantity::Q, 1), (Quantity::Theta, 1)]);
}

#[test]
fn message_may_contain_subset_of_joints() {
    let mut bag = Bag::new();
    for step in 0..20 {
        let time = START_NS + 10 * step * MS;
        // Same stamp, two messages: one frame.
        bag.joint(time, &[("a", 1.0)]);
        bag.joint(time, &[("b", 2.0)]);
        // Each motor reports on its own, at other times.
        bag.motor(time - 2 * MS, &[("a", step as f64)]);
        bag.motor(time + 3 * MS, &[("b", 0.1 * step as f64)]);
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 20);
    for (step, frame) in frames.iter().enumerate().skip(1).take(18) {
        assert_eq!(frame.q, [1.0, 2.0]);
        assert!(
            (frame.theta[0] - (step as f64 + 0.2)).abs() < 1e-12,
            "{frame:?}"
        );
        assert!(
            (frame.theta[1] - (0.1 * step as f64 - 0.03)).abs() < 1e-12,
            "{frame:?}"
        );
    }
    assert_eq!(health.duplicates, 0);
    assert_eq!(health.out_of_order, 0);
}

#[test]
fn joints_that_appear_late_are_named_and_ignored() {
    let mut bag = Bag::new();
    // More than the part looked at when opening: the first 16,384 messages of a topic.
    plain(&mut bag, 0..16_400);
    bag.joint(
        START_NS + 164_000 * MS,
        &[("a", 0.0), ("ghost", 1.0), ("b", 0.0)],
    );
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 16_401);
    assert_eq!(frames[16_400].q, [0.0, 0.0]);
    assert_eq!(health.unknown_joints, ["ghost"]);
}

#[test]
fn late_messages_are_sorted_in_and_too_late_ones_dropped() {
    let mut bag = Bag::new();
    for time in [0, 10, 30, 20, 40, 40, 400, 5, 410] {
        bag.joint(START_NS + time * MS, &[("a", time as f64 * 1e-3)]);
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(times(&frames), [0, 10, 20, 30, 40, 400, 410]);
    assert_eq!(
        (health.out_of_order, health.duplicates, health.late),
        (1, 1, 1)
    );
    assert!(health.is_lossy() && !health.is_damaged());
    // The first of two with one stamp is kept.
    assert_eq!(frames[4].q, [0.04]);
}

#[test]
fn gap_starts_segment() {
    let mut bag = Bag::new();
    plain(&mut bag, 0..10);
    plain(&mut bag, 1010..1020);
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames[9].segment, 0);
    assert_eq!(frames[10].segment, 1);
    assert_eq!(health.gaps, 1);
    assert!((health.longest_gap_s - 10.01).abs() < 1e-9);
    assert!(
        health
            .events
            .iter()
            .any(|event| event.kind == EventKind::Gap)
    );
}

#[test]
fn clock_step_back_starts_segment() {
    let mut bag = Bag::new();
    plain(&mut bag, 1000..1100);
    plain(&mut bag, 0..100);
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 200);
    assert_eq!(frames[99].segment, 0);
    assert_eq!(frames[100].segment, 1);
    // Its time continues by the last period.
    assert_eq!(times(&frames)[100], 11_000);
    assert_eq!((health.clock_steps, health.late), (1, 0));
    // The motor side jumps along.
    assert!(frames.iter().all(|frame| !frame.theta[0].is_nan()));
}

#[test]
fn one_stamp_from_the_future_does_not_end_the_recording() {
    let mut bag = Bag::new();
    plain(&mut bag, 0..100);
    bag.joint(START_NS + 86_400_000 * MS, &[("a", 0.0), ("b", 0.0)]);
    plain(&mut bag, 100..200);
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 200);
    assert_eq!((health.gaps, health.clock_steps, health.late), (0, 0, 1));
    assert!(frames.iter().all(|frame| !frame.theta[0].is_nan()));
}

#[test]
fn wrap_around_gives_same_turn_on_both_sides_after_gap() {
    let tau = std::f64::consts::TAU;
    let wrapped = |angle: f64| angle - tau * (angle / tau).round();
    let mut bag = Bag::new();
    let mut truth = Vec::new();
    for step in 0..400_i64 {
        // A gap of 2 s in which the joint turns by nearly half a turn, 3.10 rad, and the
        // motor, whose torque changes sign, by more than half a turn, 3.22 rad.
        let (pause, turned, twist) = if step >= 200 {
            (2000, 3.05, 0.06)
        } else {
            (0, 0.0, -0.06)
        };
        let q = 0.05 * step as f64 + turned;
        let theta = q + twist;
        let time = START_NS + (10 * step + pause) * MS;
        bag.joint(time, &[("a", wrapped(q))]);
        bag.motor(time, &[("a", wrapped(theta))]);
        truth.push((q, theta));
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    for (frame, (q, theta)) in frames.iter().zip(&truth) {
        assert!((frame.q[0] - q).abs() < 1e-9, "{} {q}", frame.q[0]);
        assert!(
            (frame.theta[0] - theta).abs() < 1e-9,
            "{} {theta}",
            frame.theta[0]
        );
    }
    assert_eq!(health.gaps, 1);
    assert_eq!(health.unwrapped.len(), 2);
    assert!(
        health.implausible_signals.is_empty(),
        "{:?}",
        health.implausible_signals
    );
}

#[test]
fn both_sides_start_on_the_same_turn() {
    let tau = std::f64::consts::TAU;
    let wrapped = |angle: f64| angle - tau * (angle / tau).round();
    let mut bag = Bag::new();
    // The joint just below half a turn, the motor just past it.
    for step in 0..20_i64 {
        let q = 3.13 - 0.001 * step as f64;
        let time = START_NS + 10 * step * MS;
        bag.joint(time, &[("a", q)]);
        bag.motor(time, &[("a", wrapped(q + 0.05))]);
    }
    let (frames, _) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 20);
    for frame in &frames {
        assert!(
            (frame.theta[0] - frame.q[0] - 0.05).abs() < 1e-9,
            "{frame:?}"
        );
    }
}

#[test]
fn signal_of_several_turns_is_unchanged() {
    let mut bag = Bag::new();
    for step in 0..100_i64 {
        // Jumps of 4 rad between samples of a signal that spans 40 rad.
        let q = if step < 20 {
            0.4 * step as f64
        } else {
            4.0 * (step % 10) as f64
        };
        bag.joint(START_NS + 10 * step * MS, &[("a", q)]);
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames[99].q, [36.0]);
    assert!(health.unwrapped.is_empty(), "{:?}", health.unwrapped);
}

#[test]
fn second_joint_state_topic_is_motor_side() {
    let mut bag = Bag::new();
    for step in 0..20 {
        let time = START_NS + 10 * step * MS;
        bag.joint(time, &[("a", 1.0)]);
        let mut motor = joint_state(time, &[("a", 2.0)]);
        motor.effort = vec![3.0];
        bag.raw("/motor_states", &little(&motor));
    }
    let bytes = bag.bytes();
    let (frames, _) = read_bytes(&bytes, "a.mcap");
    assert_eq!((frames[0].theta[0], frames[0].tau_m[0]), (2.0, 3.0));
    let options = OpenOptions {
        motor_topic: Some("/motor_sates".to_owned()),
        ..OpenOptions::default()
    };
    let error = error_of(&bytes, "a.mcap", &options);
    assert!(error.contains("did you mean '/motor_states'"), "{error}");
}

#[test]
fn without_a_stamp_the_log_time_counts() {
    let mut bag = Bag::new();
    for _ in 0..5 {
        bag.joint(0, &[("a", 1.0)]);
    }
    let (frames, _) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 5);
    assert_eq!(frames[0].time_ns, START_NS + 1);
}

#[test]
fn mapping_converts_topics_of_other_robots() {
    let mut bag = Bag::new();
    for step in 0..20 {
        let time = START_NS + 10 * step * MS;
        bag.raw("/arm/states", &little(&joint_state(time, &[("j1", 90.0)])));
        // Amperes where a torque would be.
        let drives = JointState {
            effort: vec![1.5],
            ..joint_state(time, &[("m1", -100.0)])
        };
        bag.raw("/arm/drives", &little(&drives));
    }
    let mapping = r#"
        [joints.shoulder]
        name = "j1"
        motor_name = "m1"
        q = { unit = "deg" }
        theta = { gear_ratio = 50.0, sign = -1, offset = 0.25 }
        tau_m = { unit = "A", torque_constant_nm_per_a = 0.04, gear_ratio = 50.0 }
        [mcap]
        joint_state_topic = "/arm/states"
        motor_topic = "/arm/drives"
    "#;
    let options = OpenOptions {
        mapping: Some(Mapping::from_toml(mapping, "map.toml").unwrap()),
        ..OpenOptions::default()
    };
    let recording = open_bytes(&bag.bytes(), "a.mcap", &options).unwrap();
    assert_eq!(recording.joints(), ["shoulder"]);
    let (frames, _) = read_all(recording);
    assert!((frames[0].q[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert!((frames[0].theta[0] - 2.25).abs() < 1e-15);
    assert!((frames[0].tau_m[0] - 3.0).abs() < 1e-15);
}
