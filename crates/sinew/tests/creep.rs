//! The example of creep tests, and what is refused, through the program.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn sinew(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew"))
        .current_dir(root().join("examples/06-creep-test"))
        .args(arguments)
        .output()
        .unwrap()
}

fn json(arguments: &[&str]) -> serde_json::Value {
    let output = sinew(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    serde_json::from_slice(&output.stdout).unwrap()
}

const ROPES: [&str; 3] = ["rope-A.csv", "rope-B.csv", "rope-C.csv"];

#[test]
fn analyze_example_recovers_truth() {
    let report = json(&[
        "creep", "analyze", ROPES[0], ROPES[1], ROPES[2], "--json", "--quiet",
    ]);
    let specimens = report["specimens"].as_array().unwrap();
    assert_eq!(specimens.len(), 3);
    // Made with b = 0.030, 0.018 and 0.041 %: the mean slope between 20 and 85 min is
    // b ln(5132.5/1232.5) / 1.083 h, and the wave of 0.0004 % tilts it by 0.0008 %/h at most.
    for (specimen, b) in specimens.iter().zip([0.030, 0.018, 0.041]) {
        let slope = &specimen["slope_per_s"];
        let truth = b * (5132.5_f64 / 1232.5).ln() / (3900.0 / 3600.0);
        // A straight line weighs the middle: 8 % off the mean slope of a logarithm.
        let of = |key: &str| 3.6e5 * slope[key].as_f64().unwrap();
        let value = of("value");
        assert!((value / truth - 1.0).abs() < 0.12, "{specimen}");
        assert!(of("low") < value && value < of("high"));
        assert_eq!(specimen["recovery"].as_array().unwrap().len(), 1);
        assert!((specimen["force_n"].as_f64().unwrap() - 60.0).abs() < 0.1);
        assert!((specimen["preload_n"].as_f64().unwrap() - 2.0).abs() < 0.1);
    }
    let kinds = |i: usize| -> Vec<String> {
        let artefacts = specimens[i]["artefacts"].as_array().unwrap();
        artefacts
            .iter()
            .map(|f| f["kind"].as_str().unwrap().to_owned())
            .collect()
    };
    assert!(!kinds(0).contains(&"slip".to_owned()), "{:?}", kinds(0));
    assert!(kinds(2).contains(&"slip".to_owned()), "{:?}", kinds(2));
}

/// At the change of the load the bench writes two rows at one time.
#[test]
fn analyze_simulated_bench_recovers_at_load_change() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("e.csv");
    let csv = csv.to_str().unwrap();
    let run = json(&["bench", "simulate", "E", "--csv", csv, "--json"]);
    let report = json(&["creep", "analyze", csv, "--json", "--quiet"]);
    let rows = run["readings"].as_array().unwrap();
    let number = |row: usize, key: &str| rows[row][key].as_f64().unwrap();
    let strain = |row: usize| rows[row]["strain_ratio"]["value"].as_f64().unwrap();
    let change = (1..rows.len())
        .find(|&row| number(row, "force_n") < number(row - 1, "force_n"))
        .unwrap();
    assert_eq!(number(change, "time_s"), number(change - 1, "time_s"));
    let specimen = &report["specimens"][0];
    let recovery = &specimen["recovery"][0];
    let last = strain(rows.len() - 1);
    for (found, expected) in [
        (&specimen["end_strain_ratio"], strain(change - 1)),
        (&recovery["before_strain_ratio"], strain(change - 1)),
        (
            &recovery["immediate_strain_ratio"],
            strain(change - 1) - strain(change),
        ),
        (&recovery["delayed_strain_ratio"], strain(change) - last),
    ] {
        let found = found.as_f64().unwrap();
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        assert!(found > 0.0);
    }
    let kinds: Vec<&str> = specimen["artefacts"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|artefact| artefact["kind"].as_str())
        .collect();
    assert_eq!(kinds, ["no-ramp"]);
}

