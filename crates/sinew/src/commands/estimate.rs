//! `sinew estimate`: from a recording to each tendon's elongation.

use super::session_args::{SessionArgs, read_baseline};
use crate::args::{self, LAGS, Method, Opening, SOURCES, choice};
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, answer, complain};
use clap::{ArgGroup, Args};
use sinew_estimate::feeder::Injection;
use sinew_estimate::session::{LimitState, SessionError};
use sinew_estimate::{EstimateDocument, Progress, Request, replay, session};
use sinew_files::JsonDocument as _;
use sinew_model::offset::{Comparison, TorqueSource, VelocityFilter};
use sinew_report::text::plain;
use sinew_report::{recording_warning, session_warning, tables};
use std::path::PathBuf;

/// Estimate how far each tendon has stretched, from a recording
///
/// LOG is MCAP as ROS 2 writes it, CSV or Parquet, with motor and joint positions. The robot's
/// folder holds robot.toml (stiffness, tendons) and the URDF.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew estimate monday.mcap --robot robots/biorob-like --report monday.html\n  \
    sinew estimate monday.mcap --reference first-day.mcap --json\n  \
    sinew estimate monday.mcap --baseline first-day.baseline --nuisance\n  \
    sinew estimate monday.mcap --inject elbow=0.010@20",
    group(ArgGroup::new("since").multiple(true)))]
pub(crate) struct Estimate {
    /// Recording
    log: PathBuf,
    /// Robot's folder [default: beside LOG, then the current folder]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Earlier recording of the same robot: report what changed since
    #[arg(long, value_name = "LOG2")]
    reference: Option<PathBuf>,
    /// Baseline made by `sinew baseline`: absolute offsets since then, with an interval
    #[arg(long, value_name = "FILE", group = "since")]
    baseline: Option<PathBuf>,
    #[command(flatten)]
    session: SessionArgs,

    /// Which estimate [default: absolute with --baseline, else paper]
    #[arg(long, value_enum, group = "since", help_heading = "Method")]
    method: Option<Method>,
    /// Where the elastic torque comes from
    #[arg(long, value_parser = choice(&SOURCES), default_value = "observer", help_heading = "Method")]
    source: TorqueSource,
    /// How the lag of the observed torque is treated
    #[arg(long, value_parser = choice(&LAGS), default_value = "matched", help_heading = "Method")]
    comparison: Comparison,
    /// Observer gain K_I, 1/s [default: 20]
    #[arg(long, value_name = "1/S", value_parser = args::positive("1/s"), allow_negative_numbers = true, help_heading = "Method")]
    gain: Option<f64>,
    /// Cut-off of the velocity filter, rad/s, or 'recorded' for recorded velocities
    /// [default: 40]
    #[arg(long, value_name = "RAD_PER_S", value_parser = args::velocity_filter, allow_negative_numbers = true, help_heading = "Method")]
    velocity_filter: Option<VelocityFilter>,
    /// Use the recorded external torque as known
    #[arg(long, help_heading = "Method")]
    tau_ext: bool,
    /// Add an offset to a motor position, rad, from a time on, s (repeatable)
    #[arg(long, value_name = "JOINT=RAD[@TIME]", value_parser = args::injection, help_heading = "Method")]
    inject: Vec<Injection>,

    #[command(flatten)]
    opening: Opening,

    /// Print one JSON document instead of the table (no value: null)
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Write every frame's estimate as CSV
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    /// Write a report with plots as one HTML file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
    /// No progress and no warnings on stderr
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

impl Estimate {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        self.check_files()?;
        if !self.is_absolute() {
            self.session.refuse_all()?;
        }
        let document = self.estimate(&self.request()?)?;
        let (estimate, session) = (&document.estimate, &document.session);
        if !self.quiet && !self.json {
            let recording = estimate.warnings.iter().map(recording_warning);
            let warnings = session.iter().flat_map(|s| &s.warnings);
            for warning in recording.chain(warnings.map(session_warning)) {
                complain("warning", &plain(&warning));
            }
        }
        if let Some(path) = &self.report {
            let page = sinew_report::html_with(estimate, session.as_ref());
            sinew_files::write_file(path, page.as_bytes())?;
        }
        if self.json {
            answer(&document.to_json()?)?;
        } else {
            let nuisance = self.session.nuisance;
            let more = session.iter().map(|s| tables::session(s, nuisance));
            answer(&(tables::estimate(estimate) + &more.collect::<String>()))?;
        }
        let mut limits = (session.iter().flat_map(|s| &s.joints)).filter_map(|j| j.retension);
        let passed = limits.any(|limit| limit.state == LimitState::Passed);
        Ok(Finish::lossy(estimate.damaged || passed))
    }

    fn request(&self) -> Result<Request, Failure> {
        let mut request = Request::new(self.log.clone());
        request.robot.clone_from(&self.robot);
        request.source = self.source;
        request.comparison = self.comparison;
        request.gain_per_s = self.gain;
        if let Some(filter) = self.velocity_filter {
            request.velocity_filter = filter;
        }
        request.use_tau_ext = self.tau_ext;
        request.injections.clone_from(&self.inject);
        request.reference.clone_from(&self.reference);
        request.open = self.opening.options()?;
        request.csv.clone_from(&self.csv);
        Ok(request)
    }

    /// Whether the absolute estimate is asked for, beside the paper's.
    fn is_absolute(&self) -> bool {
        match self.method {
            Some(method) => method == Method::Absolute,
            None => self.baseline.is_some(),
        }
    }

    /// The paper's estimate and, where it is asked for, the session's, which is saved where asked to.
    fn estimate(&self, request: &Request) -> Result<EstimateDocument, Failure> {
        let bar = Bar::new("estimating", self.quiet);
        let mut progress = |at: Progress| {
            bar.say(if at.reference {
                "reference "
            } else {
                "estimating"
            });
            bar.set(at.bytes_done as f64, at.bytes_total as f64);
        };
        if !self.is_absolute() {
            let estimate =
                replay::run(request, &mut progress).map_err(|e| Failure::Refused(e.to_string()))?;
            return Ok(EstimateDocument {
                estimate,
                session: None,
            });
        }
        let refused = |e: SessionError| Failure::Refused(e.to_string());
        let (window, options) = (self.session.window()?, self.session.options());
        let read = read_baseline(self.baseline.as_deref()).map_err(refused)?;
        let since = read.as_ref().map(|(b, name)| (b, name.as_str()));
        let (estimate, session, next) =
            session::estimate_with_replay(request, window, since, &options, &mut progress)
                .map_err(refused)?;
        if let Some(path) = &self.session.save {
            next.write(path)?;
        }
        Ok(EstimateDocument {
            estimate,
            session: Some(session),
        })
    }

    fn check_files(&self) -> Result<(), Failure> {
        let outputs = [
            ("--csv", self.csv.as_deref()),
            ("--report", self.report.as_deref()),
            ("--save", self.session.save.as_deref()),
        ];
        let inputs = [
            ("the recording", Some(self.log.as_path())),
            ("the reference", self.reference.as_deref()),
            ("the baseline", self.baseline.as_deref()),
            ("the mapping file", self.opening.mapping()),
        ];
        check_outputs(&outputs, &inputs)
    }
}
