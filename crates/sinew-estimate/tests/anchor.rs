//! Reference contacts: an end stop or an index mark separates an encoder slip from an elongation.
//!
//! `SINEW_SEEDS=24 cargo test --release -p sinew-estimate --test all anchor:: -- --nocapture` measures it.

use crate::support;

use sinew_estimate::session::{
    self, Recorded, Recorder, SessionEstimate, SessionOptions, Touch, Verdict,
};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use sinew_model::transmission::{Anchor, AnchorKind};
use sinew_sim::{Scenario, Simulation};
use support::{biorob_like, least, repository, seeds};

/// Position of the elbow's stop, rad.
pub(crate) const STOP_RAD: f64 = 1.9;
/// Duration of each session, s.
const SESSION_S: f64 = 60.0;
pub(crate) const ELBOW: usize = 2;

/// Motion over the arm's range, then three slow pushes of the elbow against its stop.
fn motion(seed: u64) -> String {
    let mut out = String::from(
        "[motion]\nkind = \"waypoints\"\nrepeat = true\nstart_rad = { elbow = 0.4 }\n",
    );
    let mut pose = |pose: [f64; 4], move_s: f64, pause_s: f64| {
        let [a, b, c, d] = pose;
        out += &format!(
            "[[motion.waypoints]]\npose_rad = {{ shoulder_yaw = {a:.3}, shoulder_pitch = {b:.3}, elbow = {c:.3}, wrist = {d:.3} }}\nmove_s = {move_s}\npause_s = {pause_s}\n"
        );
    };
    let part = |k: u64, n: u64| ((k * 7919 + seed * 104_729) % n) as f64 / n as f64;
    for k in 0..24 {
        let at = [
            -1.2 + 2.4 * part(k, 101),
            1.6 * part(k + 3, 97),
            1.7 * part(k + 7, 89),
            -1.0 + 2.0 * part(k + 11, 83),
        ];
        pose(at, 1.1, 0.6);
    }
    pose([0.0, 0.6, STOP_RAD - 0.05, 0.0], 1.5, 0.5);
    for _ in 0..3 {
        pose([0.0, 0.6, STOP_RAD + 0.2, 0.0], 1.6, 0.3);
        pose([0.0, 0.6, STOP_RAD + 0.06, 0.0], 1.6, 0.3);
    }
    pose([0.0, 0.6, 1.2, 0.0], 1.5, 0.3);
    out
}

/// Simulates two sessions: directly after tensioning, and later with `offsets`.
pub(crate) fn simulate(
    robot: &Robot,
    seed: u64,
    offsets: &str,
    touches: [&[Touch]; 2],
) -> [Recorded; 2] {
    let text = std::fs::read_to_string(repository().join("examples/scenarios/work-session.toml"));
    let text = text.unwrap();
    // Truth and sensors are those of the shipped scenario; motion and events are replaced.
    let from = text.find("[motion]").unwrap();
    let to = text.find("[truth]").unwrap();
    let end = text.find("[random_contacts]").unwrap();
    let text = format!(
        "{}{}\n{}\n[[stops]]\njoint = \"elbow\"\nupper_rad = {STOP_RAD}\n{offsets}",
        &text[..from],
        motion(seed),
        &text[to..end]
    );
    let text = text.replace(
        "duration_s = 180.0",
        &format!("duration_s = {}", 2.0 * SESSION_S),
    );
    let mut scenario = Scenario::from_toml(&text, "anchor.toml").unwrap();
    scenario.seed = seed;
    let mut simulation = Simulation::new(robot, &scenario).unwrap();
    let recorder =
        |touches| Recorder::new(robot, &FeatureConfig::default(), 0.5).with_touches(robot, touches);
    let mut parts = touches.map(recorder);
    let mut at_s = 0.0;
    while let Some(frame) = simulation.next_frame().unwrap() {
        parts[usize::from(at_s >= SESSION_S)].push(frame, at_s);
        at_s += 1.0 / scenario.sample_rate_hz;
    }
    parts.map(Recorder::finish)
}

pub(crate) fn with_anchor(kind: AnchorKind, position_rad: f64) -> Robot {
    let mut robot = biorob_like();
    let anchor = Anchor {
        kind,
        position_rad,
        std_rad: 0.2e-3,
    };
    robot.transmissions[ELBOW]
        .as_mut()
        .unwrap()
        .anchors
        .push(anchor);
    robot
}

