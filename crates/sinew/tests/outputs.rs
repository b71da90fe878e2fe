//! Time series as CSV and Parquet contain identical numbers.

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use std::fs::File;
use std::path::Path;
use std::process::Command;

/// Returns the output of a command that succeeds, or exceeds a limit.
fn ok(args: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sinew"));
    command
        .args(args)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let output = command.output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        matches!(output.status.code(), Some(0 | 3)),
        "{args:?}: {told}"
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Header and rows of a table as text; numbers as the shortest text that reads back the same.
fn csv(path: &Path) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_path(path)
        .unwrap();
    let rows = reader.records().map(Result::unwrap);
    rows.map(|row| row.iter().map(str::to_owned).collect())
        .collect()
}

fn parquet(path: &Path) -> Vec<Vec<String>> {
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let schema = reader.metadata().file_metadata().schema();
    let names = schema
        .get_fields()
        .iter()
        .map(|field| field.name().to_owned());
    let mut out = vec![names.collect::<Vec<_>>()];
    for row in reader.get_row_iter(None).unwrap() {
        let row = row.unwrap();
        let text = |(_, field): (&String, &Field)| match field {
            Field::Null => String::new(),
            Field::Str(text) => text.clone(),
            Field::Double(x) => format!("{x:?}"),
            Field::Long(x) => x.to_string(),
            Field::Bool(x) => x.to_string(),
            other => panic!("{other}"),
        };
        out.push(row.get_column_iter().map(text).collect());
    }
    out
}

/// Runs a command twice, once for CSV and once for Parquet, and returns the table that both hold.
fn both(folder: &Path, command: &[&str], option: &str) -> Vec<Vec<String>> {
    let [one, other] = ["a.csv", "a.parquet"].map(|name| folder.join(name));
    for path in [&one, &other] {
        let path = path.to_str().unwrap();
        ok(&[command, &[option, path]].concat());
    }
    let (one, other) = (csv(&one), parquet(&other));
    assert!(one.len() > 1, "{command:?}: {one:?}");
    assert_eq!(one, other, "{command:?}");
    one
}

/// Returns the cells of a column without header.
fn column<'a>(table: &'a [Vec<String>], name: &str) -> Vec<&'a str> {
    let at = table[0].iter().position(|found| found == name);
    let at = at.unwrap_or_else(|| panic!("no {name} in {:?}", table[0]));
    table[1..].iter().map(|row| row[at].as_str()).collect()
}

#[test]
fn series_csv_equals_parquet() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let creep = "examples/06-creep-test/rope-C.csv";
    let sessions = "examples/10-trend/sessions.csv";
    let robot = "robots/biorob-like";

    let predict = [
        "rope",
        "predict",
        "liros-dc000-0301",
        "--tension",
        "60",
        "--length",
        "700",
    ];
    let table = both(at, &predict, "--series");
    let times = column(&table, "time_s");
    assert!(times.len() > 80 && times[0] == "60.0", "{times:?}");
    assert_eq!(times.last(), Some(&"31557600.0"));

    let table = both(
        at,
        &["trend", sessions, "--robot", robot, "--quiet"],
        "--series",
    );
    let kinds = column(&table, "kind");
    assert!(kinds.contains(&"session") && kinds.contains(&"forecast"));
    both(
        at,
        &["trend", sessions, "--robot", robot, "--quiet"],
        "--csv",
    );

    let table = both(at, &["creep", "analyze", creep, "--quiet"], "--series");
    assert_eq!(column(&table, "time_s").len(), table.len() - 1);
    both(at, &["creep", "analyze", creep, "--quiet"], "--csv");
    let fit = [
        "creep",
        "fit",
        creep,
        "--quiet",
        "--law",
        "findley",
        "--forecast",
        "24h",
    ];
    let table = both(at, &fit, "--series");
    assert!(column(&table, "kind").contains(&"forecast"));
    both(at, &["bench", "simulate", "E", "--draws", "20"], "--csv");
}

