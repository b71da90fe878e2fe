//! Configuration of the monitor: one TOML file.
//!
//! Every value is read through [`sinew_files::Section`], so that an error names file, line, key, value, unit and
//! remedy. Paths are relative to the folder of the file.

mod alarms;
mod recording;
mod robot;
mod transport;
mod web;

pub use recording::RecordingSettings;
pub use robot::RobotSettings;
pub use transport::{Address, TransportSettings};
pub use web::{
    Mail, MailTls, MqttSettings, PostFormat, Receiver, Role, TokenSettings, WebSettings, Webhook,
};

use jiff::tz::TimeZone;
use sinew_files::{Budget, Fault, Fields as _, Located, Section, TomlFile, read_text};
use sinew_transport::Publishing;
use std::path::{Path, PathBuf};

/// Default path of the configuration.
pub const PLACE: &str = "/etc/sinew/watch.toml";
/// Default folder of the store.
pub const STORE: &str = "/var/lib/sinew";
/// Maximum number of robots of one monitor.
const MAX_ROBOTS: usize = 10_000;
/// Maximum age after which records are thinned: a century, days.
const MAX_THIN_AFTER_D: u64 = 36_500;

/// Configuration of the monitor.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// Settings of the web page and its access control.
    pub web: WebSettings,
    /// Folder of the store.
    pub store: PathBuf,
    /// Age after which only the best record of each day and tendon is kept, days; `None`: all are kept.
    pub thin_after_d: Option<u32>,
    /// Messages published to the networks of the robots.
    pub publish: Publishing,
    /// Recordings around incidents.
    pub recording: RecordingSettings,
    /// Time zone of the texts; `None`: UTC.
    pub time_zone: Option<TimeZone>,
    /// Receivers of alarm notifications.
    pub receivers: Vec<Receiver>,
    /// Broker to which the states of the tendons are published; `None`: none.
    pub mqtt: Option<MqttSettings>,
    /// Robots to monitor.
    pub robots: Vec<RobotSettings>,
}

impl Config {
    /// Reads a configuration file.
    ///
    /// # Errors
    /// Returns a [`Located`] fault with place, reason and remedy if the file cannot be read or has an invalid value.
    pub fn read(path: &Path) -> Result<Self, Located> {
        let text = read_text(path, &Budget::SETTINGS)?;
        Self::parse(
            &text,
            &path.display().to_string(),
            sinew_files::folder_of(path),
        )
    }

    /// Parses a configuration; `file` is its name in messages, `folder` the base of its relative paths.
    ///
    /// # Errors
    /// Same as [`Config::read`].
    pub fn parse(text: &str, file: &str, folder: &Path) -> Result<Self, Located> {
        TomlFile::parse(text, file)?.root().whole(|root| {
            let web = root
                .read("web", |s| web::read(s, folder))?
                .unwrap_or_default();
            let (store, thin_after_d) = root
                .read("store", |s| store(s, folder))?
                .unwrap_or_default();
            let publish = root.read("publish", publish)?.unwrap_or_default();
            let recording = root.read("recording", recording::read)?.unwrap_or_default();
            let time_zone = time_zone(root)?;
            let webhooks = root.each("webhook", |s| web::read_webhook(s, folder))?;
            let mails = root.each("mail", |s| web::read_mail(s, folder))?;
            let with_link = |mail: Mail| Mail {
                page: web.url.clone(),
                ..mail
            };
            let mails = mails.into_iter().map(|mail| Receiver::Mail(with_link(mail)));
            let receivers = webhooks.into_iter().map(Receiver::Webhook).chain(mails);
            let receivers = receivers.collect();
            let mqtt = root.read("mqtt", |s| web::read_mqtt(s, folder))?;
            let robots = root.each("robot", |s| robot::read(s, folder))?;
            if robots.is_empty() {
                let cure = "add [[robot]] with name, dir and a transport; `sinew watch` without a file lists the robots found";
                return Err(root.missing("robot", cure));
            }
            if robots.len() > MAX_ROBOTS {
                let many = format!(
                    "{} robots exceed the limit of {MAX_ROBOTS} per monitor",
                    robots.len()
                );
                return Err(root.here(Fault::TooLarge, many));
            }
            apart(root, &robots)?;
            Ok(Self {
                web,
                store: store.unwrap_or_else(|| PathBuf::from(STORE)),
                thin_after_d,
                publish,
                receivers,
                mqtt,
                recording,
                time_zone,
                robots,
            })
        })
    }
}

/// Reads the folder of the store, and the age after which records are thinned, days.
fn store(s: &Section<'_>, folder: &Path) -> Result<(Option<PathBuf>, Option<u32>), Located> {
    let thin_after_d = s.count("thin_after_d")?;
    if thin_after_d.is_some_and(|days| !(1..=MAX_THIN_AFTER_D).contains(&days)) {
        return Err(s.invalid("thin_after_d", "between 1 and 36500 d"));
    }
    Ok((
        path(s, "dir", folder)?,
        thin_after_d.map(|days| days as u32),
    ))
}

fn publish(s: &Section<'_>) -> Result<Publishing, Located> {
    Ok(Publishing {
        diagnostics: s.flag_or("diagnostics", true)?,
        tendons: s.flag_or("tendons", true)?,
    })
}

/// Reads the name of a time zone of the system's time zone database.
fn time_zone(root: &Section<'_>) -> Result<Option<TimeZone>, Located> {
    let Some(name) = root.text("time_zone")? else {
        return Ok(None);
    };
    let found = TimeZone::get(&name).map_err(|_| {
        let must = "a name of the time zone database, such as \"Europe/Berlin\"";
        root.invalid("time_zone", must)
    });
    found.map(Some)
}

/// Checks that the names of robots are unique.
fn apart(root: &Section<'_>, robots: &[RobotSettings]) -> Result<(), Located> {
    let mut names: Vec<&str> = robots.iter().map(|r| r.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(()),
        Some(pair) => {
            let twice = format!("duplicate robot name '{}'", pair[0]);
            let located = root.here(Fault::Contradiction, twice).key("robot.name");
            Err(located.cure("give every robot a unique name"))
        }
    }
}

/// Returns a path relative to the folder of the file.
fn path(s: &Section<'_>, key: &'static str, folder: &Path) -> Result<Option<PathBuf>, Located> {
    let text = s.text(key)?;
    Ok(text.map(|text| folder.join(text)))
}
