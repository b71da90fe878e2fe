//! The commands of the example stories, of the manual and of the README run as they stand there.

use crate::skipped::skipped;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Markdown files of a folder, in order.
fn pages(folder: &str, page: impl Fn(PathBuf) -> PathBuf) -> Vec<PathBuf> {
    let mut pages: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
        .unwrap()
        .map(|e| page(e.unwrap().path()))
        .filter(|p| p.is_file())
        .collect();
    pages.sort();
    pages
}

/// Commands of a story, lines that start with four spaces and a dollar sign, and of a page of the manual:
/// those of `sinew` in its `sh` blocks.
fn commands(text: &str, manual: bool) -> Vec<String> {
    let (mut shell, mut commands) = (false, Vec::new());
    for line in text.lines() {
        if line.starts_with("```") {
            shell = line == "```sh";
        } else if let Some(command) = line.strip_prefix("    $ ") {
            commands.push(command.to_string());
        } else if manual && shell && line.starts_with("sinew ") {
            commands.push(line.to_string());
        }
    }
    commands
}

/// Output blocks of a page: a `text` block, with the commands of the `sh` block before it.
fn outputs(page: &str) -> Vec<(Vec<String>, Vec<String>)> {
    let (mut language, mut commands, mut lines) = (None, Vec::new(), Vec::new());
    let mut out = Vec::new();
    for line in page.lines().map(str::trim_start) {
        let Some(mark) = line.strip_prefix("```") else {
            match language {
                Some("sh") => commands.push(line.to_string()),
                Some("text") => lines.push(line.to_string()),
                _ => {}
            }
            continue;
        };
        match language {
            Some("text") if !commands.is_empty() => {
                out.push((std::mem::take(&mut commands), std::mem::take(&mut lines)));
            }
            Some("sh") => {}
            // A block in another language lies between a command and what it prints.
            Some(_) => commands.clear(),
            None => lines.clear(),
        }
        language = match (language, mark) {
            (Some(_), _) => None,
            (None, mark) => {
                if mark == "sh" {
                    commands.clear();
                }
                Some(mark)
            }
        };
    }
    out
}

/// Lines of an output block that the output lacks; space is not compared, and `…` stands for omitted lines.
fn missing_lines(shown: &[String], printed: &str) -> Vec<String> {
    let squeezed = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    let printed: HashSet<String> = printed.lines().map(squeezed).collect();
    let shown = shown.iter().map(|line| squeezed(line));
    let shown = shown.filter(|line| !line.is_empty() && line != "…" && !line.starts_with('─'));
    shown.filter(|line| !printed.contains(line)).collect()
}

/// `cargo run … --example NAME -- ARGUMENTS` by the example that the tests of the whole workspace have
/// built, where they have: another build of everything in release says no more.
fn built(words: Vec<String>) -> Vec<String> {
    let example = words.iter().position(|w| w == "--example");
    let arguments = words.iter().position(|w| w == "--");
    if let ("cargo", Some(example), Some(arguments)) = (words[0].as_str(), example, arguments) {
        let place = Path::new(env!("CARGO_BIN_EXE_sinew")).with_file_name("examples");
        let program = place.join(format!(
            "{}{}",
            words[example + 1],
            std::env::consts::EXE_SUFFIX
        ));
        if program.is_file() {
            let program = program.display().to_string();
            return [&[program], &words[arguments + 1..]].concat();
        }
    }
    words
}

/// Path of a program that lies beside the one that is tested.
fn beside(program: &str) -> PathBuf {
    Path::new(env!("CARGO_BIN_EXE_sinew"))
        .with_file_name(format!("{program}{}", std::env::consts::EXE_SUFFIX))
}

/// Whether a command is a study, which `sinew-bench` runs.
fn is_study(command: &str) -> bool {
    ["sinew scenarios ", "sinew paper ", "sinew trend simulate "]
        .iter()
        .any(|study| command.starts_with(study))
}

