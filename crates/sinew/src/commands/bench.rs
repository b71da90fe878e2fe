//! `sinew bench`: bending bench of the paper.

#[cfg(feature = "camera")]
use super::bench_read_camera::ReadCamera;
use super::rope::{Ropes, find};
use crate::files::{check_outputs, write_table};
use crate::terminal::{Failure, Finish, answer_as};
use clap::{Args, Subcommand};
use sinew_files::{Budget, read_text};
use sinew_report::rope::{bench_csv, bench_figure, bench_table};
use sinew_rope::bench::{Bench, routings};
use std::path::PathBuf;

/// Bending bench: a rope between two pulleys, over guides, pulled by a carriage
#[derive(Debug, Subcommand)]
pub(crate) enum BenchCommand {
    Simulate(Simulate),
    ReadCamera(Box<ReadCamera>),
}

/// Not included in this build
///
/// Measures the carriage position in images of a half-millimetre scale. Include it with
/// cargo build --release --features camera
#[cfg(not(feature = "camera"))]
#[derive(Debug, Args)]
pub(crate) struct ReadCamera {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<std::ffi::OsString>,
}

#[cfg(not(feature = "camera"))]
impl ReadCamera {
    fn run(&self) -> Result<Finish, Failure> {
        Err(Failure::Error(
            "read-camera is not included in this build; rebuild with cargo build --release --features camera".into(),
        ))
    }
}

impl BenchCommand {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::Simulate(command) => command.run(),
            Self::ReadCamera(command) => command.run(),
        }
    }
}

/// Text of `--help`: format of a bench description.
const FORMAT: &str = "\
Examples:
  sinew bench simulate B
  sinew bench simulate my-bench.toml --rope liros-dc000-0701 --csv run.csv

Format of a bench description, my-bench.toml:
  name = \"mine\"
  strand_mm = 600.0        # each of the two strands, drive to joint pulley
  stroke_mm = 100.0        # rope unwound and wound
  period_s = 10.0          # sinusoidal motion
  joint_friction = 0.02    # optional: ln of the tension ratio that turns the joint pulley
  [[guide]]                # guiding pulleys (optional, repeatable)
  strand = 1               # 1 or 2
  at_mm = 150.0            # contact point, from the drive
  radius_mm = 8.0
  wrap_deg = 20.0
  friction = 0.05          # optional [default: of the rope]
  [[phase]]                # phases of the programme, in order
  force_n = 200.0          # on the carriage, half of it per strand
  duration_min = 240.0
  temperature_c = 23.0     # optional
  moving = true            # optional";

/// Simulate a rope on the bench
///
/// Cases A to F of the paper, or a bench description (routing and programme, TOML).
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  sinew bench simulate B\n  sinew bench simulate my-bench.toml --rope liros-dc000-0701 --csv run.csv",
    after_long_help = FORMAT
)]
pub(crate) struct Simulate {
    /// Case A, B, C, D, E or F, or bench description (.toml)
    bench: String,
    /// Rope; see `sinew rope list`
    #[arg(long, value_name = "NAME", default_value = "liros-dc000-0301")]
    rope: String,
    #[command(flatten)]
    ropes: Ropes,
    /// Number of times, evenly spaced over the programme
    #[arg(long, value_name = "N", default_value_t = 160, value_parser = clap::value_parser!(u32).range(2..=1000))]
    readings: u32,
    /// Number of parameter draws for the intervals
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(20..=10_000))]
    draws: u32,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write all values over time; .csv or .parquet
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a plot; .svg or .png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

impl Simulate {
    fn run(&self) -> Result<Finish, Failure> {
        let outputs = [
            ("--csv", self.csv.as_deref()),
            ("--plot", self.plot.as_deref()),
        ];
        check_outputs(&outputs, &[])?;
        let bench = match routings::paper(&self.bench) {
            Some(bench) => bench,
            None => {
                let text = read_text(self.bench.as_ref(), &Budget::SETTINGS).map_err(|e| {
                    Failure::Error(format!(
                        "'{}' is neither one of {} nor a readable file: {}",
                        self.bench,
                        routings::NAMES.join(", "),
                        e.problem
                    ))
                })?;
                Bench::parse(&text, &self.bench)?
            }
        };
        let catalogue = self.ropes.catalogue()?;
        let rope = find(&catalogue, &self.rope)?;
        let draws = self.draws as usize;
        let run = sinew_rope::bench::run(rope, &bench, self.readings, draws, self.seed)?;
        write_table(self.csv.as_deref(), || bench_csv(&run))?;
        if let Some(path) = &self.plot {
            bench_figure(&run).write(path)?;
        }
        answer_as(self.json, &run, bench_table)?;
        Ok(Finish::Complete)
    }
}
