//! Programs of their own that are commands of this one.

use crate::terminal::{Failure, Finish, style_arguments};
use clap::Args;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

/// What is passed on as it is.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// What the program is given; --help lists it
    #[arg(
        trailing_var_arg = true,
        allow_hyphen_values = true,
        value_name = "ARGUMENTS"
    )]
    arguments: Vec<OsString>,
}

impl Arguments {
    /// Runs the monitor.
    pub(crate) fn watch(self) -> Result<Finish, Failure> {
        const MISSING: &str = "sinew-watch, the monitor, was not found beside sinew or in PATH; \
             install it with cargo install --path crates/sinew-watch";
        run("sinew-watch", self.arguments, MISSING)
    }

    /// Asks a fleet's records.
    pub(crate) fn fleet(self) -> Result<Finish, Failure> {
        const MISSING: &str = "sinew-fleet, which queries the records of a fleet, was not found beside sinew or in PATH; \
             install it with cargo install --path fleet";
        run("sinew-fleet", self.arguments, MISSING)
    }

    /// Runs a study of the laboratory.
    pub(crate) fn bench(self, study: &str) -> Result<Finish, Failure> {
        const MISSING: &str = "sinew-bench, which runs simulation studies, was not found beside sinew or in PATH; \
             install it with cargo install --path crates/sinew-bench";
        let mut arguments = vec![study.into()];
        arguments.extend(style_arguments());
        arguments.extend(self.arguments);
        run("sinew-bench", arguments, MISSING)
    }
}

/// Runs the program beside this one, else the one in PATH, as cargo runs its subcommands. `missing`: how to get it.
fn run(program: &str, arguments: Vec<OsString>, missing: &str) -> Result<Finish, Failure> {
    let name = format!("{program}{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe()
        .ok()
        .map(|exe| exe.with_file_name(&name));
    let program = beside
        .filter(|path| path.is_file())
        .unwrap_or(PathBuf::from(name));
    let mut command = Command::new(&program);
    command.args(arguments);
    let error = match start(&mut command) {
        Ok(finish) => return Ok(finish),
        Err(error) => error,
    };
    Err(Failure::Refused(match error.kind() {
        ErrorKind::NotFound => missing.into(),
        _ => format!("{}: can't be run: {error}", program.display()),
    }))
}

/// Becomes the program; returns only where that can't be.
#[cfg(unix)]
fn start(command: &mut Command) -> std::io::Result<Finish> {
    use std::os::unix::process::CommandExt as _;
    Err(command.exec())
}

/// Runs the program and ends as it does.
#[cfg(not(unix))]
fn start(command: &mut Command) -> std::io::Result<Finish> {
    Ok(match command.status()?.code() {
        Some(0) => Finish::Complete,
        Some(3) => Finish::Lossy,
        _ => Finish::Refused,
    })
}