#[test]
fn every_story_and_every_page_of_the_manual_runs() {
    let stories = pages("examples", |folder| folder.join("README.md"));
    assert!(stories.len() >= 5, "{stories:?}");
    let manual = pages("docs/src/manual", |page| page);
    assert!(manual.len() >= 10, "{manual:?}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("out")).unwrap();
    // `out/` is this test's own; everything else is the repository's.
    let here = |word: &str| -> String {
        match word {
            "sinew" => env!("CARGO_BIN_EXE_sinew").to_string(),
            "out" => folder.path().join("out").display().to_string(),
            _ if word.starts_with("out/") => folder.path().join(word).display().to_string(),
            _ => word.to_string(),
        }
    };
    // What a story has run needn't be run again by the manual: its files are still there.
    let mut ran: HashMap<String, String> = HashMap::new();
    let mut stale = Vec::new();
    let stories = stories.into_iter().map(|page| (page, false));
    let manual = manual.into_iter().map(|page| (page, true));
    for (page, of_manual) in stories.chain(manual) {
        let text = std::fs::read_to_string(&page).unwrap();
        for command in commands(&text, of_manual) {
            if command.contains("../shared") && !root().join("../shared/data").is_dir()
                || command.contains("--robot out") && !folder.path().join("out/robot.toml").exists()
            {
                skipped(format_args!("no shared folder for: {command}"));
                continue;
            }
            // The tests of the whole workspace build the laboratory; those of this crate alone do not, and .ci/skips
            // does not hold this word.
            if is_study(&command) && !beside("sinew-bench").is_file() {
                skipped(format_args!("sinew-bench is not built for: {command}"));
                continue;
            }
            if ran.contains_key(&command) {
                continue;
            }
            let words = built(command.split_whitespace().map(here).collect());
            // Without the camera its command says how to build it in, and there is no series to analyse.
            let camera =
                command.starts_with("sinew bench read-camera") && cfg!(not(feature = "camera"));
            let is_missing =
                |file: &str| command.contains(file) && !folder.path().join(file).is_file();
            // `sinew-fleet` writes the second.
            if !camera && is_missing("out/creep.csv") || is_missing("out/tendon.csv") {
                continue;
            }
            let output = Command::new(&words[0])
                .args(&words[1..])
                .current_dir(root())
                .output()
                .unwrap();
            if camera {
                let said = String::from_utf8_lossy(&output.stderr);
                assert_eq!(output.status.code(), Some(1), "{command}: {said}");
                assert!(said.contains("--features camera"), "{command}: {said}");
                ran.insert(command, String::new());
                continue;
            }
            // A page may document exit status 3: a limit is exceeded or the rope breaks.
            let documented = text.contains("exit status is 3") || text.contains("exit code is 3");
            let passed = output.status.code() == Some(3) && documented;
            assert!(
                output.status.success() || passed,
                "{}: {command}: {}\n{}",
                page.display(),
                output.status,
                String::from_utf8_lossy(&output.stderr)
            );
            let printed = [output.stdout, b"\n".to_vec(), output.stderr].concat();
            ran.insert(command, String::from_utf8_lossy(&printed).into_owned());
        }
        for (commands, shown) in outputs(&text) {
            let printed: Vec<&str> = (commands.iter())
                .filter_map(|c| ran.get(c).map(String::as_str))
                .collect();
            let missing = missing_lines(&shown, &printed.join("\n"));
            if !printed.is_empty() && !missing.is_empty() {
                let lines = missing.join("\n  ");
                stale.push(format!(
                    "{}: {}\n  {lines}",
                    page.display(),
                    commands.join("; ")
                ));
            }
        }
    }
    assert!(ran.len() >= 30, "{} commands ran", ran.len());
    assert!(
        stale.is_empty(),
        "not printed any more:\n{}",
        stale.join("\n")
    );
}

#[test]
fn the_readme_prints_what_it_says() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let first = "\ncargo run --release -- ";
    let (command, after) = readme
        .split_once(first)
        .unwrap()
        .1
        .split_once('\n')
        .unwrap();
    let shown = after.split_once("```text\n").unwrap().1;
    let (shown, _) = shown.split_once("```").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let [report, plot] =
        ["report.html", "offsets.svg"].map(|name| folder.path().join(name).display().to_string());
    let words = command.split_whitespace().map(|word| match word {
        "report.html" => &report,
        "offsets.svg" => &plot,
        _ => word,
    });
    let output = Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(words)
        .current_dir(root())
        .output()
        .unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout), shown);
    assert!(Path::new(&report).is_file());
    // The last digit of a curve may depend on the platform; the text of the picture may not.
    let picture = after.split_once("](").unwrap().1.split_once(')').unwrap().0;
    let text = |svg: &Path| -> Vec<String> {
        let svg = std::fs::read_to_string(svg).unwrap();
        let lines = svg.lines().filter_map(|line| line.split_once("<text"));
        let words = lines.filter_map(|(_, text)| text.split_once('>'));
        words.map(|(_, words)| words.to_owned()).collect()
    };
    let shown = text(&root().join(picture));
    assert!(shown.len() > 20, "{picture}");
    assert_eq!(text(Path::new(&plot)), shown);
}

