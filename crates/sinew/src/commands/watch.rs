//! `sinew watch`: runs the monitor, a program of its own.

use crate::terminal::{Failure, Finish};
use clap::Args;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

/// Watch running robots: listen, learn, keep, alarm, show (runs sinew-watch)
#[derive(Debug, Args)]
#[command(
    disable_help_flag = true,
    after_help = "Examples:\n  sinew watch --demo\n  sinew watch /etc/sinew/watch.toml"
)]
pub(crate) struct Watch {
    /// What sinew-watch is given; `sinew watch --help` lists it
    #[arg(
        trailing_var_arg = true,
        allow_hyphen_values = true,
        value_name = "ARGUMENTS"
    )]
    arguments: Vec<OsString>,
}

impl Watch {
    /// Runs the program beside this one, else the one in PATH, as cargo runs its subcommands.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let name = format!("sinew-watch{}", std::env::consts::EXE_SUFFIX);
        let beside = std::env::current_exe()
            .ok()
            .map(|exe| exe.with_file_name(&name));
        let program = beside
            .filter(|path| path.is_file())
            .unwrap_or(PathBuf::from(name));
        let mut command = Command::new(&program);
        command.args(&self.arguments);
        let error = match start(&mut command) {
            Ok(finish) => return Ok(finish),
            Err(error) => error,
        };
        Err(Failure::Refused(match error.kind() {
            ErrorKind::NotFound => "the monitor is a program of its own, sinew-watch, and is neither beside sinew nor in PATH; \
                 cargo install --path crates/sinew-watch installs it"
                .into(),
            _ => format!("{}: can't be run: {error}", program.display()),
        }))
    }
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
