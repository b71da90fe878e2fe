//! Causes that the command names: slips of an encoder, torn tendons, and wrong statements.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// Runs the command in the repository and returns its output.
fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Simulates an example scenario with the lines `added` at its end, and returns the recording.
fn simulated(folder: &Path, example: &str, edit: impl Fn(String) -> String) -> String {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenarios");
    let scenario = std::fs::read_to_string(place.join(example)).unwrap();
    let file = folder.join("scenario.toml");
    std::fs::write(&file, edit(scenario)).unwrap();
    let log = folder.join("log.mcap").display().to_string();
    let robot = ["--robot", "robots/biorob-like"];
    let args = ["simulate", file.to_str().unwrap(), "--out", &log];
    let output = run(&[&args[..], &robot].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    log
}

/// Result of a joint, with the exit status and stderr of the command.
fn estimate(log: &str, joint: &str, more: &[&str]) -> (Value, Option<i32>, String) {
    let args = ["estimate", log, "--robot", "robots/biorob-like", "--json"];
    let output = run(&[&args[..], more].concat());
    let json: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|e| {
        panic!("{e}: {}", text(&output.stderr));
    });
    let joints = json["session"]["joints"].as_array().unwrap().clone();
    let found = joints.into_iter().find(|j| j["name"] == joint).unwrap();
    // With --json warnings are in the document.
    let warnings =
        json["session"]["warnings"].to_string() + &json["reading"]["warnings"].to_string();
    (found, output.status.code(), warnings)
}

/// Whether a 95 % interval of a JSON value contains `truth`.
fn contains(gaussian: &Value, truth: f64) -> bool {
    let (mean, std) = (
        gaussian["mean"].as_f64().unwrap(),
        gaussian["std"].as_f64().unwrap(),
    );
    (mean - truth).abs() < 1.96 * std
}

#[test]
fn joint_encoder_slip_leaves_rope_offset_unchanged() {
    for size_rad in [0.04, -0.04] {
        let folder = tempfile::tempdir().unwrap();
        let log = simulated(folder.path(), "stretched-arm.toml", |scenario| {
            format!(
                "{scenario}\n[[offsets]]\njoint = \"shoulder_pitch\"\nkind = \"joint-encoder\"\nshape = \"step\"\nat_s = 20.0\nrad = {size_rad}\n"
            )
        });
        let (joint, status, warnings) = estimate(&log, "shoulder_pitch", &[]);
        let changes = joint["changes"].as_array().unwrap();
        println!("{} {}", joint["offset_rad"], joint["changes"]);
        assert_eq!(changes.len(), 1, "{changes:?}");
        assert_eq!(changes[0]["kind"], "slip");
        assert_eq!(changes[0]["cause"], "joint-encoder");
        // Gravity is computed at the corrected pose, so that the size has no bias.
        assert!(contains(&changes[0]["size_rad"], size_rad), "{changes:?}");
        // The rope is longer by 14 mrad throughout, below its limit.
        assert!(contains(&joint["offset_rad"], 0.014), "{joint}");
        assert_eq!(status, Some(0), "{warnings}");
        assert_ne!(joint["retension"]["state"], "passed", "{joint}");
        assert!(!warnings.contains("far-from-prior"), "{warnings}");
    }
}

#[test]
fn torn_tendon_exits_3_with_time_and_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let log = simulated(folder.path(), "stretched-arm.toml", |scenario| {
        scenario.replace(
            "[truth]\n",
            "[truth]\nstiffness_later_factor = { elbow = 0 }\nstiffness_later_from_s = 30\n",
        )
    });
    let (joint, status, warnings) = estimate(&log, "elbow", &[]);
    assert_eq!(status, Some(3));
    assert_eq!(joint["verdict"], "transmission-lost");
    let changes = joint["changes"].as_array().unwrap();
    let lost = changes.iter().find(|c| c["kind"] == "transmission-lost");
    let lost = lost.unwrap_or_else(|| panic!("{changes:?}"));
    assert!(
        (lost["time_s"].as_f64().unwrap() - 30.0).abs() < 1.0,
        "{lost}"
    );
    // The distance between motor and joint is no wrong unit.
    assert!(!warnings.contains("implausible-offset"), "{warnings}");
    let table = run(&["estimate", &log, "--robot", "robots/biorob-like"]);
    // Lines may break anywhere.
    let shown = text(&table.stdout);
    let shown = shown.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(shown.contains("transmission lost"), "{shown}");
    assert!(shown.contains("stop the robot"), "{shown}");
}

#[test]
fn wrong_stated_payload_is_estimated_instead() {
    let folder = tempfile::tempdir().unwrap();
    let log = simulated(folder.path(), "work-session.toml", |scenario| {
        scenario
            .replace("seed = 7", "seed = 38")
            .replace("duration_s = 180.0", "duration_s = 120.0")
            .replace("mass_kg = { min = 0.0, max = 0.5 }", "mass_kg = 0.085")
            .replace("to_s = 180.0", "to_s = 120.0")
            .replace("from_s = 120.0", "from_s = 110.0")
    });
    let baseline = folder.path().join("arm.baseline").display().to_string();
    let robot = ["--robot", "robots/biorob-like"];
    let learn = ["baseline", &log, "--to", "60", "--out", &baseline];
    let output = run(&[&learn[..], &robot].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let window = ["--baseline", &baseline, "--from", "60"];
    for stated in [&["--empty"][..], &["--payload", "0.5kg"]] {
        let (joint, _, warnings) = estimate(&log, "elbow", &[&window[..], stated].concat());
        assert!(
            warnings.contains("payload-inconsistent"),
            "{stated:?} {warnings}"
        );
        assert!(
            !warnings.contains("stiffness-changed"),
            "{stated:?} {warnings}"
        );
        assert!(joint["changes"].as_array().unwrap().is_empty(), "{joint}");
        assert!(contains(&joint["offset_rad"], 0.010), "{joint}");
    }
    // A true statement is used.
    let (joint, _, warnings) = estimate(
        &log,
        "elbow",
        &[&window[..], &["--payload", "0.085kg"]].concat(),
    );
    assert!(!warnings.contains("payload-inconsistent"), "{warnings}");
    assert!(contains(&joint["offset_rad"], 0.010), "{joint}");
}
