//! The command line as a user meets it: exit codes, messages, files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

fn sinew(args: &[&str], dir: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(dir)
        .output()
        .expect("the program starts")
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("not ended by a signal")
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("stdout is UTF-8")
}

fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("stderr is UTF-8")
}

/// Refused with this exit code, a single clear message and nothing on stdout.
#[track_caller]
fn refused(args: &[&str], dir: &Path, exit: i32, words: &[&str]) {
    let output = sinew(args, dir);
    let message = err(&output);
    assert_eq!(code(&output), exit, "{args:?}: {message}");
    assert_eq!(out(&output), "", "{args:?}");
    assert!(message.starts_with("error: "), "{args:?}: {message}");
    for word in words {
        assert!(
            message.contains(word),
            "{args:?}: '{word}' is not in: {message}"
        );
    }
    for never in ["panicked", "RUST_BACKTRACE", "Os {", "Err("] {
        assert!(!message.contains(never), "{args:?}: {message}");
    }
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn robot() -> String {
    let folder = repository().join("robots/biorob-like");
    folder.display().to_string()
}

/// A folder with `s.mcap`: some seconds of the BioRob-like arm with stretched tendons.
fn simulated(duration_s: &str) -> TempDir {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let scenario = repository().join("examples/scenarios/stretched-arm.toml");
    let scenario = scenario.display().to_string();
    let args = [
        "simulate",
        &scenario,
        "--robot",
        &robot(),
        "--out",
        "s.mcap",
        "--duration",
        duration_s,
    ];
    let output = sinew(&args, dir.path());
    assert_eq!(code(&output), 0, "{}", err(&output));
    dir
}

#[test]
fn help_fits_80_columns_on_stdout() {
    let dir = tempfile::tempdir().unwrap();
    for command in [
        vec!["--help"],
        vec!["init", "--help"],
        vec!["estimate", "--help"],
        vec!["estimate", "-h"],
        vec!["simulate", "--help"],
        vec!["simulate", "-h"],
        vec!["robot", "--help"],
        vec!["robot", "check", "--help"],
        vec!["log", "--help"],
        vec!["log", "info", "--help"],
    ] {
        let output = sinew(&command, dir.path());
        assert_eq!(code(&output), 0, "{command:?}");
        let text = out(&output);
        assert!(text.contains("Usage: sinew"), "{command:?}");
        for line in text.lines() {
            assert!(line.chars().count() <= 80, "{command:?}: {line}");
        }
    }
    let version = out(&sinew(&["--version"], dir.path()));
    assert_eq!(version.trim(), concat!("sinew ", env!("CARGO_PKG_VERSION")));
}

#[test]
fn usage_error_exits_2_names_value_and_unit() {
    let dir = tempfile::tempdir().unwrap();
    let estimate = |option: &str, value: &str, words: &[&str]| {
        refused(&["estimate", "x.mcap", option, value], dir.path(), 2, words);
    };
    estimate("--gain", "-3", &["-3 1/s must be above 0", "--gain"]);
    estimate("--gain", "NaN", &["1/s", "finite"]);
    estimate("--velocity-filter", "0", &["0 rad/s must be above 0"]);
    estimate("--velocity-filter", "fast", &["fast", "rad/s", "recorded"]);
    estimate(
        "--source",
        "guess",
        &["guess", "observer", "torque-sensor", "motor"],
    );
    estimate("--comparison", "none", &["matched", "paper"]);
    estimate("--inject", "elbow", &["JOINT=RAD"]);
    estimate("--inject", "elbow=45", &["45 rad is more than half a turn"]);
    estimate(
        "--inject",
        "elbow=0.01@-2",
        &["-2 s is before the recording"],
    );
    refused(&["estimate"], dir.path(), 2, &["<LOG>"]);
    refused(&["estimat", "x.mcap"], dir.path(), 2, &["estimate"]);
    refused(
        &["simulate", "x.toml", "--out", "x.mcap", "--duration", "-1"],
        dir.path(),
        2,
        &["-1 s"],
    );
    refused(&["simulate", "x.toml"], dir.path(), 2, &["--out"]);
    assert_eq!(
        code(&sinew(&[], dir.path())),
        2,
        "no command is a usage error"
    );
}

#[test]
fn paper_estimate_rejects_options_of_absolute() {
    let dir = simulated("4");
    let robot = robot();
    for option in [
        ["--save", "x.baseline"].as_slice(),
        &["--payload", "0.5kg"],
        &["--empty"],
        &["--nuisance"],
        &["--no-motor-torque"],
        &["--online"],
    ] {
        let mut args = vec!["estimate", "s.mcap", "--robot", robot.as_str()];
        args.extend(option);
        // Specified by its method, or by one of its options.
        for paper in [["--method", "paper"], ["--source", "motor"]] {
            let args = [&args[..], &paper].concat();
            refused(&args, dir.path(), 1, &[option[0], "--method absolute"]);
        }
    }
    let part = ["estimate", "s.mcap", "--robot", robot.as_str(), "--to", "3"];
    let part = [&part[..], &["--reference", "s.mcap"]].concat();
    refused(&part, dir.path(), 1, &["--to", "--method absolute"]);
    assert!(!dir.path().join("x.baseline").exists());
}

#[test]
fn motor_current_is_used_with_wider_interval_than_torque() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let scenario = repository().join("examples/scenarios/work-session.toml");
    let (scenario, robot) = (scenario.display().to_string(), robot());
    let simulate = ["simulate", &scenario, "--out", "w.csv", "--duration", "20"];
    let simulated = sinew(&simulate, dir.path());
    assert_eq!(code(&simulated), 0, "{}", err(&simulated));
    let mut mappings = [String::new(), String::new()];
    for joint in ["shoulder_yaw", "shoulder_pitch", "elbow", "wrist"] {
        // What is a torque in the file is a current here: 0.05 N·m/A, geared 20 : 1.
        let current = "unit = \"A\", torque_constant_nm_per_a = 0.05, gear_ratio = 20";
        for (mapping, how) in mappings.iter_mut().zip(["unit = \"N·m\"", current]) {
            mapping.push_str(&format!(
                "[joints.{joint}]\nq = {{ column = \"q.{joint}_rad\" }}\n\
                 theta = {{ column = \"theta.{joint}_rad\" }}\n\
                 tau_m = {{ column = \"tau_m.{joint}_nm\", {how} }}\n"
            ));
        }
    }
    let [torque, current] = mappings.map(|mapping| {
        std::fs::write(dir.path().join("map.toml"), mapping).expect("a mapping");
        let with = [
            "--robot",
            &robot,
            "--mapping",
            "map.toml",
            "--method",
            "absolute",
        ];
        let args = [&["estimate", "w.csv"], &with[..], &["--json", "--quiet"]].concat();
        let output = sinew(&args, dir.path());
        assert_eq!(code(&output), 0, "{}", err(&output));
        let mut json: serde_json::Value = serde_json::from_str(&out(&output)).expect("JSON");
        json["session"].take()
    });
    assert_eq!(torque["motor_torque"], "measured");
    assert_eq!(current["motor_torque"], "from-current");
    let scale = |said: &serde_json::Value| {
        let all = said["nuisance"]
            .as_array()
            .expect("what was estimated along");
        let own = all.iter().find(|n| n["name"] == "motor torque scale");
        own.expect("its scale")["prior"]["std"]
            .as_f64()
            .expect("a deviation")
    };
    assert!((scale(&torque) - 0.03).abs() < 1e-12, "{}", scale(&torque));
    assert!((scale(&current) - 0.1).abs() < 1e-12, "{}", scale(&current));
}

