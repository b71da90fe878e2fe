//! Recordings as files.

use super::{biorob_like, repository, shipped_robot};
use crate::scenario::Record;
use crate::{Scenario, SimulateOptions, Simulation, run};
use std::path::Path;

fn shipped(root: &Path, name: &str) -> Scenario {
    let path = root.join("examples/scenarios").join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    Scenario::from_toml(&text, name).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn shipped_scenarios_run() {
    let Some(root) = repository() else { return };
    let folder = root.join("examples/scenarios");
    let mut seen = 0;
    for entry in std::fs::read_dir(&folder).expect("examples/scenarios") {
        let name = entry
            .expect("readable")
            .file_name()
            .into_string()
            .expect("utf-8");
        if !name.ends_with(".toml") {
            continue;
        }
        let scenario = shipped(&root, &name);
        let robot = scenario
            .robot
            .as_deref()
            .and_then(|folder| Path::new(folder).file_name()?.to_str())
            .unwrap_or_else(|| panic!("{name} names its robot"));
        let robot = shipped_robot(robot);
        let mut simulation = Simulation::new(&robot, &scenario).unwrap_or_else(|e| panic!("{e}"));
        // Through every session would take a while; the first seconds already move.
        for _ in 0..1000 {
            simulation
                .next_frame()
                .unwrap_or_else(|e| panic!("{name}: {e}"));
        }
        seen += 1;
    }
    assert!(seen >= 4, "{seen} scenarios");
}

#[test]
fn formats_round_trip_and_are_deterministic() {
    let Some(root) = repository() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = Scenario {
        duration_s: Some(2.0),
        record: Record {
            dq: true,
            tau_el: true,
            tau_m: true,
            tau_ext: false,
            temperature: true,
            tension: false,
        },
        ..shipped(&root, "work-session.toml")
    };
    let mut simulation = Simulation::new(&biorob_like(), &scenario).expect("a scenario");
    let mut expected = Vec::new();
    while let Some(frame) = simulation.next_frame().expect("steps") {
        expected.push(frame.clone());
    }
    for name in ["a.mcap", "a.csv", "a.parquet"] {
        let mut bytes = Vec::new();
        for copy in ["1", "2"] {
            let out = folder.path().join(format!("{copy}-{name}"));
            let mut told = 0;
            let summary = run(
                &biorob_like(),
                &scenario,
                &SimulateOptions::new(&out),
                &mut |_| told += 1,
            )
            .expect("written");
            assert_eq!(summary.frames.written, 500);
            assert!(told > 5);
            bytes.push(std::fs::read(&out).expect("there"));
            let truth = std::fs::read_to_string(&summary.truth_file).expect("there");
            let truth: serde_json::Value = serde_json::from_str(&truth).expect("JSON");
            assert_eq!(truth["seed"], 7);
            // The offsets come at 60 s: two seconds in there are none yet.
            assert_eq!(truth["offset_rad"]["elbow"], 0.0);
            assert_eq!(truth["steps"][0]["size_rad"], 0.010);
            assert_eq!(truth["baseline_s"], serde_json::json!([0.0, 60.0]));
        }
        assert!(bytes[0] == bytes[1], "{name} differs from run to run");
        let mut recording = sinew_log::open(
            &folder.path().join(format!("1-{name}")),
            &Default::default(),
        )
        .expect("opens");
        let robot = biorob_like();
        let joints: Vec<&str> = robot.joint_names().iter().map(String::as_str).collect();
        recording.select(&joints).expect("all joints");
        let mut count = 0;
        while let Some(frame) = recording.next_frame().expect("reads") {
            let want = &expected[count];
            assert_eq!(frame.time_ns, want.time_ns);
            assert_eq!(
                (&frame.q, &frame.theta),
                (&want.q, &want.theta),
                "{name} {count}"
            );
            assert_eq!((&frame.dq, &frame.tau_el), (&want.dq, &want.tau_el));
            assert_eq!(
                (&frame.tau_m, frame.temperature_c),
                (&want.tau_m, want.temperature_c)
            );
            count += 1;
        }
        assert_eq!(count, 500);
    }
}

#[test]
fn invalid_output_leaves_no_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("a.bag");
    let scenario = Scenario {
        duration_s: Some(0.1),
        ..Scenario::default()
    };
    let message = run(
        &biorob_like(),
        &scenario,
        &SimulateOptions::new(&out),
        &mut |_| {},
    )
    .expect_err("no writer of bags")
    .to_string();
    for ending in [".mcap", ".parquet", ".csv"] {
        assert!(message.contains(ending), "{message}");
    }
    let missing = folder.path().join("no/such/folder/a.csv");
    assert!(
        run(
            &biorob_like(),
            &scenario,
            &SimulateOptions::new(&missing),
            &mut |_| {}
        )
        .is_err()
    );
    assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 0);
}

#[test]
fn faults_are_counted_and_seeded() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut scenario = Scenario {
        duration_s: Some(4.0),
        sample_rate_hz: 500.0,
        ..Scenario::default()
    };
    scenario.faults.dropout_fraction = 0.05;
    scenario.faults.duplicate_fraction = 0.05;
    scenario.faults.late_fraction = 0.05;
    scenario.faults.gaps_s = vec![(1.0, 0.5)];
    let out = folder.path().join("a.csv");
    let summary = run(
        &biorob_like(),
        &scenario,
        &SimulateOptions::new(&out),
        &mut |_| {},
    )
    .expect("written");
    let counts = summary.frames;
    assert_eq!(counts.written, 2000 - counts.lost + counts.duplicated);
    // 250 in the gap and 5 % of 1750 ± three standard deviations of a binomial.
    assert!((250 + 60..=250 + 115).contains(&counts.lost), "{counts:?}");
    assert!(
        (55..=115).contains(&counts.duplicated) && (45..=115).contains(&counts.late),
        "{counts:?}"
    );
    let lines = std::fs::read_to_string(&out)
        .expect("there")
        .lines()
        .count();
    assert_eq!(lines as u64, counts.written + 1);
}

#[test]
fn scenario_keys_are_documented() {
    let Some(root) = repository() else { return };
    let page = root.join("docs/src/reference/scenario.md");
    let page = std::fs::read_to_string(page).expect("there");
    let reader = include_str!("../scenario/read.rs");
    // Every quoted lower-case word with an underscore is a key: kinds and shapes have none.
    let keys: Vec<&str> = reader
        .split('"')
        .skip(1)
        .step_by(2)
        .filter(|word| {
            word.contains('_')
                && word
                    .chars()
                    .all(|c| c.is_ascii_lowercase() || c == '_' || c.is_ascii_digit())
        })
        .collect();
    assert!(keys.len() > 60, "{} keys", keys.len());
    for key in keys {
        assert!(
            page.contains(key),
            "the reference of scenarios doesn't mention {key}"
        );
    }
}