fn estimate(robot: &Robot, [a, b]: &[Recorded; 2]) -> SessionEstimate {
    let learning = session::Learning::default();
    let (baseline, _) = session::learn_recorded(robot, a, "A", &learning).unwrap();
    let options = SessionOptions::default();
    let with = Some((&baseline, "A"));
    session::estimate_recorded(robot, b, "B", with, &options)
        .unwrap()
        .0
}

// The joint encoder slips by 8 mrad between the sessions, and the offset of the rope grows by 5 mrad: the estimate from
// motion is 13 mrad.
#[test]
fn stop_separates_encoder_slip_from_elongation() {
    let offsets = "[[offsets]]\njoint = \"elbow\"\nkind = \"joint-encoder\"\nshape = \"step\"\nat_s = 60.0\nrad = 0.008\n\
        [[offsets]]\njoint = \"elbow\"\nkind = \"physical\"\nshape = \"step\"\nat_s = 60.0\nrad = 0.005\n";
    let (mut hits, mut without_reference, mut pushed, mut squares) = (0, 0, 0, 0.0);
    let count = seeds(4);
    for seed in 0..count {
        let plain = biorob_like();
        let recorded = simulate(&plain, 40 + seed, offsets, [&[], &[]]);
        let robot = with_anchor(AnchorKind::Stop, STOP_RAD);
        let result = estimate(&robot, &recorded);
        let elbow = &result.joints[ELBOW];
        let anchored = elbow.anchored.as_ref().expect("the stop was touched");
        assert!(anchored.since_baseline && anchored.readings.len() == 1);
        let off = |x: sinew_model::Gaussian, truth: f64| (x.mean - truth).abs();
        // The estimate from motion alone is wrong, with a small interval.
        without_reference +=
            u32::from(off(anchored.by_motion_rad, 5e-3) > anchored.by_motion_rad.half_width_95());
        assert!(
            off(anchored.correction_rad, -8e-3) < 1.5e-3,
            "{:?}",
            anchored.correction_rad
        );
        hits += u32::from(off(elbow.offset_rad, 5e-3) <= elbow.offset_rad.half_width_95());
        squares += off(elbow.offset_rad, 5e-3).powi(2);
        let push = anchored
            .by_push_rad
            .expect("the motor's torque is recorded");
        println!(
            "{seed}: motion {:.2} ± {:.2}, corrected {:.2} ± {:.2}, push {:.2} ± {:.2} mrad",
            1e3 * anchored.by_motion_rad.mean,
            1e3 * anchored.by_motion_rad.half_width_95(),
            1e3 * elbow.offset_rad.mean,
            1e3 * elbow.offset_rad.half_width_95(),
            1e3 * push.mean,
            1e3 * push.half_width_95(),
        );
        pushed += u32::from(off(push, 5e-3) <= push.half_width_95());
        // Other joints are unchanged, and without the reference nothing is corrected.
        let free = estimate(&plain, &recorded);
        assert_eq!(free.joints[ELBOW].offset_rad, anchored.by_motion_rad);
        assert_eq!(free.joints[1].offset_rad, result.joints[1].offset_rad);
    }
    let rms = 1e3 * (squares / count as f64).sqrt();
    println!(
        "{hits} of {count} inside, RMS {rms:.2} mrad; by motion alone {without_reference} outside, by pushes {pushed} inside"
    );
    assert!(
        u64::from(hits) * 10 >= count * 9 && rms < 1.0,
        "{hits} of {count}, {rms} mrad"
    );
    assert_eq!(u64::from(without_reference), count);
    assert!(f64::from(pushed) >= least(0.95, count as f64), "{pushed}");
}

// A recording that does not reach the stop, or rests near it without pushing, has no reference.
#[test]
fn stop_without_push_is_no_reference() {
    let mut robot = with_anchor(AnchorKind::Stop, 0.4);
    let recorded = simulate(&biorob_like(), 60, "", [&[], &[]]);
    assert!(estimate(&robot, &recorded).joints[ELBOW].anchored.is_none());
    let anchors = &mut robot.transmissions[ELBOW].as_mut().unwrap().anchors;
    anchors[0].position_rad = STOP_RAD - 0.2;
    assert!(estimate(&robot, &recorded).joints[ELBOW].anchored.is_none());
}

