//! Terminal output: width, colour, notes, completions, manual pages.

use std::path::Path;
use std::process::{Command, Output};

fn sinew(args: &[&str], set: &[(&str, &str)]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sinew"));
    for name in ["NO_COLOR", "CLICOLOR_FORCE", "COLUMNS"] {
        command.env_remove(name);
    }
    command
        .args(args)
        .envs(set.iter().copied())
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .output()
        .unwrap()
}

fn told(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

const ESTIMATE: [&str; 4] = [
    "estimate",
    "examples/01-stretched-arm/stretched-arm.mcap",
    "--robot",
    "robots/biorob-like",
];

#[test]
fn tables_fit_terminal_width() {
    let widest = |columns: &str| {
        let text = told(&sinew(&["rope", "list"], &[("COLUMNS", columns)]).stdout);
        text.lines().map(|l| l.chars().count()).max().unwrap()
    };
    let (narrow, usual, wide) = (widest("60"), widest("80"), widest("200"));
    assert!(narrow <= 60 && usual <= 80 && wide <= 200);
    assert!(narrow < usual, "{narrow}, {usual}");
    // Eight columns without a terminal do not panic.
    assert!(widest("8") > 0);
    let named = told(&sinew(&["rope", "list"], &[("COLUMNS", "200")]).stdout);
    assert!(named.contains("gottifredi-maffioli-sk99-ultra"), "{named}");
}

#[test]
fn colour_on_terminal_or_if_requested() {
    let coloured = |more: &[&str], set: &[(&str, &str)]| {
        let output = sinew(&[&ESTIMATE[..], more].concat(), set);
        let seen = |bytes: &[u8]| bytes.contains(&0x1b);
        (seen(&output.stdout), seen(&output.stderr))
    };
    assert_eq!(coloured(&[], &[]), (false, false), "a pipe is no terminal");
    assert_eq!(coloured(&["--color", "always"], &[]), (true, true));
    let no = [("NO_COLOR", "1"), ("CLICOLOR_FORCE", "1")];
    assert_eq!(
        coloured(&["--color", "never"], &[("CLICOLOR_FORCE", "1")]),
        (false, false)
    );
    assert_eq!(coloured(&[], &no), (false, false));
    let json = sinew(
        &[&ESTIMATE[..], &["--json", "--color", "always"]].concat(),
        &[],
    );
    assert!(!json.stdout.contains(&0x1b), "a document has no colour");
}

#[test]
fn verbose_lists_sources_and_times() {
    let notes = |more: &[&str]| told(&sinew(&[&ESTIMATE[..], more].concat(), &[]).stderr);
    let quiet = notes(&[]);
    assert!(!quiet.contains("note:"), "{quiet}");
    let said = notes(&["-v"]);
    for part in [
        "note: q from /joint_states position",
        "note: theta from /dynamic_joint_states motor_position",
        ", URDF ",
        "note: estimating: ",
    ] {
        assert!(said.contains(part), "'{part}' is not in {said}");
    }
}

#[test]
fn completions_contain_every_command() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = sinew(&["completions", shell], &[]);
        let script = told(&output.stdout);
        assert!(output.status.success(), "{shell}");
        for word in ["estimate", "pretension", "baseline", "no-motor-torque"] {
            assert!(script.contains(word), "{shell}: no {word}");
        }
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().display().to_string();
    let output = sinew(&["man", "--out", &path], &[]);
    assert!(output.status.success(), "{}", told(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(read("sinew-rope-pretension.1").contains(".TH"));
    assert!(read("sinew-estimate.1").contains("baseline"));
    assert!(told(&sinew(&["man"], &[]).stdout).contains(".TH"));
    let file = folder.path().join("sinew.1").display().to_string();
    let output = sinew(&["man", "--out", &file], &[]);
    assert_eq!(output.status.code(), Some(1));
    assert!(told(&output.stderr).contains("cannot create the folder"));
}
