//! `sinew rope` and `sinew bench` as a user meets them.

use crate::skipped::skipped;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn sinew(args: &[&str], dir: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(dir)
        .output()
        .expect("the program starts")
}

/// Stdout of a command that must succeed.
#[track_caller]
fn told(args: &[&str], dir: &Path) -> String {
    let output = sinew(args, dir);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{args:?}: {errors}");
    let text = String::from_utf8(output.stdout).expect("stdout is UTF-8");
    for line in text.lines() {
        assert!(
            // A rope file is for an editor, not for a terminal.
            line.chars().count() <= 80 || args.contains(&"--json") || args.contains(&"--toml"),
            "{line}"
        );
    }
    text
}

#[track_caller]
fn refused(args: &[&str], dir: &Path, exit: i32, words: &[&str]) {
    let output = sinew(args, dir);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(exit), "{args:?}: {message}");
    assert!(output.stdout.is_empty(), "{args:?}");
    for word in words {
        assert!(
            message.contains(word),
            "{args:?}: '{word}' is not in: {message}"
        );
    }
    assert!(!message.contains("panicked"), "{message}");
}

fn empty() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn robot() -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/biorob-like");
    path.display().to_string()
}

#[track_caller]
fn json(args: &[&str], dir: &Path) -> serde_json::Value {
    serde_json::from_str(&told(args, dir)).expect("JSON")
}

#[test]
fn catalogue_is_built_in() {
    let dir = empty();
    let list = told(&["rope", "list"], dir.path());
    assert_eq!(list.matches("/26").count(), 15, "{list}");
    let show = told(&["rope", "show", "tu-chemnitz-vectran"], dir.path());
    assert!(
        show.contains("not published: breaking_load_n, weight_g_per_m"),
        "{show}"
    );
    assert!(show.contains("assumed"));
    let words = [
        "no rope 'liros-dc000-301'",
        "did you mean 'liros-dc000-0301'",
    ];
    refused(&["rope", "show", "liros-dc000-301"], dir.path(), 1, &words);
}

#[test]
fn user_rope_from_builtin_template_is_valid() {
    let dir = empty();
    std::fs::create_dir(dir.path().join("ropes")).expect("made");
    let text = told(&["rope", "show", "liros-dc000-0301", "--toml"], dir.path());
    let own = text.replace("name = \"liros-dc000-0301\"", "name = \"mine\"");
    std::fs::write(dir.path().join("ropes/mine.toml"), &own).expect("written");
    assert!(told(&["rope", "list"], dir.path()).contains("\nmine "));
    let bad = own.replace(
        "toe_percent = { value = 0.2",
        "toe_percent = { value = -0.2",
    );
    std::fs::write(dir.path().join("ropes/bad.toml"), bad).expect("written");
    // An invalid file is an error only for its own rope.
    assert!(told(&["rope", "list"], dir.path()).contains("\nmine "));
    refused(
        &["rope", "show", "bad"],
        dir.path(),
        1,
        &["bad.toml, line", "law.toe_percent.value = -0.2"],
    );
}

#[test]
fn predictions_increase_and_match_stored_value() {
    let dir = empty();
    let args = [
        "rope",
        "predict",
        "liros-dc000-0301",
        "--tension",
        "60",
        "--length",
        "700",
        "--json",
    ];
    let found = json(&args, dir.path());
    let readings = found["readings"].as_array().expect("readings");
    assert_eq!(readings.len(), 4);
    let mut last = 0.0;
    for r in readings {
        let i = &r["since_tensioned_m"];
        let number = |k: &str| i[k].as_f64().expect("a number");
        assert!(number("low") < number("value") && number("value") < number("high"));
        assert!(number("value") >= last);
        last = number("value");
    }
    assert_eq!(
        json(&args, dir.path()),
        found,
        "the same seed gives the same answer"
    );
    let joint = [
        "rope",
        "predict",
        "--robot",
        &robot(),
        "--joint",
        "elbow",
        "--stroke",
        "80",
    ];
    assert!(told(&joint, dir.path()).contains("liros-dc000-0301"));
}

