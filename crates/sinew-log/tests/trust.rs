//! Samples that are questioned before they are used: clocks that are set, missing stamps, second publishers, drivers
//! that share a topic or start late, counts of one motor turn.

use crate::support::*;
use sinew_log::{Frame, Health, Mapping, OpenOptions, Quantity, StreamRole};

/// Position of a joint that moves, rad.
fn position(time_s: f64) -> f64 {
    0.4 + 0.3 * (1.7 * time_s).sin()
}

/// Recording at 100 Hz with both sides, 10 s long; `stamp` and `log` give both clocks by the true time, ns.
fn clocked(stamp: impl Fn(i64) -> i64, log: impl Fn(i64) -> i64) -> (Vec<Frame>, Health) {
    let mut bag = Bag::new();
    for step in 0..1_000 {
        let (at, q) = (10 * step * MS, position(0.01 * step as f64));
        bag.log_at(log(at) as u64);
        bag.joint(stamp(at), &[("a", q)]);
        bag.motor(stamp(at), &[("a", q + 0.02)]);
    }
    read_bytes(&bag.bytes(), "a.mcap")
}

/// Checks that frames are 10 ms apart, hold their positions, and begin a new segment at `at` only.
fn assert_continuous(frames: &[Frame], at: usize) {
    assert_eq!(frames.len(), 1_000);
    for (step, frame) in frames.iter().enumerate() {
        let since_ns = frame.time_ns - frames[0].time_ns;
        let late_ns = since_ns - 10 * step as i64 * MS;
        assert!(late_ns.abs() < MS, "{step}: {late_ns} ns");
        let q = position(0.01 * step as f64);
        assert_eq!((frame.q[0], frame.theta[0]), (q, q + 0.02), "{step}");
        assert_eq!(frame.segment, u32::from(step >= at));
    }
}

#[test]
fn clock_set_back_by_an_hour_continues_recording() {
    let back = |at: i64| START_NS + at - i64::from(at >= 5_000 * MS) * 3_600_000 * MS;
    // Log times continue, are set back too, and are those of no clock.
    let plain = |at: i64| START_NS + at;
    let none = |at: i64| START_NS + at / MS;
    for (name, log) in [
        ("on", &plain as &dyn Fn(i64) -> i64),
        ("back", &back),
        ("none", &none),
    ] {
        let (frames, health) = clocked(back, log);
        assert_continuous(&frames, 500);
        assert_eq!((health.clock_steps, health.gaps), (1, 0), "{name}");
        assert!(!health.is_lossy(), "{name}: {health:?}");
    }
}

#[test]
fn clock_set_back_within_reorder_window_continues_recording() {
    for step_ms in [130, 200, 265] {
        let back = |at: i64| START_NS + at - i64::from(at >= 5_000 * MS) * step_ms * MS;
        let (frames, health) = clocked(back, |at| START_NS + at);
        assert_continuous(&frames, 500);
        let counts = (health.clock_steps, health.out_of_order, health.duplicates);
        assert_eq!(counts, (1, 0, 0), "{step_ms} ms");
    }
}

#[test]
fn clock_set_back_during_pause_keeps_pause() {
    let (frames, health) = clocked(
        |at| START_NS + at + i64::from(at >= 5_000 * MS) * (2_000 - 3_600_000) * MS,
        |at| START_NS + at + i64::from(at >= 5_000 * MS) * 2_000 * MS,
    );
    assert_eq!(frames[500].time_ns - frames[499].time_ns, 2_010 * MS);
    assert_eq!((health.clock_steps, health.gaps), (1, 1));
}

#[test]
fn clock_set_ahead_while_log_times_continue_is_no_gap() {
    let ahead = |at: i64| START_NS + at + i64::from(at >= 5_000 * MS) * 3_600_000 * MS;
    let (frames, health) = clocked(ahead, |at| START_NS + at);
    assert_continuous(&frames, 500);
    assert_eq!((health.clock_steps, health.gaps), (1, 0));
    // Without such log times it is a pause.
    let (frames, health) = clocked(ahead, ahead);
    assert_eq!(
        (frames.len(), health.clock_steps, health.gaps),
        (1_000, 0, 1)
    );
    assert!((health.longest_gap_s - 3_600.01).abs() < 1e-6);
}

#[test]
fn clock_of_table_set_back_continues_recording() {
    let mut text = String::from("time_s,q.a_rad,theta.a_rad\n");
    for step in 0..1_000 {
        let time_s = 0.01 * f64::from(step) - if step >= 500 { 3_600.0 } else { 0.0 };
        let q = position(0.01 * f64::from(step));
        text.push_str(&format!("{time_s:.2},{q},{}\n", q + 0.02));
    }
    let (frames, health) = read_bytes(text.as_bytes(), "a.csv");
    assert_eq!((frames.len(), health.clock_steps), (1_000, 1));
    assert_eq!(frames[999].time_ns - frames[0].time_ns, 9_990 * MS);
}

