//! Online estimate: the estimator of recordings on a sliding window.

use crate::rest_phases;
use crate::support::{biorob_like, repository, sessions, watching, work_session};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::online::{OnlineEstimator, Provisional, StepOutcome, Window, replay};
use sinew_estimate::session::{
    Learning, Recorded, Recorder, SessionEstimate, SessionOptions, estimate_recorded,
    learn_recorded,
};
use sinew_model::StepError;
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use sinew_sim::protocol::plan_named;

const PITCH: usize = 1;
const ELBOW: usize = 2;

fn learned(robot: &Robot, recorded: &Recorded) -> Baseline {
    learn_recorded(robot, recorded, "A", &Learning::default())
        .unwrap()
        .0
}

/// The first blocks of a recording.
fn until(recorded: &Recorded, count: usize) -> Recorded {
    let mut part = recorded.clone();
    part.blocks.truncate(count);
    let end_s = recorded.blocks.last().unwrap().time_s;
    let before_end_s = end_s - part.blocks.last().unwrap().time_s;
    part.end_time_ns -= (before_end_s * 1e9).round() as i64;
    part
}

// At every solution the window is bitwise identical to the estimate of a recording that ends there.
#[test]
fn window_equals_estimate_of_its_blocks() {
    let plan = plan_named("S7").unwrap();
    let ([a, b], _) = sessions(&plan, 31);
    let (robot, options) = (&plan.robot, watching(&plan));
    let baseline = learned(robot, &a);
    let with = Some((&baseline, "A"));
    let mut window = Window::new(
        robot.clone(),
        Some((baseline.clone(), "A".into())),
        &options,
        "B",
    )
    .unwrap();
    let mut compared = 0;
    for count in [10, 40, 150, b.blocks.len() / 10 * 10] {
        let part = until(&b, count);
        let mut seen = 0;
        window = replay(robot, &part, with, &options, "B", &mut |window| {
            seen += 1;
            assert_eq!(window.answer().blocks, seen);
        })
        .unwrap();
        let (estimate, _) = estimate_recorded(robot, &part, "B", with, &options).unwrap();
        let online = window.estimate().unwrap();
        assert_eq!(online.joints.len(), 4);
        for (online, batch) in online.joints.iter().zip(&estimate.joints) {
            assert_eq!(
                online.offset_rad, batch.offset_rad,
                "{count}: {}",
                batch.name
            );
            assert_eq!(online.stiffness_change, batch.stiffness_change);
            assert_eq!(online.verdict, batch.verdict);
            compared += 1;
        }
        assert_eq!(online.payload_kg, estimate.payload_kg);
        assert_eq!(online.rejected_intervals, estimate.rejected_intervals);
        assert_eq!(online.warnings, estimate.warnings);
    }
    assert_eq!(compared, 16);
    let next = window.next().unwrap();
    assert_eq!(next.recordings, ["A", "B"]);
}

