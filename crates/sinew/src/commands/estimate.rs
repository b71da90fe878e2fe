//! `sinew estimate`: from a recording to each tendon's elongation.

use crate::args::{self, Lag, Method, Opening, Source};
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, answer, complain};
use crate::text::{paragraph, plain, table};
use clap::{ArgGroup, Args};
use sinew_estimate::absolute::Absolute;
use sinew_estimate::estimate;
use sinew_estimate::estimate::{Estimate as Result_, EstimateError, Progress, Request};
use sinew_estimate::feeder::Injection;
use sinew_estimate::robot_dir;
use sinew_files::names::nearest;
use sinew_model::offset::VelocityFilter;
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
    watching: super::absolute::Watching,

    /// Which estimate [default: absolute with --baseline, else paper]
    #[arg(long, value_enum, group = "since", help_heading = "Method")]
    method: Option<Method>,
    /// Where the elastic torque comes from
    #[arg(long, value_enum, default_value = "observer", help_heading = "Method")]
    source: Source,
    /// How the lag of the observed torque is treated
    #[arg(long, value_enum, default_value = "matched", help_heading = "Method")]
    comparison: Lag,
    /// Observer gain K_I, 1/s [default: 20]
    #[arg(long, value_name = "1/S", value_parser = args::gain, allow_negative_numbers = true, help_heading = "Method")]
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
            self.watching.refuse_all()?;
        }
        let mut request = Request::new(self.log.clone());
        request.robot.clone_from(&self.robot);
        request.source = self.source.into();
        request.comparison = self.comparison.into();
        request.gain_per_s = self.gain;
        if let Some(filter) = self.velocity_filter {
            request.velocity_filter = filter;
        }
        request.use_tau_ext = self.tau_ext;
        request.injections.clone_from(&self.inject);
        request.reference.clone_from(&self.reference);
        request.open = self.opening.options()?;
        request.csv.clone_from(&self.csv);

        let (result, absolute) = self.estimate(&request)?;
        if !self.quiet && !self.json {
            let absolute = absolute.iter().flat_map(|a| &a.warnings);
            for warning in result.warnings.iter().chain(absolute) {
                complain("warning", &plain(warning));
            }
        }
        if let Some(path) = &self.report {
            let page = sinew_report::html_with(&result, absolute.as_ref());
            sinew_files::write_file(path, page.as_bytes())?;
        }
        if self.json {
            let mut document = serde_json::to_value(&result)?;
            if let (Some(absolute), Some(object)) = (&absolute, document.as_object_mut()) {
                object.insert("absolute".into(), serde_json::to_value(absolute)?);
            }
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            let mut text = told(&result);
            if let Some(absolute) = &absolute {
                text.push_str(&super::absolute::told(absolute, self.watching.nuisance));
            }
            answer(&text)?;
        }
        let passed =
            absolute.is_some_and(|a| a.joints.iter().any(|j| j.limit_passed == Some(true)));
        Ok(Finish::lossy(result.damaged || passed))
    }

    /// Whether the absolute estimate is asked for, beside the paper's.
    fn is_absolute(&self) -> bool {
        match self.method {
            Some(method) => method == Method::Absolute,
            None => self.baseline.is_some(),
        }
    }

    /// The paper's estimate and, where it is asked for, the absolute one.
    fn estimate(&self, request: &Request) -> Result<(Result_, Option<Absolute>), Failure> {
        let bar = Bar::new("estimating", self.quiet);
        let mut progress = |at: Progress| {
            bar.say(if at.reference {
                "reference "
            } else {
                "estimating"
            });
            bar.set(at.bytes_done as f64, at.bytes_total as f64);
        };
        let explain = |error| self.explain(error);
        if !self.is_absolute() {
            let result = estimate::run(request, &mut progress).map_err(explain)?;
            return Ok((result, None));
        }
        let baseline = self.baseline.as_deref();
        let (result, absolute) = self
            .watching
            .watch(request, baseline, explain, &mut progress)?;
        Ok((result, Some(absolute)))
    }

    fn check_files(&self) -> Result<(), Failure> {
        let outputs: Vec<_> = [
            ("--csv", &self.csv),
            ("--report", &self.report),
            ("--save", &self.watching.save),
        ]
        .into_iter()
        .filter_map(|(option, path)| Some((option, path.as_deref()?)))
        .collect();
        let inputs: Vec<_> = [
            ("the recording", Some(self.log.as_path())),
            ("the reference", self.reference.as_deref()),
            ("the baseline", self.baseline.as_deref()),
            ("the mapping file", self.opening.mapping()),
        ]
        .into_iter()
        .filter_map(|(name, path)| Some((name, path?)))
        .collect();
        check_outputs(&outputs, &inputs)
    }

    /// An error's message, with the joint that may have been meant.
    fn explain(&self, error: EstimateError) -> Failure {
        let mut message = error.to_string();
        if matches!(error, EstimateError::Injection(_)) {
            let names = self.robot_joints();
            let unknown = self.inject.iter().find(|i| !names.contains(&i.joint));
            if let Some(name) = unknown.and_then(|i| nearest(&i.joint, &names)) {
                message.push_str(&format!("; did you mean '{name}'?"));
            }
        }
        Failure::Refused(message)
    }

    fn robot_joints(&self) -> Vec<String> {
        let place = match &self.robot {
            Some(place) => Ok(place.clone()),
            None => robot_dir::find(&self.log),
        };
        place
            .and_then(|place| robot_dir::load(&place, None))
            .map(|loaded| loaded.robot.joint_names().to_vec())
            .unwrap_or_default()
    }
}