#[test]
fn series_has_both_methods_and_utc() {
    let folder = tempfile::tempdir().unwrap();
    let log = "examples/01-stretched-arm/stretched-arm.mcap";
    let estimate = ["estimate", log, "--robot", "robots/biorob-like", "--quiet"];
    let table = both(folder.path(), &estimate, "--series");
    let (methods, times) = (column(&table, "method"), column(&table, "time_s"));
    let utc = column(&table, "time_utc_ns");
    let (mean, std) = (
        column(&table, "offset_rad"),
        column(&table, "offset_std_rad"),
    );
    let document: serde_json::Value =
        serde_json::from_str(&ok(&[&estimate[..], &["--json"]].concat())).unwrap();
    let start = document["reading"]["recording"]["start_time_ns"]
        .as_i64()
        .unwrap();
    for (at, time) in times.iter().enumerate() {
        let ns = start + (1e9 * time.parse::<f64>().unwrap()).round() as i64;
        assert_eq!(utc[at], ns.to_string());
        // A reading is no verdict: it has no standard deviation.
        assert_eq!(methods[at] == "absolute", !std[at].is_empty(), "{at}");
    }
    // The last block equals the result up to the last 0.2 s.
    let joint = &document["session"]["joints"][0];
    let name = joint["name"].as_str().unwrap();
    let joints = column(&table, "joint");
    let last = (0..times.len())
        .rev()
        .find(|&k| methods[k] == "absolute" && joints[k] == name);
    let offset: f64 = mean[last.unwrap()].parse().unwrap();
    let said = joint["offset_rad"]["mean"].as_f64().unwrap();
    assert!((offset - said).abs() < 1e-6, "{offset} {said}");

    let frames = both(folder.path(), &estimate, "--csv");
    assert_eq!(frames[0][..2], ["time_ns", "time_s"]);
}

/// With `--online` the online estimate answers, too: at the end, over time, and when it was provisional.
#[test]
fn live_option_reports_online_estimate() {
    let folder = tempfile::tempdir().unwrap();
    let log = "examples/01-stretched-arm/stretched-arm.mcap";
    let robot = "robots/biorob-like";
    let estimate = ["estimate", log, "--robot", robot, "--quiet", "--online"];
    let table = both(folder.path(), &estimate, "--series");
    let (methods, joints) = (column(&table, "method"), column(&table, "joint"));
    let of = |method: &str| methods.iter().filter(|m| **m == method).count();
    assert_eq!(of("online"), of("absolute"));
    let document: serde_json::Value =
        serde_json::from_str(&ok(&[&estimate[..], &["--json"]].concat())).unwrap();
    let online = &document["session"]["online"];
    let tendon = &online["joints"][2];
    let last = (0..methods.len()).rfind(|&k| methods[k] == "online" && joints[k] == "elbow");
    let mean: f64 = column(&table, "offset_rad")[last.unwrap()].parse().unwrap();
    assert_eq!(tendon["name"], "elbow");
    assert!((tendon["offset_rad"]["mean"].as_f64().unwrap() - mean).abs() < 1e-9);
    let text = ok(&estimate);
    assert!(
        text.contains("Online estimate at the end of the recording"),
        "{text}"
    );
    assert!(text.contains("was provisional from "), "{text}");
    // Only if requested.
    assert!(!ok(&estimate[..5]).contains("Online estimate"));
}

#[test]
fn simulated_mcap_equals_parquet() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "examples/scenarios/stretched-arm.toml";
    let mut answers = Vec::new();
    for name in ["a.mcap", "a.parquet"] {
        let path = folder.path().join(name);
        let path = path.to_str().unwrap();
        ok(&[
            "simulate",
            scenario,
            "--duration",
            "12",
            "--out",
            path,
            "--quiet",
        ]);
        let text = ok(&["estimate", path, "--robot", "robots/biorob-like", "--json"]);
        let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
        answers.push(answer["session"]["joints"].clone());
    }
    assert_eq!(answers[0], answers[1]);
}

