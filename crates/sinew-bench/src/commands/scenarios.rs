//! `sinew scenarios`: accuracy of the absolute offset over many simulated recordings.

use clap::{Args, Subcommand};
use sinew::files::{check_outputs, write_table};
use sinew::terminal::{Bar, Failure, Finish, answer, answer_as};
use sinew_bench::scenarios;
use sinew_bench::scenarios::{Options, Sessions};
use sinew_estimate::robot_dir;
use sinew_sim::protocol::{DEFAULT, UNMODELLED, plan_adapted, plan_named, variants};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Assess the absolute offset on many simulated recordings with known truth
#[derive(Debug, Subcommand)]
pub(crate) enum Scenarios {
    Run(Run),
    Show(Show),
}

/// Simulate, estimate, compare with the truth
///
/// Each recording has a session A of one minute for the baseline, a session B assessed at its end, and a session C in
/// which two tendons slip by 5 mrad. The draws are documented in docs/src/validation.md.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew scenarios run --n 200 --out s7.jsonl --scenario S7\n  \
    sinew scenarios run --robot my-robot --scenario S7\n  \
    sinew scenarios run --variants --n 8 --out variants.jsonl\n\n\
    A stopped run resumes with the same --out.")]
pub(crate) struct Run {
    /// Scenario name, or file (.toml) with sessions A, B and C; repeatable [default: S5 S6 S7 S8]
    #[arg(long, value_name = "NAME")]
    scenario: Vec<String>,
    /// Folder of the robot: S5 to S8b with its joints, masses, stiffness, friction and limits
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Run the scenarios with errors that the estimator does not model (U1, U2, …)
    #[arg(long, conflicts_with_all = ["scenario", "robot"])]
    unmodelled: bool,
    /// Run conditions outside the protocol: constant external forces, creep, an arm that is not zeroed and more;
    /// assesses every offset at the end of B, and of C with the posterior of B as prior. With --scenario: those
    /// scenarios instead, assessed in the same way
    #[arg(long, conflicts_with_all = ["robot", "unmodelled", "no_steps"])]
    variants: bool,
    /// Assess the online estimate at every block of B and C instead of the ends: time to the first useful estimate,
    /// time outside the interval without a warning, response to a slip
    #[arg(long, conflicts_with_all = ["variants", "no_steps", "no_motor_torque", "table"])]
    trajectory: bool,
    /// Recordings per scenario
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    n: u64,
    /// Seed of the first recording; the others follow
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Omit session C: half the time, no slips
    #[arg(long)]
    no_steps: bool,
    /// Use motor and joint positions only, without motor torque
    #[arg(long)]
    no_motor_torque: bool,
    /// Number of threads [default: number of CPU cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1024))]
    jobs: Option<u64>,
    /// File with a line of JSON per recording; recordings in it are not run again
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Write a row per recording and joint; .csv or .parquet
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    table: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long, help_heading = "Output")]
    json: bool,
}

/// Print a scenario as `sinew simulate` reads it
#[derive(Debug, Args)]
pub(crate) struct Show {
    /// Name of the scenario, such as S7
    name: String,
    /// Adapt it to the robot in this folder
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
                        plan_adapted(&show.name, &robot_dir::load(folder, None)?.robot)?
                    }
                    None => plan_named(&show.name)?,
                };
                answer(&plan.text)?;
                Ok(Finish::Complete)
            }
        }
    }
}

impl Run {
    fn run(&self) -> Result<Finish, Failure> {
        let [out, table] = [
            ("--out", self.out.as_deref()),
            ("--table", self.table.as_deref()),
        ];
        // Earlier results are resumed, not replaced.
        check_outputs(&[out], &[])?;
        check_outputs(&[table], &[out])?;
        let names = |list: &[&str]| list.iter().map(ToString::to_string).collect();
        let mut wanted: Vec<String> = if self.unmodelled {
            names(&UNMODELLED)
        } else if self.variants && self.scenario.is_empty() {
            variants().map(String::from).collect()
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
            sessions: if self.variants {
                Sessions::Chain
            } else {
                Sessions::with_slips(!self.no_steps)
            },
            motor_torque: !self.no_motor_torque,
            jobs: self.jobs.unwrap_or(cores) as usize,
            out: self.out.clone(),
        };
        let bar = Bar::new("recordings");
        let mut progress = |done, all| bar.set(done as f64, all as f64);
        if self.trajectory {
            let report = scenarios::run_trajectories(&options, &mut progress)?;
            drop(bar);
            answer_as(self.json, &report, scenarios::render_trajectories)?;
            return Ok(match report.scenarios.iter().all(|s| s.recordings == 0) {
                true => Finish::InvalidInput,
                false => Finish::lossy(!report.rejections.is_empty()),
            });
        }
        let (report, recordings) = scenarios::run_recordings(&options, &mut progress)?;
        drop(bar);
        write_table(self.table.as_deref(), || scenarios::rows(&recordings))?;
        let render = if self.variants {
            scenarios::render_ends
        } else {
            scenarios::render_table
        };
        answer_as(self.json, &report, render)?;
        // A run without an assessed recording is not a success.
        Ok(match recordings.is_empty() {
            true => Finish::InvalidInput,
            false => Finish::lossy(!report.rejections.is_empty()),
        })
    }
}
