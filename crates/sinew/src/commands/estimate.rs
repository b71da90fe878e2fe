//! `sinew estimate`: elongation of each tendon from a recording.

use super::session_args::{SessionArgs, read_baseline};
use crate::args::{self, LAGS, Method, Opening, SOURCES, choice};
use crate::files::{check_outputs, write_table};
use crate::terminal::{Bar, Failure, Finish, Word, answer, complain_coded, note};
use clap::Args;
use sinew_estimate::feeder::Injection;
use sinew_estimate::{EstimateDocument, Method as Answer, Plan, Progress, Request};
use sinew_files::JsonDocument as _;
use sinew_model::offset::{Comparison, TorqueSource, VelocityFilter};
use sinew_report::text::plain;
use sinew_report::{document_warnings, estimate_series, tables, topics};
use std::path::{Path, PathBuf};

/// Heading of the options of the uncorrected estimate.
const PAPER: &str = "Uncorrected (paper) estimate";

/// Estimate the elongation of each tendon from a recording
///
/// LOG is MCAP (ROS 2), CSV, Parquet or NumPy with motor and joint positions. The robot folder contains
/// robot.toml (stiffness, tendons) and the URDF.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew estimate monday.mcap --robot robots/biorob-like --report monday.html\n  \
    sinew estimate monday.mcap --baseline first-day.baseline --nuisance\n  \
    sinew estimate monday.mcap --reference first-day.mcap --json\n  \
    sinew estimate monday.csv --baseline first-day.baseline --date 2026-11-29 --json\n  \
    sinew estimate --each runs/*.mcap --baseline first-day.baseline --table runs.parquet\n  \
    sinew estimate monday.mcap --mcap monday-tendons.mcap\n  \
    sinew estimate monday.mcap --inject elbow=0.010@20")]
pub(crate) struct Estimate {
    /// Recording: a file, the folder of a bag, or a quoted pattern for its parts
    #[arg(required = true, value_name = "LOG")]
    pub(super) logs: Vec<PathBuf>,
    /// Estimate several recordings independently; a quoted pattern or a folder means all recordings
    /// there. Exit code 3: some failed, 1: all failed
    #[arg(long, conflicts_with_all = ["csv", "series", "report", "plot", "mcap", "save", "reference", "nuisance"])]
    each: bool,
    /// Robot folder [default: folder of LOG, then current folder]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Baseline of `sinew baseline` to which offsets refer [default: encoder zero]
    #[arg(long, value_name = "FILE")]
    pub(super) baseline: Option<PathBuf>,
    /// Earlier recording with comparable motion for the uncorrected difference
    #[arg(long, value_name = "LOG2")]
    reference: Option<PathBuf>,
    #[command(flatten)]
    pub(super) session: SessionArgs,

    /// Add the online estimate, and the intervals in which it is provisional
    #[arg(long, conflicts_with = "each")]
    online: bool,
    /// Method [default: absolute; paper with --reference or an option of the uncorrected estimate]
    #[arg(long, value_enum)]
    method: Option<Method>,
    /// Add an offset to a motor position, rad, from a time on, s, for tests (repeatable)
    #[arg(long, value_name = "JOINT=ANGLE[@TIME]", value_parser = args::injection)]
    inject: Vec<Injection>,

    /// Source of the elastic torque [default: observer]
    #[arg(long, value_parser = choice(&SOURCES), help_heading = PAPER)]
    source: Option<TorqueSource>,
    /// Treatment of the lag of the observed torque [default: matched]
    #[arg(long, value_parser = choice(&LAGS), help_heading = PAPER)]
    comparison: Option<Comparison>,
    /// Observer gain K_I, 1/s [default: 20]
    #[arg(long, value_name = "1/S", value_parser = args::positive("1/s"), allow_negative_numbers = true, help_heading = PAPER)]
    gain: Option<f64>,
    /// Cut-off of the velocity filter, rad/s, or 'recorded' for recorded velocities
    /// [default: 40]
    #[arg(long, value_name = "RAD_PER_S", value_parser = args::velocity_filter, allow_negative_numbers = true, help_heading = PAPER)]
    velocity_filter: Option<VelocityFilter>,
    /// Use the recorded external torque as exact
    #[arg(long, help_heading = PAPER)]
    tau_ext: bool,

    #[command(flatten)]
    pub(super) opening: Opening,

    /// Print one JSON document instead of the table (missing values: null; time series: --series)
    #[arg(long, help_heading = "Output")]
    pub(super) json: bool,
    /// Write the uncorrected estimate of every frame; .csv or .parquet
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    /// Write the estimates of both methods over time; .csv or .parquet
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    series: Option<PathBuf>,
    /// Write the estimate over time as ROS 2 topics for Foxglove or PlotJuggler
    #[arg(long, value_name = "FILE.mcap", help_heading = "Output")]
    mcap: Option<PathBuf>,
    /// Write one row per recording and joint, with --each; .csv or .parquet
    #[arg(long, value_name = "FILE", requires = "each", help_heading = "Output")]
    pub(super) table: Option<PathBuf>,
    /// Write a report with plots as one HTML file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
    /// Write a plot of the offsets over time; .svg or .png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    plot: Option<PathBuf>,
}

impl Estimate {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        if self.method() == Answer::Paper {
            self.session.check_unused(self.online)?;
        }
        if self.each {
            return self.run_each();
        }
        let log = self.log()?;
        self.check_files(log)?;
        let document = self.estimate(&self.request(log.to_path_buf())?)?;
        if !self.json {
            for warning in document_warnings(&document) {
                complain_coded(Word::Warning, &warning);
            }
        }
        for line in tables::sources(&document.reading) {
            note(|| plain(&line));
        }
        write_table(self.series.as_deref(), || estimate_series(&document))?;
        if let Some(path) = &self.mcap {
            topics::write_topics(&document, path)?;
        }
        if let Some(path) = &self.report {
            sinew_files::write_file(path, sinew_report::html(&document).as_bytes())?;
        }
        if let Some(path) = &self.plot {
            sinew_report::figure(&document).write(path)?;
        }
        answer(&match self.json {
            true => document.to_json()?,
            false => tables::document(&document, self.session.nuisance),
        })?;
        Ok(Finish::lossy(
            document.is_damaged() || document.lacks_encoder() || document.requires_action(),
        ))
    }

    /// Returns the recording, which must be a single one without `--each`.
    fn log(&self) -> Result<&Path, Failure> {
        match &self.logs[..] {
            [log] => Ok(log),
            several => Err(Failure::Error(format!(
                "{} recordings specified, expected one: add --each to estimate them independently; for the parts of one recording specify its folder or a quoted pattern",
                several.len()
            ))),
        }
    }

    /// Returns the request for a recording.
    pub(super) fn request(&self, log: PathBuf) -> Result<Request, Failure> {
        let mut request = Request::new(log);
        request.robot.clone_from(&self.robot);
        if let Some(source) = self.source {
            request.source = source;
        }
        if let Some(comparison) = self.comparison {
            request.comparison = comparison;
        }
        request.gain_per_s = self.gain;
        if let Some(filter) = self.velocity_filter {
            request.velocity_filter = filter;
        }
        request.use_tau_ext = self.tau_ext;
        request.injections.clone_from(&self.inject);
        request.touches = self.session.touches().to_vec();
        request.reference.clone_from(&self.reference);
        request.open = self.opening.options()?;
        request.csv.clone_from(&self.csv);
        request.date_utc_s = self.session.date;
        Ok(request)
    }

    /// Returns the specified method, else the method whose options are specified.
    pub(super) fn method(&self) -> Answer {
        let paper = self.reference.is_some()
            || self.source.is_some()
            || self.comparison.is_some()
            || self.gain.is_some()
            || self.velocity_filter.is_some()
            || self.tau_ext;
        match self.method {
            Some(method) => method.into(),
            None if paper && self.baseline.is_none() => Answer::Paper,
            None => Answer::Absolute,
        }
    }

    /// Computes the estimate, and saves the posterior if requested.
    fn estimate(&self, request: &Request) -> Result<EstimateDocument, Failure> {
        let bar = Bar::new("estimating");
        let mut progress = |at: Progress| {
            bar.set_label(if at.reference {
                "reference "
            } else {
                "estimating"
            });
            bar.set(at.bytes_done as f64, at.bytes_total as f64);
        };
        let read = read_baseline(self.baseline.as_deref())?;
        let plan = Plan {
            method: self.method(),
            window: self.session.window()?,
            baseline: read.as_ref().map(|(b, name)| (b, name.as_str())),
            options: self.session.options(),
            online: self.online,
        };
        let (document, next) = sinew_estimate::estimate(request, &plan, &mut progress)?;
        let reading = &document.reading;
        if let Some(reason) = sinew_report::nothing_estimated(reading).filter(|_| next.is_none()) {
            return Err(Failure::Error(plain(&reason)));
        }
        if let (Some(path), Some(next)) = (&self.session.save, next) {
            next.write(path)?;
        }
        Ok(document)
    }

    fn check_files(&self, log: &Path) -> Result<(), Failure> {
        let outputs = [
            ("--csv", self.csv.as_deref()),
            ("--series", self.series.as_deref()),
            ("--mcap", self.mcap.as_deref()),
            ("--report", self.report.as_deref()),
            ("--plot", self.plot.as_deref()),
            ("--save", self.session.save.as_deref()),
        ];
        let inputs = [
            ("the recording", Some(log)),
            ("the reference", self.reference.as_deref()),
            ("the baseline", self.baseline.as_deref()),
            ("the mapping file", self.opening.mapping()),
        ];
        check_outputs(&outputs, &inputs)
    }
}
