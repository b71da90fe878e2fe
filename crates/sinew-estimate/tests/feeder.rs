//! Input of frames to an observer: rejected frames do not change it, a segment re-initialises it.

use crate::support::biorob_like;

use sinew_estimate::feeder::{FeedOutcome, Feeder, FeederOptions, RejectionReason};
use sinew_estimate::session::Recorder;
use sinew_log::Frame;
use sinew_model::offset::{Block, FeatureConfig, FeatureObserver};
use sinew_model::robot::Robot;

/// Frames of an oscillating arm: 16 s at 250 Hz.
fn swing(robot: &Robot) -> Vec<Frame> {
    let n = robot.arm.dof();
    let frame = |k: u32| {
        let t = f64::from(k) / 250.0;
        let mut frame = Frame::new(n);
        frame.time_ns = i64::from(k) * 4_000_000;
        for i in 0..n {
            let phase = 1.3 * t + i as f64;
            frame.q[i] = 0.5 * phase.sin();
            frame.theta[i] = frame.q[i] + 0.02 * phase.cos();
        }
        frame
    };
    (0..4000).map(frame).collect()
}

fn recorded(robot: &Robot, frames: &[Frame]) -> Vec<Block> {
    let mut recorder = Recorder::new(robot, &FeatureConfig::default(), 0.5);
    for frame in frames {
        recorder.push(frame, frame.time_ns as f64 * 1e-9);
    }
    recorder.finish().blocks
}

/// Blocks of samples that are processed as in `examples/live_offsets.rs`.
fn live(robot: &Robot, frames: &[Frame]) -> Vec<Block> {
    let features = FeatureObserver::new(&robot.arm, FeatureConfig::default());
    let mut feeder = Feeder::new(features, &robot.transmissions, FeederOptions::default());
    let mut blocks = Vec::new();
    for frame in frames {
        if feeder.frame(frame).output() == Some(true) {
            blocks.push(feeder.observer().block().clone());
        }
    }
    blocks
}

/// Checks that blocks are bitwise identical except for the time of day; NaN equals NaN.
fn assert_same(a: &[Block], b: &[Block]) {
    assert!(
        a.len() > 10 && a.len() == b.len(),
        "{} {}",
        a.len(),
        b.len()
    );
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert_eq!(
            format!("{:?}", (&a.q, &a.y)),
            format!("{:?}", (&b.q, &b.y)),
            "block {k}"
        );
    }
}

type Blocks = fn(&Robot, &[Frame]) -> Vec<Block>;

// Every 50th frame is unusable: the time step of the next one is the time since the last usable frame.
#[test]
fn rejected_sample_does_not_change_state() {
    let robot = biorob_like();
    let clean = swing(&robot);
    for bad in [1e70, f64::NAN] {
        let mut frames = clean.clone();
        let refused = |k: usize| k % 50 == 49;
        for (k, frame) in frames.iter_mut().enumerate() {
            if refused(k) {
                frame.q[1] = bad;
            }
        }
        let left: Vec<Frame> = (0..clean.len())
            .filter(|k| !refused(*k))
            .map(|k| clean[k].clone())
            .collect();
        for (name, blocks) in [("recorder", recorded as Blocks), ("live", live)] {
            println!("{name}, {bad}");
            assert_same(&blocks(&robot, &frames), &blocks(&robot, &left));
        }
    }
}

// Wild values of a running robot: beyond the limits of the URDF, or within them at a speed that no drive reaches (2 rad in 1 ms are
// 2000 rad/s, the URDF states 6 rad/s).
#[test]
fn unreachable_sample_does_not_change_state() {
    let robot = biorob_like();
    let clean = swing(&robot);
    let recorded = |frames: &[Frame]| {
        let recorder = Recorder::new(&robot, &FeatureConfig::default(), 0.5);
        let mut recorder = recorder.with_limits(&robot);
        for frame in frames {
            recorder.push(frame, frame.time_ns as f64 * 1e-9);
        }
        recorder.finish().blocks
    };
    let refused = |k: usize| k % 50 == 49;
    let left: Vec<Frame> = (0..clean.len())
        .filter(|k| !refused(*k))
        .map(|k| clean[k].clone())
        .collect();
    let wild: [fn(&mut Frame); 3] = [
        |frame| frame.q[1] = 1000.0,
        |frame| frame.q[1] += 2.0,
        |frame| frame.theta[1] = 1000.0,
    ];
    for wild in wild {
        let mut frames = clean.clone();
        for (k, frame) in frames.iter_mut().enumerate() {
            if refused(k) {
                wild(frame);
            }
        }
        assert_same(&recorded(&frames), &recorded(&left));
    }
    // A valid recording is not affected.
    assert_same(&recorded(&clean), &self::recorded(&robot, &clean));
}

// After a short gap, which the recording marks as a new segment, the arm has another pose.
#[test]
fn new_segment_reinitialises_filters() {
    let robot = biorob_like();
    let mut frames = swing(&robot);
    for frame in &mut frames[2000..] {
        frame.segment = 1;
        frame.time_ns += 300_000_000;
        frame
            .q
            .iter_mut()
            .chain(&mut frame.theta)
            .for_each(|x| *x += 0.4);
    }
    let first = recorded(&robot, &frames[..2000]).len();
    let alone = recorded(&robot, &frames[2000..]);
    for (name, blocks) in [("recorder", recorded as Blocks), ("live", live)] {
        println!("{name}");
        let blocks = blocks(&robot, &frames);
        assert_eq!(blocks.len(), first + alone.len());
        for (a, b) in blocks[first..].iter().zip(&alone) {
            // The clock of the blocks continues, so sums of steps are rounded differently.
            let pairs = a.y.iter().zip(&b.y);
            assert!(
                pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9),
                "{a:?} {b:?}"
            );
        }
    }
}

// Outcome of a frame as returned to the caller.
#[test]
fn frame_outcome_is_used_rejected_or_restart() {
    let robot = biorob_like();
    let mut frames = swing(&robot);
    frames.truncate(9);
    frames[2].q[0] = f64::NAN;
    frames[3].theta[1] = f64::INFINITY;
    frames[4].q[0] = 1e70;
    frames[5].time_ns = frames[1].time_ns;
    frames[7].segment = 1;
    frames[8].segment = 1;
    frames[8].time_ns += 600_000_000;
    let features = FeatureObserver::new(&robot.arm, FeatureConfig::default());
    let mut feeder = Feeder::new(features, &robot.transmissions, FeederOptions::default());
    let fed: Vec<FeedOutcome<bool>> = frames.iter().map(|frame| feeder.frame(frame)).collect();
    let expected = [
        FeedOutcome::Restarted(false),
        FeedOutcome::Accepted(false),
        FeedOutcome::Rejected(RejectionReason::JointPosition),
        FeedOutcome::Rejected(RejectionReason::MotorPosition),
        FeedOutcome::Rejected(RejectionReason::Range),
        FeedOutcome::Rejected(RejectionReason::TimeStep),
        FeedOutcome::Accepted(false),
        FeedOutcome::Restarted(false),
        FeedOutcome::Restarted(false),
    ];
    assert_eq!(fed, expected);
    assert_eq!(feeder.segments(), 2);
}
