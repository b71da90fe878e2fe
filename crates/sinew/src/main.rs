//! The program `sinew`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(sinew::run(std::env::args_os()))
}