#[test]
fn duty_table_is_read_with_warnings() {
    let dir = empty();
    let duty = dir.path().join("duty.toml");
    std::fs::write(
        &duty,
        "[[block]]\nduration_h = 8\ntension_n = 2000\ntemperature_c = 70\n[[block]]\nduration_h = 16\ntension_n = 20\n",
    )
    .expect("written");
    let args = [
        "rope",
        "predict",
        "liros-dc000-0301",
        "--duty",
        "duty.toml",
        "--draws",
        "20",
    ];
    let output = sinew(&args, dir.path());
    assert_eq!(output.status.code(), Some(3), "45 % at 70 °C breaks it");
    let text = String::from_utf8_lossy(&output.stdout);
    for words in [
        "40 % of the breaking load",
        "1 % of the breaking load",
        "above 65 °C",
    ] {
        assert!(text.contains(words), "{words} is not in {text}");
    }
    std::fs::write(&duty, "[[block]]\nduration_h = 8\ntension_n = -1\n").expect("written");
    refused(
        &args,
        dir.path(),
        1,
        &["duty.toml", "tension_n = -1", "between 0 and 1000000000 N"],
    );
    let args = ["rope", "predict", "liros-dc000-0301"];
    refused(
        &args,
        dir.path(),
        1,
        &["--tension N, --duty FILE or --recording LOG"],
    );
    let args = ["rope", "predict", "liros-dc000-0301", "--tension", "5000"];
    refused(
        &args,
        dir.path(),
        1,
        &["exceeds the breaking load of 4450 N"],
    );
}

#[test]
fn recorded_torques_become_duty() {
    let dir = empty();
    let log = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/01-stretched-arm");
    let log = std::fs::read_dir(log)
        .expect("the example")
        .filter_map(|e| Some(e.ok()?.path()))
        .find(|p| {
            p.extension()
                .is_some_and(|e| e == "mcap" || e == "csv" || e == "parquet")
        });
    let Some(log) = log else {
        skipped("the example has no recording");
        return;
    };
    let log = log.display().to_string();
    let robot = robot();
    let args = [
        "rope",
        "predict",
        "--recording",
        &log,
        "--robot",
        &robot,
        "--joint",
        "elbow",
        "--draws",
        "20",
        "--json",
    ];
    let found = json(&args, dir.path());
    let summary = &found["summary"];
    let number = |k: &str| summary[k].as_f64().expect("a number");
    // Pretension 60 N, and the elbow's torque on top of it, both ways or not.
    assert!(
        number("tension_min_n") >= 0.0 && number("tension_max_n") > 60.0,
        "{summary}"
    );
    assert!(number("tension_max_n") < 1000.0, "{summary}");
    assert_eq!(found["rope"], "liros-dc000-0301");
}

#[test]
fn select_ranks_and_states_reasons() {
    let dir = empty();
    let args = [
        "rope",
        "select",
        "--tension",
        "60",
        "--length",
        "700",
        "--max-diameter",
        "1.9",
        "--pulley-diameter",
        "16",
        "--min-bend-ratio",
        "8",
        "--draws",
        "50",
        "--plot",
        "choice.svg",
    ];
    let text = told(&args, dir.path());
    assert!(
        text.contains("diameter above the limit of 1.9 mm:"),
        "{text}"
    );
    let plot = std::fs::read_to_string(dir.path().join("choice.svg")).expect("a plot");
    assert!(plot.starts_with("<svg") && plot.contains("ockert-climax-combat"));
    let none = [
        "rope",
        "select",
        "--tension",
        "60",
        "--max-diameter",
        "0.2",
        "--draws",
        "20",
    ];
    let output = sinew(&none, dir.path());
    assert_eq!(output.status.code(), Some(3), "no rope is left");
}

#[test]
fn pretension_plans_procedure_and_schedule() {
    let dir = empty();
    let args = [
        "rope",
        "pretension",
        "liros-dc000-0301",
        "--tension",
        "60",
        "--draws",
        "20",
    ];
    let text = told(&args, dir.path());
    assert!(
        text.contains("* mildest sufficient procedure") && text.contains("preconditioned:"),
        "{text}"
    );
    let odd = [
        "rope",
        "pretension",
        "liros-dc000-0301",
        "--tension",
        "60",
        "--lowest",
        "70",
    ];
    refused(&odd, dir.path(), 1, &["--lowest 70 N must be below"]);
    refused(&args[..3], dir.path(), 2, &["--tension"]);
}

