//! What the program is asked for.

use crate::address::folder_or_address;
pub use crate::by::By;
use crate::creep::Ages;
use clap::builder::{PathBufValueParser, TypedValueParser as _};
use clap::{Parser, Subcommand};
use std::path::PathBuf;

/// Ask the records of a whole fleet
///
/// Reads folders of sinew-record/1 files as the monitors write them, copies and damaged files among them, and
/// answers with bounded memory.
#[derive(Debug, Clone, Parser)]
#[command(
    name = "sinew-fleet",
    version,
    max_term_width = 80,
    after_help = "Exit codes: 0 done, 1 input refused, 2 usage, 3 done but files were refused, a limit is passed, a group \
                  is worse or a tendon surely departs."
)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Clone, Subcommand)]
pub enum Command {
    /// Say what a folder of records holds, what is twice and what can't be read
    Rows(Rows),
    /// Say which tendon passes its limit when, the worst first
    Due(Due),
    /// Say which rope, batch, site or temperature creeps more
    Compare(Compare),
    /// Say which tendons creep unlike others of their kind
    Outliers(Outliers),
    /// Write a page of the fleet: work by week, ropes compared, worse batches
    Report(Report),
    /// Learn from a type's robots what a new one starts from
    Pool(Pool),
    /// Ask by SQL
    Query(Query),
    /// Make up a fleet: records of years, and the truth beside them
    Simulate(Simulate),
}

/// Where records lie and how they are read.
#[derive(Debug, Clone, clap::Args)]
pub struct Source {
    /// Folder with records/ of the monitors, or s3://BUCKET/FOLDER; robots.csv, tendons.csv and events.csv may lie in it
    #[arg(value_parser = PathBufValueParser::new().try_map(folder_or_address))]
    pub folder: PathBuf,
    /// Memory a query may take before it goes on disk, MB
    #[arg(long, value_name = "MB", default_value_t = 1024, value_parser = clap::value_parser!(u64).range(64..))]
    pub memory_mb: u64,
}

/// `rows`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example:\n  sinew-fleet rows fleet/")]
pub struct Rows {
    /// Records.
    #[command(flatten)]
    pub source: Source,
    /// Read every column of every file, not just its keys
    #[arg(long)]
    pub verify: bool,
}

/// `query`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Tables: records (each session of each tendon once, of the newest version), every_version (each \
                  version once), robots, tendons, events (the .csv files of these names).\n\nFunctions beside \
                  those of SQL: sinew_elongation_mm(offset_rad, robot_type, joint); of each tendon's records, with \
                  GROUP BY robot, joint: sinew_trend(*), sinew_days_until(*), sinew_days_until(limit_mm, *).\n\n\
                  Example:\n  \
                  sinew-fleet query fleet/ \"SELECT site, count(*) FROM records JOIN robots USING (robot) GROUP BY site\""
)]
pub struct Query {
    /// Records.
    #[command(flatten)]
    pub source: Source,
    /// The question
    pub sql: String,
    /// Folder of a robot type beside those in types/, for the functions of Sinew; may be given again
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// Write all rows here, as CSV, instead of a table
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Rows the table shows at most
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub rows: usize,
}

/// `due`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example:\n  sinew-fleet due fleet/ --within 30 --state due.state --csv due.csv"
)]
pub struct Due {
    /// Records.
    #[command(flatten)]
    pub source: Source,
    /// Folder of a robot type beside those in types/; may be given again
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// Days within which a limit may be passed
    #[arg(long = "within", value_name = "DAYS", default_value_t = 30.0, value_parser = days)]
    pub within_days: f64,
    /// Rows the list shows at most
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub rows: usize,
    /// Write every tendon that was followed here, as CSV or Parquet
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Keep here how far each tendon was followed: the next question goes on from there, with the same answers
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// Begin each trend with how fast such ropes creep in a fleet, as pool --creep has learned
    #[arg(long, value_name = "FILE")]
    pub creep: Option<PathBuf>,
    /// Follow every tendon: a quarter of a second each
    #[arg(long)]
    pub follow_all: bool,
}

