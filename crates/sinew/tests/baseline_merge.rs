//! Command line of merged baselines.

use std::path::Path;
use std::process::{Command, Output};

fn sinew(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .output()
        .unwrap()
}

fn done(args: &[&str]) -> String {
    let output = sinew(args);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {said}");
    String::from_utf8(output.stdout).unwrap()
}

fn refused(args: &[&str], code: i32, words: &[&str]) {
    let output = sinew(args);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
    for word in words {
        assert!(said.contains(word), "{args:?} says {said}");
    }
}

const WORK: &str = r#"
duration_s = 20.0
sample_rate_hz = 250
robot_seed = 4
[truth]
stiffness_factor = { min = 0.9, max = 1.1 }
[motion]
kind = "random"
range_rad = { shoulder_yaw = { min = -1.2, max = 1.2 }, shoulder_pitch = { min = 0.0, max = 1.7 }, elbow = { min = 0.0, max = 1.8 }, wrist = { min = -1.0, max = 1.0 } }
[motor_friction]
coulomb_nm = 0.0
"#;

#[test]
fn merged_baseline_is_valid_prior() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let robot = ["--robot", "robots/biorob-like"];
    for name in ["a", "b"] {
        let seed = if name == "a" { 1 } else { 2 };
        let (toml, log, out) = (
            at(&format!("{name}.toml")),
            at(&format!("{name}.csv")),
            at(&format!("{name}.baseline")),
        );
        std::fs::write(&toml, format!("seed = {seed}\n{WORK}")).unwrap();
        done(&[&["simulate", &toml, "--out", &log][..], &robot].concat());
        done(&[&["baseline", &log, "--quiet", "--out", &out][..], &robot].concat());
    }
    let (a, b, known) = (at("a.baseline"), at("b.baseline"), at("arm.prior"));
    let merge = [&["baseline", "merge", &a, &b, "--out", &known][..], &robot].concat();
    let text = done(&merge);
    assert!(text.contains("2 files, 2 recordings"), "{text}");
    // The last lines are a path, as long as it is.
    let told = text.split("written to").next().unwrap();
    assert!(told.lines().all(|l| l.chars().count() <= 80), "{text}");
    let json = done(&[&merge[..], &["--json"]].concat());
    let said: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(said["recordings"].as_array().unwrap().len(), 2);

    let (log, again) = (at("b.csv"), at("again.baseline"));
    let start = ["baseline", &log, "--start", &known, "--out", &again];
    done(&[&start[..], &robot].concat());
    let fleet = [&merge[..], &["--fleet", "--scatter", "2%"]].concat();
    done(&fleet);

    let twice = ["baseline", "merge", &a, &a, "--out", &known];
    refused(&[&twice[..], &robot].concat(), 1, &["count twice"]);
    let alone = ["baseline", "merge", &a, "--out", &known];
    refused(&[&alone[..], &robot].concat(), 2, &["2"]);
    refused(
        &[&merge[..], &["--scatter", "2%"]].concat(),
        2,
        &["--fleet"],
    );
    refused(
        &[&merge[..], &["--fleet", "--scatter", "-1%"]].concat(),
        2,
        &["-1"],
    );
    let over = ["baseline", "merge", &a, &b, "--out", &a];
    refused(&[&over[..], &robot].concat(), 1, &["same file"]);
    refused(&["baseline"], 2, &["--out"]);
    let old = std::fs::read_to_string(&a).unwrap();
    std::fs::write(
        at("old.baseline"),
        old.replace("\"version\":6", "\"version\":2"),
    )
    .unwrap();
    let old = [
        "baseline",
        "merge",
        &b,
        &at("old.baseline"),
        "--out",
        &known,
    ];
    refused(
        &[&old[..], &robot].concat(),
        1,
        &["old.baseline", "version 2", "version 4 to 6"],
    );
}
