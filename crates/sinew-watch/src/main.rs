//! Entry point of `sinew-watch`.

use clap::Parser as _;
use sinew_watch::args::Args;
use std::process::ExitCode;

fn main() -> ExitCode {
    match sinew_watch::run(&Args::parse()) {
        Ok(code) => code,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(1)
        }
    }
}