fn estimate(args: &[&str]) -> serde_json::Value {
    let output = Command::new(env!("CARGO_BIN_EXE_sinew"))
        .arg("estimate")
        .args(args)
        .arg("--json")
        .current_dir(root())
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

fn offset_mrad(estimate: &serde_json::Value, joint: &str) -> f64 {
    offset(&estimate["reading"]["joints"], joint)
        .as_f64()
        .map(|rad| 1e3 * rad)
        .unwrap()
}

fn offset<'a>(joints: &'a serde_json::Value, joint: &str) -> &'a serde_json::Value {
    let found = joints
        .as_array()
        .unwrap()
        .iter()
        .find(|j| j["name"] == joint)
        .unwrap();
    &found["offset_rad"]
}

#[test]
fn the_shipped_recording_says_what_its_story_says() {
    let log = "examples/01-stretched-arm/stretched-arm.mcap";
    let robot = ["--robot", "robots/biorob-like"];
    let plain = estimate(&[&[log], &robot[..]].concat());
    // Stiffness within 3 %, masses within 2 %, mean torque 2.4 and 0.9 N·m: 5 % of 59 and 45 mrad
    // is the most a model error can do; the truth is 14, and 9 then 15 from 24 s of 40 s on.
    let pitch = offset_mrad(&plain, "shoulder_pitch");
    let elbow = offset_mrad(&plain, "elbow");
    assert!((pitch - 14.0).abs() < 3.0, "{pitch}");
    assert!(
        (elbow - (9.0 * 24.0 + 15.0 * 16.0) / 40.0).abs() < 2.3,
        "{elbow}"
    );
    // The answer at the end, after the slip, and that its interval holds the truth.
    for (joint, truth) in [
        ("shoulder_yaw", 0.0),
        ("shoulder_pitch", 14.0),
        ("elbow", 15.0),
        ("wrist", 0.0),
    ] {
        let answer = offset(&plain["session"]["joints"], joint);
        let [mean, std] = ["mean", "std"].map(|k| 1e3 * answer[k].as_f64().unwrap());
        assert!((mean - truth).abs() < 2.0 * std, "{joint}: {mean} ± {std}");
    }
    let injected = estimate(&[&[log], &robot[..], &["--inject", "shoulder_yaw=0.01"]].concat());
    let added = offset_mrad(&injected, "shoulder_yaw") - offset_mrad(&plain, "shoulder_yaw");
    assert!((added - 10.0).abs() < 1e-6, "{added}");
}

#[test]
fn a_csv_written_by_hand_is_enough() {
    let story = "examples/05-your-own-robot";
    let log = format!("{story}/nod.csv");
    let found = offset_mrad(&estimate(&[&log, "--robot", story]), "tilt");
    // 6 mrad; six decimals in the file, 100 Hz.
    assert!((found - 6.0).abs() < 0.05, "{found}");
}
