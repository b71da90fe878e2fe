//! The command line of Sinew: arguments in, tables and files out.
//!
//! No physics and no format lives here. Exit codes: 0 done, 1 input refused, 2 usage, 3 finished,
//! but data was lost or a threshold was passed. The result goes to stdout, everything else to
//! stderr. [`run`] is all there is: the program `sinew` and the command in the Python wheel call it.

mod args;
mod commands;
mod files;
mod terminal;

use clap::{CommandFactory as _, Parser, Subcommand};
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
    Watch(commands::watch::Watch),
    Fleet(commands::fleet::Fleet),
    Excitation(commands::excitation::Excitation),
    Simulate(commands::simulate::Simulate),
    #[command(subcommand)]
    Scenarios(commands::scenarios::Scenarios),
    Paper(commands::paper::Paper),
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
            Self::Watch(command) => command.run(),
            Self::Fleet(command) => command.run(),
            Self::Excitation(command) => command.run(),
            Self::Simulate(command) => command.run(),
            Self::Scenarios(command) => command.run(),
            Self::Paper(command) => command.run(),
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
    let arguments = Vec::from_iter(arguments);
    terminal::set_arguments(arguments.clone());
    let result = match Cli::try_parse_from(arguments) {
        Ok(cli) => {
            cli.style.apply();
            cli.command.run()
        }
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
