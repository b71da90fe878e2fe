//! `sinew trend` from the outside: exit codes, columns, files.

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

/// Messages of a command in one line.
fn messages(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr);
    Vec::from_iter(text.split_whitespace()).join(" ")
}

const SESSIONS: &str = "examples/10-trend/sessions.csv";

#[test]
fn confirmed_step_exits_3_table_fits_80_columns() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("trend.html");
    let csv = folder.path().join("trend.csv");
    let output = sinew(&[
        "trend",
        SESSIONS,
        "--robot",
        "robots/biorob-like",
        "--tensioned",
        "2026-03-02",
        "--report",
        page.to_str().unwrap(),
        "--csv",
        csv.to_str().unwrap(),
    ]);
    assert_eq!(
        output.status.code(),
        Some(3),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).unwrap();
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    assert!(
        text.contains("2026-05-05: step change") && text.contains("strand"),
        "{text}"
    );
    assert!(
        std::fs::read_to_string(page)
            .unwrap()
            .contains("shoulder_pitch")
    );
    let table = std::fs::read_to_string(csv).unwrap();
    let sessions = std::fs::read_to_string(root().join(SESSIONS)).unwrap();
    assert_eq!(table.lines().count(), sessions.lines().count());
}

#[test]
fn trend_json_lists_events_of_split_files() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(root().join(SESSIONS)).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    // Odd and even lines in two files, the later ones first.
    let part = |odd: usize| -> String {
        let rows: Vec<&str> = rows.lines().skip(odd).step_by(2).collect();
        format!("{head}\n{}\n", rows.join("\n"))
    };
    let (a, b) = (folder.path().join("a.csv"), folder.path().join("b.csv"));
    std::fs::write(&a, part(1)).unwrap();
    std::fs::write(&b, part(0)).unwrap();
    let ask = |files: &[&str]| -> serde_json::Value {
        let fixed = [
            "--robot",
            "robots/biorob-like",
            "--tensioned",
            "2026-03-02",
            "--json",
        ];
        let output = sinew(&[&["trend"], files, &fixed].concat());
        assert_eq!(output.status.code(), Some(3));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let whole = ask(&[SESSIONS]);
    assert_eq!(whole, ask(&[a.to_str().unwrap(), b.to_str().unwrap()]));
    let elbow = &whole["joints"].as_array().unwrap()[1];
    assert_eq!(elbow["name"], "elbow");
    assert_eq!(elbow["events"][0]["kind"], "step-change");
    // 2026-05-05, some time of the day.
    let day = elbow["events"][0]["time_utc_s"].as_f64().unwrap() / 86_400.0;
    assert_eq!(day.floor(), 20_578.0);
    let size = 1e3 * elbow["events"][0]["size_rad"]["mean"].as_f64().unwrap();
    assert!((size - 2.9).abs() < 0.8, "{size}");
}

#[test]
fn recording_without_date_enters_trend_by_specified_date() {
    const ROBOT: &str = "examples/05-your-own-robot";
    const LOG: &str = "examples/05-your-own-robot/nod.csv";
    let folder = tempfile::tempdir().unwrap();
    let stored = folder.path().join("session.json");
    let path = stored.to_str().unwrap();
    let estimate = |more: &[&str]| {
        let args = ["estimate", LOG, "--robot", ROBOT, "--json"];
        let output = sinew(&[&args[..], more].concat());
        std::fs::write(&stored, &output.stdout).unwrap();
        output
    };
    assert!(estimate(&[]).status.success());
    let output = sinew(&["trend", path]);
    let text = messages(&output);
    assert!(
        text.contains("has no date") && text.contains("--date"),
        "{text}"
    );
    for (date, time_utc_s) in [
        ("2026-11-29", 1_795_910_400.0),
        ("2026-11-29T08:30:00+01:00", 1_795_937_400.0),
    ] {
        let output = estimate(&["--date", date]);
        assert!(output.status.success());
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(document["session"]["start_time_utc_s"], time_utc_s);
        let warnings = document["session"]["warnings"].as_array().unwrap();
        assert!(warnings.iter().all(|w| w["kind"] != "date-inconsistent"));
        let output = sinew(&["trend", path, "--json"]);
        let trend: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(trend["joints"][0]["series"][0]["time_utc_s"], time_utc_s);
    }
    for date in ["29.11.2026", "2026-02-30", "20261129"] {
        let output = estimate(&["--date", date]);
        let text = messages(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        for words in ["--date", date, "2026-11-29T08:30Z"] {
            assert!(text.contains(words), "{words}: {text}");
        }
    }
}

#[test]
fn specified_date_that_contradicts_clock_is_reported() {
    const LOG: &str = "examples/01-stretched-arm/stretched-arm.mcap";
    let args = ["estimate", LOG, "--robot", "robots/biorob-like", "--date"];
    let output = sinew(&[&args[..], &["2040-05-06"]].concat());
    let text = messages(&output);
    assert!(
        text.contains("warning[date-inconsistent]: date 2040-05-06"),
        "{text}"
    );
    let output = sinew(&[&args[..], &["2040-05-06", "--method", "paper"]].concat());
    let text = messages(&output);
    assert!(text.contains("--date conflicts"), "{text}");
}

#[test]
fn implausible_tensioning_year_is_noted() {
    let output = sinew(&["trend", SESSIONS, "--tensioned", "2025-03-01"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains(
            "366 days after the tensioning on 2025-03-01; earlier creep unknown; check the year"
        ),
        "{said}"
    );
}

#[test]
fn invalid_input_error_names_location() {
    for (args, code, words) in [
        (vec!["trend"], 2, "Usage"),
        (vec!["trend", "no-such.csv"], 1, "no-such.csv"),
        (
            vec!["trend", SESSIONS, "--tensioned", "soon"],
            2,
            "not a date",
        ),
        (
            vec!["trend", SESSIONS, "--tensioned", "knee=2026-03-02"],
            1,
            "knee",
        ),
        // After the last session, 2026-06-19.
        (
            vec!["trend", SESSIONS, "--tensioned", "2026-07-01"],
            1,
            "after its last session on 2026-06-19",
        ),
        (vec!["trend", "Cargo.toml"], 1, "not JSON"),
        (vec!["trend", SESSIONS, "--csv", SESSIONS], 1, "same file"),
        (
            vec!["trend", SESSIONS, "--robot", "robots/none"],
            1,
            "robots/none",
        ),
    ] {
        let output = sinew(&args);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{args:?}: {error}");
        assert!(error.contains(words), "{args:?}: {error}");
    }
}