#[test]
fn missing_file_exits_1_names_file() {
    let dir = tempfile::tempdir().unwrap();
    let robot = robot();
    refused(
        &["estimate", "nowhere.mcap", "--robot", &robot],
        dir.path(),
        1,
        &["nowhere.mcap"],
    );
    refused(
        &["log", "info", "nowhere.csv"],
        dir.path(),
        1,
        &["nowhere.csv"],
    );
    refused(&["robot", "check", "nowhere"], dir.path(), 1, &["nowhere"]);
    refused(
        &["simulate", "nowhere.toml", "--out", "x.mcap"],
        dir.path(),
        1,
        &["nowhere.toml"],
    );
    refused(
        &["estimate", "x.mcap", "--mapping", "nowhere.toml"],
        dir.path(),
        1,
        &["nowhere.toml"],
    );
    std::fs::write(dir.path().join("empty.mcap"), "").unwrap();
    refused(
        &["estimate", "empty.mcap", "--robot", &robot],
        dir.path(),
        1,
        &["empty.mcap"],
    );
    refused(
        &["log", "info", "empty.mcap"],
        dir.path(),
        1,
        &["empty.mcap"],
    );
}

#[test]
fn empty_recording_exits_1_states_reason() {
    let dir = tempfile::tempdir().expect("a folder");
    let header = "time_s,q.a_rad,theta.a_rad\n";
    for (rows, reason) in [
        ("", "no row"),
        (",1,1\n,2,2\n", "none of 2 rows has a time"),
        ("0.2,1,1\n0.1,2,2\n0.0,3,3\n", "backwards"),
        ("0,1,1\n0,2,2\n0,3,3\n", "same time"),
    ] {
        std::fs::write(dir.path().join("a.csv"), format!("{header}{rows}")).expect("written");
        refused(&["log", "info", "a.csv"], dir.path(), 1, &["a.csv", reason]);
    }
    // Three rows are a valid recording.
    std::fs::write(
        dir.path().join("a.csv"),
        format!("{header}0,1,1\n1,2,2\n2,3,3\n"),
    )
    .expect("written");
    assert_eq!(code(&sinew(&["log", "info", "a.csv"], dir.path())), 0);
    // Parts, packed: one recording.
    let packed = dir.path().join("b.csv");
    std::fs::write(&packed, format!("{header}3,1,1\n4,2,2\n5,3,3\n")).expect("written");
    let whole = sinew(&["log", "info", "b.csv", "a.csv"], dir.path());
    assert!(out(&whole).contains("6 frames"), "{}", out(&whole));
    let pattern = sinew(&["log", "info", "?.csv", "--json"], dir.path());
    assert!(out(&pattern).contains("\"frames\": 6"), "{}", out(&pattern));
    refused(
        &["log", "info", "*.mcap"],
        dir.path(),
        1,
        &["no file matches the name"],
    );
}

