//! Golden tests of whole results for recordings, robots and sessions.

#[path = "../../sinew-creep/tests/golden/flat.rs"]
mod flat;

use crate::anchor::{ELBOW, STOP_RAD, simulate, with_anchor};
use crate::answers::Answers;
use crate::rest_phases;
use crate::support::{biorob_like, biorob_like_folder, repository, work_session};
use flat::document;
use serde_json::{Value, json};
use sinew_estimate::baseline::{Baseline, MergeOptions, merge};
use sinew_estimate::feeder::Injection;
use sinew_estimate::init::Init;
use sinew_estimate::online::trajectory;
use sinew_estimate::replay::Estimate;
use sinew_estimate::robot_check::RobotCheck;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{self, BlockEstimate, Payload, SessionOptions, Touch, Window};
use sinew_estimate::strand_duty::{self, Strand};
use sinew_estimate::{Method, Plan, Request, estimate};
use sinew_log::OpenOptions;
use sinew_model::Gaussian;
use sinew_model::offset::{Comparison, TorqueSource};
use sinew_model::transmission::AnchorKind;
use sinew_rope::Catalogue;
use std::path::{Path, PathBuf};

/// Baseline without its model error, thousands of equations that the probabilities of a session depend on.
fn without_model_error(baseline: &Baseline) -> Baseline {
    Baseline {
        model_error: None,
        ..baseline.clone()
    }
}

fn stretched_arm() -> PathBuf {
    repository().join("examples/01-stretched-arm/stretched-arm.mcap")
}

fn request() -> Request {
    let mut request = Request::new(stretched_arm());
    request.robot = Some(biorob_like_folder());
    request
}

/// Values over time of each joint, which are not part of the document.
fn series(reading: &Estimate) -> Value {
    let joints = reading.joints.iter().map(|joint| {
        let s = &joint.series;
        json!({
            "offset_max_rad": s.offset_max_rad,
            "offset_min_rad": s.offset_min_rad,
            "offset_rad": s.offset_rad,
            "q_rad": s.q_rad,
            "tau_el_nm": s.tau_el_nm,
            "tau_spring_nm": s.tau_spring_nm,
            "time_s": s.time_s,
            "usable_share": s.usable_share,
        })
    });
    let numbered = joints.enumerate().map(|(i, joint)| (i.to_string(), joint));
    Value::Object(numbered.collect())
}

// One recording by the paper's method and by the absolute method, with several settings.
#[test]
fn recording_results_match_golden() {
    let mut answers = Answers::default();
    let absolute = Plan {
        method: Method::Absolute,
        window: Window::default(),
        baseline: None,
        options: SessionOptions::default(),
        online: true,
    };
    let result = estimate(&request(), &absolute, &mut |_| {}).unwrap().0;
    document(&mut answers, "absolute", &result);
    document(&mut answers, "absolute series", &series(&result.reading));

    let paper = Plan {
        method: Method::Paper,
        online: false,
        ..absolute
    };
    let mut injected = request();
    injected.reference = Some(stretched_arm());
    injected.injections = vec![Injection {
        joint: "shoulder_yaw".into(),
        offset_rad: 0.01,
        from_s: Some(15.0),
    }];
    let mut motor = request();
    motor.source = TorqueSource::Motor;
    motor.comparison = Comparison::Paper;
    motor.gain_per_s = Some(25.0);
    for (about, case) in [("injected", injected), ("motor", motor)] {
        let result = estimate(&case, &paper, &mut |_| {}).unwrap().0;
        document(&mut answers, about, &result);
        let about = format!("{about} series");
        document(&mut answers, &about, &series(&result.reading));
    }

    let window = |from_s, to_s| Window { from_s, to_s };
    let learning = session::Learning {
        temperature_c: Some(Gaussian::new(22.0, 0.5)),
        ..session::Learning::default()
    };
    let (baseline, mut learned) =
        session::learn(&request(), window(0.0, 20.0), &learning, &mut |_| {}).unwrap();
    learned.nuisance.clear();
    document(&mut answers, "learned", &learned);
    document(&mut answers, "baseline", &without_model_error(&baseline));
    let options = SessionOptions {
        payload: Payload::Unknown,
        temperature_c: Some(Gaussian::new(25.0, 0.5)),
        external_force_n: Some([Gaussian::new(0.0, 2.0); 3]),
        ..SessionOptions::default()
    };
    let later = Plan {
        window: window(20.0, 40.0),
        baseline: Some((&baseline, "first.baseline")),
        options,
        online: false,
        ..absolute
    };
    let (mut result, next) = estimate(&request(), &later, &mut |_| {}).unwrap();
    result.session.as_mut().unwrap().nuisance.clear();
    document(&mut answers, "later", &result.session);
    document(
        &mut answers,
        "next",
        &next.as_ref().map(without_model_error),
    );
    answers.hold("golden_recording.csv");
}

