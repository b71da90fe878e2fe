//! Habits of the options of all commands.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};

fn sinew(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinew"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// Options of a manual page that write a file or a folder.
fn outputs(page: &str) -> Vec<String> {
    let page = page.replace("\\-", "-");
    let lines: Vec<&str> = page.lines().collect();
    let written = lines.windows(2).filter(|pair| {
        let is_output = ["Write", "Output", "Folder for"];
        is_output.iter().any(|word| pair[1].starts_with(word))
    });
    written
        .filter_map(|pair| pair[0].strip_prefix("\\fB--")?.split_once("\\fR \\fI<"))
        .map(|(option, _)| format!("--{option}"))
        .collect()
}

/// Arguments with which a command reaches its outputs; its inputs may be missing.
fn inputs(command: &str, option: &str) -> &'static [&'static str] {
    match (command, option) {
        ("baseline", _) => &["none.csv"],
        ("baseline-merge", _) => &["none-1", "none-2"],
        ("bench-read-camera", _) => &["none"],
        ("bench-simulate", _) => &["none.toml"],
        ("creep-fit", "--write-rope") => &["none.csv", "--rope", "liros-dc000-0301"],
        ("creep-analyze" | "creep-compare" | "creep-fit", _) => &["none.csv"],
        ("creep-plan", _) => &["none", "--tension", "60N"],
        ("estimate", "--table") => &["empty.csv", "--each", "--baseline", "none"],
        ("estimate", _) => &["none.csv"],
        ("excitation", _) => &["--robot", "none"],
        ("init", _) => &["robot.urdf"],
        ("man", _) => &[],
        ("robot-generate", _) => &["ROBOT", "--lang", "c"],
        ("rope-predict" | "rope-select", _) => &["--tension", "60N", "--ropes", "none"],
        ("rope-pretension", _) => &["none", "--tension", "60N"],
        ("simulate", _) => &["none.toml"],
        ("trend" | "trend-survival", _) => &["none.csv"],
        other => panic!("{other:?}: state inputs of the new command"),
    }
}

#[test]
fn missing_folders_of_outputs_are_created() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let robot = root.join("robots/biorob-like").canonicalize().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    std::fs::copy(robot.join("biorob-like.urdf"), dir.join("robot.urdf")).unwrap();
    std::fs::write(dir.join("empty.csv"), "").unwrap();
    let pages = sinew(&["man", "--out", "pages/man1"], dir);
    assert!(pages.status.success(), "{pages:?}");
    let mut seen = BTreeSet::new();
    for page in std::fs::read_dir(dir.join("pages/man1")).unwrap() {
        let path = page.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let Some(command) = name.strip_prefix("sinew-") else {
            continue;
        };
        for option in outputs(&std::fs::read_to_string(&path).unwrap()) {
            let extension = match option.as_str() {
                "--plot" => "svg",
                "--write-rope" | "--out" if command == "creep-fit" || command == "excitation" => {
                    "toml"
                }
                _ => "csv",
            };
            let place = dir.join(format!("{command}{option}/new"));
            let file = place.join(format!("file.{extension}"));
            let mut arguments: Vec<&str> = command.split('-').collect();
            if command == "bench-read-camera" {
                arguments = vec!["bench", "read-camera"];
            }
            arguments.extend(inputs(command, &option));
            let robot = robot.to_str().unwrap();
            let arguments = arguments
                .iter()
                .map(|a| if *a == "ROBOT" { robot } else { a });
            let mut arguments: Vec<&str> = arguments.collect();
            arguments.extend([option.as_str(), file.to_str().unwrap()]);
            let output = sinew(&arguments, dir);
            assert!(place.is_dir(), "{arguments:?}: {output:?}");
            assert_ne!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
            seen.insert(command.to_owned());
        }
    }
    assert!(seen.len() >= 17, "{seen:?}");
}

/// Former names of options, and values with and without a unit, give the same document.
#[test]
fn units_and_former_names_give_the_same_result() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |arguments: &str| {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let output = sinew(&arguments, &root);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {errors}");
        String::from_utf8(output.stdout).unwrap()
    };
    let rope = "rope predict liros-dc000-0301 --draws 20 --at 1d --json";
    let bare = read(&format!(
        "{rope} --tension 60 --length 700 --temperature 25"
    ));
    let units = read(&format!(
        "{rope} --tension 0.06kN --length 700mm --temperature 25degC"
    ));
    assert_eq!(bare, units);
    let creep = "creep analyze examples/06-creep-test/rope-A.csv --json --quiet";
    let named = read(&format!("{creep} --area 1.2 --temperature 25"));
    let former = read(&format!("{creep} --area-mm2 1.2 --temperature-c 25degC"));
    assert_eq!(named, former);
}

#[test]
fn value_with_wrong_unit_is_rejected_with_valid_form() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        ("rope predict x --tension 60mm", "60N"),
        ("rope predict x --length 7kg", "700mm"),
        ("rope predict x --tension 60 --at 3fortnights", "3weeks"),
        (
            "rope pretension x --tension 60 --remove 80",
            "between 0 and 1",
        ),
        ("trend x.csv --horizon 1095", "90d"),
        ("creep fit x.csv --forecast year", "1year"),
        ("estimate x.csv --temperature warm", "22degC"),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let output = sinew(&arguments, folder.path());
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {errors}");
        assert!(errors.contains(expected), "{arguments:?}: {errors}");
    }
}
