//! `sinew bench`: the paper's bending bench.

#[cfg(feature = "camera")]
use super::bench_read_camera::ReadCamera;
use crate::files::check_outputs;
use crate::terminal::{Failure, Finish, answer};
use crate::text::{paragraph, plain, table};
use clap::{Args, Subcommand};
use sinew_figure::plot::{Band, Figure, Line, Panel};
use sinew_figure::rounded;
use sinew_files::write_file;
use sinew_rope::bench::{Bench, Simulated, routings, simulate};
use sinew_rope::{Catalogue, Draws, Interval};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

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
    /// Folder with your own ropes
    #[arg(long = "ropes", value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Times read, evenly over the programme
    #[arg(long, value_name = "N", default_value_t = 160, value_parser = clap::value_parser!(u32).range(2..=1000))]
    readings: u32,
    /// Draws of the rope's parameters for the intervals
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(20..=10_000))]
    draws: u32,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Every reading as CSV: time_s, force_n, elongation_mm, strain_percent, interval
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Plot, .svg or .png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

/// Readings with their intervals.
struct Run {
    bench: Bench,
    nominal: Simulated,
    strain: Vec<Interval>,
}

impl Simulate {
    fn run(&self) -> Result<Finish, Failure> {
        let outputs: Vec<(&str, &Path)> = [("--csv", &self.csv), ("--plot", &self.plot)]
            .into_iter()
            .filter_map(|(option, path)| path.as_deref().map(|p| (option, p)))
            .collect();
        check_outputs(&outputs, &[])?;
        let bench = match routings::paper(&self.bench) {
            Some(bench) => bench,
            None => {
                let text = std::fs::read_to_string(&self.bench).map_err(|e| {
                    Failure::Refused(format!(
                        "'{}' is neither one of {} nor a file that can be read: {e}",
                        self.bench,
                        routings::NAMES.join(", ")
                    ))
                })?;
                Bench::parse(&text, &self.bench)?
            }
        };
        let folders: Vec<&Path> = self.folders.iter().map(PathBuf::as_path).collect();
        let catalogue = Catalogue::with_folders(&folders)?;
        let draws = Draws::new(catalogue.find(&self.rope)?, self.draws as usize, self.seed)?;
        let every_s = bench.duration_s() / f64::from(self.readings);
        let nominal = simulate(&draws.nominal, &bench, every_s)?;
        let drawn: Vec<Simulated> = draws
            .laws
            .iter()
            .filter_map(|law| simulate(law, &bench, every_s).ok())
            .collect();
        let strain = (0..nominal.time_s.len())
            .map(|i| {
                let all: Vec<f64> = drawn.iter().map(|d| d.strain_percent[i]).collect();
                Interval::of(nominal.strain_percent[i], &all)
            })
            .collect();
        let run = Run {
            bench,
            nominal,
            strain,
        };
        if let Some(path) = &self.csv {
            write_file(path, run.csv().as_bytes())?;
        }
        if let Some(path) = &self.plot {
            let figure = run.figure(&self.rope);
            let bytes = if path.extension().is_some_and(|e| e == "png") {
                figure.png(2.0)?
            } else {
                figure.svg().into_bytes()
            };
            write_file(path, &bytes)?;
        }
        if self.json {
            let document = serde_json::json!({
                "bench": run.bench.name,
                "rope": self.rope,
                "readings": run.nominal,
                "strain_percent_interval": run.strain,
            });
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            answer(&run.told(&self.rope))?;
        }
        Ok(Finish::Complete)
    }
}

impl Run {
    fn told(&self, rope: &str) -> String {
        let mut out = paragraph(
            &plain(&format!(
                "bench {}, {rope}: strands of {} mm, stroke {} mm",
                self.bench.name,
                rounded(1e3 * self.bench.strand_m, 3),
                rounded(1e3 * self.bench.stroke_m, 3)
            )),
            2,
        );
        out.push('\n');
        let head = ["min", "force\nN", "elongation\nmm", "strain\n%", "stays\n%"];
        let n = &self.nominal;
        // A dozen rows, the last one, and both sides of every change of force.
        let step = (n.time_s.len() / 12).max(1);
        let changes = |i: usize| {
            let differs = |a: Option<&f64>| a.is_some_and(|f| *f != n.force_n[i]);
            differs(n.force_n.get(i + 1)) || (i > 0 && differs(n.force_n.get(i - 1)))
        };
        let rows = (0..n.time_s.len())
            .filter(|&i| i % step == 0 || i + 1 == n.time_s.len() || changes(i))
            .map(|i| {
                let s = self.strain[i];
                vec![
                    rounded(n.time_s[i] / 60.0, 3),
                    rounded(n.force_n[i], 3),
                    rounded(n.elongation_mm[i], 3),
                    format!(
                        "{} ({} to {})",
                        rounded(s.value, 3),
                        rounded(s.low, 2),
                        rounded(s.high, 2)
                    ),
                    rounded(n.irreversible_percent[i], 3),
                ]
            })
            .collect();
        out.push_str(&table(&head, rows, 0));
        out.push_str(&paragraph(
            "elongation: how far the carriage has moved; brackets: 95 % of the draws of the \
             rope's parameters",
            2,
        ));
        out
    }

    fn csv(&self) -> String {
        let mut out = String::from(
            "time_s,force_n,elongation_mm,strain_percent,strain_low_percent,strain_high_percent\n",
        );
        let n = &self.nominal;
        for (i, s) in self.strain.iter().enumerate() {
            let _ = writeln!(
                out,
                "{},{},{:.6},{:.6},{:.6},{:.6}",
                n.time_s[i], n.force_n[i], n.elongation_mm[i], s.value, s.low, s.high
            );
        }
        out
    }

    fn figure(&self, rope: &str) -> Figure {
        let minutes: Vec<f64> = self.nominal.time_s.iter().map(|t| t / 60.0).collect();
        let edge = |f: &dyn Fn(&Interval) -> f64| self.strain.iter().map(f).collect::<Vec<f64>>();
        Figure::new(format!("Bench {}, simulated", self.bench.name))
            .subtitle(format!("{rope}; band: 95 % of the draws"))
            .size(900.0, 420.0)
            .panel(
                Panel::new("", "time (min)", "strain (%)")
                    .y_right("carriage (mm)", 10.0 * self.bench.strand_m)
                    .band(Band::new(
                        "",
                        minutes.clone(),
                        edge(&|i| i.low),
                        edge(&|i| i.high),
                    ))
                    .line(Line::new("", minutes, self.nominal.strain_percent.clone())),
            )
    }
}