#[test]
fn simulated_time_from_zero_is_time_stamp() {
    let (frames, health) = clocked(|at| at, |at| START_NS + at);
    assert_continuous(&frames, usize::MAX);
    assert_eq!(frames[0].time_ns, 0);
    assert_eq!(
        (health.clock_steps, health.gaps, health.unstamped),
        (0, 0, 0)
    );
}

#[test]
fn message_without_stamp_follows_clock_of_topic() {
    // Stamps of simulated time from 100 s on; three messages have none.
    let missing = [0, 400, 777];
    let stamp = |at: i64| match missing.contains(&(at / (10 * MS))) {
        true => 0,
        false => 100_000 * MS + at,
    };
    let (frames, health) = clocked(stamp, |at| START_NS + at);
    assert_continuous(&frames, usize::MAX);
    // Of both sides.
    assert_eq!(
        (health.clock_steps, health.gaps, health.unstamped),
        (0, 0, 6)
    );
}

#[test]
fn stamp_from_future_on_one_side_leaves_sides_joined() {
    let mut bag = Bag::new();
    for step in 0..1_000 {
        let (at, q) = (START_NS + 10 * step * MS, position(0.01 * step as f64));
        bag.joint(at + i64::from(step == 400) * 86_400_000 * MS, &[("a", q)]);
        bag.motor(at, &[("a", q + 0.02)]);
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!((frames.len(), health.late, health.clock_steps), (999, 1, 0));
    assert!(frames.iter().all(|frame| frame.theta[0].is_finite()));
}

/// Recording of two drivers that share the joint side: `a` and, `later_ns` later, `b`.
fn shared_topic(later_ns: i64, every: i64) -> (Vec<Frame>, Health) {
    let mut bag = Bag::new();
    for step in 0..1_000 {
        let at = START_NS + 8 * step * MS;
        let q = |time_ns: i64| position(1e-9 * (time_ns - START_NS) as f64);
        bag.joint(at, &[("a", q(at))]);
        if step % every == 0 {
            let later = at + later_ns;
            bag.joint(later, &[("b", -q(later))]);
        }
        bag.motor(at, &[("a", q(at)), ("b", -q(at))]);
    }
    read_bytes(&bag.bytes(), "a.mcap")
}

#[test]
fn joints_of_two_drivers_are_joined_by_time() {
    for (later_ns, every) in [(300_000, 1), (5_000_000, 1), (0, 1), (300_000, 4)] {
        let (frames, health) = shared_topic(later_ns, every);
        assert_eq!(frames.len(), 1_000);
        let within = &frames[8..990];
        for frame in within {
            // Half the curvature times the square of half the interval of the slower driver; rounding of stamps.
            let bound = 0.5 * 0.3 * 1.7_f64.powi(2) * (0.004 * every as f64).powi(2) + 1e-7;
            let error = (frame.q[1] - frame.theta[1]).abs();
            assert!(error <= bound, "{later_ns} {every}: {error} {bound}");
            assert_eq!(frame.q[0], frame.theta[0]);
        }
        assert!(!health.is_lossy(), "{:?}", health.streams);
        assert!(health.second_publishers.is_empty(), "{health:?}");
        let joint_side = &health.streams[0];
        assert_eq!(
            (joint_side.role, joint_side.missing),
            (StreamRole::JointSide, Some(0))
        );
        assert!((joint_side.step_s.unwrap() - 0.008).abs() < 1e-9);
    }
}

/// Recording at 125 Hz with a second publisher of the joints every `every_ms` from `from_ms` on, with `pose` by
/// the time in s.
fn with_second(
    every_ms: f64,
    from_ms: f64,
    pose: impl Fn(f64) -> [f64; 2],
) -> (Vec<Frame>, Health) {
    let (mut bag, mut next_ms) = (Bag::new(), from_ms + 0.7);
    for step in 0..2_500_i64 {
        let at_ms = 8.0 * step as f64;
        while next_ms < at_ms {
            let [a, b] = pose(1e-3 * next_ms);
            bag.joint(START_NS + (next_ms * 1e6) as i64, &[("a", a), ("b", b)]);
            next_ms += every_ms;
        }
        let (at, q) = (START_NS + 8 * step * MS, position(1e-3 * at_ms));
        bag.joint(at, &[("a", q), ("b", 0.5 * q)]);
        bag.motor(at, &[("a", q + 0.02), ("b", 0.5 * q + 0.02)]);
    }
    read_bytes(&bag.bytes(), "a.mcap")
}

#[test]
fn samples_of_second_publisher_are_excluded_and_counted() {
    // A fixed pose rarely, often, from the start, later, as often as the driver, and a moving one.
    for (every_ms, from_ms) in [
        (96.0, 40.0),
        (96.0, 0.0),
        (96.0, 9_000.0),
        (20.0, 6_000.0),
        (8.0, 0.0),
    ] {
        let (frames, health) = with_second(every_ms, from_ms, |_| [0.1, 0.6]);
        let name = format!("every {every_ms} ms from {from_ms} ms");
        assert_eq!(
            frames.len(),
            2_500,
            "{name}: {:?}",
            health.second_publishers
        );
        for frame in &frames {
            assert!(
                (frame.theta[0] - frame.q[0] - 0.02).abs() < 1e-12,
                "{name}: {frame:?}"
            );
        }
        let [second] = &health.second_publishers[..] else {
            panic!("{name}: {health:?}");
        };
        let expected = ((19_991.3 - from_ms) / every_ms).ceil() as u64;
        assert_eq!(
            (second.stream, second.samples),
            (StreamRole::JointSide, expected),
            "{name}"
        );
        assert_eq!(health.streams[0].missing, Some(0), "{name}");
    }
    let (frames, health) = with_second(50.0, 1_000.0, |t| [0.3 * t.cos(), -0.2]);
    assert_eq!(frames.len(), 2_500);
    assert!(!health.second_publishers.is_empty());
}

#[test]
fn step_that_lasts_and_wrong_value_are_samples_of_driver() {
    let mut bag = Bag::new();
    for step in 0..2_000_i64 {
        let at = START_NS + 8 * step * MS;
        let noise = 1e-4 * ((step * 7_919 % 101) as f64 - 50.0) / 50.0;
        // The reading slips at a step, and is wrong once.
        let slip = if step >= 900 { -0.04 } else { 0.0 } + if step == 1_500 { 0.5 } else { 0.0 };
        let q = position(0.008 * step as f64) + noise + slip;
        bag.joint(at, &[("a", q)]);
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 2_000);
    assert!(health.second_publishers.is_empty(), "{health:?}");
}

#[test]
fn joint_that_appears_late_is_used_from_then_on() {
    let mut bag = Bag::new();
    for step in 0..2_000_i64 {
        let (at, q) = (START_NS + 8 * step * MS, position(0.008 * step as f64));
        let count = if step < 500 { 1 } else { 2 };
        bag.joint(at, &[("a", q), ("b", -q)][..count]);
        bag.motor(at, &[("a", q), ("b", -q)]);
    }
    let recording = open_bytes(&bag.bytes(), "a.mcap", &OpenOptions::default()).unwrap();
    assert!(recording.channels().joints.iter().all(|joint| joint.q));
    let (frames, health) = read_all(recording);
    assert!(frames[499].q[1].is_nan() && frames[500].q[1].is_finite());
    let [late] = &health.late_starts[..] else {
        panic!("{health:?}");
    };
    assert_eq!((late.quantity, late.joint.as_str()), (Quantity::Q, "b"));
    assert!((late.after_s - 4.0).abs() < 1e-9);
    assert_eq!(health.unknown_joints, Vec::<String>::new());
}

#[test]
fn counts_of_one_motor_turn_unwrap_by_gear_ratio() {
    let mapping = r#"
        [joints.a]
        theta = { unit = "count", counts_per_turn = 4096, gear_ratio = 6 }
    "#;
    let options = OpenOptions {
        mapping: Some(Mapping::from_toml(mapping, "servo.toml").unwrap()),
        ..OpenOptions::default()
    };
    let mut bag = Bag::new();
    for step in 0..2_000_i64 {
        let (at, q) = (START_NS + 8 * step * MS, position(0.008 * step as f64));
        let turns = (3.0 * q + 0.3) * 6.0 / std::f64::consts::TAU;
        bag.joint(at, &[("a", 3.0 * q)]);
        bag.motor(at, &[("a", (4096.0 * turns.fract()).floor())]);
    }
    let (frames, health) = read_all(open_bytes(&bag.bytes(), "a.mcap", &options).unwrap());
    let apart = |frame: &Frame| frame.theta[0] - frame.q[0] - 0.3;
    let turn = std::f64::consts::TAU / 6.0;
    let first = (apart(&frames[0]) / turn).round() * turn;
    for frame in &frames {
        assert!(
            (apart(frame) - first).abs() < turn / 4096.0 + 1e-9,
            "{frame:?}"
        );
    }
    let [unwrapped] = &health.unwrapped[..] else {
        panic!("{health:?}");
    };
    assert_eq!(unwrapped.quantity, Quantity::Theta);
    assert!(unwrapped.count >= 4, "{unwrapped:?}");
}