/// `compare`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Examples:\n  sinew-fleet compare fleet/ --by batch\n  sinew-fleet compare fleet/ --by rope-temperature --ages 30,300"
)]
pub struct Compare {
    /// Records.
    #[command(flatten)]
    pub source: Source,
    /// What to compare
    #[arg(long, value_name = "WHAT")]
    pub by: By,
    /// Folder of a robot type beside those in types/; may be given again
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// Ages of a rope over which its creep counts, days since it was fitted
    #[arg(long, value_name = "FROM,TO", default_value = "1,30", value_parser = ages)]
    pub ages: Ages,
    /// Differences below this are none, %
    #[arg(long = "least", value_name = "PERCENT", default_value = "5", value_parser = percent)]
    pub least: f64,
    /// Seed of the draws: the same one says the same
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Write the groups here, as CSV or Parquet
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// `outliers`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example:\n  sinew-fleet outliers fleet/ --by-chance 0.1 --csv outliers.csv"
)]
pub struct Outliers {
    /// Records.
    #[command(flatten)]
    pub source: Source,
    /// Folder of a robot type beside those in types/; may be given again
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// Ages of a rope over which its creep counts, days since it was fitted
    #[arg(long, value_name = "FROM,TO", default_value = "1,30", value_parser = ages)]
    pub ages: Ages,
    /// Tendons that may be listed by chance, on average
    #[arg(long, value_name = "N", default_value = "1", value_parser = by_chance)]
    pub by_chance: f64,
    /// Rows the list shows at most
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub rows: usize,
    /// Seed of the draws: the same one says the same
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Write all that are listed here, as CSV or Parquet
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// `report`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example:\n  sinew-fleet report fleet/ --weeks 8 --out fleet.html")]
pub struct Report {
    /// Records.
    #[command(flatten)]
    pub source: Source,
    /// The page
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Folder of a robot type beside those in types/; may be given again
    #[arg(long = "robot", value_name = "DIR")]
    pub robots: Vec<PathBuf>,
    /// File of due --state: tendons are followed from where it left them
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// Weeks the work list looks ahead
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=52))]
    pub weeks: u32,
    /// Ages of a rope over which its creep counts, days since it was fitted
    #[arg(long, value_name = "FROM,TO", default_value = "1,30", value_parser = ages)]
    pub ages: Ages,
    /// Seed of the draws: the same one says the same
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// `pool`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example:\n  sinew-fleet pool fleet/baselines --robot robots/biorob-like --out type.known\n  \
                  sinew baseline LOG --start type.known --robot robots/biorob-like --out arm.baseline\n  \
                  sinew-fleet pool fleet/ --creep --robot robots/biorob-like --out creep.csv\n  \
                  sinew-fleet due fleet/ --creep creep.csv"
)]
pub struct Pool {
    /// Folder with .baseline files, or s3://BUCKET/FOLDER: one of each robot, learned right after tensioning; with --creep the folder
    /// of records
    #[arg(value_parser = PathBufValueParser::new().try_map(folder_or_address))]
    pub folder: PathBuf,
    /// Folder of the robot type: robot.toml and URDF
    #[arg(long, value_name = "DIR")]
    pub robot: PathBuf,
    /// Learn from records how fast the type's ropes creep, for due --creep
    #[arg(long)]
    pub creep: bool,
    /// Where the start for sinew baseline --start goes; with --creep a table, CSV
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// How many by chance.
fn by_chance(text: &str) -> Result<f64, String> {
    within(text, 1e-6, 1e6)
}

/// Ages: two numbers of days.
fn ages(text: &str) -> Result<Ages, String> {
    let wrong = || "write two ages in days, such as 1,30".to_owned();
    let (from, to) = text.split_once(',').ok_or_else(wrong)?;
    let day = |text: &str| text.trim().parse::<f64>().map_err(|_| wrong());
    let (from_days, to_days) = (day(from)?, day(to)?);
    match from_days >= 0.1 && to_days >= 2.0 * from_days && to_days <= 36_500.0 {
        true => Ok(Ages { from_days, to_days }),
        false => Err("ages begin at 0.1 days or later, and end at twice that or later".into()),
    }
}

/// A share, given in percent.
fn percent(text: &str) -> Result<f64, String> {
    let percent: f64 = text
        .parse()
        .map_err(|_| "write a number of percent, such as 5")?;
    match (0.0..=1000.0).contains(&percent) {
        true => Ok(0.01 * percent),
        false => Err("from 0 to 1000 %".into()),
    }
}

/// Days a forecast reaches.
fn days(text: &str) -> Result<f64, String> {
    let days: f64 = text
        .parse()
        .map_err(|_| "write a number of days, such as 30")?;
    match (0.0..=365.0).contains(&days) {
        true => Ok(days),
        false => Err("forecasts reach from 0 to 365 days".into()),
    }
}

/// `simulate`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example:\n  sinew-fleet simulate --robot robots/biorob-like --robots 100 --days 365 --out fleet/"
)]
pub struct Simulate {
    /// Folder of the robot type: robot.toml and URDF
    #[arg(long, value_name = "DIR")]
    pub robot: PathBuf,
    /// New folder for records, side tables and truth
    #[arg(long, value_name = "FOLDER")]
    pub out: PathBuf,
    /// Robots
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub robots: u32,
    /// Days that are recorded
    #[arg(long, value_name = "N", default_value_t = 365, value_parser = clap::value_parser!(u32).range(30..=3650))]
    pub days: u32,
    /// Seed: the same one makes the same fleet
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// What batches of a rope differ by in their creep, as a standard deviation of its logarithm
    #[arg(long, value_name = "RATIO", default_value_t = 0.08, value_parser = spread)]
    pub batch_spread: f64,
    /// Creep of the one bad batch over its rope's
    #[arg(long, value_name = "FACTOR", default_value_t = 1.7, value_parser = factor)]
    pub bad_batch: f64,
    /// Another rope that some of the robots have, by its name in the catalogue; may be given again
    #[arg(long = "rope", value_name = "NAME")]
    pub ropes: Vec<String>,
    /// Recordings of so many robots: a minute right after tensioning, then one as on the last day
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub recordings: u32,
}

/// A standard deviation of a logarithm.
fn spread(text: &str) -> Result<f64, String> {
    within(text, 0.0, 1.0)
}

/// A factor.
fn factor(text: &str) -> Result<f64, String> {
    within(text, 0.1, 10.0)
}

fn within(text: &str, from: f64, to: f64) -> Result<f64, String> {
    let found = text.parse().ok().filter(|x| (from..=to).contains(x));
    found.ok_or_else(|| format!("write a number from {from} to {to}"))
}