#[test]
fn fit_example_selects_true_law() {
    let report = json(&["creep", "fit", "rope-A.csv", "--json", "--quiet"]);
    let best = &report["fits"][0]["laws"][0];
    assert_eq!(best["law"], "log-time", "{best}");
    let b = best["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .find(|p| p["name"] == "b")
        .unwrap();
    let of = |key: &str| b[key].as_f64().unwrap();
    assert!(of("low") < 0.030 && 0.030 < of("high"), "{b}");
}

#[test]
fn compare_writes_ranking_and_figure() {
    let folder = tempfile::tempdir().unwrap();
    let (plot, page) = (
        folder.path().join("ropes.png"),
        folder.path().join("ropes.html"),
    );
    let report = json(&[
        "creep",
        "compare",
        ROPES[0],
        ROPES[1],
        ROPES[2],
        "--json",
        "--quiet",
        "--plot",
        plot.to_str().unwrap(),
        "--report",
        page.to_str().unwrap(),
        "--preconditioning",
        "none",
    ]);
    let order: Vec<&str> = report["ranks"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["name"].as_str().unwrap())
        .collect();
    assert_eq!(order, ["rope-B", "rope-C", "rope-A"]);
    assert!(std::fs::read(plot).unwrap().starts_with(b"\x89PNG"));
    let page = std::fs::read_to_string(page).unwrap();
    for wanted in ["ISO 899-1", "SHA-256", "Preconditioning", "grip slip"] {
        assert!(page.contains(wanted), "{wanted}");
    }
}

#[test]
fn fitted_rope_is_read_by_rope_commands() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my-rope.toml");
    let ropes = folder.path().to_str().unwrap();
    let report = json(&[
        "creep",
        "fit",
        ROPES[0],
        "--rope",
        "liros-dc000-0301",
        "--law",
        "rope",
        "--write-rope",
        file.to_str().unwrap(),
        "--json",
        "--quiet",
    ]);
    let fit = &report["fits"][0]["laws"][0];
    assert_eq!(fit["law"], "rope");
    assert!(!fit["fixed"].as_array().unwrap().is_empty());
    let shown = json(&["rope", "show", "my-rope", "--ropes", ropes, "--json"]);
    let bedding = &shown["law"]["bedding_percent"];
    assert_eq!(bedding["origin"], "fitted", "{bedding}");
    assert_eq!(bedding["date"].as_str().unwrap().len(), 10);
    assert!(bedding["factor"].is_number() || bedding["plus_minus"].is_number());
    let source = shown["sources"]["creep-fit"].as_str().unwrap();
    assert!(source.contains("rope-A.csv (SHA-256 "), "{source}");
    let energy = &shown["law"]["bedding_energy_j_per_mol"];
    assert_eq!(energy["origin"], "assumed");
    let told = json(&[
        "rope",
        "predict",
        "my-rope",
        "--ropes",
        ropes,
        "--tension",
        "60",
        "--at",
        "85min",
        "--json",
    ]);
    // The record ends at 0.75 % under 60 N.
    let strain = &told["readings"][0]["strain_ratio"];
    let of = |key: &str| 100.0 * strain[key].as_f64().unwrap();
    assert!((of("value") - 0.75).abs() < 0.1, "{strain}");
}

#[test]
fn plan_writes_table_and_programme() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("programme.csv");
    let asked = [
        "creep",
        "plan",
        "liros-dc000-0301",
        "--tension",
        "100",
        "--length",
        "700",
        "--at",
        "30d",
        "--quiet",
        "--loads",
        "60,200",
        "--temperatures",
        "23",
        "--durations",
        "85min",
        "--bench-time",
        "5h",
    ];
    fn with<'a>(asked: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
        [asked, more].concat()
    }
    for (loads, words) in [
        (
            "60,5000",
            "5000 N exceeds the breaking load of liros-dc000-0301 (4450 N)",
        ),
        ("3", "more than 3 N"),
    ] {
        let refused = sinew(&with(&asked[..10], &["--loads", loads]));
        assert_eq!(refused.status.code(), Some(1), "{loads}");
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(words), "{said}");
    }
    let plan = json(&with(&asked, &["--json", "--csv", csv.to_str().unwrap()]));
    let tests = plan["tests"].as_array().unwrap();
    assert!(!tests.is_empty(), "{plan}");
    let of = |v: &serde_json::Value, key: &str| v[key].as_f64().unwrap();
    assert!(of(&plan, "bench_s") <= 5.0 * 3600.0, "{plan}");
    // One record may widen it: what is fitted starts from less than the entry knew. The programme narrows it.
    let last = |plan: &serde_json::Value| {
        let tests = plan["tests"].as_array().unwrap();
        of(tests.last().unwrap(), "half_width_share")
    };
    assert!(last(&plan) < of(&plan, "half_width_share"));
    let text = std::fs::read_to_string(csv).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("test,time_s,force_n,temperature_c,reading")
    );
    // Preload first, then the load of the test, without a reading at the step.
    let first = of(&tests[0]["test"], "load_n");
    assert_eq!(lines.next(), Some("1.0,0.0,2.0,23.0,1.0"));
    assert_eq!(
        lines.next(),
        Some(format!("1.0,60.0,{first:.1},23.0,0.0").as_str())
    );
    // An existing record is included in the fit.
    let existing = json(&with(&asked, &["--json", "--with", "rope-A.csv"]));
    assert_eq!(existing["existing"], 1);
    assert!(last(&existing) < of(&existing, "half_width_share"));
    // A record with less information than the entry does not widen the interval.
    assert!(of(&existing, "half_width_share") <= of(&plan, "half_width_share"));
    let table = sinew(&asked);
    let table = String::from_utf8(table.stdout).unwrap();
    assert!(table.lines().all(|l| l.chars().count() <= 80), "{table}");
    for wanted in [
        "present 95 % interval",
        "test 1: ",
        "95 % interval",
        "on the bench",
    ] {
        assert!(table.contains(wanted), "{wanted}: {table}");
    }
}

