//! What the program is asked for.

use clap::Parser;
use std::net::SocketAddr;
use std::path::PathBuf;

/// Watch the rope tendons of running robots
///
/// Listens to robots' topics without a ROS installation, keeps learning through power cuts, says which tendon
/// needs what and since when, and shows it in a browser. It never commands a robot.
#[derive(Debug, Parser)]
#[command(
    name = "sinew-watch",
    version,
    max_term_width = 80,
    after_help = "Exit codes: 0 done, 1 input refused, 2 usage.\n\n\
                  Examples:\n  sinew watch --demo\n  sinew watch --check /etc/sinew/watch.toml"
)]
pub struct Args {
    /// Configuration [default: /etc/sinew/watch.toml, where that is there]
    pub config: Option<PathBuf>,
    /// Read the configuration and everything it names, say what is wrong, and end
    #[arg(long)]
    pub check: bool,
    /// Show made-up arms: no robot, and no network but the page
    #[arg(long, conflicts_with_all = ["config", "check"])]
    pub demo: bool,
    /// Where the demonstration's page is [default: 127.0.0.1:8642]
    #[arg(long, value_name = "ADDRESS", requires = "demo", value_parser = loopback)]
    pub bind: Option<SocketAddr>,
}

/// Whoever can reach the demonstration may press its buttons: this computer alone.
fn loopback(text: &str) -> Result<SocketAddr, String> {
    let address: SocketAddr = text
        .parse()
        .map_err(|_| "write an address and a port, such as 127.0.0.1:8642")?;
    match address.ip().is_loopback() {
        true => Ok(address),
        false => Err("the demonstration is for this computer alone: 127.0.0.1 or [::1]".into()),
    }
}
