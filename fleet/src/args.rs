//! Command-line arguments of `sinew-fleet`.

use crate::address::folder_or_address;
pub use crate::by::By;
use crate::creep::Ages;
use clap::builder::{PathBufValueParser, TypedValueParser as _};
use clap::{Parser, Subcommand};
use std::path::PathBuf;

/// Analyse the records of a whole fleet
///
/// Reads folders of sinew-record/2 files written by monitors. Tolerates copies and damaged files, and uses bounded
/// memory.
#[derive(Debug, Clone, Parser)]
#[command(
    name = "sinew-fleet",
    version,
    max_term_width = 80,
    after_help = "Exit codes: 0 done, 1 invalid input, 2 usage, 3 done but files were rejected, a limit is exceeded, a group \
                  is worse or a tendon departs significantly."
)]
pub struct Args {
    /// Command to run.
    #[command(subcommand)]
    pub command: Command,
}

/// Command of the program.
#[derive(Debug, Clone, Subcommand)]
pub enum Command {
    /// List the contents, duplicates and unreadable files of a folder of records
    Rows(Rows),
    /// List the tendons that may exceed a limit, most urgent first
    Due(Due),
    /// Compare the creep of ropes, batches, sites or temperatures
    Compare(Compare),
    /// List tendons whose creep differs from that of their kind
    Outliers(Outliers),
    /// Write a page of the fleet: work by week, ropes compared, worse batches
    Report(Report),
    /// Pool the baselines of a robot type into the prior of a new robot
    Pool(Pool),
    /// Run an SQL query
    Query(Query),
    /// Simulate a fleet: records of several years and the ground truth
    Simulate(Simulate),
}

/// Location of the records and memory limit of queries.
#[derive(Debug, Clone, clap::Args)]
pub struct Source {
    /// Folder with records/ of the monitors, or s3://BUCKET/FOLDER; may contain robots.csv, tendons.csv and events.csv
    #[arg(value_parser = PathBufValueParser::new().try_map(folder_or_address))]
    pub folder: PathBuf,
    /// Memory limit of a query before it spills to disk, MB
    #[arg(long, value_name = "MB", default_value_t = 1024, value_parser = clap::value_parser!(u64).range(64..))]
    pub memory_mb: u64,
}

/// Arguments of `rows`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example:\n  sinew-fleet rows fleet/")]
pub struct Rows {
    /// Source of the records.
    #[command(flatten)]
    pub source: Source,
    /// Read every column of every file, not just its keys
    #[arg(long)]
    pub verify: bool,
}

/// Arguments of `query`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Tables: records (each session of each tendon once, of the newest version), every_version (each \
                  version once), robots, tendons, events (the .csv files of these names).\n\nFunctions in addition to \
                  SQL: sinew_elongation_mm(offset_rad, robot_type, joint); of each tendon's records, with \
                  GROUP BY robot, joint: sinew_trend(*), sinew_days_until(*), sinew_days_until(limit_mm, *).\n\n\
                  Example:\n  \
                  sinew-fleet query fleet/ \"SELECT site, count(*) FROM records JOIN robots USING (robot) GROUP BY site\""
)]
pub struct Query {
    /// Source of the records.
    #[command(flatten)]
    pub source: Source,
    /// SQL query
    pub sql: String,
    /// Further folder of a robot type, in addition to types/, for the Sinew functions; may be repeated
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// Write all rows to this CSV file instead of printing a table
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Maximum number of rows in the table
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub rows: usize,
}

/// Arguments of `due`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example:\n  sinew-fleet due fleet/ --within 30 --state due.state --csv due.csv"
)]
pub struct Due {
    /// Source of the records.
    #[command(flatten)]
    pub source: Source,
    /// Further folder of a robot type, in addition to types/; may be repeated
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// Look-ahead time for limits, days
    #[arg(long = "within", value_name = "DAYS", default_value_t = 30.0, value_parser = days)]
    pub within_days: f64,
    /// Maximum number of rows in the list
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub rows: usize,
    /// Write every tracked tendon to this file, CSV or Parquet
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Store the trend of each tendon in this file; the next run resumes from it and gives the same results
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// Use the creep rates of a fleet, written by pool --creep, as prior of each trend
    #[arg(long, value_name = "FILE")]
    pub creep: Option<PathBuf>,
    /// Track every tendon: a quarter of a second each
    #[arg(long)]
    pub follow_all: bool,
}

