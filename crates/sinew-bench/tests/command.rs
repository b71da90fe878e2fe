//! The program `sinew-bench` as a user meets it: exit codes, messages, files, documents.

#[path = "../../sinew/tests/checker.rs"]
mod checker;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn robot() -> String {
    let folder = repository().join("robots/biorob-like");
    folder.display().to_string()
}

fn bench(args: &[&str], dir: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew-bench"))
        .args(args)
        .current_dir(dir)
        .output()
        .expect("the program starts")
}

fn bench_here(args: &[&str]) -> Output {
    bench(args, &repository())
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
    let output = bench(args, dir);
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
}

#[test]
fn help_fits_80_columns_on_stdout() {
    for command in [
        &["--help"][..],
        &["paper", "--help"],
        &["paper", "-h"],
        &["scenarios", "--help"],
        &["scenarios", "run", "--help"],
        &["scenarios", "show", "--help"],
        &["trend-simulate", "--help"],
        &["validation", "--help"],
    ] {
        let output = bench_here(command);
        assert_eq!(code(&output), 0, "{command:?}");
        let text = out(&output);
        assert!(text.contains("Usage: sinew-bench"), "{command:?}");
        for line in text.lines() {
            assert!(line.chars().count() <= 80, "{command:?}: {line}");
        }
    }
}

#[test]
fn study_output_matches_schema() {
    let folder = tempfile::tempdir().unwrap();
    let figures = folder.path().to_str().unwrap();
    for (name, args) in [
        (
            "trend-simulate",
            &[
                "trend-simulate",
                "--robot",
                "robots/biorob-like",
                "--robots",
                "1",
                "--joints",
                "elbow",
                "--json",
            ][..],
        ),
        ("paper", &["paper", "table1", "--out", figures, "--json"]),
        (
            "scenarios",
            &[
                "scenarios",
                "run",
                "--scenario",
                "S7",
                "--n",
                "1",
                "--no-steps",
                "--json",
            ],
        ),
        (
            "trajectory",
            &[
                "scenarios",
                "run",
                "--trajectory",
                "--scenario",
                "S5",
                "--n",
                "1",
                "--json",
            ],
        ),
    ] {
        let output = bench_here(args);
        let value: serde_json::Value =
            serde_json::from_str(&out(&output)).unwrap_or_else(|e| panic!("{args:?}: {e}"));
        assert_eq!(value["schema"], format!("sinew/{name}/2"));
        let schema = repository().join(format!("docs/schema/{name}-2.json"));
        let schema = std::fs::read_to_string(schema).expect("a published schema");
        let schema = serde_json::from_str(&schema).expect("JSON");
        let faults = checker::check(&schema, &value);
        assert!(faults.is_empty(), "{args:?}: {faults:#?}");
        // The check detects a missing key and an additional one.
        let mut spoiled = value.clone();
        let keys = spoiled.as_object_mut().unwrap();
        keys.insert("surplus".into(), 1.into());
        keys.remove("schema");
        assert_eq!(checker::check(&schema, &spoiled).len(), 2, "{args:?}");
    }
}

#[test]
fn paper_figures_write_files_with_assessed_sentences() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["fig6", "fig7"] {
        let output = bench(
            &["paper", name, "--robot", &robot(), "--out", "f", "--json"],
            dir.path(),
        );
        let json: serde_json::Value = serde_json::from_str(&out(&output)).expect("JSON");
        let sentences = json["sentences"].as_array().expect("sentences");
        let failed = sentences.iter().filter(|s| s["holds"] != true).count();
        assert!(!sentences.is_empty());
        assert_eq!(
            code(&output),
            if failed > 0 { 3 } else { 0 },
            "{}",
            err(&output)
        );
        let file = |ending: &str| {
            std::fs::read(dir.path().join(format!("f/{name}.{ending}"))).expect(ending)
        };
        assert_eq!(&file("png")[1..4], b"PNG");
        assert!(file("svg").starts_with(b"<svg"));
        let page = String::from_utf8(file("html")).expect("UTF-8");
        assert_eq!(page.matches("<svg xmlns").count(), 2);
    }
    refused(&["paper", "fig8"], dir.path(), 2, &["fig8", "fig6", "fig7"]);
    let missing = ["paper", "fig6", "--robot", "robots/biorob-like"];
    refused(&missing, dir.path(), 1, &["robots/biorob-like"]);
    // An option without effect is an error.
    for (figure, option) in [
        ("fig6", "--ropes"),
        ("fig7", "--ropes"),
        ("control", "--ropes"),
        ("fig1", "--robot"),
    ] {
        refused(
            &["paper", figure, option, "."],
            dir.path(),
            1,
            &[option, figure, "remove the option"],
        );
    }
}

