//! `sinew robot`: check of a robot description, and code generation.

use super::rope::Ropes;
use crate::args;
use crate::files::create_folder;
use crate::terminal::{Failure, Finish, answer, answer_as};
use clap::{Args, Subcommand, ValueEnum};
use sinew_estimate::robot_check::{RobotCheck, Severity};
use sinew_estimate::robot_dir;
use sinew_files::{Budget, read_text, write_file};
use sinew_generate::{Language, Precision, generate};
use sinew_log::Mapping;
use sinew_model::offset::{OffsetConfig, VelocityFilter};
use std::path::PathBuf;

/// Check a robot description, or generate code for it
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

/// Check robot.toml and the URDF
///
/// Lists the joints in the order of Sinew with stiffness and tendons, and implausible values: unit
/// errors, masses, inertias, stiffness, friction, ropes, pulleys, limits. The column "mm per mrad"
/// converts an offset to an elongation. Exit code 3: implausible or missing values, 1: impossible values.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew robot check robots/biorob-like")]
pub(crate) struct Check {
    /// Robot folder, or robot.toml
    dir: PathBuf,
    /// Mapping file to check: gear ratios, scales, torque constants
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
        let mut check = RobotCheck::of(&loaded, &gaps, &self.ropes.catalogue()?)?;
        if let Some(file) = &self.mapping {
            Mapping::read(file)?;
            let text = read_text(file, &Budget::SETTINGS)?;
            check.add_mapping(&text, &file.display().to_string())?;
        }
        answer_as(self.json, &check, sinew_report::robot::render)?;
        Ok(match check.worst() {
            None => Finish::Complete,
            Some(Severity::Implausible | Severity::Missing) => Finish::Lossy,
            Some(Severity::Impossible) => Finish::InvalidInput,
        })
    }
}

/// Language of the generated code
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Lang {
    /// C99 with math.h only: header and source
    C,
    /// Rust without the standard library, with the crate libm: one module
    Rust,
}

/// Precision of the generated code
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Exactness {
    /// 64 bits: equal to `sinew` up to rounding
    Double,
    /// 32 bits, for processors without 64-bit hardware: offset error of some microradians
    Single,
}

/// Generate code for one robot: momentum pass and observer without loops
///
/// Structure, masses, stiffness and friction are constants of the code; zero terms are removed. The code does not
/// allocate memory, and its results equal those of `sinew` up to rounding. Generate it again after changes of
/// robot.toml or the URDF.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  sinew robot generate robots/biorob-like --lang c --out out/code"
)]
pub(crate) struct Generate {
    /// Robot folder, or robot.toml
    dir: PathBuf,
    /// Language of the code
    #[arg(long, value_name = "LANGUAGE")]
    lang: Lang,
    /// Precision of the code
    #[arg(long, value_name = "PRECISION", default_value = "double")]
    precision: Exactness,
    /// Output folder, created if missing
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    out: PathBuf,
    /// Observer gain, 1/s
    #[arg(long, value_name = "PER_S", value_parser = args::positive("1/s"), allow_negative_numbers = true, default_value = "20")]
    gain: f64,
    /// Cut-off of the velocity filter, rad/s
    #[arg(long, value_name = "RAD_PER_S", value_parser = args::positive("rad/s"), allow_negative_numbers = true, default_value = "40")]
    velocity_filter: f64,
    /// Replace existing files
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
            return Err(Failure::Error(format!(
                "{} already exists; replace it with --force, or use --out FOLDER",
                file.display()
            )));
        }
        create_folder("--out", &self.out)?;
        let mut text = String::new();
        for (path, content) in planned {
            write_file(&path, content.as_bytes())?;
            text += &format!("wrote {}\n", path.display());
        }
        let count = written.operations;
        text += &format!(
            "momentum pass: {} additions, {} multiplications, {} sine and cosine pairs\n",
            count.sums, count.products, count.turns
        );
        answer(&text)?;
        Ok(Finish::Complete)
    }
}
