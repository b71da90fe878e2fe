//! The program `sinew-bench`: simulation studies of the accuracy of the estimates.
//!
//! `sinew paper`, `sinew scenarios` and `sinew trend simulate-year` run it.

mod commands;

use clap::{Parser, Subcommand};
use sinew::terminal::{Failure, Finish, Style};
use std::process::ExitCode;

/// Simulation studies of the accuracy of the estimates, and the figures of the paper
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 80,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 done, 1 input refused, 2 usage, 3 finished, but data was lost\n\
                  or a threshold was passed."
)]
struct Cli {
    #[command(flatten)]
    style: Style,
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    Paper(commands::paper::Paper),
    #[command(subcommand)]
    Scenarios(commands::scenarios::Scenarios),
    SimulateYear(Box<commands::simulate_year::SimulateYear>),
}

impl Study {
    fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::Paper(study) => study.run(),
            Self::Scenarios(study) => study.run(),
            Self::SimulateYear(study) => study.run(),
        }
    }
}

fn main() -> ExitCode {
    ExitCode::from(sinew::run_program(std::env::args_os(), |cli: Cli| {
        cli.style.apply();
        cli.study.run()
    }))
}