// Chain of three sessions of a simulated arm, and the merged baseline of two of them.
#[test]
fn session_results_match_golden() {
    let mut answers = Answers::default();
    let robot = biorob_like();
    let (recorded, _) = work_session(&robot, 5, |text| text, &[60.0, 120.0]);
    let learning = session::Learning::default();
    let (first, _) = session::learn_recorded(&robot, &recorded[0], "A", &learning).unwrap();
    let options = SessionOptions {
        payload: Payload::Unknown,
        ..SessionOptions::default()
    };
    let mut before = first.clone();
    for (name, part) in [("B", &recorded[1]), ("C", &recorded[2])] {
        let with = Some((&before, "before"));
        let (mut result, next) =
            session::estimate_recorded(&robot, part, name, with, &options).unwrap();
        if name == "B" {
            result.nuisance.clear();
        }
        document(&mut answers, name, &result);
        blocks(&mut answers, name, &result.blocks);
        before = next;
    }
    document(&mut answers, "saved", &without_model_error(&before));
    let (again, _) = session::learn_recorded(&robot, &recorded[1], "B", &learning).unwrap();
    for fleet in [false, true] {
        let merging = MergeOptions {
            fleet,
            scatter: 0.01,
        };
        let both = [(&first, "A"), (&again, "B")];
        let (merged, mut summary) = merge(&robot, &both, None, &merging).unwrap();
        document(&mut answers, &format!("merged {fleet}"), &merged);
        if fleet {
            summary.nuisance.clear();
        }
        document(&mut answers, &format!("merge {fleet}"), &summary);
    }
    answers.hold("golden_sessions.csv");
}

// Stop contacts and index marks, a slip followed by a rest phase, a motion of several minutes; and the online estimate
// over time.
#[test]
fn reference_contacts_and_rest_phases_match_golden() {
    let mut answers = Answers::default();
    let plain = biorob_like();
    let slipped = "[[offsets]]\njoint = \"elbow\"\nkind = \"joint-encoder\"\nshape = \"step\"\nat_s = 60.0\nrad = 0.008\n\
        [[offsets]]\njoint = \"elbow\"\nkind = \"physical\"\nshape = \"step\"\nat_s = 90.0\nrad = 0.005\n";
    let touches = [20.0, 80.0].map(|time_s| {
        let (joint, kind) = ("elbow".into(), None);
        [Touch {
            joint,
            kind,
            time_s,
        }]
    });
    let [a, mut b] = simulate(&plain, 40, slipped, [&touches[0], &touches[1]]);
    b.touches[0].theta_measured = a.touches[0].theta_measured + 6e-3;
    let mark_rad = a.touches[0].theta_measured;
    let learning = session::Learning::default();
    let options = SessionOptions::default();
    for (kind, at_rad) in [
        (AnchorKind::Stop, STOP_RAD),
        (AnchorKind::MotorMark, mark_rad),
        (AnchorKind::JointMark, a.touches[0].q),
    ] {
        let robot = with_anchor(kind, at_rad);
        let (first, _) = session::learn_recorded(&robot, &a, "A", &learning).unwrap();
        let with = Some((&first, "A"));
        let (mut result, next) =
            session::estimate_recorded(&robot, &b, "B", with, &options).unwrap();
        assert!(result.joints[ELBOW].anchored.is_some());
        result.nuisance.clear();
        document(&mut answers, &format!("{kind:?}"), &result);
        if kind == AnchorKind::Stop {
            document(&mut answers, "saved", &next.anchors);
        }
    }
    let first = rest_phases::baseline(&plain);
    let with = Some((&first, "A"));
    for (name, rounds, to_s, more) in [
        ("stands", 2, 70.0, rest_phases::elbow_slips(0.012, 55.0)),
        ("works", 9, 190.0, rest_phases::elbow_slips(0.006, 60.0)),
    ] {
        let recorded = rest_phases::recording(&plain, rounds, to_s, 11, &more);
        let (mut result, _) =
            session::estimate_recorded(&plain, &recorded, name, with, &options).unwrap();
        result.nuisance.clear();
        document(&mut answers, name, &result);
        blocks(&mut answers, name, &result.blocks);
        let online = trajectory(&plain, &recorded, with, &options, name).unwrap();
        document(&mut answers, &format!("{name} online"), &online);
        for (k, block) in online.blocks.iter().enumerate().skip(59).step_by(60) {
            answers.about(&format!("{name} online over time, {k}"));
            answers.number("time", block.time_s);
            answers.number("weight", block.weight);
            answers.number("provisional", f64::from(u8::from(block.provisional)));
            for (joint, offset) in block.offset_rad.iter().enumerate() {
                answers.gaussian(&format!("{joint}"), *offset);
            }
        }
    }
    answers.hold("golden_touches.csv");
}

/// Adds the values that plots show over time and no document contains: one block of every twelve seconds.
fn blocks(answers: &mut Answers, about: &str, blocks: &[BlockEstimate]) {
    assert!(blocks.len() > 120, "{}", blocks.len());
    for (k, block) in blocks.iter().enumerate().skip(59).step_by(60) {
        answers.about(&format!("{about} over time, {k}"));
        answers.number("time", block.time_s);
        answers.number("weight", block.weight);
        for (joint, (own, offset)) in block.block_rad.iter().zip(&block.offset_rad).enumerate() {
            answers.number(&format!("{joint} of the block"), *own);
            answers.gaussian(&format!("{joint}"), *offset);
        }
    }
}