// Two tendons slip by 5 mrad 20 s apart: each is suspected within 2 s, no other one is for long, and the offset is
// right 10 s later.
#[test]
fn slip_is_provisional_within_2_s_then_tracked() {
    const SLIPS: [(usize, f64); 2] = [(PITCH, 130.0), (ELBOW, 150.0)];
    const SIZE_RAD: f64 = 5e-3;
    let robot = biorob_like();
    let (parts, truth) = work_session(&robot, 60, |text| text, &[60.0]);
    let baseline = learned(&robot, &parts[0]);
    let options = SessionOptions::default();
    let (mut suspected_s, mut silent_s) = ([f64::NAN; 2], [0.0; 2]);
    let (mut provisional, mut calm) = (0, 0);
    let mut each = |window: &Window| {
        let answer = window.answer();
        let time_s = answer.time_s;
        for (k, (joint, at_s)) in SLIPS.into_iter().enumerate() {
            let own = &answer.joints[joint];
            if time_s < at_s {
                continue;
            }
            let is_step = matches!(own.provisional, Some(Provisional::Step { .. }));
            if is_step && suspected_s[k].is_nan() {
                suspected_s[k] = time_s - at_s;
            }
            let error_rad = own.offset_rad.mean - 1e-3 * truth[joint] - SIZE_RAD;
            // A correct interval is left occasionally: only the effect of the slip is checked.
            let outside = error_rad.abs() > 1.5 * own.offset_rad.half_width_95();
            if outside && own.provisional.is_none() {
                silent_s[k] = time_s - at_s;
            }
        }
        let after = |at_s: f64| (at_s..at_s + 12.0).contains(&time_s);
        if time_s > 75.0 && !SLIPS.iter().any(|(_, at_s)| after(*at_s)) {
            calm += answer.joints.len();
            let own = answer.joints.iter().filter(|own| own.provisional.is_some());
            provisional += own.count();
        }
    };
    let with = Some((&baseline, "A"));
    let window = replay(&robot, &parts[1], with, &options, "B", &mut each).unwrap();
    println!("suspected after {suspected_s:.1?} s, silently outside until {silent_s:.1?} s");
    println!("{provisional} of {calm} answers provisional where nothing happens");
    assert!(suspected_s.iter().all(|s| *s < 2.0), "{suspected_s:?}");
    assert!(silent_s.iter().all(|s| *s < 2.0), "{silent_s:?}");
    assert!(20 * provisional < calm, "{provisional} of {calm}");
    for (joint, _) in SLIPS {
        let own = window.answer().joints[joint];
        let error_rad = own.offset_rad.mean - 1e-3 * truth[joint] - SIZE_RAD;
        assert!(error_rad.abs() < own.offset_rad.half_width_95(), "{own:?}");
        assert!(own.offset_rad.half_width_95() < 3e-3 && own.provisional.is_none());
    }
}

// A motor torque that the estimate rejects is also ignored for later blocks: every answer equals the one without it.
#[test]
fn rejected_motor_torque_is_ignored_by_check() {
    let robot = biorob_like();
    let slips = |text: String| {
        text + "\n[[offsets]]\njoint = \"shoulder_pitch\"\nkind = \"physical\"\nshape = \"step\"\nat_s = 82.1\nrad = 0.005\n"
    };
    let (parts, _) = work_session(&robot, 60, slips, &[60.0, 95.0]);
    let baseline = learned(&robot, &parts[0]);
    let answers = |torque: &dyn Fn(f64) -> f64| {
        let mut recorded = parts[1].clone();
        for motor in recorded.blocks.iter_mut().flat_map(|b| &mut b.motor_torque) {
            *motor = torque(*motor);
        }
        let mut answers = Vec::new();
        let mut each = |window: &Window| {
            let known = window.answer().joints.iter();
            let known = known.map(|own| (own.offset_rad, own.provisional));
            answers.push((window.answer().solved_s, known.collect::<Vec<_>>()));
        };
        let with = Some((&baseline, "A"));
        let options = SessionOptions::default();
        replay(&robot, &recorded, with, &options, "B", &mut each).unwrap();
        // Before the first solution there is no answer.
        answers.retain(|(solved_s, _)| solved_s.is_finite());
        answers
    };
    let without = answers(&|_| f64::NAN);
    assert!(without.len() > 100, "{}", without.len());
    assert!(answers(&|_| 3.0) == without, "a constant torque");
    assert!(answers(&|nm| nm) != without, "a torque that is used");
}

// An arm at rest for minutes after motion keeps its estimate and needs no more memory.
#[test]
fn long_rest_phase_keeps_motion_in_window() {
    let robot = biorob_like();
    let baseline = rest_phases::baseline(&robot);
    let recorded = rest_phases::recording(&robot, 2, 400.0, 11, "");
    let with = Some((&baseline, "A"));
    let moves = recorded
        .blocks
        .iter()
        .take_while(|block| block.stood_s < 12.0);
    let worked = until(&recorded, moves.count());
    let options = SessionOptions::default();
    let [worked, stood] = [&worked, &recorded]
        .map(|recorded| replay(&robot, recorded, with, &options, "B", &mut |_| ()).unwrap());
    let [(before, _), (blocks, bytes)] = [&worked, &stood].map(Window::size);
    println!(
        "{before}, then {blocks} blocks, {:.2} MB",
        1e-6 * bytes as f64
    );
    assert!(recorded.blocks.len() > 2 * blocks && blocks <= before + 1);
    for own in &stood.answer().joints {
        let then = worked.answer().joint(own.joint).unwrap().offset_rad;
        let offset = own.offset_rad;
        assert!(offset.mean.abs() < offset.half_width_95(), "{own:?}");
        assert!(offset.std < 1.5 * then.std, "{own:?} {then:?}");
    }
}