#[test]
fn no_estimate_exits_1_writes_no_file() {
    let dir = tempfile::tempdir().expect("a folder");
    let robot = repository()
        .join("examples/05-your-own-robot")
        .display()
        .to_string();
    let rows = |from: usize, to: usize, cell: &dyn Fn(usize) -> String| -> String {
        (from..to)
            .map(|k| format!("{},{}\n", 0.01 * k as f64, cell(k)))
            .collect()
    };
    let write = |text: String| std::fs::write(dir.path().join("a.csv"), text).expect("written");
    let estimate = ["estimate", "a.csv", "--robot", &robot, "--csv", "e.csv"];
    let refuse = |words: &[&str]| {
        refused(&estimate, dir.path(), 1, words);
        refused(
            &[&estimate[..], &["--method", "paper"]].concat(),
            dir.path(),
            1,
            words,
        );
        assert!(!dir.path().join("e.csv").exists());
    };
    // No motor position of the one joint that has a tendon.
    let header = "time_s,q.pan_rad,q.tilt_rad\n".to_string();
    write(header + &rows(0, 1000, &|k| format!("0,{}", 1e-3 * k as f64)));
    refuse(&["a.csv", "tilt"]);
    // Too short.
    let header = "time_s,q.pan_rad,q.tilt_rad,theta.tilt_rad\n".to_string();
    write(header + &rows(0, 3, &|k| format!("0,{k},{k}")));
    refuse(&["a.csv"]);
}

