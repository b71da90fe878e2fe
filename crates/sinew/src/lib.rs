//! Command line of Sinew.
//!
//! Exit codes: 0 success, 1 invalid input, 2 invalid usage, 3 success with lost data or an exceeded limit. Results are
//! written to stdout, everything else to stderr. The program `sinew` and the command of the Python package call [`run`].
//! The public modules parse options, check files and write results for all programs of the project.

pub mod args;
mod commands;
pub mod files;
pub mod terminal;

use clap::{CommandFactory as _, Parser, Subcommand};
use commands::external::Arguments;
use sinew_report::text;
use std::ffi::OsString;
use terminal::{Failure, Finish};

/// Estimate the elongation of the rope tendons of a robot from its encoders
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 80,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 success, 1 invalid input, 2 invalid usage, 3 success, but data\n\
                  lost or limit exceeded.\n\n\
                  Example:\n  sinew estimate monday.mcap --robot robots/biorob-like --report monday.html"
)]
struct Cli {
    #[command(flatten)]
    style: terminal::Style,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Init(commands::init::InitCommand),
    Estimate(Box<commands::estimate::Estimate>),
    Baseline(Box<commands::baseline::Baseline>),
    Trend(Box<commands::trend::Trend>),
    /// Monitor running robots: estimates, records, alarms, web page (runs sinew-watch)
    #[command(
        disable_help_flag = true,
        after_help = "Examples:\n  sinew watch --demo\n  sinew watch /etc/sinew/watch.toml"
    )]
    Watch(Arguments),
    /// Query the records of a fleet: tables, comparison, maintenance due (runs sinew-fleet)
    #[command(
        disable_help_flag = true,
        after_help = "Examples:\n  sinew fleet rows /srv/records\n  sinew fleet query /srv/records \"SELECT count(*) FROM records\"\n  sinew fleet due /srv/records --within 30"
    )]
    Fleet(Arguments),
    Excitation(commands::excitation::Excitation),
    Simulate(commands::simulate::Simulate),
    /// Validate the absolute offset on simulated recordings with known truth (runs sinew-bench)
    #[command(
        disable_help_flag = true,
        after_help = "Examples:\n  sinew scenarios run --scenario S7 --n 200 --out s7.jsonl\n  sinew scenarios show S7"
    )]
    Scenarios(Arguments),
    /// Reproduce a figure of the paper from simulations (runs sinew-bench)
    #[command(
        disable_help_flag = true,
        after_help = "Example:\n  sinew paper fig6 --out figures"
    )]
    Paper(Arguments),
    #[command(subcommand)]
    Bench(commands::bench::BenchCommand),
    #[command(subcommand)]
    Rope(commands::rope::Rope),
    #[command(subcommand)]
    Creep(Box<commands::creep::Creep>),
    #[command(subcommand)]
    Robot(commands::robot::Robot),
    #[command(subcommand)]
    Log(commands::log::Log),
    Completions(commands::shell::Completions),
    Man(commands::shell::Man),
}

impl Command {
    fn run(self) -> Result<Finish, Failure> {
        match self {
            Self::Init(command) => command.run(),
            Self::Estimate(command) => command.run(),
            Self::Baseline(command) => command.run(),
            Self::Trend(command) => command.run(),
            Self::Watch(arguments) => arguments.watch(),
            Self::Fleet(arguments) => arguments.fleet(),
            Self::Excitation(command) => command.run(),
            Self::Simulate(command) => command.run(),
            Self::Scenarios(arguments) => arguments.bench("scenarios"),
            Self::Paper(arguments) => arguments.bench("paper"),
            Self::Bench(command) => command.run(),
            Self::Rope(command) => command.run(),
            Self::Creep(command) => command.run(),
            Self::Robot(command) => command.run(),
            Self::Log(command) => command.run(),
            Self::Completions(command) => command.run(Cli::command()),
            Self::Man(command) => command.run(Cli::command()),
        }
    }
}

/// Runs the command line and returns the exit code. Call it once per process.
///
/// * `arguments`: arguments, starting with the name of the program.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    run_program(arguments, |cli: Cli| {
        cli.style.apply();
        cli.command.run()
    })
}

/// Parses the command line of a program, runs it, and returns the exit code. Call it once per process.
///
/// * `arguments`: arguments, starting with the name of the program.
/// * `run`: the program; its error is printed to stderr.
pub fn run_program<P: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
    run: impl FnOnce(P) -> Result<Finish, Failure>,
) -> u8 {
    let arguments = Vec::from_iter(arguments);
    terminal::set_arguments(arguments.clone());
    let result = match P::try_parse_from(arguments) {
        Ok(program) => run(program),
        // Invalid usage. A closed stderr is ignored.
        Err(error) if error.use_stderr() => {
            let _ = error.print();
            return 2;
        }
        // Output of --help and --version.
        Err(error) => terminal::answer(&error.to_string()).map(|()| Finish::Complete),
    };
    terminal::end();
    match result {
        Ok(Finish::Complete) => 0,
        Ok(Finish::Lossy) => 3,
        Ok(Finish::InvalidInput) => 1,
        // The reader closed the pipe (`sinew … | head`).
        Err(Failure::ReaderGone) => 0,
        Err(Failure::Error(message)) => {
            terminal::complain(terminal::Word::Error, &message);
            1
        }
    }
}
