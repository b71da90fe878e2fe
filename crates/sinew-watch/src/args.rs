//! Command-line arguments of the monitor.

use clap::{Parser, Subcommand};
use std::net::SocketAddr;
use std::path::PathBuf;

/// Monitor the rope tendons of running robots
///
/// Subscribes to the topics of robots without a ROS installation, estimates the elongation of every tendon, stores
/// the results, raises alarms, and shows them in a browser. It never commands a robot.
#[derive(Debug, Parser)]
#[command(
    name = "sinew-watch",
    version,
    max_term_width = 80,
    args_conflicts_with_subcommands = true,
    after_help = "Exit codes: 0 success, 1 invalid input, 2 usage.\n\n\
                  Examples:\n  sinew watch --demo\n  sinew watch --check /etc/sinew/watch.toml\n  \
                  sinew watch backup /var/backups/watch.db"
)]
pub struct Args {
    /// Configuration file [default: /etc/sinew/watch.toml, if it exists]
    pub config: Option<PathBuf>,
    /// Check the configuration and all files and addresses that it names, then exit
    #[arg(long)]
    pub check: bool,
    /// Show simulated robots; opens no network connection except the page
    #[arg(long, conflicts_with_all = ["config", "check"])]
    pub demo: bool,
    /// Address of the demonstration page [default: 127.0.0.1:8642]
    #[arg(long, value_name = "ADDRESS", requires = "demo", value_parser = loopback)]
    pub bind: Option<SocketAddr>,
    /// Command instead of monitoring
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// Command of the program.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Copy the store into a file while the monitor is running
    Backup {
        /// File to write; an existing one is replaced once the copy is complete
        target: PathBuf,
        /// Configuration file that names the store
        #[arg(long, value_name = "FILE", default_value = crate::config::PLACE)]
        config: PathBuf,
    },
}

/// Parses an address on the loopback interface: everybody who reaches the demonstration may operate it.
fn loopback(text: &str) -> Result<SocketAddr, String> {
    let address: SocketAddr = text
        .parse()
        .map_err(|_| "expected an address and a port, such as 127.0.0.1:8642")?;
    match address.ip().is_loopback() {
        true => Ok(address),
        false => {
            Err("the demonstration is available on this host only: set 127.0.0.1 or [::1]".into())
        }
    }
}
