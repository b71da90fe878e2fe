//! `sinew watch`, `sinew fleet` and the studies run other programs, or state how to install them.

use std::path::Path;
use std::process::Command;

#[test]
fn missing_program_error_states_installation() {
    // A build of the whole workspace puts the monitor beside: away from there.
    let folder = tempfile::tempdir().unwrap();
    let sinew = folder.path().join("sinew");
    std::fs::copy(env!("CARGO_BIN_EXE_sinew"), &sinew).unwrap();
    for (command, path) in [
        ("watch", "crates/sinew-watch"),
        ("fleet", "fleet"),
        ("scenarios", "crates/sinew-bench"),
        ("paper", "crates/sinew-bench"),
        ("trend simulate", "crates/sinew-bench"),
    ] {
        let output = Command::new(&sinew)
            .args(command.split(' '))
            .arg("--version")
            .env("PATH", "")
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        let cure = format!("install it with cargo install --path {path}");
        assert!(said.trim_end().ends_with(&cure), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn external_program_receives_all_arguments() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    // Outside the folder of the built program.
    let sinew = folder.path().join("bin/sinew");
    std::fs::create_dir(folder.path().join("bin")).unwrap();
    std::fs::copy(env!("CARGO_BIN_EXE_sinew"), &sinew).unwrap();
    let other = folder.path().join("path");
    std::fs::create_dir(&other).unwrap();
    let program = |at: &Path, says: &str| {
        let file = at.join("sinew-watch");
        std::fs::write(&file, format!("#!/bin/sh\necho {says} \"$@\"\nexit 3\n")).unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
    };
    let run = || {
        let path = format!("{}:/usr/bin:/bin", other.display());
        let mut command = Command::new(&sinew);
        let arguments = ["watch", "--help", "-x", "a b", "--", "--quiet"];
        command.args(arguments).env("PATH", path);
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(3));
        String::from_utf8(output.stdout).unwrap()
    };
    program(&other, "in PATH");
    assert_eq!(run(), "in PATH --help -x a b -- --quiet\n");
    program(&folder.path().join("bin"), "beside");
    assert_eq!(run(), "beside --help -x a b -- --quiet\n");
    // A study is named to the laboratory, with how this program speaks.
    for (asked, given) in [
        ("scenarios run --help", "scenarios --color auto run --help"),
        (
            "--verbose --color never paper fig6",
            "paper --verbose --color never fig6",
        ),
        (
            "trend simulate --robots 3",
            "trend-simulate --color auto --robots 3",
        ),
    ] {
        let file = folder.path().join("bin/sinew-bench");
        std::fs::write(&file, "#!/bin/sh\necho \"$@\"\nexit 3\n").unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
        let output = Command::new(&sinew)
            .args(asked.split(' '))
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(3), "{asked}");
        assert_eq!(String::from_utf8(output.stdout).unwrap().trim(), given);
    }
}
