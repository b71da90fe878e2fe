//! From a recording or a URDF to a robot.toml that the other commands take.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn sinew(args: &[&str], dir: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(dir)
        .output()
        .expect("the program starts")
}

/// Runs a command, checks its exit code, and returns its output.
#[track_caller]
fn ends(code: i32, args: &[&str], dir: &Path) -> String {
    let output = sinew(args, dir);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let said = text(&output.stdout) + &text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
    said
}

/// Words of a text, independent of line breaks.
fn unwrapped(said: &str) -> String {
    said.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn path(inside: &str) -> String {
    root().join(inside).display().to_string()
}

/// Takes the # away before every stiffness and gives it the shipped robot's value.
fn filled(text: &str) -> String {
    let known = [
        ("shoulder_yaw", 50.0),
        ("shoulder_pitch", 40.0),
        ("elbow", 20.0),
        ("wrist", 8.0),
    ];
    let mut joint = String::new();
    let lines = text.lines().map(|line| {
        if let Some(name) = line.strip_prefix("[joints.") {
            joint = name.trim_end_matches(']').to_owned();
        }
        match (
            line.starts_with("# stiffness_nm_per_rad"),
            known.iter().find(|k| k.0 == joint),
        ) {
            (true, Some((_, k))) => format!("stiffness_nm_per_rad = {k:?}\n"),
            _ => format!("{line}\n"),
        }
    });
    lines.collect()
}

#[test]
fn init_from_recording_is_valid_with_stiffness() {
    let dir = tempfile::tempdir().expect("a folder");
    let dir = dir.path();
    let (scenario, robot) = (
        path("examples/scenarios/stretched-arm.toml"),
        path("robots/biorob-like"),
    );
    let simulate = [
        "simulate",
        &scenario,
        "--robot",
        &robot,
        "--out",
        "s.mcap",
        "--duration",
        "20",
    ];
    ends(0, &simulate, dir);

    let said = ends(0, &["init", "s.mcap", "--out", "bot"], dir);
    for words in [
        "wrote bot/robot.toml",
        "wrote bot/robot.urdf",
        "theta from /dynamic_joint_states motor_position",
        "stiffness_nm_per_rad of shoulder_yaw, shoulder_pitch, elbow, wrist",
        "sinew robot check bot",
        "sinew estimate s.mcap --robot bot",
    ] {
        assert!(said.contains(words), "'{words}' is not in:\n{said}");
    }
    let file = dir.join("bot/robot.toml");
    let text = std::fs::read_to_string(&file).expect("written");
    assert!(
        text.lines().all(|line| line.chars().count() <= 120),
        "{text}"
    );

    // Nothing is overwritten unasked; what is replaced is named.
    let said = ends(1, &["init", "s.mcap", "--out", "bot"], dir);
    assert!(said.contains("bot/robot.toml already exists"), "{said}");
    let said = ends(0, &["init", "s.mcap", "--out", "bot", "--force"], dir);
    assert!(said.contains("replaced bot/robot.toml"), "{said}");

    // Accepted by the check, with its gaps named.
    let json = ends(3, &["robot", "check", "bot", "--json"], dir);
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let findings = json["findings"].as_array().expect("findings");
    assert_eq!(findings.len(), 4, "{json:#}");
    assert!(
        findings.iter().all(|f| f["severity"] == "missing"),
        "{json:#}"
    );
    assert!(
        findings[0]["text"]
            .as_str()
            .is_some_and(|t| t.contains("stiffness")),
        "{json:#}"
    );

    std::fs::write(&file, filled(&text)).expect("written");
    ends(0, &["robot", "check", "bot"], dir);
    let said = ends(0, &["estimate", "s.mcap", "--robot", "bot", "--quiet"], dir);
    assert!(said.contains("elbow"), "{said}");
}

#[test]
fn init_from_urdf_writes_next_to_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let dir = dir.path();
    let from = root().join("examples/05-your-own-robot/pan-tilt.urdf");
    std::fs::copy(from, dir.join("pan-tilt.urdf")).expect("copied");
    let said = ends(0, &["init", "pan-tilt.urdf"], dir);
    assert!(
        said.contains("wrote ./robot.toml") && !said.contains("pan-tilt.urdf\nwrote"),
        "{said}"
    );
    let text = std::fs::read_to_string(dir.join("robot.toml")).expect("written");
    assert!(text.contains("urdf = \"pan-tilt.urdf\""), "{text}");
    assert!(text.contains("[joints.tilt]\n# turns about 0 "), "{text}");
    let said = unwrapped(&ends(3, &["robot", "check", "."], dir));
    assert!(
        said.contains("missing: ") && said.contains("stiffness_nm_per_rad is missing"),
        "{said}"
    );
}