#[test]
fn identical_or_swapped_sides_error_names_joints() {
    let dir = tempfile::tempdir().expect("a folder");
    let robot = robot();
    let refuse = |text: &str, words: &[&str]| {
        std::fs::write(dir.path().join("b.csv"), text).expect("written");
        let estimate = ["estimate", "b.csv", "--robot", &robot, "--csv", "e.csv"];
        refused(&estimate, dir.path(), 1, words);
        let learn = [
            "baseline",
            "b.csv",
            "--robot",
            &robot,
            "--out",
            "b.baseline",
        ];
        refused(&learn, dir.path(), 1, words);
        assert!(!dir.path().join("e.csv").exists());
        assert!(!dir.path().join("b.baseline").exists());
    };
    // A quiet motion; a session with a payload that comes, slips and contacts.
    for (scenario, duration) in [("stretched-arm", "30"), ("work-session", "180")] {
        let file = format!("examples/scenarios/{scenario}.toml");
        let file = repository().join(file).display().to_string();
        let simulate = ["simulate", &file, "--robot", &robot, "--duration", duration];
        let made = sinew(&[&simulate[..], &["--out", "a.csv"]].concat(), dir.path());
        assert_eq!(code(&made), 0, "{}", err(&made));
        let text = std::fs::read_to_string(dir.path().join("a.csv")).expect("it is there");
        let (header, rows) = text.split_once('\n').expect("a header");
        let exchanged = |joint: &str| {
            let [q, theta] = ["q.", "theta."].map(|side| format!("{side}{joint}"));
            let header = header.replace(&theta, "?").replace(&q, &theta);
            format!("{}\n{rows}", header.replace('?', &q))
        };
        refuse(&exchanged(""), &["swapped", "'elbow'", "mapping"]);
        refuse(
            &exchanged("elbow"),
            &["swapped", "by a factor of", "at 'elbow'"],
        );
        // One joint's motor side is its joint side.
        let one = rows.lines().map(|row| {
            let mut cells: Vec<&str> = row.split(',').collect();
            cells[7] = cells[3];
            cells.join(",") + "\n"
        });
        let one = format!("{header}\n{}", one.collect::<String>());
        refuse(&one, &["of 'elbow' are identical", "--motor-topic"]);
        let paper = ["estimate", "b.csv", "--robot", &robot, "--method", "paper"];
        refused(&paper, dir.path(), 1, &["of 'elbow' are identical"]);
        let info = sinew(&["log", "info", "b.csv"], dir.path());
        assert!(
            out(&info).contains("theta.elbow is bitwise identical to q.elbow"),
            "{}",
            out(&info)
        );
    }
}

