//! `sinew baseline`: what a recording right after tensioning teaches.

use crate::args::Opening;
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, answer, complain};
use crate::text::{paragraph, plain, table};
use clap::Args;
use sinew_lab::absolute;
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
    window: super::absolute::Part,
    #[command(flatten)]
    opening: Opening,
    /// Print one JSON document instead of the table (no value: null)
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// No progress and no warnings on stderr
    #[arg(long, help_heading = "Output")]
    quiet: bool,
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
