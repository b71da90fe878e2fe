//! The command line of Sinew: arguments in, tables and files out.
//!
//! No physics and no format lives here. Exit codes: 0 done, 1 input refused, 2 usage, 3 finished,
//! but data was lost or a threshold was passed. The result goes to stdout, everything else to
//! stderr.

mod args;
mod commands;
mod files;
mod terminal;

use clap::{CommandFactory as _, Parser, Subcommand};
use sinew_report::text;
use std::process::ExitCode;
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

fn main() -> ExitCode {
    let cli = Cli::parse();
    cli.style.apply();
    let result = match cli.command {
        Command::Init(command) => command.run(),
        Command::Estimate(command) => command.run(),
        Command::Baseline(command) => command.run(),
        Command::Trend(command) => command.run(),
        Command::Excitation(command) => command.run(),
        Command::Simulate(command) => command.run(),
        Command::Scenarios(command) => command.run(),
        Command::Paper(command) => command.run(),
        Command::Bench(command) => command.run(),
        Command::Rope(command) => command.run(),
        Command::Creep(command) => command.run(),
        Command::Robot(command) => command.run(),
        Command::Log(command) => command.run(),
        Command::Completions(command) => command.run(Cli::command()),
        Command::Man(command) => command.run(Cli::command()),
    };
    if result.is_ok() {
        terminal::end();
    }
    match result {
        Ok(Finish::Complete) => ExitCode::SUCCESS,
        Ok(Finish::Lossy) => ExitCode::from(3),
        Ok(Finish::Refused) => ExitCode::from(1),
        // The reader has gone (`sinew … | head`): nothing is left to say, and nobody to say it to.
        Err(Failure::ReaderGone) => ExitCode::SUCCESS,
        Err(Failure::Refused(message)) => {
            terminal::complain(terminal::Word::Error, &message);
            ExitCode::from(1)
        }
    }
}
