//! Recordings with faults that real robots make: the part that the estimate uses, and the warnings about the rest.

use crate::skipped::shared;
use serde_json::Value;
use std::process::{Command, Output};

/// Offsets of the recording under the cases of the shared folder, rad: 125 Hz of example 01 at its end.
const TRUTH: [(&str, f64); 4] = [
    ("shoulder_yaw", 0.0),
    ("shoulder_pitch", 0.014),
    ("elbow", 0.015),
    ("wrist", 0.0),
];

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .output()
        .unwrap()
}

/// Estimate of a recording as JSON, checked to succeed with all of `TRUTH` in its 95 % intervals.
fn assert_truth(name: &str, log: &str, more: &[&str]) -> Value {
    let args = ["estimate", log, "--robot", "robots/biorob-like", "--json"];
    let output = run(&[&args[..], more].concat());
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {stderr}");
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    for (joint, truth) in TRUTH {
        let mut joints = json["session"]["joints"].as_array().unwrap().iter();
        let offset = &joints.find(|j| j["name"] == joint).unwrap()["offset_rad"];
        let [mean, std] = ["mean", "std"].map(|key| offset[key].as_f64().unwrap());
        println!(
            "{name} {joint}: {:.1} ± {:.1} mrad",
            1e3 * mean,
            1960.0 * std
        );
        assert!(
            (mean - truth).abs() < 1.96 * std,
            "{name} {joint}: {offset}"
        );
    }
    json
}

fn warning<'a>(json: &'a Value, kind: &str) -> &'a Value {
    let mut warnings = json["reading"]["warnings"].as_array().unwrap().iter();
    let found = warnings.find(|warning| warning["kind"] == kind);
    found.unwrap_or_else(|| panic!("no {kind}: {}", json["reading"]["warnings"]))
}

fn log_info(log: &str, more: &[&str]) -> String {
    let output = run(&[&["log", "info", log], more].concat());
    assert!(output.status.success());
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn shared_cases_give_offsets_of_recording_underneath() {
    let Some(cases) = shared("cases") else {
        return;
    };
    let log = |name: &str| cases.join(name).display().to_string();

    let pose = log("01/two-publishers-pose.mcap");
    let json = assert_truth("01", &pose, &[]);
    assert_eq!(warning(&json, "second-publisher")["samples"], 417);
    assert!(log_info(&pose, &[]).contains("417 samples of a second publisher excluded"));

    let back = log("03/clock-back-3600s.mcap");
    let json = assert_truth("03", &back, &[]);
    assert_eq!(warning(&json, "clock-jumps")["count"], 1);
    let duration_s = json["reading"]["recording"]["duration_s"].as_f64().unwrap();
    assert!((duration_s - 39.992).abs() < 1e-6, "{duration_s}");

    assert_truth("05", &log("05/sim-time-from-zero.mcap"), &[]);

    let halves = log("07/joint-side-in-halves.mcap");
    assert_truth("07", &halves, &[]);
    let info = log_info(&halves, &[]);
    assert!(
        !info.contains("lost\n") || info.contains("no data lost"),
        "{info}"
    );

    let late = log("09/joint-appears-after-4s.mcap");
    let json = assert_truth("09", &late, &[]);
    assert_eq!(warning(&json, "late-start")["joint"], "wrist");
    assert!(log_info(&late, &[]).contains("q of 'wrist' from 4.0 s on"));

    let servo = log("12/servo-counts.mcap");
    let mapping = log("12/servo.toml");
    let with_period = log("12/servo-with-period.toml");
    let [json, other] =
        [&mapping, &with_period].map(|mapping| assert_truth("12", &servo, &["--mapping", mapping]));
    assert_eq!(json["session"]["joints"], other["session"]["joints"]);
    assert!(log_info(&servo, &["--mapping", &mapping]).contains("wrap-arounds of theta"));
}

#[test]
fn other_formats_are_named_with_their_conversion() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("robot").display().to_string();
    let level_5 = [&b"MATLAB 5.0 MAT-file, Platform: GLNXA64"[..], &[0; 200]].concat();
    let level_73 = [&b"MATLAB 7.3 MAT-file, Platform: GLNXA64"[..], &[0; 200]].concat();
    for (name, content, words) in [
        ("run.bag", b"#ROSBAG V2.0\n\0".to_vec(), "mcap convert"),
        // By the content, whatever the name.
        ("run.csv", b"#ROSBAG V2.0\n\0".to_vec(), "mcap convert"),
        ("run.mat", level_5, "scipy.io.loadmat"),
        ("run.mat", level_73, "h5py.File"),
    ] {
        let path = dir.path().join(name);
        std::fs::write(&path, content).unwrap();
        let path = path.display().to_string();
        for args in [
            &["log", "info", &path][..],
            &["init", &path, "--out", &out],
            &["estimate", &path, "--robot", "robots/biorob-like"],
            &["estimate", &path],
            &[
                "baseline",
                &path,
                "--robot",
                "robots/biorob-like",
                "--out",
                &out,
            ],
        ] {
            let output = run(args);
            let stderr = String::from_utf8_lossy(&output.stderr);
            let stderr = Vec::from_iter(stderr.split_whitespace()).join(" ");
            assert_eq!(output.status.code(), Some(1), "{args:?}: {stderr}");
            for words in [name, words] {
                assert!(stderr.contains(words), "{args:?}: {words}: {stderr}");
            }
        }
    }
}
