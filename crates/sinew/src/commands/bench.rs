//! `sinew bench`: the paper's bending bench.

#[cfg(feature = "camera")]
use super::bench_read_camera::ReadCamera;
use super::rope::{Ropes, find};
use crate::files::{check_outputs, write_table};
use crate::terminal::{Failure, Finish, answer_as};
use clap::{Args, Subcommand};
use sinew_files::{limits, read_text};
use sinew_report::rope::{bench_csv, bench_figure, bench_table};
use sinew_rope::bench::{Bench, routings};
use std::path::PathBuf;

/// The bending bench: a rope between two pulleys, over guides, pulled by a carriage
#[derive(Debug, Subcommand)]
pub(crate) enum BenchCommand {
    Simulate(Simulate),
    ReadCamera(Box<ReadCamera>),
}

/// Left out of this build
///
/// Reads the carriage's position from pictures of a half-millimetre scale. Build it in with
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
        Err(Failure::Refused(
            "this build of sinew reads no pictures; build it with the camera: cargo build --release --features camera".into(),
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

/// `--help` in full: what a bench of one's own looks like.
const FORMAT: &str = "\
Examples:
  sinew bench simulate B
  sinew bench simulate my-bench.toml --rope liros-dc000-0701 --csv run.csv

A bench of your own, my-bench.toml:
  name = \"mine\"
  strand_mm = 600.0        # each of the two strands, drive to joint pulley
  stroke_mm = 100.0        # rope unrolled and taken up
  period_s = 10.0          # one sinusoid
  [[guide]]                # guiding pulleys, as many as there are; none is fine
  strand = 1               # 1 or 2
  at_mm = 150.0            # where the rope meets it, from the drive
  radius_mm = 8.0
  wrap_deg = 20.0
  friction = 0.05          # optional: else the rope's
  [[phase]]                # the programme, in order
  force_n = 200.0          # on the carriage: half of it per strand
  duration_min = 240.0
  temperature_c = 23.0     # optional
  moving = true            # optional";

/// A virtual rope on the bench
///
/// The paper's cases A to F, or a bench of your own: routing and programme in TOML.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  sinew bench simulate B\n  sinew bench simulate my-bench.toml --rope liros-dc000-0701 --csv run.csv",
    after_long_help = FORMAT
)]
pub(crate) struct Simulate {
    /// A, B, C, D, E or F, or a file (.toml)
    bench: String,
    /// Rope; `sinew rope list` names them
    #[arg(long, value_name = "NAME", default_value = "liros-dc000-0301")]
    rope: String,
    #[command(flatten)]
    ropes: Ropes,
    /// Times read, evenly over the programme
    #[arg(long, value_name = "N", default_value_t = 160, value_parser = clap::value_parser!(u32).range(2..=1000))]
    readings: u32,
    /// Draws of the rope's parameters for the intervals
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(20..=10_000))]
    draws: u32,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Every reading over time; .csv or .parquet
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Plot, .svg or .png
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
        check_outputs(&outputs, &[], false)?;
        let bench = match routings::paper(&self.bench) {
            Some(bench) => bench,
            None => {
                let text = read_text(self.bench.as_ref(), &limits::SETTINGS).map_err(|e| {
                    Failure::Refused(format!(
                        "'{}' is neither one of {} nor a file that can be read: {}",
                        self.bench,
                        routings::NAMES.join(", "),
                        e.problem
                    ))
                })?;
                Bench::parse(&text, &self.bench)?
            }
        };
        let catalogue = self.ropes.catalogue(false)?;
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
