//! Build size of the first README command in crates and lines, which do not depend on the machine.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

/// Crates at most, ours included.
const CRATES_MOST: usize = 140;
/// Lines of Rust and C in their source folders at most.
const LINES_MOST: usize = 1_888_500;

/// Output of cargo.
fn cargo(arguments: &[&str]) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(arguments).args(["--locked", "--offline"]);
    let output = command
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Counts the lines of the sources below a folder, without tests and examples.
fn lines_below(folder: &Path) -> usize {
    let mut lines = 0;
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let path = entry.path();
        let name = entry.file_name().into_string().unwrap_or_default();
        if path.is_dir() {
            if !["tests", "benches", "examples", "target", "fuzz"].contains(&name.as_str()) {
                lines += lines_below(&path);
            }
        } else if name != "tests.rs" && [".rs", ".c", ".h"].iter().any(|end| name.ends_with(end)) {
            let bytes = std::fs::read(&path).unwrap();
            lines += bytes.iter().filter(|b| **b == b'\n').count();
        }
    }
    lines
}

#[test]
fn main_job_build_stays_within_budget() {
    let arguments = [
        "tree",
        "-p",
        "sinew",
        "-e",
        "normal,build",
        "--prefix",
        "none",
    ];
    let tree = cargo(&arguments);
    let built: BTreeSet<(&str, &str)> = tree
        .lines()
        .filter_map(|line| {
            let mut words = line.split(' ');
            Some((words.next()?, words.next()?.trim_start_matches('v')))
        })
        .collect();
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let about = Command::new(compiler).arg("-vV").output().unwrap().stdout;
    let about = String::from_utf8(about).unwrap();
    let host = about
        .lines()
        .find_map(|l| l.strip_prefix("host: "))
        .unwrap();
    let arguments = [
        "metadata",
        "--format-version",
        "1",
        "--filter-platform",
        host,
    ];
    let metadata: Value = serde_json::from_str(&cargo(&arguments)).unwrap();
    let text = |package: &Value, key: &str| package[key].as_str().unwrap().to_owned();
    let folders: BTreeMap<(String, String), String> = metadata["packages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| {
            (
                (text(p, "name"), text(p, "version")),
                text(p, "manifest_path"),
            )
        })
        .collect();
    let mut sizes: Vec<(usize, &str)> = built
        .iter()
        .map(|(name, version)| {
            let manifest = &folders[&((*name).to_owned(), (*version).to_owned())];
            (lines_below(Path::new(manifest).parent().unwrap()), *name)
        })
        .collect();
    sizes.sort_unstable();
    let lines: usize = sizes.iter().map(|(lines, _)| lines).sum();
    let largest: Vec<_> = sizes.iter().rev().take(12).collect();
    println!(
        "{} crates, {lines} lines; the largest {largest:?}",
        built.len()
    );
    assert!(
        built.len() <= CRATES_MOST,
        "{} crates: {built:?}",
        built.len()
    );
    assert!(
        lines <= LINES_MOST,
        "{lines} lines; the largest {largest:?}"
    );
}
