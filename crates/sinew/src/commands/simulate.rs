//! `sinew simulate`: simulated recordings with known truth.

use super::simulate_control::render;
use crate::args::{Choice, choice};
use crate::files::check_outputs;
use crate::quantity::{Time, above_zero};
use crate::terminal::{Bar, Failure, Finish, Word, answer, complain};
use crate::text::plain;
use clap::Args;
use sinew_estimate::robot_dir;
use sinew_files::JsonDocument as _;
use sinew_log::Compression;
use sinew_sim::control::{self, Comparison, Simulated};
use sinew_sim::{Scenario, SimulateOptions, Summary, truth_path};
use std::path::{Path, PathBuf};

/// Simulate a recording of a joint-elastic arm with elongating tendons
///
/// The truth (offsets, stiffness, payload, contacts) is written to NAME.truth.json next to the
/// recording. Equal robot, scenario and seed give identical files.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew simulate examples/scenarios/stretched-arm.toml --out stretched.mcap --seed 7")]
pub(crate) struct Simulate {
    /// Scenario, TOML
    scenario: PathBuf,
    /// Robot folder [default: from the scenario]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Output recording; .mcap, .parquet or .csv
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Random seed [default: from the scenario]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Duration, s [default: from the scenario]
    #[arg(long, value_name = "TIME", value_parser = above_zero::<Time>, allow_hyphen_values = true)]
    duration: Option<Time>,
    /// Compression of an MCAP file
    #[arg(long, value_parser = choice(&PACKINGS), default_value = "zstd")]
    compression: Compression,
    /// Simulate without and with the correction of the scenario, and report position errors and
    /// missed and false contacts
    #[arg(long)]
    control: bool,
    /// Print one JSON document (the truth) instead of text
    #[arg(long)]
    json: bool,
}

const PACKINGS: [Choice<Compression>; 3] = [
    ("zstd", "Smaller", Compression::Zstd),
    ("lz4", "Faster", Compression::Lz4),
    ("none", "Uncompressed", Compression::None),
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
        check_outputs(&outputs, &inputs)?;
        let (scenario, folder) = self.opened()?;
        let loaded = robot_dir::load(&folder, None)?;
        for warning in &loaded.robot.warnings {
            complain(Word::Warning, &plain(warning));
        }
        let mut options = SimulateOptions::new(&self.out);
        options.robot_description = Some(loaded.urdf_text.clone());
        options.compression = self.compression;
        // Checked before anything is written: a scenario without correction is invalid.
        let comparison = match self.control {
            true => Some(control::compare(&loaded.robot, &scenario)?),
            false => None,
        };
        let bar = Bar::new("simulating");
        let summary = sinew_sim::run(&loaded.robot, &scenario, &options, &mut |at| {
            bar.set(at.done_s, at.total_s);
        });
        drop(bar);
        let summary = summary?;
        self.show(summary, comparison)?;
        Ok(Finish::Complete)
    }

    /// Reads the scenario, and returns it with its robot folder.
    fn opened(&self) -> Result<(Scenario, PathBuf), Failure> {
        let name = self.scenario.display().to_string();
        let mut scenario = Scenario::open(&self.scenario)?;
        if let Some(seed) = self.seed {
            scenario.seed = seed;
        }
        if self.duration.is_some() {
            scenario.duration_s = self.duration.map(|time| time.0);
        }
        let folder = self.scenario.parent().unwrap_or(Path::new(""));
        let folder = match (&self.robot, &scenario.robot) {
            (Some(folder), _) => folder.clone(),
            (None, Some(named)) => folder.join(named),
            (None, None) => {
                return Err(Failure::Error(format!(
                    "{name}: robot missing; specify --robot DIR"
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
                "{}: {} s, {} frames, {:.1} MB; truth: {}\n",
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
