//! Command-line arguments of the monitor.

use crate::store::word;
use clap::{Parser, Subcommand};
use sinew_watch_core::alarm::Condition;
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
                  sinew watch backup /var/backups/watch.db\n  \
                  sinew watch acknowledge arm-7 step-change --joint elbow --who Ada"
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
    /// Print the size of the store, per robot and per year
    Disk {
        /// Configuration file that names the store
        #[arg(long, value_name = "FILE", default_value = crate::config::PLACE)]
        config: PathBuf,
    },
    /// Write the lifetimes of ropes, as the table for `sinew trend survival`
    ///
    /// One row per rope whose installation was recorded as a replacement: hours of motion, and whether it broke by the
    /// finding of an incident, was replaced for another reason, or is running. The monitor may be running.
    Survival {
        /// CSV to write
        table: PathBuf,
        /// Configuration file that names the store
        #[arg(long, value_name = "FILE", default_value = crate::config::PLACE)]
        config: PathBuf,
    },
    /// Send a test notification to every receiver
    Notify {
        /// Configuration file that names the receivers
        #[arg(long, value_name = "FILE", default_value = crate::config::PLACE)]
        config: PathBuf,
    },
    /// Acknowledge an alarm of the running monitor
    Acknowledge(Acknowledge),
}

/// Alarm to acknowledge, and the operator.
#[derive(Debug, clap::Args)]
pub struct Acknowledge {
    /// Name of the robot
    pub robot: String,
    /// Condition of the alarm, such as step-change
    #[arg(value_parser = condition)]
    pub condition: Condition,
    /// Joint of the tendon; without it, an alarm of the robot as a whole
    #[arg(long)]
    pub joint: Option<String>,
    /// Name of the operator
    #[arg(long, value_name = "NAME")]
    pub who: String,
    /// Note for the journal
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub note: String,
    /// Configuration file of the monitor
    #[arg(long, value_name = "FILE", default_value = crate::config::PLACE)]
    pub config: PathBuf,
}

/// Parses a condition by its present name in the API.
fn condition(text: &str) -> Result<Condition, String> {
    let named = Condition::ALL.into_iter().find(|c| word(c) == text);
    named.ok_or_else(|| {
        let names: Vec<String> = Condition::ALL.iter().map(word).collect();
        let hint = sinew_files::names::hint(text, &names);
        format!(
            "unknown condition{hint} valid conditions: {}",
            names.join(", ")
        )
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn condition_unknown_lists_present_names() {
        for each in Condition::ALL {
            assert_eq!(condition(&word(&each)), Ok(each));
        }
        let names: Vec<String> = Condition::ALL.iter().map(word).collect();
        let list = format!("valid conditions: {}", names.join(", "));
        assert_eq!(
            condition("step-chang"),
            Err(format!(
                "unknown condition; did you mean 'step-change'? {list}"
            ))
        );
        // A former name is read from stored files only.
        assert_eq!(condition("jump"), Err(format!("unknown condition; {list}")));
    }
}