/// A folder with three recordings, the second of which is invalid.
fn recordings() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "examples/scenarios/stretched-arm.toml";
    for (name, seed) in [("run_1.mcap", "1"), ("run_10.mcap", "2")] {
        let path = folder.path().join(name);
        let path = path.to_str().unwrap();
        ok(&[
            "simulate",
            scenario,
            "--duration",
            "40",
            "--seed",
            seed,
            "--out",
            path,
            "--quiet",
        ]);
    }
    std::fs::write(folder.path().join("run_2.mcap"), "not a recording").unwrap();
    folder
}

fn run(args: &[&str]) -> std::process::Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sinew"));
    command
        .args(args)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    command.output().unwrap()
}

#[test]
fn each_continues_after_failed_recording() {
    let folder = recordings();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let robot = ["--robot", "robots/biorob-like"];
    let (pattern, table) = (at("*.mcap"), at("all.csv"));
    let each = ["estimate", "--each", &pattern, robot[0], robot[1]];
    let output = run(&[&each[..], &["--table", &table, "--json"]].concat());
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    // Some failed: data was lost.
    assert_eq!(output.status.code(), Some(3), "{told}");
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let found = document["recordings"].as_array().unwrap();
    let names: Vec<&str> = found
        .iter()
        .map(|r| r["recording"].as_str().unwrap())
        .collect();
    // Numbers in their order.
    assert_eq!(
        names,
        [at("run_1.mcap"), at("run_2.mcap"), at("run_10.mcap")]
    );
    assert!(found[1]["error"].as_str().unwrap().contains("run_2.mcap"));

    // Each result equals that of a single recording.
    let alone = ok(&["estimate", names[2], robot[0], robot[1], "--json"]);
    let alone: serde_json::Value = serde_json::from_str(&alone).unwrap();
    assert_eq!(found[2]["estimate"]["session"], alone["session"]);

    let rows = csv(Path::new(&table));
    let joints = alone["session"]["joints"].as_array().unwrap().len();
    assert_eq!(rows.len(), 1 + joints + 1 + joints);
    let (errors, offsets) = (column(&rows, "error"), column(&rows, "offset_rad"));
    for (error, offset) in errors.iter().zip(&offsets) {
        assert_eq!(error.is_empty(), !offset.is_empty(), "{rows:?}");
    }
    let parquet_table = at("all.parquet");
    run(&[&each[..], &["--table", &parquet_table, "--quiet"]].concat());
    assert_eq!(parquet(Path::new(&parquet_table)), rows);
}

#[test]
fn each_all_failed_exits_1_several_logs_require_each() {
    let folder = tempfile::tempdir().unwrap();
    let bad = ["a.mcap", "b.mcap"].map(|name| {
        let path = folder.path().join(name);
        std::fs::write(&path, "no").unwrap();
        path.to_str().unwrap().to_owned()
    });
    let robot = ["--robot", "robots/biorob-like"];
    let output = run(&["estimate", "--each", &bad[0], &bad[1], robot[0], robot[1]]);
    assert_eq!(output.status.code(), Some(1));
    let (said, told) = (
        String::from_utf8_lossy(&output.stdout).into_owned(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    );
    assert!(told.contains("(2 failed)"), "{told}");
    assert!(said.contains("0 of 2 recordings estimated"), "{said}");
    for line in said.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    let output = run(&["estimate", &bad[0], &bad[1], robot[0], robot[1]]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1));
    assert!(told.contains("--each"), "{told}");
}

/// Joint, interface and value.
type Entry = (String, String, f64);

