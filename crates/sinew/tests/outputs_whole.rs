//! Output files are complete or absent after an interruption, for every destination.

use crate::skipped::skipped;
use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::{FileTypeExt as _, symlink};
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Returns a `sinew simulate` command of some seconds that writes `out`.
fn simulate(dir: &Path, out: &str, seed: &str, seconds: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sinew"));
    command.current_dir(dir).arg("simulate");
    command.arg(repository().join("examples/scenarios/stretched-arm.toml"));
    command
        .arg("--robot")
        .arg(repository().join("robots/biorob-like"));
    command.args(["--out", out, "--seed", seed, "--duration", seconds]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs a shell command in which `$0` is the program.
fn shell(dir: &Path, line: &str) -> Output {
    let mut command = Command::new("sh");
    command.current_dir(dir).args(["-c", line]);
    command.arg(env!("CARGO_BIN_EXE_sinew")).output().unwrap()
}

fn names(dir: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(dir).unwrap();
    entries
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn ended_well(output: &Output) -> String {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    said
}

#[test]
fn concurrent_runs_last_complete_output_wins() {
    for out in ["a.csv", "a.mcap"] {
        let dir = tempfile::tempdir().unwrap();
        let alone: Vec<[Vec<u8>; 2]> = ["1", "2"]
            .iter()
            .map(|seed| {
                ended_well(&simulate(dir.path(), out, seed, "0.5").output().unwrap());
                [out, "a.truth.json"].map(|name| fs::read(dir.path().join(name)).unwrap())
            })
            .collect();
        assert!(alone[0] != alone[1]);
        for _ in 0..3 {
            let both: Vec<Child> = ["1", "2"]
                .iter()
                .map(|seed| simulate(dir.path(), out, seed, "0.5").spawn().unwrap())
                .collect();
            for child in both {
                ended_well(&child.wait_with_output().unwrap());
            }
            let found = [out, "a.truth.json"].map(|name| fs::read(dir.path().join(name)).unwrap());
            assert!(
                alone.contains(&found),
                "{out} is of neither run, or of both"
            );
            assert_eq!(names(dir.path()).len(), 2, "{:?}", names(dir.path()));
        }
    }
}

#[test]
fn killed_run_leaves_no_partial_file() {
    for out in ["a.csv", "a.mcap"] {
        let dir = tempfile::tempdir().unwrap();
        // A file of the user's that looks as temporary files of others do.
        fs::write(dir.path().join(format!("{out}.tmp")), "mine").unwrap();
        // What a dead run left on a system where files have names while they are written.
        fs::write(dir.path().join(format!(".{out}.sinew-1-1.tmp")), "half").unwrap();
        for k in 1..8 {
            let mut child = simulate(dir.path(), out, "1", "300").spawn().unwrap();
            std::thread::sleep(Duration::from_millis(40 + 37 * k));
            child.kill().unwrap();
            child.wait().unwrap();
            assert!(!dir.path().join(out).exists());
        }
        ended_well(&simulate(dir.path(), out, "1", "0.1").output().unwrap());
        let whole = [out.to_string(), format!("{out}.tmp"), "a.truth.json".into()];
        assert_eq!(names(dir.path()), BTreeSet::from(whole));
        assert_eq!(
            fs::read(dir.path().join(format!("{out}.tmp"))).unwrap(),
            b"mine"
        );
    }
}

#[test]
fn interrupted_run_leaves_no_file() {
    // A shell's background job has SIGINT ignored, and so has what it starts.
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    let ignored = ignored.map_or(0, |mask| u64::from_str_radix(mask.trim(), 16).unwrap());
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        if ignored >> (number - 1) & 1 == 1 {
            skipped(format_args!("SIG{signal} is ignored here"));
            continue;
        }
        let dir = tempfile::tempdir().unwrap();
        let child = simulate(dir.path(), "a.mcap", "1", "300").spawn().unwrap();
        // Long enough to write, much too short to finish.
        std::thread::sleep(Duration::from_millis(400));
        let kill = ["-s", signal, &child.id().to_string()].map(String::from);
        assert!(Command::new("kill").args(kill).status().unwrap().success());
        let status = child.wait_with_output().unwrap().status;
        assert_eq!(
            status.signal(),
            Some(number),
            "ended as the signal ends a program"
        );
        assert_eq!(names(dir.path()), BTreeSet::new());
    }
}

#[test]
fn link_is_followed_replaced_file_is_reported() {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir(dir.path().join("far")).unwrap();
    for there in [false, true] {
        if !there {
            symlink("far/real.csv", dir.path().join("link.csv")).unwrap();
        }
        let output = simulate(dir.path(), "link.csv", "1", "0.1")
            .output()
            .unwrap();
        let said = ended_well(&output);
        assert_eq!(
            said.contains("--out replaced the existing file link.csv\n"),
            there,
            "{said}"
        );
        assert!(
            fs::symlink_metadata(dir.path().join("link.csv"))
                .unwrap()
                .is_symlink()
        );
        let real = fs::read(dir.path().join("far/real.csv")).unwrap();
        assert!(real.starts_with(b"time_s"));
    }
    let mut quiet = simulate(dir.path(), "link.csv", "1", "0.1");
    assert_eq!(ended_well(&quiet.arg("--quiet").output().unwrap()), "");
}

#[test]
fn pipes_and_devices_are_written_directly() {
    let dir = tempfile::tempdir().unwrap();
    ended_well(&simulate(dir.path(), "b.csv", "1", "0.1").output().unwrap());
    ended_well(&simulate(dir.path(), "b.mcap", "1", "0.1").output().unwrap());
    for (pipe, same) in [("p.csv", "b.csv"), ("p.mcap", "b.mcap")] {
        assert!(
            shell(dir.path(), &format!("mkfifo {pipe}"))
                .status
                .success()
        );
        let mut reader = Command::new("cat");
        reader.current_dir(dir.path()).arg(pipe);
        let reader = reader.stdout(Stdio::piped()).spawn().unwrap();
        ended_well(&simulate(dir.path(), pipe, "1", "0.1").output().unwrap());
        let read = reader.wait_with_output().unwrap().stdout;
        if same == "b.csv" {
            assert_eq!(read, fs::read(dir.path().join(same)).unwrap());
        } else {
            fs::write(dir.path().join("read.mcap"), read).unwrap();
            ended_well(&shell(dir.path(), "\"$0\" log info read.mcap"));
        }
        let kind = fs::symlink_metadata(dir.path().join(pipe))
            .unwrap()
            .file_type();
        assert!(kind.is_fifo());
    }
}

#[test]
fn stdout_is_used_by_one_output_only() {
    let dir = tempfile::tempdir().unwrap();
    ended_well(&simulate(dir.path(), "a.mcap", "1", "1").output().unwrap());
    let robot = repository()
        .join("robots/biorob-like")
        .display()
        .to_string();
    let estimate = format!("\"$0\" estimate a.mcap --method paper --robot {robot}");
    ended_well(&shell(dir.path(), &format!("{estimate} --csv a.csv")));
    let csv = fs::read(dir.path().join("a.csv")).unwrap();
    for line in [
        format!("{estimate} --csv -"),
        format!("{estimate} --csv /dev/stdout 2>&1 >got.csv; cat got.csv"),
    ] {
        let output = shell(dir.path(), &line);
        assert_eq!(output.status.code(), Some(0), "{line}");
        assert!(text(&output.stdout).contains(&text(&csv)), "{line}");
        assert!(!dir.path().join("-").exists());
    }
    let output = shell(dir.path(), &format!("{estimate} --csv -"));
    assert!(output.stdout == csv, "only the file goes to stdout");
    assert!(
        text(&output.stderr).contains("mrad"),
        "the table goes to stderr"
    );
    for twice in ["--csv - --report -", "--csv - --json"] {
        let output = shell(dir.path(), &format!("{estimate} {twice}"));
        assert_eq!(output.status.code(), Some(1));
        assert!(
            text(&output.stderr).contains("stdout is already used by"),
            "{twice}"
        );
    }
    let gone = shell(
        dir.path(),
        &format!("({estimate} --csv - --quiet 2>e; echo $? >&2) | head -c 5"),
    );
    assert_eq!(text(&gone.stderr), "0\n");
    let folder = shell(dir.path(), &format!("{estimate} --csv ."));
    assert!(text(&folder.stderr).contains("is a folder; specify a file"));
}

#[test]
fn full_stdout_is_error() {
    let dir = tempfile::tempdir().unwrap();
    for what in [
        "--help",
        "--version",
        "estimate --help",
        "rope list",
        "rope list --json",
    ] {
        let full = shell(dir.path(), &format!("\"$0\" {what} >/dev/full"));
        assert_eq!(full.status.code(), Some(1), "{what}");
        assert!(
            text(&full.stderr).contains("cannot write to stdout"),
            "{what}"
        );
        // Opened as by Python's DEVNULL; no error.
        let null = shell(dir.path(), &format!("\"$0\" {what} 1<>/dev/null"));
        assert_eq!(null.status.code(), Some(0), "{what}");
    }
    let full = simulate(dir.path(), "/dev/full", "1", "0.1")
        .output()
        .unwrap();
    assert_eq!(full.status.code(), Some(1));
    symlink("/dev/full", dir.path().join("full.csv")).unwrap();
    symlink("/dev/full", dir.path().join("full.mcap")).unwrap();
    for out in ["full.csv", "full.mcap"] {
        let full = simulate(dir.path(), out, "1", "0.1").output().unwrap();
        let said = text(&full.stderr);
        assert_eq!(full.status.code(), Some(1), "{said}");
        assert!(
            said.starts_with(&format!("error: cannot write {out}: ")),
            "{said}"
        );
    }
    assert_eq!(names(dir.path()).len(), 2, "{:?}", names(dir.path()));
}

#[test]
fn file_size_limit_leaves_no_file() {
    let dir = tempfile::tempdir().unwrap();
    for out in ["a.csv", "a.mcap"] {
        let scenario = repository().join("examples/scenarios/stretched-arm.toml");
        let robot = repository().join("robots/biorob-like");
        let output = shell(
            dir.path(),
            &format!(
                "ulimit -f 100; \"$0\" simulate {} --robot {} --out {out} --duration 60",
                scenario.display(),
                robot.display(),
            ),
        );
        let said = text(&output.stderr);
        // Terminated by SIGXFSZ, as reported by the shell.
        assert_eq!(output.status.code(), Some(128 + 25), "{said}");
        assert_eq!(names(dir.path()), BTreeSet::new());
    }
}
