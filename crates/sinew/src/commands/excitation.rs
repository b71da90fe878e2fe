//! `sinew excitation`: poses that make the offsets identifiable.

use crate::files::check_outputs;
use crate::quantity::{Time, duration};
use crate::terminal::{Bar, Failure, Finish, Word, answer_as, complain};
use crate::text::plain;
use clap::Args;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::excitation::{ExcitationError, Options, Proposal, Sensors, propose};
use sinew_estimate::robot_dir;
use sinew_files::{Fault, Located};
use std::path::{Path, PathBuf};

/// Propose a short list of poses that makes the offsets identifiable
///
/// Each candidate list is simulated with the nominal robot, and evaluated by the interval of sinew
/// estimate --baseline. Collisions are not checked. Execute the poses with the robot controller;
/// Sinew never commands the robot.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew excitation --robot robots/biorob-like --poses 6 --out check.toml")]
pub(crate) struct Excitation {
    /// Robot folder
    #[arg(long, value_name = "DIR", default_value = ".")]
    robot: PathBuf,
    /// Baseline of the later session [default: simulated baseline of 25 random poses]
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// Number of poses
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(2..=100))]
    poses: u16,
    /// Rest time at each pose, s
    #[arg(long, value_name = "TIME", default_value = "1s", value_parser = duration, allow_hyphen_values = true)]
    pause: Time,
    /// Gripper is empty [default: unknown payload]
    #[arg(long)]
    no_payload: bool,
    /// Resolution of the joint encoders, bits per turn
    #[arg(long, value_name = "BITS", default_value_t = 13, value_parser = clap::value_parser!(u32).range(4..=40))]
    joint_bits: u32,
    /// Candidates per pose and round (two rounds)
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..=1000))]
    candidates: u16,
    /// Random seed of the candidates
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Write the poses; .toml (a motion for sinew simulate) or .csv
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long, help_heading = "Output")]
    json: bool,
}

impl Excitation {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let text = match self.out.as_deref() {
            None => None,
            Some(out) => {
                let inputs = [("--baseline", self.baseline.as_deref())];
                check_outputs(&[("--out", Some(out))], &inputs)?;
                Some((out, writer(out)?))
            }
        };
        let loaded = robot_dir::load(&self.robot, None)?;
        for warning in &loaded.robot.warnings {
            complain(Word::Warning, &plain(warning));
        }
        let baseline = match &self.baseline {
            Some(file) => Some((Baseline::read(file)?, file.display().to_string())),
            None => None,
        };
        let options = Options {
            poses: usize::from(self.poses),
            pause_s: self.pause.0,
            candidates: usize::from(self.candidates),
            payload: !self.no_payload,
            sensors: Sensors {
                joint_bits: self.joint_bits,
                ..Sensors::default()
            },
            seed: self.seed,
            ..Options::default()
        };
        let bar = Bar::new("evaluating poses");
        let proposal = propose(
            &loaded.robot,
            baseline.as_ref().map(|(b, file)| (b, file.as_str())),
            &options,
            &mut |done, all| bar.set(done as f64, all as f64),
        );
        drop(bar);
        let proposal = proposal.map_err(|error| match error {
            ExcitationError::JointEquations { .. } => {
                let mut lines = (1..).zip(loaded.file_text.lines());
                let first = lines.find(|(_, line)| line.trim_start().starts_with("[[tendons]]"));
                let file = loaded.file.display().to_string();
                let located = Located::new(&file, Fault::NotAllowed, error.to_string());
                located.line(first.map_or(0, |(line, _)| line)).into()
            }
            error => Failure::from(error),
        })?;
        if let Some((out, write)) = text {
            sinew_files::write_file(out, write(&proposal).as_bytes())?;
        }
        answer_as(self.json, &proposal, sinew_report::excitation::render)?;
        Ok(Finish::Complete)
    }
}

/// Returns the writer for the extension of a file.
fn writer(out: &Path) -> Result<fn(&Proposal) -> String, Failure> {
    match out.extension().and_then(|e| e.to_str()) {
        Some("toml") => Ok(Proposal::to_toml),
        Some("csv") => Ok(Proposal::to_csv),
        _ => Err(Failure::Error(format!(
            "--out {}: unsupported extension; expected .toml or .csv",
            out.display()
        ))),
    }
}
