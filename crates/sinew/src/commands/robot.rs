//! `sinew robot`: what a robot's folder says, and code for that robot alone.

use super::rope::Ropes;
use crate::args;
use crate::terminal::{Failure, Finish, answer, answer_as};
use clap::{Args, Subcommand, ValueEnum};
use sinew_estimate::robot_check::{RobotCheck, Severity};
use sinew_estimate::robot_dir;
use sinew_files::{limits, read_text, write_file};
use sinew_generate::{Language, Precision, generate};
use sinew_log::Mapping;
use sinew_model::offset::{OffsetConfig, VelocityFilter};
use std::path::PathBuf;

/// Check a robot's description, or write code for it
#[derive(Debug, Subcommand)]
pub(crate) enum Robot {
    Check(Check),
    Generate(Generate),
}

impl Robot {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::Check(check) => check.run(),
            Self::Generate(generate) => generate.run(),
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

/// The language code is written in
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Lang {
    /// C99 that needs math.h alone: a header and a source
    C,
    /// Rust without the standard library that needs the crate libm: one module
    Rust,
}

/// How exact the code's numbers are
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Exactness {
    /// 64 bits: what `sinew` gives, to rounding
    Double,
    /// 32 bits, for chips without more in hardware: offsets to some microradians
    Single,
}

/// Write code for this robot alone: its momentum pass and observer without loops
///
/// The arm's structure, masses, stiffness and friction stand in the code as numbers, and what they make zero is gone.
/// It allocates nothing and gives what `sinew` gives, to rounding. Write it anew when robot.toml or the URDF change.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  sinew robot generate robots/biorob-like --lang c --out out/code"
)]
pub(crate) struct Generate {
    /// Robot's folder, or robot.toml itself
    dir: PathBuf,
    /// Language
    #[arg(long, value_name = "LANGUAGE")]
    lang: Lang,
    /// Precision of its numbers
    #[arg(long, value_name = "PRECISION", default_value = "double")]
    precision: Exactness,
    /// Folder to write to, made where it isn't there
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    out: PathBuf,
    /// Gain of the observer, 1/s
    #[arg(long, value_name = "PER_S", value_parser = args::positive("1/s"), allow_negative_numbers = true, default_value = "20")]
    gain: f64,
    /// Cut-off of the velocity filter, rad/s
    #[arg(long, value_name = "RAD_PER_S", value_parser = args::positive("rad/s"), allow_negative_numbers = true, default_value = "40")]
    velocity_filter: f64,
    /// Replace files that are there already
    #[arg(long)]
    force: bool,
}

impl Generate {
    fn run(&self) -> Result<Finish, Failure> {
        let robot = robot_dir::load(&self.dir, None)?.robot;
        let language = match self.lang {
            Lang::C => Language::C,
            Lang::Rust => Language::Rust,
        };
        let precision = match self.precision {
            Exactness::Double => Precision::Double,
            Exactness::Single => Precision::Single,
        };
        let config = OffsetConfig {
            gain_per_s: self.gain,
            velocity: VelocityFilter::StateVariable {
                cutoff_rad_per_s: self.velocity_filter,
            },
            ..OffsetConfig::default()
        };
        let written = generate(&robot, &config, language, precision)?;
        let planned = written.files.iter();
        let planned: Vec<_> = planned.map(|f| (self.out.join(&f.name), &f.text)).collect();
        if let (false, Some((file, _))) = (self.force, planned.iter().find(|(p, _)| p.exists())) {
            return Err(Failure::Refused(format!(
                "{} is there already; --force replaces it, --out FOLDER writes elsewhere",
                file.display()
            )));
        }
        std::fs::create_dir_all(&self.out)
            .map_err(|e| Failure::Refused(format!("{}: can't make it: {e}", self.out.display())))?;
        let mut said = String::new();
        for (path, text) in planned {
            write_file(&path, text.as_bytes())?;
            said += &format!("wrote {}\n", path.display());
        }
        let count = written.operations;
        said += &format!(
            "A momentum pass takes {} sums, {} products and {} sines with their cosines.\n",
            count.sums, count.products, count.turns
        );
        answer(&said)?;
        Ok(Finish::Complete)
    }
}