#[test]
fn estimate_writes_table_json_csv_report() {
    let dir = simulated("12");
    let robot = robot();
    let base = ["estimate", "s.mcap", "--robot", &robot];

    let table = sinew(&base, dir.path());
    assert_eq!(code(&table), 0, "{}", err(&table));
    let text = out(&table);
    for word in ["shoulder_pitch", "elbow", "mrad", "encoder zero", "result"] {
        assert!(text.contains(word), "'{word}' is not in:\n{text}");
    }
    // One answer, not two.
    assert!(
        !text.contains("reading") && text.matches("elbow  ").count() == 1,
        "{text}"
    );
    let paper = sinew(&[&base[..], &["--method", "paper"]].concat(), dir.path());
    assert_eq!(code(&paper), 0, "{}", err(&paper));
    let reading = out(&paper);
    assert!(
        reading.contains("elbow: uncorrected offset ") && reading.contains("Uncorrected estimate:"),
        "{reading}"
    );
    for verdict in ["elongated", "no change detected", "95 % CI"] {
        assert!(!reading.contains(verdict), "'{verdict}' is in:\n{reading}");
    }
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }

    let files = ["--csv", "e.csv", "--report", "e.html", "--json"];
    let both = sinew(&[&base[..], &files].concat(), dir.path());
    assert_eq!(code(&both), 0, "{}", err(&both));
    assert_eq!(err(&both), "", "nothing to say on stderr");
    let json: serde_json::Value = serde_json::from_str(&out(&both)).expect("one JSON document");
    assert_eq!(json["method"], "absolute");
    let answers = json["session"]["joints"].as_array().expect("joints");
    let joints = json["reading"]["joints"].as_array().expect("joints");
    assert_eq!((joints.len(), answers.len()), (4, 4));
    let truth = std::fs::read_to_string(dir.path().join("s.truth.json")).expect("the truth");
    let truth: serde_json::Value = serde_json::from_str(&truth).expect("JSON");
    for answer in answers {
        let name = answer["name"].as_str().expect("a name");
        let number = |key: &str| 1e3 * answer["offset_rad"][key].as_f64().expect("a number");
        let true_mrad = 1e3 * truth["offset_rad"][name].as_f64().unwrap_or(0.0);
        let error = (number("mean") - true_mrad).abs();
        assert!(error < 2.0 * number("std"), "{name}: {error}");
    }
    for joint in joints {
        let name = joint["name"].as_str().expect("a name");
        let estimate = 1e3 * joint["offset_rad"].as_f64().expect("an estimate");
        let true_mrad = 1e3 * truth["offset_rad"][name].as_f64().unwrap_or(0.0);
        // Errors of the robot description: up to 3 % in stiffness, 2 % in masses.
        let per_error = joint["offset_per_stiffness_error_rad"].as_f64().unwrap();
        let wrong = 1e3 * 0.05 * per_error.abs();
        assert!(
            (estimate - true_mrad).abs() < 0.5 + wrong,
            "{name}: {estimate} {true_mrad}"
        );
    }
    // The time series has its own file: `--series`.
    assert!(joints.iter().all(|joint| joint.get("series").is_none()));

    let html = std::fs::read_to_string(dir.path().join("e.html")).expect("the report");
    assert!(html.starts_with("<!DOCTYPE html>") && html.contains("tendon"));
    // The answer over time, and what the paper's equation reads.
    // Each of the eight has a second layout for narrow windows.
    assert_eq!(html.matches("<svg xmlns").count(), 16);
    let csv = std::fs::read_to_string(dir.path().join("e.csv")).expect("the CSV");
    assert!(
        csv.lines()
            .next()
            .is_some_and(|l| l.contains("delta_e.elbow_rad"))
    );
    let frames = json["reading"]["recording"]["frames"]
        .as_u64()
        .expect("frames") as usize;
    assert_eq!(csv.lines().count(), frames + 1);
    let left: Vec<_> = std::fs::read_dir(dir.path())
        .unwrap()
        .map(|f| f.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name.contains("tmp"))
        .collect();
    assert!(left.is_empty(), "left behind: {left:?}");

    let again = sinew(&[&base[..], &files].concat(), dir.path());
    assert_eq!(again.stdout, both.stdout, "the same every time");
    assert_eq!(
        std::fs::read_to_string(dir.path().join("e.html")).unwrap(),
        html
    );
}

#[test]
fn injected_offset_equals_difference_to_reference() {
    let dir = simulated("12");
    let robot = robot();
    let args = [
        "estimate",
        "s.mcap",
        "--robot",
        &robot,
        "--reference",
        "s.mcap",
        "--inject",
        "elbow=-0.004",
        "--json",
    ];
    let output = sinew(&args, dir.path());
    assert_eq!(code(&output), 0, "{}", err(&output));
    let json: serde_json::Value = serde_json::from_str(&out(&output)).expect("JSON");
    for joint in json["reading"]["joints"].as_array().expect("joints") {
        let expected = if joint["name"] == "elbow" { -4.0 } else { 0.0 };
        let found = joint["difference"]["difference_rad"].as_f64();
        let found = 1e3 * found.expect("a difference");
        // An added constant passes the linear filters unchanged: rounding only.
        assert!(
            (found - expected).abs() < 1e-6,
            "{}: {found}",
            joint["name"]
        );
    }
}

#[test]
fn mistyped_joint_name_suggests_nearest() {
    let dir = simulated("2");
    let args = [
        "estimate",
        "s.mcap",
        "--robot",
        &robot(),
        "--inject",
        "elbw=0.01",
    ];
    refused(&args, dir.path(), 1, &["elbw", "did you mean 'elbow'?"]);
}