#[test]
fn init_urdf_transmissions_become_tendons() {
    let dir = tempfile::tempdir().expect("a folder");
    let dir = dir.path();
    let from = root().join("examples/05-your-own-robot/pan-tilt.urdf");
    let text = std::fs::read_to_string(from).expect("there");
    let differential = "<transmission name='t'><type>transmission_interface/DifferentialTransmission</type>
  <joint name='pan'><role>joint1</role><mechanicalReduction>2</mechanicalReduction></joint>
  <joint name='tilt'><role>joint2</role></joint>
  <actuator name='left'><role>actuator1</role><mechanicalReduction>50</mechanicalReduction></actuator>
  <actuator name='right'><role>actuator2</role><mechanicalReduction>-50</mechanicalReduction></actuator>
</transmission></robot>";
    let text = text.replace("</robot>", differential);
    std::fs::write(dir.join("arm.urdf"), &text).expect("written");
    let args = ["init", "arm.urdf", "--transmissions", "arm.urdf"];
    let said = ends(0, &args, dir);
    for words in [
        "tendon left: left to pan, tilt",
        "stiffness of the tendons left, right",
    ] {
        assert!(said.contains(words), "'{words}' is not in:\n{said}");
    }
    let written = std::fs::read_to_string(dir.join("robot.toml")).expect("written");
    for words in [
        "motor = \"left\"\nratios = { pan = 100.0, tilt = 50.0 }",
        "motor = \"right\"\nratios = { pan = -100.0, tilt = 50.0 }",
    ] {
        assert!(written.contains(words), "'{words}' is not in:\n{written}");
    }
    // Stiffness is what is missing; with it the robot is whole.
    let said = ends(3, &["robot", "check", "."], dir);
    assert!(said.contains("stiffness_nm_per_rad is missing"), "{said}");
    let filled = written.replace("# stiffness_nm_per_rad =", "stiffness_nm_per_rad = 0.02 #");
    std::fs::write(dir.join("robot.toml"), &filled).expect("written");
    let said = ends(0, &["robot", "check", "."], dir);
    let picture = "left   ==O==---(+)---(+)\nright  ==O==---(-)---(+)\n";
    assert!(said.contains(picture), "{said}");
    std::fs::write(dir.join("t.csv"), "motor,pan\nm,x\n").expect("written");
    let said = ends(
        1,
        &["init", "arm.urdf", "--transmissions", "t.csv", "--force"],
        dir,
    );
    assert!(
        unwrapped(&said).contains("t.csv, line 2, column 'pan' = 'x'"),
        "{said}"
    );
}

#[test]
fn init_incomplete_recording_lists_missing_values() {
    let dir = tempfile::tempdir().expect("a folder");
    let dir = dir.path();
    let nod = path("examples/05-your-own-robot/nod.csv");
    let said = ends(0, &["init", &nod, "--out", "a"], dir);
    assert!(said.contains("URDF with masses"), "{said}");
    let urdf = path("examples/05-your-own-robot/pan-tilt.urdf");
    let said = ends(0, &["init", &nod, "--urdf", &urdf, "--out", "b"], dir);
    assert!(
        said.contains("wrote b/pan-tilt.urdf") && !said.contains("URDF with masses"),
        "{said}"
    );

    // A text without columns is no table to choose from.
    std::fs::write(dir.join("t.txt"), "hello\n").expect("written");
    ends(1, &["init", "t.txt"], dir);
    std::fs::write(dir.join("t.csv"), "clock,pos1,mot1\n0,1,1\n0.01,1,1\n").expect("written");
    let said = ends(3, &["init", "t.csv"], dir);
    for words in [
        "wrote ./mapping.toml",
        "sinew init t.csv --mapping ./mapping.toml",
    ] {
        assert!(said.contains(words), "'{words}' is not in:\n{said}");
    }
    let text = std::fs::read_to_string(dir.join("mapping.toml")).expect("written");
    assert!(
        text.contains("#   mot1") && text.contains("\ncolumn = \"clock\"  # assumed"),
        "{text}"
    );
    std::fs::write(
        dir.join("mapping.toml"),
        "[time]\ncolumn = \"clock\"\n[joints.a]\nq = { column = \"pos1\" }\ntheta = { column = \"mot1\" }\n",
    )
    .expect("written");
    let said = ends(0, &["init", "t.csv", "--mapping", "mapping.toml"], dir);
    let next = "sinew estimate t.csv --robot . --mapping mapping.toml";
    assert!(said.contains(next), "{said}");
    assert!(
        said.contains("theta from mot1") && said.contains("stiffness_nm_per_rad of a"),
        "{said}"
    );
}

#[test]
fn check_impossible_exits_1_implausible_exits_3() {
    let dir = tempfile::tempdir().expect("a folder");
    let dir = dir.path();
    for file in ["robot.toml", "biorob-like.urdf"] {
        let from = root().join("robots/biorob-like").join(file);
        std::fs::copy(from, dir.join(file)).expect("copied");
    }
    let shipped = std::fs::read_to_string(dir.join("robot.toml")).expect("there");
    let check = |from: &str, to: &str, code: i32, words: &str| {
        assert!(shipped.contains(from), "{from}");
        std::fs::write(dir.join("robot.toml"), shipped.replace(from, to)).expect("written");
        let said = ends(code, &["robot", "check", "."], dir);
        assert!(
            unwrapped(&said).contains(words),
            "'{words}' is not in:\n{said}"
        );
    };
    let length = "tendon.length_mm = 0.52 mm: usual range 15.0 to \
                  10000 mm; if specified in m, write 520 mm";
    check("length_mm = 700.0", "length_mm = 0.52", 1, length);
    check(
        "liros-dc000-0301",
        "liros-dc000-031",
        3,
        "similar: liros-dc000-0301, ",
    );
    check(
        "pretension_n = 40.0",
        "pretension_n = 4000.0",
        3,
        "89.9 % of the breaking load; usual at most 20.0 %",
    );
}

#[test]
fn urdf_as_robot_error_names_folder() {
    let dir = tempfile::tempdir().expect("a folder");
    let dir = dir.path();
    let from = root().join("robots/biorob-like/biorob-like.urdf");
    std::fs::copy(from, dir.join("arm.urdf")).expect("copied");
    let said = ends(1, &["robot", "check", "arm.urdf"], dir);
    let words = "arm.urdf is a URDF, which contains no stiffness; specify the folder of robot.toml instead: sinew init arm.urdf creates one";
    assert!(unwrapped(&said).contains(words), "{said}");
    let urdf = path("robots/biorob-like/biorob-like.urdf");
    let said = ends(1, &["robot", "check", &urdf], dir);
    let words = format!("instead: {}", path("robots/biorob-like"));
    assert!(unwrapped(&said).contains(&words), "{said}");
}
