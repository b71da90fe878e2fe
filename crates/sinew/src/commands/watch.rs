//! `sinew watch`: runs the monitor, a program of its own.

use super::beside;
use crate::terminal::{Failure, Finish};
use clap::Args;
use std::ffi::OsString;

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
    /// Runs the monitor.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        const MISSING: &str = "the monitor is a program of its own, sinew-watch, and is neither beside sinew nor in PATH; \
             cargo install --path crates/sinew-watch installs it";
        beside::run("sinew-watch", &self.arguments, MISSING)
    }
}