/// Every message of a topic with its stamp, by our own decoder.
fn tendons(path: &Path, topic: &str) -> Vec<(i64, Vec<Entry>)> {
    use sinew_log::decode::{Field, MessageKind, parse, stamp_ns};
    let bytes = std::fs::read(path).unwrap();
    let all = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap);
    let mut out = Vec::new();
    let mut before = 0;
    for message in all {
        assert!(
            message.log_time >= before,
            "messages are in the order of times"
        );
        before = message.log_time;
        if message.channel.topic != topic {
            continue;
        }
        let schema = message.channel.schema.as_ref().unwrap();
        assert_eq!(schema.encoding, "ros2msg");
        let kind = MessageKind::of_schema(&schema.name).unwrap();
        let stamp = stamp_ns(&message.data).unwrap();
        assert_eq!(stamp as u64, message.log_time);
        let parsed = parse(kind, &message.data).unwrap();
        assert!(!parsed.short);
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
        let entries = parsed.entries.iter().map(|entry| {
            let Field::Interface(interface) = entry.field else {
                panic!("{entry:?}")
            };
            let value = message.data[entry.at..].first_chunk::<8>().unwrap();
            (
                text(entry.joint),
                text(interface),
                f64::from_le_bytes(*value),
            )
        });
        out.push((stamp, entries.collect()));
    }
    out
}

#[test]
fn topics_equal_series_with_recording_times() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let log = "examples/01-stretched-arm/stretched-arm.mcap";
    let (topics, series) = (at("a.mcap"), at("a.csv"));
    for (method, topic, rows) in [
        ("absolute", "/sinew/tendons", "absolute"),
        ("absolute", "/sinew/reading", "paper"),
        ("paper", "/sinew/tendons", "paper"),
    ] {
        ok(&[
            "estimate",
            log,
            "--robot",
            "robots/biorob-like",
            "--quiet",
            "--method",
            method,
            "--mcap",
            &topics,
            "--series",
            &series,
        ]);
        let table = csv(Path::new(&series));
        let names = [
            "offset_rad",
            "offset_std_rad",
            "elongation_m",
            "strain_ratio",
        ];
        let cells = names.map(|name| column(&table, name));
        let (methods, joints) = (column(&table, "method"), column(&table, "joint"));
        let utc = column(&table, "time_utc_ns");
        let mut wanted = Vec::new();
        for row in (0..methods.len()).filter(|&k| methods[k] == rows && !cells[0][k].is_empty()) {
            for (interface, cell) in sinew_report::topics::INTERFACES.iter().zip(&cells) {
                let value = cell[row].parse().unwrap_or(f64::NAN);
                wanted.push((
                    utc[row].to_owned(),
                    joints[row].to_owned(),
                    *interface,
                    value,
                ));
            }
        }
        let mut found = Vec::new();
        for (stamp, entries) in tendons(Path::new(&topics), topic) {
            for (joint, interface, value) in entries {
                found.push((stamp.to_string(), joint, interface, value));
            }
        }
        wanted.sort_by(|a, b| (&a.0, &a.1, a.2).cmp(&(&b.0, &b.1, b.2)));
        found.sort_by(|a, b| (&a.0, &a.1, &a.2).cmp(&(&b.0, &b.1, &b.2)));
        assert!(found.len() > 100, "{method} {topic}");
        assert_eq!(
            format!("{found:?}"),
            format!("{wanted:?}"),
            "{method} {topic}"
        );
    }
}

#[test]
fn replaced_file_is_reported_unless_quiet() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("curve.csv");
    let path = path.to_str().unwrap();
    let predict = [
        "rope",
        "predict",
        "liros-dc000-0301",
        "--tension",
        "60",
        "--length",
        "700",
    ];
    let told = |more: &[&str]| {
        let output = run(&[&predict[..], &["--series", path], more].concat());
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8(output.stderr).unwrap()
    };
    let replaces = format!("--series replaced the existing file {path}");
    assert!(!told(&[]).contains(&replaces));
    assert!(told(&[]).contains(&replaces));
    assert_eq!(told(&["--quiet"]), "");
    // What is refused has replaced nothing.
    let output = run(&[
        "rope",
        "predict",
        "no-rope",
        "--tension",
        "60",
        "--length",
        "700",
        "--series",
        path,
    ]);
    assert_eq!(output.status.code(), Some(1));
    assert!(!String::from_utf8_lossy(&output.stderr).contains("replaced"));
}