// A window drops blocks older than 2 min.
#[test]
fn window_drops_blocks_after_2_min() {
    let robot = biorob_like();
    let (parts, _) = work_session(&robot, 42, |text| text, &[60.0]);
    let baseline = learned(&robot, &parts[0]);
    let mut twice = parts[1].clone();
    let length_s = twice.blocks.last().unwrap().time_s - twice.blocks[0].time_s + 0.2;
    for block in &parts[1].blocks {
        let mut block = block.clone();
        block.time_s += length_s;
        twice.blocks.push(block);
    }
    let with = Some((&baseline, "A"));
    let window = replay(
        &robot,
        &twice,
        with,
        &SessionOptions::default(),
        "B",
        &mut |_| (),
    )
    .unwrap();
    let (blocks, _) = window.size();
    assert!(twice.blocks.len() > 800 && blocks == 600, "{blocks}");
    let estimate = window.estimate().unwrap();
    let from_s = twice.blocks[twice.blocks.len() - 600].time_s;
    assert!(
        (estimate.segments[0].from_s - from_s).abs() < 2.5,
        "{from_s}"
    );
    assert!(
        (115.0..=130.0).contains(&estimate.duration_s),
        "{}",
        estimate.duration_s
    );
}

// Samples processed by the caller or by a thread give the same result as a replay of the recording.
#[test]
fn online_samples_equal_replay() {
    let robot = biorob_like();
    let options = SessionOptions::default();
    let file = repository().join("examples/01-stretched-arm/stretched-arm.mcap");
    let mut recording = sinew_log::open(&file, &sinew_log::OpenOptions::default()).unwrap();
    let mut recorder = Recorder::new(&robot, &FeatureConfig::default(), 0.5);
    let mut frames = Vec::new();
    while let Some(frame) = recording.next_frame().unwrap() {
        let start_ns = frames
            .first()
            .map_or(frame.time_ns, |f: &sinew_log::Frame| f.time_ns);
        recorder.push(frame, 1e-9 * (frame.time_ns - start_ns) as f64);
        frames.push(frame.clone());
    }
    let recorded = recorder.finish();
    let baseline = learned(&robot, &recorded);
    let with = Some((&baseline, "A"));
    let replayed = replay(&robot, &recorded, with, &options, "B", &mut |_| ()).unwrap();
    let online = || {
        let baseline = Some((baseline.clone(), "A".into()));
        OnlineEstimator::new(robot.clone(), baseline, &options, "B").unwrap()
    };
    let run = |online: &mut OnlineEstimator, after: &mut dyn FnMut(&mut OnlineEstimator)| {
        let mut last_ns = frames[0].time_ns;
        let mut blocks = 0;
        for frame in &frames {
            let dt_s = 1e-9 * (frame.time_ns - last_ns) as f64;
            last_ns = frame.time_ns;
            let (q, theta, tau_m) = (&frame.q, &frame.theta, &frame.tau_m);
            let outcome = online.step(dt_s, q, theta, tau_m, frame.temperature_c);
            if outcome.unwrap() == StepOutcome::Block {
                blocks += 1;
                after(online);
            }
        }
        blocks
    };
    let mut own = online();
    assert!(own.answer().is_provisional() && own.answer().joints[0].offset_rad.mean.is_nan());
    assert!(own.save("B", 0).is_err());
    let blocks = run(&mut own, &mut OnlineEstimator::work);
    assert_eq!(blocks, recorded.blocks.len());
    let (now, then) = (own.answer().clone(), replayed.answer());
    assert_eq!((now.blocks, own.blocks_dropped()), (then.blocks, 0));
    for (now, then) in now.joints.iter().zip(&then.joints) {
        // Blocks are some nanoseconds apart, by rounding of times.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(
            close(now.offset_rad.mean, then.offset_rad.mean),
            "{now:?} {then:?}"
        );
        assert!(close(now.offset_rad.std, then.offset_rad.std));
    }
    assert_eq!((own.blocks_behind(), own.error().is_none()), (0, true));
    // The slipped encoder is identified across the exchanged parts.
    let causes = |estimate: &SessionEstimate| -> Vec<_> {
        let changes = estimate.joints.iter().flat_map(|joint| &joint.changes);
        changes.map(|change| change.cause).collect()
    };
    let found = causes(&own.estimate().unwrap());
    assert_eq!(found, causes(replayed.estimate().unwrap()));
    assert!(found.iter().any(Option::is_some), "{found:?}");
    let saved = own.save("today", 5).unwrap();
    assert_eq!((&*saved.recordings[1], saved.end_time_ns), ("today", 5));
    // An invalid sample changes nothing.
    let four = [0.1; 4];
    let refused = own.step(0.002, &four[..3], &four, &[], f64::NAN);
    assert_eq!(refused, Err(StepError::Length));
    for dt_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = own.step(dt_s, &four, &four, &[], f64::NAN);
        assert_eq!(refused, Err(StepError::TimeStep));
    }
    // A separate thread, joined at the end: its delay is never large enough to drop blocks.
    let mut threaded = online();
    threaded.start_worker().unwrap();
    run(&mut threaded, &mut |online| {
        while online.answer().blocks == 0 && online.blocks_dropped() == 0 {
            std::thread::yield_now();
        }
    });
    while threaded.answer().blocks < now.blocks && threaded.blocks_dropped() == 0 {
        std::thread::yield_now();
    }
}