/// The estimate as text of at most 80 columns.
fn told(e: &Result_) -> String {
    let r = &e.recording;
    let mut out = paragraph(
        &plain(&format!(
            "{}: {}, {} s, {} frames at {} Hz",
            e.robot.name,
            r.path,
            sinew_figure::rounded(r.duration_s, 4),
            r.frames,
            sinew_figure::rounded(r.rate_hz, 4)
        )),
        2,
    );
    let head = [
        "joint",
        "offset\nmrad",
        "±\nmrad",
        "scatter\nmrad",
        "stretch\nmm",
        "strain\n%",
        "used\n%",
        "1 % of K\nmrad",
    ];
    let optional = |v: Option<f64>| v.map_or("–".to_string(), |v| sinew_figure::rounded(v, 3));
    let rows = e
        .joints
        .iter()
        .map(|j| {
            vec![
                plain(&j.name),
                sinew_figure::rounded(j.delta_e_mrad, 4),
                sinew_figure::rounded(j.standard_error_mrad, 2),
                sinew_figure::rounded(j.scatter_mrad, 2),
                optional(j.elongation_mm),
                optional(j.strain_percent),
                format!("{:.1}", 100.0 * j.usable_share),
                sinew_figure::rounded(j.stiffness_error_mrad_per_percent, 2),
            ]
        })
        .collect();
    out.push_str(&table(&head, rows, 1));
    out.push('\n');
    let changes = changes(e);
    let changed = !changes.is_empty();
    if changed {
        let head = [
            "joint",
            "reference\nmrad",
            "change\nmrad",
            "change\nmm",
            "1 % of K\nmrad",
        ];
        out.push_str(&table(&head, changes, 1));
        out.push('\n');
    }
    for joint in &e.joints {
        out.push_str(&paragraph(&plain(&sinew_report::headline(e, joint)), 2));
    }
    out.push('\n');
    for joint in &e.joints {
        // What every joint lost stands below, once.
        for loss in joint.losses.iter().filter(|l| !e.losses.contains(l)) {
            let line = format!(
                "not used: {} ({:.1} %) of {}, {}",
                frames(loss.frames),
                100.0 * loss.share,
                joint.name,
                loss.reason
            );
            out.push_str(&paragraph(&plain(&line), 2));
        }
    }
    for loss in &e.losses {
        let line = format!("not used: {}, {}", frames(loss.frames), loss.reason);
        out.push_str(&paragraph(&plain(&line), 2));
    }
    let rest = if changed {
        "The change is right as far as robot, payload and motion were alike."
    } else {
        "Right in differences; the absolute value rests on stiffness and masses. --reference LOG2 shows what changed."
    };
    out + &paragraph(rest, 0)
}

fn frames(count: u64) -> String {
    match count {
        1 => "1 frame".into(),
        n => format!("{n} frames"),
    }
}

/// Rows of what changed since the reference; none without one.
fn changes(e: &Result_) -> Vec<Vec<String>> {
    e.joints
        .iter()
        .filter_map(|j| j.difference.as_ref().map(|d| (j, d)))
        .map(|(j, d)| {
            vec![
                plain(&j.name),
                sinew_figure::rounded(d.reference_mrad, 4),
                sinew_figure::with_error(d.difference_mrad, d.standard_error_mrad),
                d.elongation_mm
                    .map_or("–".into(), |mm| sinew_figure::rounded(mm, 3)),
                sinew_figure::rounded(d.stiffness_error_mrad_per_percent, 2),
            ]
        })
        .collect()
}