/// One year of `liros-dc000-0301`, against an independent implicit solver: times to tension again and
/// the tension at which a rope left alone ends. Tension frozen over steps gave 100 times and 481 to
/// 850 N.
#[test]
fn relaxation_is_stable_at_high_loads() {
    let dir = empty();
    let plan = |tension: &str, celsius: &str| {
        let args = [
            "rope",
            "pretension",
            "liros-dc000-0301",
            "--tension",
            tension,
        ];
        let more = ["--temperature", celsius, "--draws", "20", "--json"];
        json(&[&args[..], &more].concat(), dir.path())
    };
    let ends = |plan: &serde_json::Value, which: &str, times: usize, n: f64| {
        let schedule = &plan[which];
        let found = schedule["tension_at_end_n"]["value"].as_f64().expect("N");
        assert!(
            (found / n - 1.0).abs() < 0.01,
            "{which}: {found} N, not {n}"
        );
        assert_eq!(schedule["times_s"].as_array().expect("times").len(), times);
    };
    let hard = plan("300", "23");
    ends(&hard, "schedule_as_delivered", 7, 81.84);
    ends(&hard, "schedule_preconditioned", 0, 253.0);
    ends(&plan("300", "40"), "schedule_preconditioned", 0, 273.0);
    ends(&plan("600", "23"), "schedule_as_delivered", 6, 165.0);
}

/// 30 % of the breaking load at 60 °C for a year was 948 % of strain and exit code 0.
#[test]
fn failing_rope_reports_lifetime_exits_3() {
    let dir = empty();
    let rope = ["rope", "predict", "teufelberger-fl-9-ng", "--draws", "40"];
    let duty = ["--tension", "1950", "--temperature", "60"];
    let output = sinew(&[&rope[..], &duty].concat(), dir.path());
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(3), "{text}");
    let said = [
        "predicted lifetime 3.9 days (95 %",
        "cause creep rupture",
        "30.0 % of the breaking load",
    ];
    // Lines may end anywhere.
    let joined = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.iter().all(|w| joined.contains(w)), "{text}");
    assert!(
        text.contains("\n1 day") && !text.contains("\n1 year"),
        "{text}"
    );
    // Bending: which portion, and when.
    let bent = [
        "--tension",
        "100",
        "--length",
        "700",
        "--stroke",
        "50",
        "--strokes-per-hour",
        "60",
    ];
    let over = ["--guide", "90:8@300", "--guide", "90:8@330"];
    let output = sinew(&[&rope[..], &bent, &over].concat(), dir.path());
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        text.contains("bending fatigue") && text.contains("\n280.0 *"),
        "{text}"
    );
    // A choice counts strokes.
    let choice = [
        "rope",
        "select",
        "--draws",
        "40",
        "--at",
        "1year",
        "--tension",
        "100",
        "--length",
        "700",
    ];
    let moved = [
        "--stroke",
        "50",
        "--strokes-per-hour",
        "6",
        "--guide",
        "90:8",
    ];
    let text = told(&[&choice[..], &moved].concat(), dir.path());
    assert!(
        text.contains("predicted failure by bending fatigue"),
        "{text}"
    );
}

/// A rope that fails within the planned time is rejected with its predicted lifetime.
#[test]
fn plan_beyond_lifetime_is_error() {
    let dir = empty();
    let rope = [
        "rope",
        "pretension",
        "teufelberger-fl-9-ng",
        "--draws",
        "20",
    ];
    let hard = ["--tension", "1950", "--temperature", "60"];
    let words = [
        "1950 N it breaks by creep rupture after about 4 days",
        "--horizon is 365 days",
        "stronger rope",
    ];
    refused(&[&rope[..], &hard].concat(), dir.path(), 1, &words);
    told(
        &[&rope[..], &hard, &["--horizon", "1d"]].concat(),
        dir.path(),
    );
}

#[test]
fn joint_tendon_plan_uses_mounting() {
    let dir = empty();
    let robot = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/biorob-like");
    let args = [
        "rope",
        "pretension",
        "--robot",
        robot,
        "--joint",
        "elbow",
        "--draws",
        "20",
    ];
    let found = json(&[&args[..], &["--json"]].concat(), dir.path());
    assert_eq!(found["rope"], "liros-dc000-0301");
    assert!((found["length_m"].as_f64().expect("m") - 0.7).abs() < 1e-12);
    // r²/K is 31 µm/N, of which the rope gives 10.
    let give = found["series_compliance_m_per_n"].as_f64().expect("m/N");
    assert!((give - 21.1e-6).abs() < 0.1e-6, "{give}");
    let two = [&args[..], &["--joint-radius", "25", "--torque", "1"]].concat();
    let told = told(&two, dir.path());
    // Lines may end anywhere.
    let text = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("the joint 20 mrad"), "{told}");
    let rope = &["rope", "pretension", "liros-dc000-0301", "--tension", "6"];
    let alone = [&rope[..], &["--torque", "1"]].concat();
    refused(
        &alone,
        dir.path(),
        1,
        &["antagonistic rope", "--joint-radius"],
    );
    let slack = [&rope[..], &["--joint-radius", "20", "--torque", "2.2"]].concat();
    refused(
        &slack,
        dir.path(),
        1,
        &["slackens the second rope", "55.0 N"],
    );
}

