//! What the owner asks for: one TOML file.
//!
//! Every value is read through [`sinew_files::Section`], so that a refusal names file, line, key, value, unit and
//! cure. Paths count from the file's folder.

mod alarms;
mod door;
mod robot;
mod web;

pub use alarms::AlarmSettings;
pub use door::DoorSettings;
pub use robot::{EstimateSettings, ReadingSettings, RobotSettings, TimeSettings};
pub use web::{WebSettings, Webhook};

use sinew_files::{Fault, Located, Section, TomlFile, limits, read_text};
use std::path::{Path, PathBuf};

/// Where a configuration is looked for when none is named.
pub const PLACE: &str = "/etc/sinew/watch.toml";
/// Where the store is when nothing is said.
pub const STORE: &str = "/var/lib/sinew";
/// Robots of one monitor at most.
const ROBOTS_MOST: usize = 10_000;

/// A configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// The page, and who may see it.
    pub web: WebSettings,
    /// Folder of the store.
    pub store: PathBuf,
    /// What is published to robots' networks.
    pub publish: Publish,
    /// Who is told of alarms.
    pub webhooks: Vec<Webhook>,
    /// Robots.
    pub robots: Vec<RobotSettings>,
}

/// What is published where robots listen. Nothing else ever is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Publish {
    /// `/diagnostics`.
    pub diagnostics: bool,
    /// `/sinew/tendons`.
    pub tendons: bool,
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
                return Err(root.missing_robot());
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

trait MissingRobot {
    fn missing_robot(&self) -> Located;
}

impl MissingRobot for Section<'_> {
    fn missing_robot(&self) -> Located {
        use sinew_files::Fields as _;
        self.missing("robot", "add [[robot]] with name, dir and where it is heard; `sinew watch` without a file lists what is there")
    }
}

impl Default for Publish {
    fn default() -> Self {
        Self {
            diagnostics: true,
            tendons: true,
        }
    }
}

fn publish(s: &Section<'_>) -> Result<Publish, Located> {
    Ok(Publish {
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
