//! Files as people have them: the cases of the shared folder, where it is there.

use crate::skipped::skipped;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder of a case, or `None` with a visible message.
fn case(number: &str) -> Option<PathBuf> {
    let root = std::env::var_os("SINEW_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let cases = root.join("cases");
    if !cases.exists() {
        skipped("shared/cases is not there");
        return None;
    }
    Some(cases.join(number)).filter(|folder| folder.exists())
}

/// Exit code and output of a command.
fn run(folder: &Path, args: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(folder)
        .output()
        .expect("the program starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let said = text(&output.stdout) + &text(&output.stderr);
    let said: Vec<&str> = said.split_whitespace().collect();
    (output.status.code().expect("not killed"), said.join(" "))
}

/// Runs a command in the folder of a case, and checks its exit code and output.
#[track_caller]
fn says(number: &str, args: &[&str], code: i32, words: &[&str]) {
    let Some(folder) = case(number) else { return };
    let (found, said) = run(&folder, args);
    assert_eq!(found, code, "{number}: {said}");
    for word in words {
        assert!(said.contains(word), "{number}: '{word}' is not in: {said}");
    }
}

#[test]
fn shared_tables_are_read_or_explained() {
    let info = |file| ["log", "info", file];
    for (number, file) in [("19", "percent-comment.csv"), ("21", "meta.csv")] {
        says(number, &info(file), 0, &["6000", "100.0 Hz", "tilt"]);
    }
    says(
        "18",
        &info("no-header.csv"),
        1,
        &["no header", "column = 2", "rate_hz"],
    );
    says(
        "25",
        &info("scope-export.csv"),
        1,
        &["tilt_joint", "tilt_motor"],
    );
    let dir = tempfile::tempdir().expect("a folder");
    let mapped = |name: &str, mapping: &str, number, file: &str, words: &[&str]| {
        let path = dir.path().join(name);
        std::fs::write(&path, mapping).expect("written");
        let path = path.display().to_string();
        says(number, &["log", "info", file, "--mapping", &path], 0, words);
    };
    let no_header =
        "[time]\ncolumn = 1\n[joints.tilt]\nq = { column = 2 }\ntheta = { column = 3 }\n";
    mapped(
        "n.toml",
        no_header,
        "18",
        "no-header.csv",
        &["6000", "100.0 Hz"],
    );
    let scope = "[joints.tilt]\nq = { column = \"tilt_joint\", unit = \"deg\" }\ntheta = { column = \"tilt_motor\", unit = \"deg\", gear_ratio = 50 }\n";
    mapped(
        "s.toml",
        scope,
        "25",
        "scope-export.csv",
        &["3000", "100.0 Hz"],
    );
}

#[test]
fn shared_scope_export_gives_mapping_that_reads_it() {
    let Some(folder) = case("25") else { return };
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().display().to_string();
    let (code, said) = run(&folder, &["init", "scope-export.csv", "--out", &out]);
    assert_eq!(code, 3, "{said}");
    let mapping = dir.path().join("mapping.toml").display().to_string();
    let (code, said) = run(
        &folder,
        &["log", "info", "scope-export.csv", "--mapping", &mapping],
    );
    assert_eq!(code, 0, "{said}");
    for words in ["3000", "100.0 Hz", "tilt"] {
        assert!(said.contains(words), "{words}: {said}");
    }
}

#[test]
fn shared_creep_tables_are_read() {
    let tensile = [
        "creep",
        "analyze",
        "instron-like.csv",
        "--gauge-length",
        "350mm",
    ];
    says("22", &tensile, 0, &["99.8", "1.00", "0.166"]);
    says("24", &["creep", "analyze", "clock-times.csv"], 0, &["1100"]);
}

#[test]
fn shared_descriptions_are_read() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().display().to_string();
    let init = |file| ["init", file, "--out", &out, "--force"];
    says(
        "13",
        &init("xacro-tag-inside-visual.urdf"),
        0,
        &["wrote", "line 11"],
    );
    says(
        "15",
        &init("blank-line-before-declaration.urdf"),
        0,
        &["wrote"],
    );
    let Some(folder) = case("28") else { return };
    let (code, said) = run(&folder, &init("placeholder-inertia.urdf"));
    assert_eq!(code, 0, "{said}");
    let (_, said) = run(dir.path(), &["robot", "check", "."]);
    assert!(said.contains("probably a placeholder"), "{said}");
    assert!(!said.contains("if specified in t"), "{said}");
}

#[test]
fn shared_bags_are_read_or_explained() {
    says("26", &["log", "info", "oldbag"], 0, &["oldbag"]);
    says(
        "26",
        &["log", "info", "renamed"],
        1,
        &["rec_0.mcap", "renamed.mcap instead"],
    );
    let ros1 = [
        "log",
        "info",
        "ros1-converted.mcap",
        "--motor-topic",
        "/motor_states",
    ];
    says("17", &ros1, 0, &["tilt", "100.0 Hz"]);
}
