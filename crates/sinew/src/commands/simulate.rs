//! `sinew simulate`: recordings with a known truth.

use super::simulate_control::render;
use crate::args::{Choice, choice, positive};
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, Word, answer, complain};
use crate::text::plain;
use clap::Args;
use sinew_estimate::robot_dir;
use sinew_files::JsonDocument as _;
use sinew_log::Compression;
use sinew_sim::control::{self, Comparison, Simulated};
use sinew_sim::{Scenario, SimulateOptions, Summary, truth_path};
use std::path::{Path, PathBuf};

/// Make a recording of a joint-elastic arm whose tendons stretch
///
/// The truth (offsets, stiffness, payload, contacts) is written beside the recording as
/// NAME.truth.json. Same robot, scenario and seed: the same bytes.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew simulate examples/scenarios/stretched-arm.toml --out stretched.mcap --seed 7")]
pub(crate) struct Simulate {
    /// Scenario, TOML
    scenario: PathBuf,
    /// Robot's folder [default: the one the scenario names]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Recording to write; .mcap, .parquet or .csv
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Seed of everything drawn [default: the scenario's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Length, s [default: the scenario's]
    #[arg(long, value_name = "S", value_parser = positive("s"), allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Compression of an MCAP
    #[arg(long, value_parser = choice(&PACKINGS), default_value = "zstd")]
    compression: Compression,
    /// Run it without and with its correction section, and say how far the joints are from where they
    /// should be and which contacts are missed or false
    #[arg(long)]
    control: bool,
    /// Print one JSON document (the truth) instead of a line
    #[arg(long)]
    json: bool,
    /// No progress and no warnings on stderr
    #[arg(long)]
    quiet: bool,
}

const PACKINGS: [Choice<Compression>; 3] = [
    ("zstd", "Smaller", Compression::Zstd),
    ("lz4", "Faster", Compression::Lz4),
    ("none", "Not compressed", Compression::None),
];

impl Simulate {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let inputs = [("the scenario", Some(self.scenario.as_path()))];
        let truth = truth_path(&self.out);
        let outputs = [
            ("--out", Some(self.out.as_path())),
            ("its truth", Some(&truth)),
        ];
        check_outputs(&outputs, &inputs, self.quiet)?;
        let (scenario, folder) = self.opened()?;
        let loaded = robot_dir::load(&folder, None)?;
        if !self.quiet {
            for warning in &loaded.robot.warnings {
                complain(Word::Warning, &plain(warning));
            }
        }
        let mut options = SimulateOptions::new(&self.out);
        options.robot_description = Some(loaded.urdf_text.clone());
        options.compression = self.compression;
        // Before anything is written: a scenario without a correction is refused.
        let comparison = match self.control {
            true => Some(control::compare(&loaded.robot, &scenario)?),
            false => None,
        };
        let bar = Bar::new("simulating", self.quiet);
        let summary = sinew_sim::run(&loaded.robot, &scenario, &options, &mut |at| {
            bar.set(at.done_s, at.total_s);
        });
        drop(bar);
        let summary = summary?;
        self.show(summary, comparison)?;
        Ok(Finish::Complete)
    }

    /// What is simulated, and the folder of its robot.
    fn opened(&self) -> Result<(Scenario, PathBuf), Failure> {
        let name = self.scenario.display().to_string();
        let mut scenario = Scenario::open(&self.scenario)?;
        if let Some(seed) = self.seed {
            scenario.seed = seed;
        }
        if self.duration.is_some() {
            scenario.duration_s = self.duration;
        }
        let beside = self.scenario.parent().unwrap_or(Path::new(""));
        let folder = match (&self.robot, &scenario.robot) {
            (Some(folder), _) => folder.clone(),
            (None, Some(named)) => beside.join(named),
            (None, None) => {
                return Err(Failure::Refused(format!(
                    "{name} names no robot; name its folder with --robot DIR"
                )));
            }
        };
        Ok((scenario, folder))
    }

    fn show(&self, summary: Summary, comparison: Option<Comparison>) -> Result<(), Failure> {
        if self.json {
            let document = Simulated {
                truth: summary.truth,
                control: comparison,
            };
            answer(&document.to_json()?)?;
        } else {
            if let Some(comparison) = &comparison {
                answer(&(render(comparison) + "\n"))?;
            }
            answer(&format!(
                "{}: {} s, {} frames, {:.1} MB; its truth is {}\n",
                summary.out.display(),
                summary.duration_s,
                summary.frames.written,
                summary.bytes as f64 / 1e6,
                summary.truth_file.display(),
            ))?;
        }
        Ok(())
    }
}