#[test]
fn robot_checks_match_golden() {
    let mut answers = Answers::default();
    let ropes = Catalogue::shipped().unwrap();
    for place in [
        "robots/biorob-like",
        "robots/finger",
        "robots/exosuit",
        "examples/05-your-own-robot",
    ] {
        let (loaded, gaps) = robot_dir::draft(&repository().join(place), None).unwrap();
        let check = RobotCheck::of(&loaded, &gaps, &ropes).unwrap();
        document(&mut answers, place, &check);
    }
    // Data of a first robot.toml.
    let urdf = std::fs::read_to_string(biorob_like_folder().join("biorob-like.urdf")).unwrap();
    let urdf = Some(("biorob-like.urdf", urdf.as_str()));
    let mut recording = sinew_log::open(&stretched_arm(), &OpenOptions::default()).unwrap();
    let init = Init::of("both", urdf, Some(&mut recording)).unwrap();
    document(&mut answers, "init", &init);
    document(
        &mut answers,
        "init of a URDF",
        &Init::of("it", urdf, None).unwrap(),
    );
    // Duty of a rope from a recording.
    let robot = biorob_like();
    let tendon = robot.transmissions[2]
        .as_ref()
        .unwrap()
        .tendon
        .as_ref()
        .unwrap();
    for strand in [Strand::Positive, Strand::Negative] {
        let duty = strand_duty::recorded(&request(), "elbow", tendon, 24.0, strand, &mut |_| {});
        answers.about(&format!("duty {strand:?}"));
        for (k, stretch) in duty.unwrap().stretches.iter().enumerate() {
            answers.number(&format!("{k} lasts"), stretch.duration_s);
            answers.number(&format!("{k} at"), stretch.from.tension_n);
        }
    }
    answers.hold("golden_robots.csv");
}

// Every number in the files of two robots, multiplied by wrong factors: errors and findings.
#[test]
fn robot_checks_of_wrong_values_match_golden() {
    const FACTORS: [f64; 7] = [-1.0, 0.0, 1e-3, 0.03, 4.0, 30.0, 1e3];
    let mut answers = Answers::default();
    let ropes = Catalogue::shipped().unwrap();
    for robot in ["biorob-like", "finger"] {
        let place = repository().join("robots").join(robot);
        let names = [format!("{robot}.urdf"), "robot.toml".into()];
        let texts = names
            .each_ref()
            .map(|name| std::fs::read_to_string(place.join(name)).unwrap());
        let folder = tempfile::tempdir().unwrap();
        let as_it_is = findings_of(folder.path(), &names, [&texts[0], &texts[1]], &ropes);
        for (file, text) in texts.iter().enumerate() {
            for (k, (from, to)) in numbers_of(text).into_iter().enumerate() {
                let value: f64 = text[from..to].parse().unwrap();
                for factor in FACTORS.into_iter().filter(|_| value != 0.0) {
                    let wrong = format!("{}{}{}", &text[..from], value * factor, &text[to..]);
                    let mut both = [texts[0].as_str(), texts[1].as_str()];
                    both[file] = &wrong;
                    let (words, size) = findings_of(folder.path(), &names, both, &ropes);
                    if (&words, size) != (&as_it_is.0, as_it_is.1) {
                        answers.about(&format!("{robot} {} {k} times {factor}", names[file]));
                        answers.usually(&words.replace([',', '\n'], " "), size, 1.0);
                    }
                }
            }
        }
    }
    answers.hold("golden_oddities.csv");
}

/// Findings of a robot, most severe first, or its error; and the sum of the logarithms of the compared values.
fn findings_of(
    folder: &Path,
    names: &[String; 2],
    texts: [&str; 2],
    ropes: &Catalogue,
) -> (String, f64) {
    for (name, text) in names.iter().zip(texts) {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let (loaded, gaps) = match robot_dir::draft(folder, None) {
        Ok(loaded) => loaded,
        Err(error) => {
            let place = folder.display().to_string();
            let error = error.to_string().replace(&place, "");
            return (format!("rejected: {error}"), 1.0);
        }
    };
    let check = RobotCheck::of(&loaded, &gaps, ropes).unwrap();
    let compared = check.findings.iter().flat_map(|f| &f.assessed);
    let size = compared.map(|j| (1.0 + j.value.abs()).ln()).sum();
    let findings = check.findings.iter();
    let findings: Vec<String> = findings
        .map(|f| format!("{:?} {:?}", f.kind, f.severity))
        .collect();
    (findings.join(" "), size)
}

/// Ranges of the numbers in a file that are not part of a word.
fn numbers_of(text: &str) -> Vec<(usize, usize)> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || ['.', '-', '_', '+'].contains(&c);
    let mut found = Vec::new();
    let mut from = 0;
    for word in text.split_inclusive(|c: char| !is_part(c)) {
        let number = word.trim_end_matches(|c: char| !is_part(c));
        if number.parse::<f64>().is_ok() {
            found.push((from, from + number.len()));
        }
        from += word.len();
    }
    found
}
