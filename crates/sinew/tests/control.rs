//! From a baseline to an estimate to a corrected arm, through the command line.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn sinew(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(root())
        .output()
        .unwrap()
}

fn done(args: &[&str]) -> String {
    let output = sinew(args);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {said}");
    String::from_utf8(output.stdout).unwrap()
}

/// Poses without contacts; the ropes give way after half of the time.
const WORK: &str = r#"
duration_s = 60.0
sample_rate_hz = 250
seed = 4
[motion]
kind = "random"
range_rad = { shoulder_yaw = { min = -1.2, max = 1.2 }, shoulder_pitch = { min = 0.0, max = 1.7 }, elbow = { min = 0.0, max = 1.8 }, wrist = { min = -1.0, max = 1.0 } }
[motor_friction]
coulomb_nm = 0.0
[encoder]
joint_bits = 13
motor_noise_rad = 0.0002
[[offsets]]
joint = "shoulder_pitch"
kind = "physical"
shape = "step"
at_s = 30.0
rad = 0.010
[[offsets]]
joint = "elbow"
kind = "physical"
shape = "step"
at_s = 30.0
rad = 0.010
"#;

#[test]
fn correction_reduces_position_error() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let robot = "robots/biorob-like";
    std::fs::write(at("work.toml"), WORK).unwrap();
    done(&[
        "simulate",
        &at("work.toml"),
        "--robot",
        robot,
        "--out",
        &at("work.mcap"),
    ]);
    let log = at("work.mcap");
    let baseline = at("arm.baseline");
    done(&[
        "baseline", &log, "--robot", robot, "--to", "30", "--out", &baseline,
    ]);
    let since = done(&[
        "estimate",
        &log,
        "--robot",
        robot,
        "--baseline",
        &baseline,
        "--from",
        "30",
        "--json",
    ]);
    std::fs::write(at("since.json"), since).unwrap();

    // The same robot continues with elongated tendons and a specified offset.
    let told = WORK
        .replace("shape = \"step\"\nat_s = 30.0\n", "")
        .replace("duration_s = 60.0", "duration_s = 20.0")
        + "[correction]\nestimate = \"since.json\"\n";
    std::fs::write(at("told.toml"), told).unwrap();
    let out = at("told.mcap");
    let args = [
        "simulate",
        &at("told.toml"),
        "--robot",
        robot,
        "--out",
        &out,
        "--control",
    ];
    let text = done(&args);
    // The last line is a path, as long as it is.
    let tables = text.lines().filter(|l| !l.contains("told.mcap"));
    assert!(
        tables.into_iter().all(|l| l.chars().count() <= 80),
        "{text}"
    );
    let json = done(&[&args[..], &["--json"]].concat());
    let said: serde_json::Value = serde_json::from_str(&json).unwrap();
    let joint = |which: &str, i: usize, key: &str| {
        said["control"][which]["joints"][i][key].as_f64().unwrap()
    };
    for (i, stiffness) in [(1, 40.0), (2, 20.0)] {
        let (before, after) = (
            1e3 * joint("without", i, "rest_mean_rad"),
            1e3 * joint("with", i, "rest_mean_rad"),
        );
        assert!(before < -7.0, "joint {i}: {before}");
        // The estimate is good to a milliradian, joint friction holds the joint within two.
        assert!(after.abs() < 2.0, "joint {i}: {after}");
        let torque = joint("without", i, "false_torque_nm");
        assert!((torque + stiffness * 0.010).abs() < 0.04, "{torque}");
        let torque = joint("with", i, "false_torque_nm");
        assert!(torque.abs() < stiffness * 0.001, "{torque}");
    }
    let contacts = &said["control"]["with"]["contacts"];
    assert_eq!(contacts["contacts"], 0);
    assert_eq!(contacts["false_alarms"], 0);
    let alarm = said["control"]["without"]["contacts"]["false_s"]
        .as_f64()
        .unwrap();
    assert!(alarm > 10.0, "{alarm} s");
}

#[test]
fn invalid_correction_errors_before_writing() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(at("plain.toml"), WORK).unwrap();
    let missing = WORK.to_string() + "[correction]\nestimate = \"nobody.json\"\n";
    std::fs::write(at("missing.toml"), missing).unwrap();
    for (scenario, parts) in [
        ("plain.toml", ["correction: offset is missing", "stated"]),
        ("missing.toml", ["nobody.json", "sinew estimate"]),
    ] {
        let out = at("never.mcap");
        let output = sinew(&[
            "simulate",
            &at(scenario),
            "--robot",
            "robots/biorob-like",
            "--out",
            &out,
            "--control",
        ]);
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8_lossy(&output.stderr);
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        for part in parts {
            assert!(said.contains(part), "'{part}' missing in: {said}");
        }
        assert!(!Path::new(&out).exists());
    }
}