// The motor encoder slips by 6 mrad: the motor mark moves, the joint mark does not.
#[test]
fn marks_identify_slipped_encoder() {
    let offsets = "[[offsets]]\njoint = \"elbow\"\nkind = \"motor-encoder\"\nshape = \"step\"\nat_s = 60.0\nrad = 0.006\n";
    let touch = |time_s| Touch {
        joint: "elbow".into(),
        kind: None,
        time_s,
    };
    let plain = biorob_like();
    // The simulated arm has the same motion in both sessions, so its position at a time of the first session is the
    // mark.
    let times = [20.0, 80.0].map(|t| [touch(t)]);
    let recorded = simulate(&plain, 70, offsets, [&times[0], &times[1]]);
    let mut robot = with_anchor(AnchorKind::MotorMark, 0.0);
    // As if the motor had passed the mark at the same position, which its encoder measures 6 mrad larger.
    let mut recorded = recorded;
    recorded[1].touches[0].theta_measured = recorded[0].touches[0].theta_measured + 6e-3;
    let result = estimate(&robot, &recorded);
    let elbow = &result.joints[ELBOW];
    let anchored = elbow.anchored.as_ref().expect("the mark was passed");
    assert!(
        (anchored.correction_rad.mean + 6e-3).abs() < 1e-9,
        "{anchored:?}"
    );
    assert!(anchored.by_motion_rad.mean > 4e-3, "{anchored:?}");
    assert_eq!(
        elbow.verdict,
        Verdict::NoChangeDetected,
        "{:?}",
        elbow.offset_rad
    );
    robot.transmissions[ELBOW].as_mut().unwrap().anchors[0].kind = AnchorKind::JointMark;
    recorded[1].touches[0].q = recorded[0].touches[0].q;
    let result = estimate(&robot, &recorded);
    let anchored = result.joints[ELBOW].anchored.as_ref().expect("passed");
    assert!(anchored.correction_rad.mean.abs() < 1e-9);
    assert_eq!(result.joints[ELBOW].verdict, Verdict::Elongated);
}

// A mark that is not in robot.toml, or at a time without data, returns an error.
#[test]
fn unreadable_mark_returns_error() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("robot");
    std::fs::create_dir(&place).unwrap();
    let shipped = repository().join("robots/biorob-like");
    for file in std::fs::read_dir(&shipped).unwrap() {
        let file = file.unwrap().path();
        std::fs::copy(&file, place.join(file.file_name().unwrap())).unwrap();
    }
    let text = std::fs::read_to_string(place.join("robot.toml")).unwrap();
    let mark = "\n[[joints.elbow.anchors]]\nkind = \"joint-mark\"\nposition_rad = 0.9\nstd_rad = 1e-3\n\
        [[joints.elbow.anchors]]\nkind = \"motor-mark\"\nposition_rad = 0.95\nstd_rad = 1e-3\n";
    std::fs::write(place.join("robot.toml"), text + mark).unwrap();
    let log = repository().join("examples/01-stretched-arm/stretched-arm.mcap");
    let estimated = |joint: &str, time_s: f64| {
        let mut request = sinew_estimate::Request::new(log.clone());
        request.robot = Some(place.clone());
        let (joint, kind) = match joint.split_once(':') {
            Some((joint, _)) => (joint, Some(AnchorKind::JointMark)),
            None => (joint, None),
        };
        let joint = joint.into();
        request.touches = vec![Touch {
            joint,
            kind,
            time_s,
        }];
        let window = session::Window::default();
        let options = SessionOptions::default();
        session::estimate(&request, window, None, &options, &mut |_| {})
            .map(|(estimate, _)| estimate)
            .map_err(|e| e.to_string())
    };
    let error_of = |joint, time_s| estimated(joint, time_s).unwrap_err();
    assert!(error_of("elbo", 3.0).contains("did you mean 'elbow'"));
    assert!(error_of("wrist", 3.0).contains("joints.wrist.anchors"));
    assert!(error_of("elbow", 400.0).contains("no positions at 400 s"));
    // The arm starts at rest at 0.9 rad and moves away later.
    assert!(error_of("elbow", 0.5).contains("two marks match"));
    assert!(error_of("elbow:joint-mark", 11.0).contains("from the marks at 0.9 rad, 0.95 rad"));
    let read = estimated("elbow:joint-mark", 0.5).unwrap();
    let elbow = read.joints.iter().find(|j| j.name == "elbow").unwrap();
    assert_eq!(elbow.anchored.as_ref().unwrap().readings.len(), 1);
}
