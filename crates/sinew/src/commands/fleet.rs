//! `sinew fleet`: runs a program of its own.

use super::beside;
use crate::terminal::{Failure, Finish};
use clap::Args;
use std::ffi::OsString;

/// Ask the records of a whole fleet: what they hold, and which tendon is due (runs sinew-fleet)
#[derive(Debug, Args)]
#[command(
    disable_help_flag = true,
    after_help = "Examples:\n  sinew fleet rows /srv/records\n  sinew fleet query /srv/records \"SELECT count(*) FROM records\"\n  sinew fleet due /srv/records --within 30"
)]
pub(crate) struct Fleet {
    /// What sinew-fleet is given; `sinew fleet --help` lists it
    #[arg(
        trailing_var_arg = true,
        allow_hyphen_values = true,
        value_name = "ARGUMENTS"
    )]
    arguments: Vec<OsString>,
}

impl Fleet {
    /// Runs it.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        const MISSING: &str = "the fleet's questions are a program of their own, sinew-fleet, and it is neither beside sinew \
             nor in PATH; cargo install --path fleet installs it";
        beside::run("sinew-fleet", &self.arguments, MISSING)
    }
}
