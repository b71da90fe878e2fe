//! The program `sinew-bench`: simulation studies of the accuracy of the estimates.
//!
//! `sinew paper`, `sinew scenarios` and `sinew trend simulate` run it.

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
    after_help = "Exit codes: 0 done, 1 invalid input, 2 usage, 3 finished, but data was lost\n\
                  or a threshold was exceeded."
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
    TrendSimulate(Box<commands::trend_simulate::TrendSimulate>),
    Validation(commands::validation::Validation),
}

impl Study {
    fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::Paper(study) => study.run(),
            Self::Scenarios(study) => study.run(),
            Self::TrendSimulate(study) => study.run(),
            Self::Validation(study) => study.run(),
        }
    }
}

fn main() -> ExitCode {
    ExitCode::from(sinew::run_program(std::env::args_os(), |cli: Cli| {
        cli.style.apply();
        cli.study.run()
    }))
}
