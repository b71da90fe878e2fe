//! The command line of Sinew: arguments in, tables and files out.
//!
//! No physics and no format lives here. Exit codes: 0 done, 1 input refused, 2 usage, 3 finished,
//! but data was lost or a threshold was passed. The result goes to stdout, everything else to
//! stderr. The program `sinew` and the command in the Python wheel call [`run`]; the modules that are public are how
//! every program of the project reads options, checks files and answers.

pub mod args;
mod commands;
pub mod files;
pub mod terminal;

use clap::{CommandFactory as _, Parser, Subcommand};
use commands::beside::Arguments;
use sinew_report::text;
use std::ffi::OsString;
use terminal::{Failure, Finish};

/// How far the rope tendons of a robot have stretched, from its encoders alone
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 80,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 done, 1 input refused, 2 usage, 3 finished, but data was lost\n\
                  or a threshold was passed.\n\n\
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
    /// Watch running robots: listen, learn, keep, alarm, show (runs sinew-watch)
    #[command(
        disable_help_flag = true,
        after_help = "Examples:\n  sinew watch --demo\n  sinew watch /etc/sinew/watch.toml"
    )]
    Watch(Arguments),
    /// Ask the records of a whole fleet: what they hold, and which tendon is due (runs sinew-fleet)
    #[command(
        disable_help_flag = true,
        after_help = "Examples:\n  sinew fleet rows /srv/records\n  sinew fleet query /srv/records \"SELECT count(*) FROM records\"\n  sinew fleet due /srv/records --within 30"
    )]
    Fleet(Arguments),
    Excitation(commands::excitation::Excitation),
    Simulate(commands::simulate::Simulate),
    /// Judge the absolute offset on many simulated recordings with known truth (runs sinew-bench)
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

/// Runs the command line, the first argument being the program's name, and returns its exit code.
///
/// Once a process: what was asked for is kept for all of it.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    run_program(arguments, |cli: Cli| {
        cli.style.apply();
        cli.command.run()
    })
}

/// Reads a program's command line, runs it, says how it ended, and returns the exit code.
///
/// Once a process: what was asked for is kept for all of it.
pub fn run_program<P: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
    run: impl FnOnce(P) -> Result<Finish, Failure>,
) -> u8 {
    let arguments = Vec::from_iter(arguments);
    terminal::set_arguments(arguments.clone());
    let result = match P::try_parse_from(arguments) {
        Ok(program) => run(program),
        // Wrong usage; nobody is left to tell where stderr is closed.
        Err(error) if error.use_stderr() => {
            let _ = error.print();
            return 2;
        }
        // What --help and --version ask for is an answer like any other.
        Err(error) => terminal::answer(&error.to_string()).map(|()| Finish::Complete),
    };
    terminal::end();
    match result {
        Ok(Finish::Complete) => 0,
        Ok(Finish::Lossy) => 3,
        Ok(Finish::Refused) => 1,
        // The reader has gone (`sinew … | head`): nothing is left to say, and nobody to say it to.
        Err(Failure::ReaderGone) => 0,
        Err(Failure::Refused(message)) => {
            terminal::complain(terminal::Word::Error, &message);
            1
        }
    }
}