// Estimate with `--online`: the intervals of provisional answers contain every provisional block.
#[test]
fn provisional_intervals_contain_all_provisional_blocks() {
    let robot = biorob_like();
    let options = SessionOptions::default();
    let (parts, _) = work_session(&robot, 40, |text| text, &[60.0, 120.0]);
    let baseline = learned(&robot, &parts[0]);
    let with = Some((&baseline, "A"));
    let course =
        sinew_estimate::online::trajectory(&robot, &parts[1], with, &options, "B").unwrap();
    assert_eq!(course.blocks.len(), parts[1].blocks.len());
    assert!(course.blocks[0].provisional && !course.provisional);
    for block in &course.blocks {
        let spans = course.provisional_intervals.iter();
        let inside = spans.filter(|d| (d.from_s..=d.to_s).contains(&block.time_s));
        let expected = usize::from(block.provisional);
        assert_eq!(inside.count(), expected, "{}", block.time_s);
    }
    // Also relative to the encoder zero.
    let fresh = sinew_estimate::online::trajectory(&robot, &parts[1], None, &options, "B").unwrap();
    let [fresh, since] = [&fresh, &course].map(|c| c.joints[PITCH].offset_rad.std);
    assert!(fresh > since, "{fresh} {since}");
}

// Motor and joint side are swapped from a time on: the window can no longer be solved, and every later answer reports
// it.
#[test]
fn unsolved_window_makes_all_answers_provisional() {
    let robot = biorob_like();
    let (parts, _) = work_session(&robot, 43, |text| text, &[60.0]);
    let baseline = learned(&robot, &parts[0]);
    let mut swapped = parts[1].clone();
    let from = swapped.blocks.len() / 3;
    for block in &mut swapped.blocks[from..] {
        block.y.iter_mut().for_each(|y| *y = -*y);
    }
    let (mut refused, mut after) = (false, 0);
    let with = Some((&baseline, "A"));
    let options = SessionOptions::default();
    let window = replay(&robot, &swapped, with, &options, "B", &mut |window| {
        let answer = window.answer();
        let is_refused = |own: &sinew_estimate::online::OnlineJoint| {
            own.provisional == Some(Provisional::NotSolved)
        };
        refused |= answer.joints.iter().any(is_refused);
        if refused {
            after += 1;
            assert!(
                answer.joints.iter().all(|own| own.provisional.is_some()),
                "{answer:?}"
            );
        }
    })
    .unwrap();
    let error = window
        .error()
        .expect("a window that was not solved")
        .to_string();
    assert!(after > 20 && error.contains("B"), "{after} {error}");
}
