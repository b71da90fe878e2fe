//! Baselines of several loads, for tendons with friction along their path.

use crate::skipped::shared;
use std::path::Path;
use std::process::Command;

const URDF: &str = r#"<robot name="instrument"><link name="base"/>
<link name="jaw"><inertial><origin xyz="0 0 0"/><mass value="0.01"/>
<inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/></inertial></link>
<joint name="jaw" type="continuous"><parent link="base"/><child link="jaw"/><axis xyz="0 0 1"/></joint></robot>"#;

const ROBOT: &str = "urdf = \"instrument.urdf\"\n[joints.jaw]\nstiffness_nm_per_rad = 0.8\n\
    motor_friction = { coulomb_nm = 0.065 }\nfriction_along_path = true\n";

const MAPPING: &str = "[joints.jaw]\n\
    q = { column = \"jaw_encoder_counts\", unit = \"count\", counts_per_turn = 4000, wrap = false }\n\
    theta = { column = \"drive_encoder_counts\", unit = \"count\", counts_per_turn = 8192, scale = -0.92, wrap = false }\n\
    tau_el = { column = \"jaw_torque_counts\", scale = -0.000039811 }\n";

/// Exit code, stdout and stderr of the program in a folder.
fn run(folder: &Path, args: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(folder)
        .output()
        .expect("the program starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let code = output.status.code().expect("not killed");
    (code, text(&output.stdout), text(&output.stderr))
}

/// Words of a text without its line breaks.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn estimate_names_load_that_baseline_lacks() {
    let Some(data) = shared("data/davinci_tools") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in [
        ("robot.toml", ROBOT),
        ("instrument.urdf", URDF),
        ("mapping.toml", MAPPING),
    ] {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    let log = |load: u8| data.join(format!("tool_4_l_2_0{load}.parquet"));
    let log = |load| log(load).display().to_string();
    let (light, heavy, middle) = (log(0), log(3), log(2));
    let place = ["--robot", ".", "--mapping", "mapping.toml"];
    let run = |args: &[&str]| run(folder.path(), &[args, &place].concat());

    let (code, said, errors) = run(&["baseline", &light, &heavy, "--out", "two.json"]);
    assert_eq!(code, 0, "{said}{errors}");
    let line = "jaw: friction along the path from 2 recordings, 0.0113 to 0.0466 N·m";
    assert!(words(&said).contains(line), "{said}");
    let (code, said, errors) = run(&["estimate", &middle, "--baseline", "two.json", "--json"]);
    assert_eq!(code, 0, "{errors}");
    let document: serde_json::Value = serde_json::from_str(&said).expect("JSON");
    let offset_rad = &document["session"]["joints"][0]["offset_rad"];
    let mean_rad = offset_rad["mean"].as_f64().expect("a number");
    assert!(mean_rad.abs() < 4e-3, "{offset_rad}");

    // Positions of the motor with the opposite sign are no elongation.
    std::fs::write(
        folder.path().join("mapping.toml"),
        MAPPING.replace("scale = -0.92", "scale = 0.92"),
    )
    .expect("written");
    let (code, said, errors) = run(&["estimate", &middle, "--baseline", "two.json"]);
    assert_eq!(code, 1, "{said}{errors}");
    assert!(
        words(&errors).contains("[joints.jaw] theta = { …, sign = -1 }"),
        "{errors}"
    );
    std::fs::write(folder.path().join("mapping.toml"), MAPPING).expect("written");

    let (code, said, errors) = run(&["baseline", &light, "--out", "one.json"]);
    assert_eq!(code, 0, "{said}{errors}");
    assert!(
        words(&said).contains("one load does not determine"),
        "{said}"
    );
    let (code, said, errors) = run(&["estimate", &middle, "--baseline", "one.json"]);
    assert_eq!(code, 0, "{said}{errors}");
    assert!(said.contains("inconclusive"), "{said}");
    let warning = "warning[cable-inconclusive]: jaw: load 0.0352 N·m";
    assert!(words(&errors).contains(warning), "{errors}");
}
