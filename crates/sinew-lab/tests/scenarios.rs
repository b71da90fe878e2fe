//! The scenario bench: resumable, repeatable, and its draws are the protocol's.

use sinew_lab::scenarios::{Options, Plan, Summary, record, run};
use sinew_lab::simulate::scenario::{Draw, PerJoint};
use std::path::Path;

fn options(out: Option<&Path>, n: u64) -> Options {
    Options {
        scenarios: vec!["S7".into()],
        n,
        first_seed: 40,
        steps: false,
        motor_torque: true,
        jobs: 2,
        out: out.map(Path::to_path_buf),
    }
}

fn ran(options: &Options) -> Summary {
    run(options, &mut |_, _| {}).unwrap()
}

#[test]
fn a_stopped_run_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("s7.jsonl");
    let first = ran(&options(Some(&out), 1));
    assert_eq!(first.scenarios[0].recordings, 1);
    // As if stopped in the middle of a line.
    let whole = std::fs::read_to_string(&out).unwrap();
    std::fs::write(&out, whole.clone() + "{\"scenario\":\"S7\",\"se").unwrap();
    let mut seen = Vec::new();
    let resumed = run(&options(Some(&out), 2), &mut |done, all| {
        seen.push((done, all))
    })
    .unwrap();
    assert_eq!(
        seen,
        [(1, 2), (2, 2)],
        "the first recording is not made again"
    );
    let text = std::fs::read_to_string(&out).unwrap();
    assert!(text.starts_with(&whole) && text.ends_with("}\n"));
    assert_eq!(text.lines().count(), 3);
    // In memory, in one go: the same numbers.
    assert_eq!(ran(&options(None, 2)), resumed);
    // Everything is there: nothing is run.
    let mut counted = Vec::new();
    run(&options(Some(&out), 2), &mut |done, _| counted.push(done)).unwrap();
    assert_eq!(counted, [2]);
    // Two runs at once kept the same recording: it counts once.
    let last = text.lines().last().unwrap();
    std::fs::write(&out, format!("{text}{last}\n")).unwrap();
    assert_eq!(ran(&options(Some(&out), 2)), resumed);
}

#[test]
fn a_file_of_other_settings_or_of_anything_else_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("r.jsonl");
    ran(&options(Some(&out), 1));
    let other = Options {
        steps: true,
        motor_torque: true,
        ..options(Some(&out), 1)
    };
    let refused = run(&other, &mut |_, _| {}).unwrap_err().to_string();
    assert!(
        refused.contains("--no-steps") && refused.contains("r.jsonl"),
        "{refused}"
    );
    for text in ["shopping list", "shopping list\nmilk\n", "{\"a\":1}\n"] {
        std::fs::write(&out, text).unwrap();
        let refused = run(&options(Some(&out), 1), &mut |_, _| {}).unwrap_err();
        assert!(
            refused
                .to_string()
                .contains("not a file of scenario results"),
            "{refused}"
        );
        assert_eq!(
            std::fs::read_to_string(&out).unwrap(),
            text,
            "left as it was"
        );
    }
}

fn of(per: &PerJoint, joint: &str) -> Draw {
    let own = per.by_joint.iter().find(|(n, _, _)| n == joint);
    own.map(|(_, _, d)| *d).or(per.all).unwrap()
}