#[test]
fn outputs_are_checked_first_never_replace_inputs() {
    let dir = simulated("2");
    let robot = robot();
    let before = std::fs::read(dir.path().join("s.mcap")).unwrap();
    let base = ["estimate", "s.mcap", "--robot", &robot];
    let with = |more: &[&str], words: &[&str]| {
        refused(&[&base[..], more].concat(), dir.path(), 1, words);
    };
    with(
        &["--csv", "s.mcap"],
        &["--csv", "same file as the recording"],
    );
    with(
        &["--report", "./s.mcap"],
        &["--report", "same file as the recording"],
    );
    with(&["--csv", "a", "--report", "a"], &["same file as --csv"]);
    with(
        &["--report", "s.mcap/r.html"],
        &["--report", "cannot create the folder"],
    );
    with(&["--csv", "."], &["is a folder"]);
    // A file of the robot's folder, which no option names, and one that another option names.
    let own = dir.path().join("rr");
    std::fs::create_dir(&own).unwrap();
    for entry in std::fs::read_dir(&robot).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, own.join(path.file_name().unwrap())).unwrap();
        }
    }
    let toml = std::fs::read(own.join("robot.toml")).unwrap();
    for report in ["rr/robot.toml", "rr/../rr/robot.toml"] {
        for robot in [&["--robot", "rr"][..], &["--robot=rr"]] {
            let args = [&["estimate", "s.mcap", "--report", report], robot].concat();
            let words = ["--report", "is an input of this command"];
            refused(&args, dir.path(), 1, &words);
        }
    }
    assert_eq!(std::fs::read(own.join("robot.toml")).unwrap(), toml);
    // The URDF that robot.toml names, at the end of a complete estimate.
    let recording = repository().join("examples/01-stretched-arm/stretched-arm.mcap");
    let recording = recording.to_str().unwrap();
    let urdf = std::fs::read(own.join("biorob-like.urdf")).unwrap();
    for robot in ["rr", "rr/robot.toml"] {
        let report = "rr/biorob-like.urdf";
        let args = ["estimate", recording, "--robot", robot, "--report", report];
        let args = [&args[..], &["--quiet"]].concat();
        refused(&args, dir.path(), 1, &["is an input of this command"]);
    }
    assert_eq!(std::fs::read(own.join("biorob-like.urdf")).unwrap(), urdf);
    std::fs::write(dir.path().join("d.toml"), "").unwrap();
    let args = ["rope", "select", "--duty", "d.toml", "--report", "d.toml"];
    refused(&args, dir.path(), 1, &["is an input of this command"]);
    assert_eq!(std::fs::read(dir.path().join("s.mcap")).unwrap(), before);

    // A refused run leaves an older result as it was.
    std::fs::write(dir.path().join("old.csv"), "old").unwrap();
    with(
        &["--csv", "old.csv", "--source", "torque-sensor"],
        &["torque"],
    );
    assert_eq!(
        std::fs::read_to_string(dir.path().join("old.csv")).unwrap(),
        "old"
    );
}

#[test]
fn truncated_recording_is_used_to_damage_exits_3() {
    let dir = simulated("8");
    let whole = std::fs::read(dir.path().join("s.mcap")).unwrap();
    std::fs::write(dir.path().join("cut.mcap"), &whole[..whole.len() * 6 / 10]).unwrap();
    let robot = robot();
    let output = sinew(&["estimate", "cut.mcap", "--robot", &robot], dir.path());
    assert_eq!(code(&output), 3, "{}", err(&output));
    assert!(out(&output).contains("elbow"));
    assert!(err(&output).contains("damaged"), "{}", err(&output));
    let quiet = sinew(
        &["estimate", "cut.mcap", "--robot", &robot, "--quiet"],
        dir.path(),
    );
    assert_eq!((code(&quiet), err(&quiet).as_str()), (3, ""));
    let info = sinew(&["log", "info", "cut.mcap"], dir.path());
    assert_eq!(code(&info), 3);
    assert!(out(&info).contains("damaged at byte"), "{}", out(&info));
}

