//! `sinew baseline`: what a recording right after tensioning teaches.

use crate::args::Opening;
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, answer, complain};
use crate::text::{paragraph, plain, table};
use clap::Args;
use sinew_lab::absolute::{self, Absolute, Window};
use sinew_lab::estimate::Request;
use sinew_lab::report;
use std::path::PathBuf;

/// Learn a baseline from a recording taken right after tensioning
///
/// Offsets are zero by definition then, so that stiffness, masses, friction and encoder errors
/// show. The gripper is empty; a dozen poses that move every joint through its range in a minute
/// are a good recording. Then: sinew estimate LOG --baseline FILE
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew baseline first-day.mcap --robot robots/biorob-like --out first-day.baseline")]
pub(crate) struct Baseline {
    /// Recording taken right after tensioning
    log: PathBuf,
    /// Robot's folder [default: beside LOG, then the current folder]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Where the baseline goes
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    window: Part,
    #[command(flatten)]
    opening: Opening,
    /// Print one JSON document instead of the table (no value: null)
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// No progress and no warnings on stderr
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

/// Which part of the recording.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct Part {
    /// Use the recording from here on, s
    #[arg(long = "from", value_name = "S", default_value_t = 0.0)]
    from_s: f64,
    /// Use the recording up to here, s
    #[arg(long = "to", value_name = "S")]
    to_s: Option<f64>,
}

impl Part {
    /// The window, if it has a length.
    pub(crate) fn window(self) -> Result<Window, Failure> {
        let window = Window {
            from_s: self.from_s,
            to_s: self.to_s.unwrap_or(f64::INFINITY),
        };
        if window.from_s >= 0.0 && window.from_s < window.to_s {
            return Ok(window);
        }
        Err(Failure::Refused(format!(
            "--from {} s --to {} s: the part must start at 0 s or later and end after its start",
            window.from_s, window.to_s
        )))
    }
}

impl Baseline {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        check_outputs(
            &[("--out", self.out.as_path())],
            &[("the recording", self.log.as_path())],
        )?;
        let window = self.window.window()?;
        let mut request = Request::new(self.log.clone());
        request.robot.clone_from(&self.robot);
        request.open = self.opening.options()?;
        let bar = Bar::new("learning", self.quiet);
        let learned = absolute::learn(&request, window, &mut |at| {
            bar.set(at.bytes_done as f64, at.bytes_total as f64);
        });
        drop(bar);
        let (baseline, said) = learned.map_err(|e| Failure::Refused(e.to_string()))?;
        baseline.write(&self.out)?;
        if !self.quiet && !self.json {
            for warning in said.warnings.iter().filter(|w| !w.starts_with("without")) {
                complain("warning", &plain(warning));
            }
        }
        if self.json {
            answer(&(serde_json::to_string_pretty(&said)? + "\n"))?;
            return Ok(Finish::lossy(said.damaged));
        }
        let mut text = paragraph(
            &plain(&format!(
                "{}: {} s, {} poses, {:.0} % left out as disturbed",
                said.recording,
                report::rounded(said.duration_s, 4),
                said.poses,
                100.0 * said.left_out_share
            )),
            2,
        );
        let rows = said
            .joints
            .iter()
            .map(|j| {
                let [change, interval] = j.stiffness_change_percent;
                vec![
                    plain(&j.name),
                    report::rounded(change, 2),
                    report::rounded(interval, 2),
                ]
            })
            .collect();
        text.push_str(&table(
            &["joint", "stiffness against robot.toml\n%", "± (95 %)\n%"],
            rows,
            1,
        ));
        text.push('\n');
        text.push_str(&paragraph(
            &plain(&format!("baseline written to {}", self.out.display())),
            2,
        ));
        answer(&text)?;
        Ok(Finish::lossy(said.damaged))
    }
}

/// Offsets since a baseline as text of at most 80 columns.
pub(crate) fn told(said: &Absolute) -> String {
    let head = [
        "joint",
        "since baseline\nmrad",
        "± (95 %)\nmrad",
        "stretch\nmm",
        "± (95 %)\nmm",
        "verdict",
    ];
    let optional = |v: Option<f64>| v.map_or("–".to_string(), |v| report::rounded(v, 2));
    let rows = said
        .joints
        .iter()
        .map(|j| {
            vec![
                plain(&j.name),
                report::rounded(j.offset_mrad, 3),
                report::rounded(j.interval_95_mrad, 2),
                optional(j.elongation_mm),
                optional(j.interval_95_mm),
                j.verdict.clone(),
            ]
        })
        .collect();
    let mut text = table(&head, rows, 1);
    text.push('\n');
    for joint in &said.joints {
        for step in &joint.steps {
            text.push_str(&paragraph(
                &plain(&format!(
                    "{}: a sudden change of {} ± {} mrad at {:.0} s",
                    joint.name,
                    report::rounded(step.size_mrad, 3),
                    report::rounded(step.interval_95_mrad, 2),
                    step.time_s
                )),
                2,
            ));
        }
    }
    text.push_str(&paragraph(
        &format!(
            "payload {} ± {} kg; {:.0} % of the time left out as contact or disturbance; {} poses",
            report::rounded(said.payload_kg[0], 2),
            report::rounded(said.payload_kg[1], 2),
            100.0 * said.left_out_share,
            said.poses
        ),
        2,
    ));
    text
}
