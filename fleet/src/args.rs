//! What the program is asked for.

use clap::{Parser, Subcommand};
use std::path::PathBuf;

/// Ask the records of a whole fleet
///
/// Reads folders of sinew-record/1 files as the monitors write them, copies and damaged files among them, and
/// answers with bounded memory.
#[derive(Debug, Parser)]
#[command(
    name = "sinew-fleet",
    version,
    max_term_width = 80,
    after_help = "Exit codes: 0 done, 1 input refused, 2 usage, 3 done but files were refused or a limit is passed."
)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Say what a folder of records holds, what is twice and what can't be read
    Rows(Rows),
    /// Say which tendon passes its limit when, the worst first
    Due(Due),
    /// Ask by SQL
    Query(Query),
    /// Make up a fleet: records of years, and the truth beside them
    Simulate(Simulate),
}

/// Where records lie and how they are read.
#[derive(Debug, Clone, clap::Args)]
pub struct Source {
    /// Folder with records/ of the monitors; robots.csv, tendons.csv and events.csv may lie in it
    pub folder: PathBuf,
    /// Memory a query may take before it goes on disk, MB
    #[arg(long, value_name = "MB", default_value_t = 1024, value_parser = clap::value_parser!(u64).range(64..))]
    pub memory_mb: u64,
}

/// `rows`.
#[derive(Debug, clap::Args)]
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
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Tables: records (each session of each tendon once, of the newest version), every_version (each \
                  version once), robots, tendons, events (the .csv files of these names).\n\nExample:\n  \
                  sinew-fleet query fleet/ \"SELECT site, count(*) FROM records JOIN robots USING (robot) GROUP BY site\""
)]
pub struct Query {
    /// Records.
    #[command(flatten)]
    pub source: Source,
    /// The question
    pub sql: String,
    /// Write all rows here, as CSV, instead of a table
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Rows the table shows at most
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub rows: usize,
}

/// `due`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example:\n  sinew-fleet due fleet/ --within 30 --csv due.csv")]
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
    /// Follow every tendon: half a second each
    #[arg(long)]
    pub follow_all: bool,
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
    /// Another rope that some of the robots have, by its name in the catalogue; may be given again
    #[arg(long = "rope", value_name = "NAME")]
    pub ropes: Vec<String>,
}