/// Arguments of `compare`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Examples:\n  sinew-fleet compare fleet/ --by batch\n  sinew-fleet compare fleet/ --by rope-temperature --ages 30,300"
)]
pub struct Compare {
    /// Source of the records.
    #[command(flatten)]
    pub source: Source,
    /// Grouping of the comparison
    #[arg(long, value_name = "WHAT")]
    pub by: By,
    /// Further folder of a robot type, in addition to types/; may be repeated
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// Range of rope ages for the creep rate, days since installation
    #[arg(long, value_name = "FROM,TO", default_value = "1,30", value_parser = ages)]
    pub ages: Ages,
    /// Smallest relevant difference, %
    #[arg(long = "least", value_name = "PERCENT", default_value = "5", value_parser = percent)]
    pub least: f64,
    /// Seed of the posterior draws; equal seeds give equal results
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Write the groups to this file, CSV or Parquet
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// Arguments of `outliers`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example:\n  sinew-fleet outliers fleet/ --by-chance 0.1 --csv outliers.csv"
)]
pub struct Outliers {
    /// Source of the records.
    #[command(flatten)]
    pub source: Source,
    /// Further folder of a robot type, in addition to types/; may be repeated
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// Range of rope ages for the creep rate, days since installation
    #[arg(long, value_name = "FROM,TO", default_value = "1,30", value_parser = ages)]
    pub ages: Ages,
    /// Expected number of tendons listed by chance
    #[arg(long, value_name = "N", default_value = "1", value_parser = by_chance)]
    pub by_chance: f64,
    /// Maximum number of rows in the list
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub rows: usize,
    /// Seed of the posterior draws; equal seeds give equal results
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Write all listed tendons to this file, CSV or Parquet
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// Arguments of `report`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example:\n  sinew-fleet report fleet/ --weeks 8 --out fleet.html")]
pub struct Report {
    /// Source of the records.
    #[command(flatten)]
    pub source: Source,
    /// Output file of the page
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Further folder of a robot type, in addition to types/; may be repeated
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// State file of due --state; tendons are tracked from the stored state
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// Number of weeks in the work list
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=52))]
    pub weeks: u32,
    /// Range of rope ages for the creep rate, days since installation
    #[arg(long, value_name = "FROM,TO", default_value = "1,30", value_parser = ages)]
    pub ages: Ages,
    /// Seed of the posterior draws; equal seeds give equal results
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// Arguments of `pool`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example:\n  sinew-fleet pool fleet/baselines --robot robots/biorob-like --out type.known\n  \
                  sinew baseline LOG --start type.known --robot robots/biorob-like --out arm.baseline\n  \
                  sinew-fleet pool fleet/ --creep --robot robots/biorob-like --out creep.csv\n  \
                  sinew-fleet due fleet/ --creep creep.csv"
)]
pub struct Pool {
    /// Folder with one .baseline file per robot, recorded right after tensioning, or s3://BUCKET/FOLDER; with --creep
    /// the folder of records
    #[arg(value_parser = PathBufValueParser::new().try_map(folder_or_address))]
    pub folder: PathBuf,
    /// Folder of the robot type: robot.toml and URDF
    #[arg(long, value_name = "DIR")]
    pub robot: PathBuf,
    /// Estimate the creep rate of the type's ropes from records, for due --creep
    #[arg(long)]
    pub creep: bool,
    /// Output file: prior for sinew baseline --start; with --creep a CSV table
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// Parses the expected number of tendons listed by chance.
fn by_chance(text: &str) -> Result<f64, String> {
    within(text, 1e-6, 1e6)
}

/// Parses the limits of an age range, days.
fn ages(text: &str) -> Result<Ages, String> {
    let wrong = || "expected two ages in days, for example 1,30".to_owned();
    let (from, to) = text.split_once(',').ok_or_else(wrong)?;
    let day = |text: &str| text.trim().parse::<f64>().map_err(|_| wrong());
    let (from_days, to_days) = (day(from)?, day(to)?);
    match from_days >= 0.1 && to_days >= 2.0 * from_days && to_days <= 36_500.0 {
        true => Ok(Ages { from_days, to_days }),
        false => Err(
            "expected a first age of at least 0.1 days and a last age of at least twice the first"
                .into(),
        ),
    }
}

/// Parses a share in per cent.
fn percent(text: &str) -> Result<f64, String> {
    let percent: f64 = text
        .parse()
        .map_err(|_| "expected a number of per cent, for example 5")?;
    match (0.0..=1000.0).contains(&percent) {
        true => Ok(0.01 * percent),
        false => Err("expected 0 to 1000 %".into()),
    }
}

/// Parses a forecast horizon, days.
fn days(text: &str) -> Result<f64, String> {
    let days: f64 = text
        .parse()
        .map_err(|_| "expected a number of days, for example 30")?;
    match (0.0..=365.0).contains(&days) {
        true => Ok(days),
        false => Err("expected 0 to 365 days, the forecast horizon".into()),
    }
}

/// Arguments of `simulate`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example:\n  sinew-fleet simulate --robot robots/biorob-like --robots 100 --days 365 --out fleet/"
)]
pub struct Simulate {
    /// Folder of the robot type: robot.toml and URDF
    #[arg(long, value_name = "DIR")]
    pub robot: PathBuf,
    /// New folder for records, side tables and ground truth
    #[arg(long, value_name = "FOLDER")]
    pub out: PathBuf,
    /// Number of robots
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub robots: u32,
    /// Number of recorded days
    #[arg(long, value_name = "N", default_value_t = 365, value_parser = clap::value_parser!(u32).range(30..=3650))]
    pub days: u32,
    /// Seed of the simulation; equal seeds give equal fleets
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Standard deviation of the logarithm of creep between batches of a rope
    #[arg(long, value_name = "RATIO", default_value_t = 0.08, value_parser = spread)]
    pub batch_spread: f64,
    /// Creep of the one bad batch relative to its rope
    #[arg(long, value_name = "FACTOR", default_value_t = 1.7, value_parser = factor)]
    pub bad_batch: f64,
    /// Further rope used by some of the robots, by catalogue name; may be repeated
    #[arg(long = "rope", value_name = "NAME")]
    pub ropes: Vec<String>,
    /// Number of robots with recordings: one minute right after tensioning, then one on the last day
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub recordings: u32,
}

/// Parses a standard deviation of a logarithm.
fn spread(text: &str) -> Result<f64, String> {
    within(text, 0.0, 1.0)
}

/// Parses a positive factor.
fn factor(text: &str) -> Result<f64, String> {
    within(text, 0.1, 10.0)
}

fn within(text: &str, from: f64, to: f64) -> Result<f64, String> {
    let found = text.parse().ok().filter(|x| (from..=to).contains(x));
    found.ok_or_else(|| format!("expected a number from {from} to {to}"))
}
