//! `sinew robot`: what a robot's folder says.

use super::rope::Ropes;
use crate::terminal::{Failure, Finish, answer_as};
use clap::{Args, Subcommand};
use sinew_estimate::robot_check::{RobotCheck, Severity};
use sinew_estimate::robot_dir;
use sinew_files::{limits, read_text};
use sinew_log::Mapping;
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
/// Joints in the order Sinew uses, their stiffness and tendons, and what looks odd: units mistaken by
/// 1000, masses, inertias, stiffness, friction, ropes, pulleys, limits. The column "mm per mrad" turns
/// an offset into an elongation. Exit code 3 when something is odd or missing, 1 when something is
/// impossible.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew robot check robots/biorob-like")]
pub(crate) struct Check {
    /// Robot's folder, or robot.toml itself
    dir: PathBuf,
    /// Mapping file to check too: gear ratios, scales, torque constants
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
    #[command(flatten)]
    ropes: Ropes,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

impl Check {
    fn run(&self) -> Result<Finish, Failure> {
        let (loaded, gaps) = robot_dir::draft(&self.dir, None)?;
        let mut check = RobotCheck::of(&loaded, &gaps, &self.ropes.catalogue(self.json)?)?;
        if let Some(file) = &self.mapping {
            Mapping::read(file)?;
            let text = read_text(file, &limits::SETTINGS)?;
            check.add_mapping(&text, &file.display().to_string())?;
        }
        answer_as(self.json, &check, sinew_report::robot::render)?;
        Ok(match check.worst() {
            None => Finish::Complete,
            Some(Severity::Odd | Severity::Missing) => Finish::Lossy,
            Some(Severity::Impossible) => Finish::Refused,
        })
    }
}
