//! `sinew-bench validation`: the measured tables of `docs/src/validation.md`.

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde_json::{Value, json};
use sinew::terminal::{Failure, Finish};
use sinew_bench::validation::{self, Measurement, STUDIES, Source, Study};
use sinew_bench::year::{RopePrior, extrapolate};
use sinew_estimate::robot_dir;
use sinew_files::{Budget, read_text, write_file};
use sinew_rope::Catalogue;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const PAGE: &str = "docs/src/validation.md";
const DATA: &str = "docs/src/validation.json";

/// Run the studies of docs/src/validation.md and write its tables
///
/// Runs in the folder of the repository. The results are written to docs/src/validation.json with the commit of the
/// program, after each study, and the tables of the page are written from this file.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  sinew-bench validation --only coverage --only slips --resume out"
)]
pub(crate) struct Validation {
    /// Name of a study, repeatable [default: all]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(STUDIES.map(|s| s.name)))]
    only: Vec<String>,
    /// Recordings per scenario, robots or tendons [default: number of each study]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    n: Option<u64>,
    /// Commit of the program [default: HEAD, with "-dirty" after a change]
    #[arg(long, value_name = "HASH")]
    commit: Option<String>,
    /// Folder with the results of each recording, from which a stopped study resumes
    #[arg(long, value_name = "DIR")]
    resume: Option<PathBuf>,
    /// Write the tables from the data file, without a study
    #[arg(long, conflicts_with_all = ["only", "n", "commit", "resume"])]
    render_only: bool,
}

impl Validation {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let text = read_text(Path::new(DATA), &Budget::TABLE)?;
        let mut data: validation::Validation = serde_json::from_str(&text)?;
        let chosen = |study: &&Study| {
            !self.render_only && (self.only.is_empty() || self.only.iter().any(|o| o == study.name))
        };
        for study in STUDIES.iter().filter(chosen) {
            let commit = self.commit.clone().map_or_else(head, Ok)?;
            let n = study.n.map(|(_, n)| self.n.unwrap_or(n));
            let results = match study.source {
                Source::Key(key) => self.documents(study, n, key)?,
                Source::Extrapolations => extrapolations(n)?,
            };
            let measured = Measurement::new(study, n, &commit, results)?;
            data.0.insert(study.name.into(), measured);
            write_file(Path::new(DATA), data.to_json()?.as_bytes())?;
        }
        let page = read_text(Path::new(PAGE), &Budget::TABLE)?;
        let page = validation::render(&page, &data)?;
        write_file(Path::new(PAGE), page.as_bytes())?;
        Ok(Finish::Complete)
    }

    /// Runs the commands of a study and returns the entries of their documents.
    fn documents(&self, study: &Study, n: Option<u64>, key: &str) -> Result<Vec<Value>, Failure> {
        let mut results = Vec::new();
        for (k, command) in study.commands(n).iter().enumerate() {
            let mut words = command.split(' ');
            let name = words.next().unwrap_or_default();
            // Both programs are built into the same folder.
            let program = std::env::current_exe()?.with_file_name(name);
            let mut child = Command::new(&program);
            child.args(words).arg("--json").stderr(Stdio::inherit());
            if let Some(folder) = self.resume.as_ref().filter(|_| name == "sinew-bench") {
                std::fs::create_dir_all(folder)?;
                let file = format!("{}-{k}.jsonl", study.name);
                child.arg("--out").arg(folder.join(file));
            }
            let output = (child.output())
                .map_err(|e| Failure::Error(format!("cannot run {}: {e}", program.display())))?;
            // Exit code 3: some recordings were rejected.
            if !matches!(output.status.code(), Some(0 | 3)) {
                return Err(Failure::Error(format!(
                    "'{command}' failed: {}",
                    output.status
                )));
            }
            let mut document: Value = serde_json::from_slice(&output.stdout)?;
            match document[key].take() {
                Value::Array(entries) => results.extend(entries),
                _ => return Err(Failure::Error(format!("'{command}': no key '{key}'"))),
            }
        }
        Ok(results)
    }
}

fn extrapolations(n: Option<u64>) -> Result<Vec<Value>, Failure> {
    let robot = robot_dir::load(Path::new("robots/biorob-like"), None)?.robot;
    let catalogue = Catalogue::shipped()?;
    let one = |prior| {
        Ok(json!(extrapolate(
            &robot,
            &catalogue,
            prior,
            n.unwrap_or(1)
        )?))
    };
    RopePrior::ALL.into_iter().map(one).collect()
}

/// Returns the commit that is checked out.
fn head() -> Result<String, Failure> {
    let git = |arguments: &[&str]| -> Result<String, Failure> {
        let output = Command::new("git").args(arguments).output()?;
        if !output.status.success() {
            return Err(Failure::Error("git failed; specify --commit HASH".into()));
        }
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_string())
    };
    let commit = git(&["rev-parse", "--short", "HEAD"])?;
    let changed = git(&["status", "--porcelain", "--", "crates"])?;
    Ok(if changed.is_empty() {
        commit
    } else {
        commit + "-dirty"
    })
}