#[test]
fn numeric_groups_have_one_line_each() {
    let output = sinew(&[
        "creep",
        "fit",
        ROPES[0],
        ROPES[1],
        "--law",
        "log-time",
        "--group",
        "Temperature (C)",
        "--quiet",
    ]);
    let text = String::from_utf8(output.stdout).unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        text.contains("n: tests; failed: not fitted") && text.contains("\n23 "),
        "{text}{errors}"
    );
}

#[test]
fn unknown_group_error_lists_columns() {
    for command in ["analyze", "fit"] {
        let asked = [
            "creep", command, ROPES[0], ROPES[1], "--group", "Rop", "--quiet",
        ];
        let output = sinew(&asked);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(
            !output.status.success() && output.stdout.is_empty(),
            "{output:?}"
        );
        assert!(
            errors.contains("--group Rop: column not found; available: "),
            "{errors}"
        );
        assert!(errors.contains("Temperature (C)"), "{errors}");
    }
}

#[test]
fn tables_stay_within_80_columns() {
    for arguments in [
        &["creep", "analyze", "rope-A.csv", "--quiet"][..],
        &[
            "creep",
            "fit",
            "rope-A.csv",
            "--quiet",
            "--law",
            "log-time",
            "--law",
            "findley",
            "--forecast",
            "100h",
        ],
        &["creep", "compare", "rope-A.csv", "rope-B.csv", "--quiet"],
        &[
            "creep",
            "fit",
            "rope-A.csv",
            "--quiet",
            "--rope",
            "liros-dc000-0301",
            "--law",
            "rope",
        ],
        &[
            "creep",
            "fit",
            "rope-A.csv",
            "rope-B.csv",
            "--quiet",
            "--hold-out",
            "0.33",
        ],
    ] {
        let output = sinew(arguments);
        let text = String::from_utf8(output.stdout).unwrap();
        println!("{text}");
        assert!(
            !text.is_empty(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        for line in text.lines() {
            assert!(line.chars().count() <= 80, "{line}");
        }
    }
}

#[test]
fn errors_suggest_fix_and_leave_no_files() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    let page = page.to_str().unwrap();
    for (arguments, wanted) in [
        (
            &["creep", "analyze", "none.csv", "--report", page][..],
            "none.csv",
        ),
        (&["creep", "analyze", "make.py", "--report", page], "header"),
        (
            &[
                "creep",
                "analyze",
                "rope-A.csv",
                "--column",
                "strain=elongation_mm:1",
                "--report",
                page,
            ],
            "m/m",
        ),
        (
            &[
                "creep",
                "analyze",
                "rope-A.csv",
                "--group",
                "colour",
                "--report",
                page,
            ],
            "colour",
        ),
        (
            &[
                "creep",
                "fit",
                "rope-A.csv",
                "--law",
                "rope",
                "--report",
                page,
            ],
            "--rope NAME",
        ),
        (
            &[
                "creep",
                "fit",
                "rope-A.csv",
                "rope-B.csv",
                "--rope",
                "liros-dc000-0301",
                "--law",
                "rope",
                "--write-rope",
                "x.toml",
                "--report",
                page,
            ],
            "--joint group",
        ),
        (
            &[
                "creep",
                "analyze",
                "rope-A.csv",
                "--level",
                "40%",
                "--report",
                page,
            ],
            "--level",
        ),
        (
            &[
                "creep",
                "plan",
                "liros-dc000-0301",
                "--tension",
                "100",
                "--length",
                "700",
                "--bench-time",
                "0.5h",
                "--csv",
                page,
            ],
            "no test fits into 0.5 h on the bench",
        ),
    ] {
        let output = sinew(arguments);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {errors}");
        assert!(errors.contains(wanted), "{arguments:?}: {errors}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn shares_outside_their_range_are_usage_errors() {
    for (command, option, value, wanted) in [
        ("fit", "--hold-out", "2", "between 0 and 1"),
        ("compare", "--scatter", "0", "above 0"),
        ("analyze", "--level", "95", "0 and 100 %"),
    ] {
        let output = sinew(&["creep", command, "rope-A.csv", option, value]);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{option}: {errors}");
        assert!(
            errors.contains(option) && errors.contains(wanted),
            "{errors}"
        );
    }
}

/// A file of rows `time_s,force_N,elongation_mm` of a rope of 350 mm.
fn made(rows: impl Iterator<Item = (f64, f64, f64)>) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.csv");
    let rows: String = rows.map(|(t, f, e)| format!("{t},{f},{e}\n")).collect();
    let head = "L0 (mm),350\ntime_s,force_N,elongation_mm\n";
    std::fs::write(&path, head.to_owned() + &rows).unwrap();
    let path = path.to_str().unwrap().to_owned();
    (folder, path)
}

#[test]
fn forecast_states_load_of_test() {
    let report = json(&[
        "creep",
        "fit",
        "rope-A.csv",
        "--law",
        "log-time",
        "--forecast",
        "8760h",
        "--json",
        "--quiet",
    ]);
    let conditions = &report["fits"][0]["forecast_conditions"];
    assert_eq!(conditions["source"], "held");
    assert!(
        (conditions["load_n"].as_f64().unwrap() - 60.0).abs() < 0.1,
        "{conditions}"
    );
    assert_eq!(conditions["temperature_c"], 23.0);
    // Made with 0.030 % per e-folding; the record ends at 2 N, an hour after 85 min at 60 N.
    let forecast = &report["fits"][0]["forecast"]["strain_ratio"];
    let last = forecast
        .as_array()
        .unwrap()
        .last()
        .unwrap()
        .as_f64()
        .unwrap();
    let held = report_end();
    let more = 0.0003 * (8760.0 * 60.0 / 85.0_f64).ln();
    assert!(
        (last - held - more).abs() < 0.1 * more,
        "{last} {held} {more}"
    );
    let table = sinew(&[
        "creep",
        "fit",
        "rope-A.csv",
        "--law",
        "log-time",
        "--forecast",
        "8760h",
        "--quiet",
    ]);
    let text = String::from_utf8(table.stdout).unwrap();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        text.contains("under 60.0 N at 23.0 °C, conditions of the test"),
        "{text}"
    );
    let output = sinew(&[
        "creep",
        "fit",
        "rope-A.csv",
        "--law",
        "log-time",
        "--forecast",
        "9h",
        "--forecast-load",
        "90N",
    ]);
    assert_eq!(output.status.code(), Some(3));
    let text = String::from_utf8_lossy(&output.stdout);
    let errors = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        errors.contains("90 N is outside the tested range (60.0 to 60.0 N)"),
        "{errors}"
    );
}

