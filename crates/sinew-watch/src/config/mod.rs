//! What the owner asks for: one TOML file.
//!
//! Every value is read through [`sinew_files::Section`], so that a refusal names file, line, key, value, unit and
//! cure. Paths count from the file's folder.

mod alarms;
mod door;
mod robot;
mod web;

pub use door::{Address, DoorSettings};
pub use robot::RobotSettings;
pub use web::{WebSettings, Webhook};

use sinew_door::Publishing;
use sinew_files::{Fault, Fields as _, Located, Section, TomlFile, limits, read_text};
use std::path::{Path, PathBuf};

/// Where a configuration is looked for when none is named.
pub const PLACE: &str = "/etc/sinew/watch.toml";
/// Where the store is when nothing is said.
pub const STORE: &str = "/var/lib/sinew";
/// Robots of one monitor at most.
const ROBOTS_MOST: usize = 10_000;

/// A configuration of the monitor.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// The page, and who may see it.
    pub web: WebSettings,
    /// Folder of the store.
    pub store: PathBuf,
    /// What is published to robots' networks.
    pub publish: Publishing,
    /// Who is told of alarms.
    pub webhooks: Vec<Webhook>,
    /// The robots that are watched.
    pub robots: Vec<RobotSettings>,
}

impl Config {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Located`]: what is wrong, where, and what to do.
    pub fn read(path: &Path) -> Result<Self, Located> {
        let text = read_text(path, &limits::SETTINGS)?;
        Self::parse(
            &text,
            &path.display().to_string(),
            sinew_files::folder_of(path),
        )
    }

    /// Reads a text; `file` is its name for messages, `folder` what its paths count from.
    ///
    /// # Errors
    /// As [`Config::read`].
    pub fn parse(text: &str, file: &str, folder: &Path) -> Result<Self, Located> {
        TomlFile::parse(text, file)?.root().whole(|root| {
            let web = root
                .read("web", |s| web::read(s, folder))?
                .unwrap_or_default();
            let store = root.read("store", |s| path(s, "dir", folder))?.flatten();
            let publish = root.read("publish", publish)?.unwrap_or_default();
            let webhooks = root.each("webhook", |s| web::read_webhook(s, folder))?;
            let robots = root.each("robot", |s| robot::read(s, folder))?;
            if robots.is_empty() {
                let cure = "add [[robot]] with name, dir and where it is heard; `sinew watch` without a file lists what is there";
                return Err(root.missing("robot", cure));
            }
            if robots.len() > ROBOTS_MOST {
                let many = format!(
                    "{} robots; a monitor has at most {ROBOTS_MOST}",
                    robots.len()
                );
                return Err(root.here(Fault::TooLarge, many));
            }
            apart(root, &robots)?;
            Ok(Self {
                web,
                store: store.unwrap_or_else(|| PathBuf::from(STORE)),
                publish,
                webhooks,
                robots,
            })
        })
    }
}

fn publish(s: &Section<'_>) -> Result<Publishing, Located> {
    Ok(Publishing {
        diagnostics: s.flag_or("diagnostics", true)?,
        tendons: s.flag_or("tendons", true)?,
    })
}

/// No two robots have one name.
fn apart(root: &Section<'_>, robots: &[RobotSettings]) -> Result<(), Located> {
    let mut names: Vec<&str> = robots.iter().map(|r| r.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(()),
        Some(pair) => {
            let twice = format!("two robots are called '{}'", pair[0]);
            let located = root.here(Fault::Contradiction, twice).key("robot.name");
            Err(located.cure("give every robot a name of its own"))
        }
    }
}

/// A path, from the file's folder.
fn path(s: &Section<'_>, key: &'static str, folder: &Path) -> Result<Option<PathBuf>, Located> {
    let text = s.text(key)?;
    Ok(text.map(|text| folder.join(text)))
}