/// Ropes and robot are part of the program.
#[test]
fn paper_runs_in_empty_folder() {
    let dir = tempfile::tempdir().unwrap();
    let inside = ["paper", "fig6", "--out", "f", "--json"];
    let robot = robot();
    let with_robot = [&inside[..], &["--robot", &robot]].concat();
    let sentences = |output: &Output| -> serde_json::Value {
        let json: serde_json::Value = serde_json::from_str(&out(output)).expect("JSON");
        json["sentences"].clone()
    };
    let shipped = bench(&inside, dir.path());
    // One statement of fig6 does not hold.
    assert_eq!(code(&shipped), 3, "{}", err(&shipped));
    let named = bench(&with_robot, dir.path());
    assert_eq!(sentences(&shipped), sentences(&named));
    let ropes = bench(&["paper", "fig1", "--out", "f", "--json"], dir.path());
    assert_eq!(code(&ropes), 0, "{}", err(&ropes));
    let figures = std::fs::read_dir(dir.path().join("f")).expect("written");
    assert!(figures.count() >= 4);
}

/// A session B that is shorter than a block cannot be assessed.
#[test]
fn study_without_assessed_recording_fails() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let robot = robot();
    let show = ["scenarios", "show", "S5", "--robot", &robot];
    let text = out(&bench(&show, dir.path()));
    let short = text.replacen("to_s = 120.0", "to_s = 60.05", 1);
    assert_ne!(text, short);
    std::fs::write(dir.path().join("short.toml"), short).expect("a scenario");
    let study = ["scenarios", "run", "--scenario", "short.toml", "--n", "1"];
    let study = [&study[..], &["--robot", &robot, "--no-steps", "--quiet"]].concat();
    let output = bench(&study, dir.path());
    assert_eq!(code(&output), 1, "{}{}", out(&output), err(&output));
    let said = out(&output);
    assert!(
        said.contains("Rejected by the estimator") && said.contains("seed 1"),
        "{said}"
    );
}

#[test]
fn year_conflicting_options_return_error() {
    for (more, exit, words) in [
        (&["--chained"][..], 2, "--chain"),
        (&["--days", "20"][..], 2, "--chain"),
        (&["--chain", "--days", "366"][..], 2, "366"),
        (&["--session", "play"][..], 2, "check"),
        (&["--chain", "--session", "hard"][..], 1, "remove --chain"),
        (
            &[
                "--chain",
                "--days",
                "1",
                "--out",
                "examples/10-trend/sessions.csv",
            ],
            1,
            "is not a file of simulated sessions",
        ),
    ] {
        let start = [
            "trend-simulate",
            "--robot",
            "robots/biorob-like",
            "--robots",
            "1",
        ];
        let output = bench_here(&[&start[..], more].concat());
        let error = err(&output);
        assert_eq!(code(&output), exit, "{more:?}: {error}");
        assert!(error.contains(words), "{more:?}: {error}");
    }
}

#[test]
fn years_stopped_run_resumes() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("years.jsonl");
    let out = out.to_str().unwrap();
    let run = |robots: &str| -> serde_json::Value {
        let output = bench_here(&[
            "trend-simulate",
            "--robot",
            "robots/biorob-like",
            "--joints",
            "elbow",
            "--forecasters",
            "rope,alone",
            "--robots",
            robots,
            "--out",
            out,
            "--json",
            "--quiet",
        ]);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let one = run("1");
    assert_eq!(one["summary"].as_array().unwrap().len(), 2);
    let again = run("1");
    assert_eq!(
        again["years"][0]["failure"]["day"],
        one["years"][0]["failure"]["day"]
    );
    let rms = |v: &serde_json::Value| v["summary"][0]["tracking_rms_rad"].as_f64().unwrap();
    assert!((rms(&one) - rms(&again)).abs() < 1e-9);
    assert!(std::fs::read_to_string(out).unwrap().lines().count() == 2);
    // A stored year is not simulated again: the content of the file counts.
    let kept = std::fs::read_to_string(out).unwrap();
    let (head, year) = kept.split_once('\n').unwrap();
    let mut year: serde_json::Value = serde_json::from_str(year).unwrap();
    year["tendons"][0]["error_rms_rad"] = 77.0.into();
    std::fs::write(out, format!("{head}\n{year}\n")).unwrap();
    assert_eq!(rms(&run("1")), 77.0);
    std::fs::write(out, "{}\n").unwrap();
    let output = bench_here(&[
        "trend-simulate",
        "--robot",
        "robots/biorob-like",
        "--robots",
        "1",
        "--out",
        out,
    ]);
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn study_file_is_locked_during_run() {
    let dir = tempfile::tempdir().unwrap();
    let study = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sinew-bench"));
        command.current_dir(dir.path());
        command.args(["trend-simulate", "--out", "years.jsonl", "--robots", "9999"]);
        command
            .arg("--robot")
            .arg(repository().join("robots/biorob-like"));
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    };
    let mut first = study().spawn().unwrap();
    // The first line is written under the lock.
    while std::fs::metadata(dir.path().join("years.jsonl")).map_or(0, |m| m.len()) == 0 {
        assert_eq!(first.try_wait().unwrap(), None, "it still runs");
        std::thread::sleep(Duration::from_millis(5));
    }
    let second = study().output().unwrap();
    first.kill().unwrap();
    first.wait().unwrap();
    let said = err(&second);
    assert_eq!(second.status.code(), Some(1), "{said}");
    let holder = format!(
        "another run is writing it (process {}, since 20",
        first.id()
    );
    assert!(said.contains(&holder), "{said}");
}
