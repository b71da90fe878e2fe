//! `sinew robot`: what a robot's folder says.

use crate::terminal::{Failure, Finish, answer_as};
use clap::{Args, Subcommand};
use sinew_estimate::robot_check::RobotCheck;
use sinew_estimate::robot_dir;
use std::path::PathBuf;

/// Check a robot's description
#[derive(Debug, Subcommand)]
pub(crate) enum Robot {
    Check(Check),
}

impl Robot {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::Check(check) => check.run(),
        }
    }
}

/// Read robot.toml and the URDF and show what Sinew understood
///
/// Joints in the order Sinew uses, their stiffness and tendons, and what looks odd. The column
/// "mm per mrad" turns an offset into an elongation.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew robot check robots/biorob-like")]
pub(crate) struct Check {
    /// Robot's folder, or robot.toml itself
    dir: PathBuf,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

impl Check {
    fn run(&self) -> Result<Finish, Failure> {
        let check = RobotCheck::of(&robot_dir::load(&self.dir, None)?);
        answer_as(self.json, &check, sinew_report::robot::render)?;
        Ok(Finish::Complete)
    }
}
