//! Entry point of `sinew-watch`.

use clap::Parser as _;
use sinew_watch::args::Args;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Args::parse();
    match sinew_files::multiply_budgets().and_then(|()| sinew_watch::run(&arguments)) {
        Ok(code) => code,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(1)
        }
    }
}