#[test]
fn bench_runs_paper_cases_and_user_file() {
    let dir = empty();
    let end = |case: &str| {
        let found = json(
            &["bench", "simulate", case, "--draws", "20", "--json"],
            dir.path(),
        );
        let readings = found["readings"].as_array().expect("readings");
        let last = readings.last().expect("a reading");
        last["strain_ratio"]["value"].as_f64().expect("a number")
    };
    // Every guided strand is longer than a free one; the order of the others depends on the friction of the guides.
    let free = end("A");
    assert!(["B", "C", "D"].iter().all(|case| end(case) > free));
    let bench = "strand_mm = 600\nstroke_mm = 100\nperiod_s = 10\n[[phase]]\nforce_n = 200\nduration_min = 240\n";
    std::fs::write(dir.path().join("own.toml"), bench).expect("written");
    assert_eq!(end("own.toml"), end("A"));
    let csv = ["bench", "simulate", "E", "--draws", "20", "--csv", "e.csv"];
    told(&csv, dir.path());
    let csv = std::fs::read_to_string(dir.path().join("e.csv")).expect("written");
    assert!(csv.starts_with("time_s,tension_n,carriage_force_n,elongation_mm,strain_percent"));
    // Its tables are creep tests: tension of a strand, strain, no options required.
    let found = json(&["creep", "analyze", "e.csv", "--json"], dir.path());
    let specimen = &found["specimens"][0];
    let force_n = specimen["force_n"].as_f64().expect("a load");
    assert!((force_n - 100.0).abs() < 1e-9, "{force_n}");
    assert_eq!(specimen["recovery"][0]["force_after_n"], 60.0);
    let bad =
        bench.to_string() + "[[guide]]\nstrand = 1\nat_mm = 900\nradius_mm = 8\nwrap_deg = 20\n";
    std::fs::write(dir.path().join("own.toml"), bad).expect("written");
    let words = ["own.toml, strand 1", "does not fit"];
    refused(&["bench", "simulate", "own.toml"], dir.path(), 1, &words);
    refused(
        &["bench", "simulate", "Z"],
        dir.path(),
        1,
        &["'Z' is neither one of A, B"],
    );
}

#[test]
fn invalid_duties_are_errors_copied_rope_is_noted() {
    let dir = empty();
    let rope = ["rope", "predict", "liros-dc000-0301", "--tension"];
    let ask = |more: &[&'static str]| [&rope[..], more].concat();
    refused(
        &ask(&["4449"]),
        dir.path(),
        1,
        &["4449 N", "breaks by creep rupture"],
    );
    refused(
        &ask(&["60", "--temperature", "200"]),
        dir.path(),
        1,
        &["melts at 144 °C"],
    );
    let long = ["60", "--length", "700", "--stroke", "700"];
    refused(
        &ask(&long),
        dir.path(),
        1,
        &["700 mm is not shorter than the strand of 700 mm"],
    );
    let output = sinew(&ask(&["2000"]), dir.path());
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("creep rupture predicted"), "{text}");
    assert_eq!(output.status.code(), Some(3), "it breaks within the year");
    let knot = ["2000", "--termination", "knot"];
    refused(
        &ask(&knot),
        dir.path(),
        1,
        &["2000 N exceeds its strength of 1869 N", "knotted"],
    );
    let folder = dir.path().join("ropes");
    std::fs::create_dir(&folder).expect("made");
    let entry = told(&["rope", "show", "liros-dc000-0301", "--toml"], dir.path());
    std::fs::write(folder.join("mine.toml"), entry).expect("written");
    let output = sinew(&["rope", "list"], dir.path());
    let notes = String::from_utf8_lossy(&output.stderr);
    assert!(notes.contains("with the same name"), "{notes}");
}