#[test]
fn draws_are_those_of_the_protocol() {
    let named = |name: &str| Plan::named(name).unwrap().scenario;
    let s5 = named("S5");
    let uniform = |min: f64, max: f64| Draw::Uniform { min, max };
    let joints = ["shoulder_yaw", "shoulder_pitch", "elbow", "wrist"];
    for (joint, coulomb, viscous, drive) in [
        (joints[0], 0.08, 0.05, 0.4),
        (joints[1], 0.08, 0.05, 0.4),
        (joints[2], 0.05, 0.03, 0.25),
        (joints[3], 0.012, 0.004, 0.08),
    ] {
        let f = &s5.joint_friction;
        for (found, middle) in [
            (of(&f.coulomb_nm, joint), coulomb),
            (of(&f.viscous_nm_s_per_rad, joint), viscous),
            (of(&s5.motor_friction.coulomb_nm, joint), drive),
        ] {
            let Draw::Uniform { min, max } = found else {
                panic!("{found:?}");
            };
            // Half to one and a half of the nominal value.
            assert!((min - 0.5 * middle).abs() < 1e-12 && (max - 1.5 * middle).abs() < 1e-12);
        }
        assert_eq!(of(&f.torque_fraction, joint), uniform(0.01, 0.03));
        assert_eq!(of(&f.presliding_rad, joint), uniform(0.0004, 0.0016));
        assert_eq!(
            of(&s5.motor_friction.torque_fraction, joint),
            uniform(0.05, 0.15)
        );
        assert_eq!(of(&s5.truth.stiffness_factor, joint), uniform(0.8, 1.2));
        assert_eq!(
            of(&s5.truth.spring_cubic_per_rad2, joint),
            uniform(0.0, 2.0)
        );
    }
    assert_eq!(s5.encoder.joint_bits, Some(13));
    assert_eq!(named("S8b").encoder.joint_bits, Some(12));
    assert!(s5.payloads.is_empty() && s5.random_contacts.is_none());
    assert_eq!(named("S6").payloads[0].mass_kg, uniform(0.0, 0.5));
    assert_eq!(named("S6").payloads[0].com_spread_m, [0.01, 0.01, 0.05]);
    assert!(named("S6").random_contacts.is_none());
    let contacts = named("S8").random_contacts.unwrap();
    assert_eq!((contacts.fraction, contacts.from_to_s.0), (0.1, 60.0));
    assert_eq!(contacts.force_n, uniform(2.0, 15.0));
    assert_eq!(contacts.duration_s, uniform(0.5, 3.0));
    let hard = named("S8b").random_contacts.unwrap();
    assert_eq!((hard.fraction, hard.duration_s), (0.2, uniform(0.5, 8.0)));
    assert_eq!(named("S8").temperature.change_k, uniform(-10.0, 15.0));
    assert_eq!(named("S7").temperature.change_k, Draw::Fixed(0.0));
    assert_eq!(named("S9b").payloads.len(), 0);
    assert_eq!(named("S9c").payloads.len(), 1);
}

#[test]
fn one_recording_is_judged_against_its_own_truth() {
    let plan = Plan::named("S8").unwrap();
    let recording = record(&plan, 3, true).unwrap();
    let truth = |name: &str| recording.joints.iter().find(|j| j.name == name).unwrap();
    assert_eq!(truth("shoulder_pitch").truth_mrad, 10.0);
    assert!((0.0..12.0).contains(&truth("wrist").truth_mrad));
    let slips: Vec<(&str, f64)> = recording
        .steps
        .iter()
        .map(|s| (s.joint.as_str(), s.size_mrad))
        .collect();
    assert_eq!(slips, [("shoulder_pitch", 5.0), ("elbow", 5.0)]);
    assert!((128.0..132.0).contains(&recording.steps[0].at_s));
    assert!((140.0..148.0).contains(&recording.steps[1].at_s));
    for joint in &recording.joints {
        // The payload alone reads as tens of milliradians in the paper's estimate; the bound is
        // what drift of 0.1 mrad/K over up to 15 K leaves, and no estimate is ten times better.
        let bound = joint.bound_mrad.unwrap();
        assert!(bound > 0.01 && bound < 2.0, "{} {bound}", joint.name);
        assert!(joint.interval_95_mrad > 0.2 * bound);
    }
}

#[test]
fn strands_that_failed_between_two_recordings_are_not_read_as_stretch() {
    let plan = Plan::named("U3").unwrap();
    for seed in [4002, 4008] {
        let recording = record(&plan, seed, false).unwrap();
        for joint in &recording.joints {
            let (error, interval) = (joint.error_mrad, joint.interval_95_mrad);
            assert!(
                error.abs() < interval,
                "{seed} {}: {error} ± {interval}",
                joint.name
            );
        }
        let said = |w: &String| w.contains("than what was known before this recording");
        assert!(
            recording.warnings.iter().any(said),
            "{:?}",
            recording.warnings
        );
    }
}
