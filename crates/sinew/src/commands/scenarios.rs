//! `sinew scenarios`: how good the absolute offset is, over many simulated recordings.

use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, answer};
use crate::text::{paragraph, plain, table};
use clap::{Args, Subcommand};
use sinew_estimate::robot_dir;
use sinew_eval::scenarios;
use sinew_eval::scenarios::{DEFAULT, Options, Plan, ScenarioSummary, UNMODELLED};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Judge the absolute offset on many simulated recordings with known truth
#[derive(Debug, Subcommand)]
pub(crate) enum Scenarios {
    Run(Run),
    Show(Show),
}

/// Simulate, estimate, compare with the truth
///
/// Each recording has a session A of a minute that teaches the baseline, B that is judged at its
/// end, and C in which two tendons slip by 5 mrad. What is drawn stands in docs/src/science/scenarios.md.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew scenarios run --n 200 --out s7.jsonl --scenario S7\n  \
    sinew scenarios run --robot my-robot --scenario S7\n\n\
    A run that was stopped goes on where it was with the same --out.")]
pub(crate) struct Run {
    /// Scenario by its name, or a file (.toml) of your own with sessions A, B and C; give several
    /// times for several [default: S5 S6 S7 S8]
    #[arg(long, value_name = "NAME")]
    scenario: Vec<String>,
    /// Your robot's folder: S5 to S8b with its joints, masses, stiffness, friction and limits
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// The errors of the model that the estimator doesn't know of (U1, U2, …)
    #[arg(long, conflicts_with_all = ["scenario", "robot"])]
    unmodelled: bool,
    /// Recordings per scenario
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    n: u64,
    /// Seed of the first recording; the others follow
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Without session C: half the time, no slips
    #[arg(long)]
    no_steps: bool,
    /// Motor and joint positions alone, without the motor's torque
    #[arg(long)]
    no_motor_torque: bool,
    /// Threads [default: as many as the machine has]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1024))]
    jobs: Option<u64>,
    /// A line of JSON per recording; recordings that are there already aren't run again
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// No progress on stderr
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

/// Print a scenario as `sinew simulate` reads it
#[derive(Debug, Args)]
pub(crate) struct Show {
    /// Its name, such as S7
    name: String,
    /// For the robot in this folder
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
}

impl Scenarios {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::Run(run) => run.run(),
            Self::Show(show) => {
                let plan = match &show.robot {
                    Some(folder) => {
                        Plan::adapted(&show.name, &robot_dir::load(folder, None)?.robot)?
                    }
                    None => Plan::named(&show.name)?,
                };
                answer(&plan.text)?;
                Ok(Finish::Complete)
            }
        }
    }
}

impl Run {
    fn run(&self) -> Result<Finish, Failure> {
        if let Some(out) = &self.out {
            check_outputs(&[("--out", out.as_path())], &[])?;
        }
        let names = |list: &[&str]| list.iter().map(ToString::to_string).collect();
        let mut wanted: Vec<String> = if self.unmodelled {
            names(&UNMODELLED)
        } else if self.scenario.is_empty() {
            names(&DEFAULT)
        } else {
            self.scenario.clone()
        };
        let mut seen = BTreeSet::new();
        wanted.retain(|name| seen.insert(name.clone()));
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
        let options = Options {
            scenarios: wanted,
            robot: self.robot.clone(),
            n: self.n,
            first_seed: self.seed,
            steps: !self.no_steps,
            motor_torque: !self.no_motor_torque,
            jobs: self.jobs.unwrap_or(cores) as usize,
            out: self.out.clone(),
        };
        let bar = Bar::new("recordings", self.quiet);
        let summary = scenarios::run(&options, &mut |done, all| bar.set(done as f64, all as f64));
        drop(bar);
        let summary = summary?;
        if self.json {
            answer(&(serde_json::to_string_pretty(&summary)? + "\n"))?;
        } else {
            answer(&told(&summary.scenarios, options.steps))?;
        }
        Ok(Finish::Complete)
    }
}

/// Results as text of at most 80 columns.
fn told(summaries: &[ScenarioSummary], steps: bool) -> String {
    let robots: BTreeSet<String> = summaries.iter().map(|s| plain(&s.robot)).collect();
    let robots = Vec::from_iter(robots).join(", ");
    let mut text = format!("{robots}: offset at the end of session B, mrad; estimate less truth\n");
    let mut rows = Vec::new();
    for s in summaries {
        let mut head = vec![format!("{}, n = {}", s.scenario, s.recordings)];
        head.resize(9, String::new());
        rows.push(head);
        for j in &s.joints {
            rows.push(vec![
                plain(&j.name),
                short(j.bias_mrad),
                short(j.rmse_mrad),
                short(j.q95_error_mrad),
                short(j.interval_95_mrad),
                short(100.0 * j.coverage),
                optional(j.bound_mrad),
                optional(j.paper_rmse_mrad),
                optional(j.paper_minus_baseline_rmse_mrad),
            ]);
        }
    }
    let head = [
        "joint", "bias", "RMSE", "95 %", "±", "in, %", "bound", "paper", "−A",
    ];
    text.push_str(&table(&head, rows, 1));
    text.push('\n');
    text.push_str(&paragraph(
        "95 %: quantile of the size of the error; ±: mean half-width of the 95 % interval; \
         in: truths inside it; bound: Bayesian Cramér–Rao; paper: RMSE of the paper's mean, −A: less its own \
         of session A",
        0,
    ));
    for s in summaries {
        if let Some(about) = &s.about {
            text.push_str(&paragraph(&format!("{}: {about}", s.scenario), 2));
        }
    }
    if steps {
        text.push_str("\nSlips in session C, with 20 s of recording after them\n");
        text.push_str(&slips(summaries));
    }
    text.push_str(&warned(summaries));
    text
}

/// Three digits or so, in five characters.
fn short(v: f64) -> String {
    let decimals = match v.abs() {
        x if x < 9.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    format!("{v:.decimals$}").replace('-', "−")
}

fn optional(v: Option<f64>) -> String {
    v.map_or("–".into(), short)
}

fn slips(summaries: &[ScenarioSummary]) -> String {
    let mut rows = Vec::new();
    for s in summaries {
        for (k, step) in s.steps.iter().enumerate() {
            let first = |text: String| if k == 0 { text } else { String::new() };
            rows.push(vec![
                first(s.scenario.clone()),
                plain(&step.joint),
                short(100.0 * step.found),
                optional(step.found_rmse_mrad),
                optional(step.moment_interval_95_s),
                optional(step.moment_coverage.map(|c| 100.0 * c)),
                optional(step.delay_s),
                optional(step.delay_90_s),
                first(short(s.false_alarms_per_hour)),
            ]);
        }
    }
    let head = [
        "",
        "joint",
        "found\n%",
        "RMSE\nmrad",
        "moment\n± s",
        "in\n%",
        "delay\ns",
        "90 %\ns",
        "false\n1/h",
    ];
    table(&head, rows, 2)
}

/// Which warnings were given how often.
fn warned(summaries: &[ScenarioSummary]) -> String {
    let mut text = String::new();
    for s in summaries {
        for (warning, share) in &s.warnings {
            text.push_str(&paragraph(
                &format!("{}, {:.0} %: {}", s.scenario, 100.0 * share, plain(warning)),
                2,
            ));
        }
    }
    if text.is_empty() {
        text
    } else {
        format!("\nWarnings, and in how many of the recordings\n{text}")
    }
}
