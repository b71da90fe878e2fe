//! Programs of their own that are commands of this one.

use crate::terminal::{Failure, Finish};
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

/// Runs the program beside this one, else the one in PATH, as cargo runs its subcommands. `missing`: how to get it.
pub(crate) fn run(program: &str, arguments: &[OsString], missing: &str) -> Result<Finish, Failure> {
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