#[test]
fn robot_check_and_log_info_list_content() {
    let dir = simulated("2");
    let check = sinew(&["robot", "check", &robot()], dir.path());
    assert_eq!(code(&check), 0, "{}", err(&check));
    let text = out(&check);
    for word in ["shoulder_pitch", "40.0", "480", "mm per"] {
        assert!(text.contains(word), "'{word}' is not in:\n{text}");
    }
    assert!(!text.contains("friction"), "{text}");
    let pan_tilt = repository().join("examples/05-your-own-robot");
    let pan_tilt = pan_tilt.display().to_string();
    let guessed = out(&sinew(&["robot", "check", &pan_tilt], dir.path()));
    assert!(
        guessed.contains("friction not specified, default derived from the stiffness: tilt"),
        "{guessed}"
    );
    let json = out(&sinew(&["robot", "check", &robot(), "--json"], dir.path()));
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["joints"][2]["stiffness_nm_per_rad"], 20.0);
    assert_eq!(json["joints"][2]["friction_specified"], true);
    let length_m = json["joints"][2]["tendon"]["length_m"].as_f64();
    // From millimetres: one rounding.
    assert!(length_m.is_some_and(|m| (m - 0.7).abs() < 1e-12));

    let info = sinew(&["log", "info", "s.mcap"], dir.path());
    assert_eq!(code(&info), 0, "{}", err(&info));
    for word in ["MCAP", "500.0 Hz", "elbow", "theta", "no data lost"] {
        assert!(
            out(&info).contains(word),
            "'{word}' is not in:\n{}",
            out(&info)
        );
    }
    let json = out(&sinew(&["log", "info", "s.mcap", "--json"], dir.path()));
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["frames"], 1000);
    assert_eq!(json["lossy"], false);
}

#[test]
fn closed_pipe_exits_0() {
    let dir = simulated("4");
    let mut child = Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(["estimate", "s.mcap", "--robot", &robot(), "--json"])
        .current_dir(dir.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert_eq!(err(&output), "");
}

/// 6 s of the shipped arm whose frames pass `faults` on their way into the file.
fn simulated_with(faults: &str) -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    let shipped = repository().join("examples/scenarios/stretched-arm.toml");
    let text = std::fs::read_to_string(shipped).unwrap() + faults;
    std::fs::write(dir.path().join("s.toml"), text).unwrap();
    let robot = robot();
    let args = [
        "simulate",
        "s.toml",
        "--robot",
        &robot,
        "--out",
        "s.mcap",
        "--duration",
        "6",
    ];
    let output = sinew(&args, dir.path());
    assert_eq!(code(&output), 0, "{}", err(&output));
    dir
}

#[test]
fn lost_samples_are_reported_exit_3_if_many() {
    let dir = simulated_with("\n[faults]\ndropout_fraction = 0.2\n");
    let info = sinew(&["log", "info", "s.mcap", "--json"], dir.path());
    assert_eq!(code(&info), 3, "{}", err(&info));
    let document: serde_json::Value = serde_json::from_slice(&info.stdout).unwrap();
    for stream in document["health"]["streams"].as_array().unwrap() {
        let (kept, missing) = (&stream["samples"], &stream["missing"]);
        let (kept, missing) = (kept.as_u64().unwrap(), missing.as_u64().unwrap());
        // All but what is lost at either end: 6 s of 500 Hz.
        assert!(
            (2990..=3001).contains(&(kept + missing)),
            "{kept}, {missing}"
        );
        assert!((450..750).contains(&missing), "{missing}");
    }
    let words = sinew(&["log", "info", "s.mcap"], dir.path());
    assert!(
        out(&words).contains("% of the samples lost"),
        "{}",
        out(&words)
    );
    let robot = robot();
    let estimate = sinew(&["estimate", "s.mcap", "--robot", &robot], dir.path());
    assert_eq!(code(&estimate), 3, "{}", err(&estimate));
    assert!(
        err(&estimate).contains("samples missing"),
        "{}",
        err(&estimate)
    );
}

#[test]
fn duplicate_frames_are_no_loss() {
    let dir = simulated_with("\n[faults]\nduplicate_fraction = 0.3\n");
    let info = sinew(&["log", "info", "s.mcap"], dir.path());
    assert_eq!(code(&info), 0, "{}", out(&info));
    assert!(
        out(&info).contains("duplicate time stamp"),
        "{}",
        out(&info)
    );
}
