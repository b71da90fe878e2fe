//! `sinew excitation`: poses that make the offsets show.

use crate::args::positive;
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, Word, answer_as, complain};
use crate::text::plain;
use clap::Args;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::excitation::{Options, Proposal, Sensors, propose};
use sinew_estimate::robot_dir;
use std::path::{Path, PathBuf};

/// Propose a short list of poses that makes the offsets identifiable
///
/// Each list tried is visited in a synthetic recording of the nominal robot, and judged by the
/// interval that sinew estimate --baseline would give. Collisions are not checked, and Sinew never
/// commands the robot: run the poses with your own controller.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew excitation --robot robots/biorob-like --poses 6 --out check.toml")]
pub(crate) struct Excitation {
    /// Robot's folder
    #[arg(long, value_name = "DIR", default_value = ".")]
    robot: PathBuf,
    /// Baseline to build on [default: what 25 random poses would teach]
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// Poses in the list
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(2..=100))]
    poses: u16,
    /// Rest at each pose, s
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = positive("s"), allow_negative_numbers = true)]
    pause: f64,
    /// The gripper is known to be empty
    #[arg(long)]
    no_payload: bool,
    /// Bits of a turn of the joint encoders
    #[arg(long, value_name = "BITS", default_value_t = 13, value_parser = clap::value_parser!(u32).range(4..=40))]
    joint_bits: u32,
    /// Poses tried in the place of each, per round of two
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..=1000))]
    candidates: u16,
    /// Seed of the poses drawn
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Write the poses; .toml (a motion for sinew simulate) or .csv
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// No progress and no warnings on stderr
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

impl Excitation {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let text = match self.out.as_deref() {
            None => None,
            Some(out) => {
                let inputs = [("--baseline", self.baseline.as_deref())];
                check_outputs(&[("--out", Some(out))], &inputs, self.quiet)?;
                Some((out, writer(out)?))
            }
        };
        let loaded = robot_dir::load(&self.robot, None)?;
        if !self.quiet {
            for warning in &loaded.robot.warnings {
                complain(Word::Warning, &plain(warning));
            }
        }
        let baseline = match &self.baseline {
            Some(file) => Some((Baseline::read(file)?, file.display().to_string())),
            None => None,
        };
        let options = Options {
            poses: usize::from(self.poses),
            pause_s: self.pause,
            candidates: usize::from(self.candidates),
            payload: !self.no_payload,
            sensors: Sensors {
                joint_bits: self.joint_bits,
                ..Sensors::default()
            },
            seed: self.seed,
            ..Options::default()
        };
        let bar = Bar::new("trying poses", self.quiet);
        let proposal = propose(
            &loaded.robot,
            baseline.as_ref().map(|(b, file)| (b, file.as_str())),
            &options,
            &mut |done, all| bar.set(done as f64, all as f64),
        );
        drop(bar);
        let proposal = proposal?;
        if let Some((out, write)) = text {
            sinew_files::write_file(out, write(&proposal).as_bytes())?;
        }
        answer_as(self.json, &proposal, sinew_report::excitation::render)?;
        Ok(Finish::Complete)
    }
}

/// What makes a file's text, by its ending.
fn writer(out: &Path) -> Result<fn(&Proposal) -> String, Failure> {
    match out.extension().and_then(|e| e.to_str()) {
        Some("toml") => Ok(Proposal::to_toml),
        Some("csv") => Ok(Proposal::to_csv),
        _ => Err(Failure::Refused(format!(
            "--out {}: the name must end in .toml or .csv",
            out.display()
        ))),
    }
}
