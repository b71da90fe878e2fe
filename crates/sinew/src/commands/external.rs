//! Commands that run another program.

use crate::terminal::{Failure, Finish, style_arguments};
use clap::Args;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

/// Arguments passed to another program unchanged.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Arguments of the program; see --help
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
        const MISSING: &str = "sinew-watch (monitor) not found in the folder of sinew or in PATH; \
             install it with cargo install --path crates/sinew-watch";
        run("sinew-watch", self.arguments, MISSING)
    }

    /// Runs the fleet queries.
    pub(crate) fn fleet(self) -> Result<Finish, Failure> {
        const MISSING: &str = "sinew-fleet (fleet queries) not found in the folder of sinew or in PATH; \
             install it with cargo install --path fleet";
        run("sinew-fleet", self.arguments, MISSING)
    }

    /// Runs a simulation study.
    pub(crate) fn bench(self, study: &str) -> Result<Finish, Failure> {
        const MISSING: &str = "sinew-bench (simulation studies) not found in the folder of sinew or in PATH; \
             install it with cargo install --path crates/sinew-bench";
        let mut arguments = vec![study.into()];
        arguments.extend(style_arguments());
        arguments.extend(self.arguments);
        run("sinew-bench", arguments, MISSING)
    }
}

/// Runs a program from the folder of this one, else from PATH.
///
/// * `missing`: error if it is not found.
fn run(program: &str, arguments: Vec<OsString>, missing: &str) -> Result<Finish, Failure> {
    let name = format!("{program}{}", std::env::consts::EXE_SUFFIX);
    let sibling = std::env::current_exe()
        .ok()
        .map(|exe| exe.with_file_name(&name));
    let program = sibling
        .filter(|path| path.is_file())
        .unwrap_or(PathBuf::from(name));
    let mut command = Command::new(&program);
    command.args(arguments);
    let error = match start(&mut command) {
        Ok(finish) => return Ok(finish),
        Err(error) => error,
    };
    Err(Failure::Error(match error.kind() {
        ErrorKind::NotFound => missing.into(),
        _ => format!("{}: cannot be run: {error}", program.display()),
    }))
}

/// Replaces this process by the program; returns only on failure.
#[cfg(unix)]
fn start(command: &mut Command) -> std::io::Result<Finish> {
    use std::os::unix::process::CommandExt as _;
    Err(command.exec())
}

/// Runs the program and returns its exit state.
#[cfg(not(unix))]
fn start(command: &mut Command) -> std::io::Result<Finish> {
    Ok(match command.status()?.code() {
        Some(0) => Finish::Complete,
        Some(3) => Finish::Lossy,
        _ => Finish::InvalidInput,
    })
}
