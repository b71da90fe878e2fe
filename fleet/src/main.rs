//! `sinew-fleet`: arguments in, an answer out.

use clap::Parser as _;
use sinew_fleet::args::Args;
use std::process::ExitCode;

fn main() -> ExitCode {
    match sinew_fleet::run(&Args::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(1)
        }
    }
}