/// Strain of rope A at the end of its 85 min under load, m/m.
fn report_end() -> f64 {
    let report = json(&["creep", "analyze", "rope-A.csv", "--json", "--quiet"]);
    let recovery = &report["specimens"][0]["recovery"][0];
    recovery["before_strain_ratio"].as_f64().unwrap()
}

#[test]
fn hold_out_short_test_reports_no_coverage() {
    let (_folder, path) =
        made((0..7).map(|i| (60.0 * f64::from(i), 60.0, 1.0 + 0.01 * f64::from(i))));
    let output = sinew(&["creep", "fit", &path, "--hold-out", "0.5", "--quiet"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        !text.contains("NaN") && text.contains("No forecast: "),
        "{text}"
    );
    assert_eq!(output.status.code(), Some(3), "{text}");
}

#[test]
fn inverted_elongation_is_reported() {
    let creep = |i: i32| 1.0 + 0.1 * (1.0 + f64::from(i)).ln();
    let rows = |sign: f64| {
        let before = (-20..0).map(|i| (f64::from(i), 2.0, 0.0));
        before.chain((0..200).map(move |i| (2.0 + 20.0 * f64::from(i), 60.0, sign * creep(i))))
    };
    for (sign, told) in [(1.0, false), (-1.0, true)] {
        let (_folder, path) = made(rows(sign));
        let report = json(&["creep", "analyze", &path, "--json", "--quiet"]);
        let artefacts = report["specimens"][0]["artefacts"].as_array().unwrap();
        let found = artefacts.iter().any(|f| f["kind"] == "shortens");
        assert_eq!(found, told, "{artefacts:?}");
    }
}

#[test]
fn several_errors_are_printed_on_separate_lines() {
    let (_one, first) = made([(0.0, 1.0, 0.1)].into_iter());
    let (_two, second) = made([(0.0, 1.0, 0.1)].into_iter());
    let output = sinew(&["creep", "analyze", &first, &second]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        !errors.contains('\u{fffd}') && errors.lines().count() >= 2,
        "{errors}"
    );
}
