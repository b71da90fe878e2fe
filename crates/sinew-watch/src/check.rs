//! `sinew watch --check`: everything a configuration names is looked at, and nothing is started or made.

use crate::config::{Address, Config, RobotSettings, WebSettings, Webhook};
use crate::runtime::check_door;
use crate::store::{Place, Reader};
use crate::{token, webhooks};
use sinew_door::DoorError;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir;
use sinew_files::Temporary;
use sinew_log::Mapping;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::net::TcpListener;
use std::path::{Path, PathBuf};

/// What is wrong with what a configuration names, in sentences: key, value, why and what to do.
pub fn faults(config: &Config) -> Vec<String> {
    let mut faults = Vec::new();
    faults.extend(store(&config.store));
    faults.extend(page(&config.web, &config.store));
    for (i, hook) in config.webhooks.iter().enumerate() {
        faults.extend(webhook(i, hook));
    }
    faults.extend(config.robots.iter().flat_map(robot_files));
    faults.extend(doors(&config.robots));
    faults
}

fn robot_files(robot: &RobotSettings) -> Vec<String> {
    let name = &robot.name;
    let mut faults = Vec::new();
    // Without a URDF the robot's own description is waited for.
    let loaded = robot_dir::load(&robot.dir, None);
    match loaded {
        Ok(_) | Err(robot_dir::RobotDirError::NoUrdf { .. }) => {}
        Err(error) => faults.push(format!("{name}: {error}")),
    }
    if let Some(Err(error)) = robot.mapping.as_deref().map(Mapping::read) {
        faults.push(format!("{name}: {error}"));
    }
    if let Some(Err(error)) = robot.baseline.as_deref().map(Baseline::read) {
        faults.push(format!("{name}: {error}"));
    }
    faults
}

/// Each door once, with all the robots behind it.
fn doors(robots: &[RobotSettings]) -> Vec<String> {
    let mut behind: BTreeMap<&Address, Vec<&RobotSettings>> = BTreeMap::new();
    for robot in robots {
        behind.entry(&robot.door.address).or_default().push(robot);
    }
    let faults = behind.into_iter().filter_map(|(address, robots)| {
        let error = check_door(address).err()?;
        Some(format!(
            "{}: {}",
            names(&robots),
            door_fault(address, &error)
        ))
    });
    faults.collect()
}

/// `arm-7, arm-8`; of many the first ones.
fn names(robots: &[&RobotSettings]) -> String {
    const SHOWN: usize = 3;
    let first: Vec<&str> = robots.iter().take(SHOWN).map(|r| r.name.as_str()).collect();
    match robots.len().saturating_sub(SHOWN) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}

fn door_fault(address: &Address, error: &DoorError) -> String {
    match (address, error) {
        (Address::Mcap { path, .. }, DoorError::Io { source, .. }) => {
            let cure = match source.kind() {
                ErrorKind::NotFound => {
                    "start the recorder first, or name the file or folder that it writes"
                }
                _ => "let this user read it",
            };
            format!("mcap.path = {path:?}: {source}; {cure}")
        }
        (Address::Mcap { path, .. }, DoorError::Content { why, .. }) => {
            format!(
                "mcap.path = {path:?}: can't be read: {why}; name the file that the recorder writes"
            )
        }
        (Address::Dds { interfaces, .. }, DoorError::Refused { door, why })
            if !interfaces.is_empty() =>
        {
            format!(
                "dds: {door} can't be joined: {why}; name an address of this computer in interfaces, or leave them out"
            )
        }
        (Address::Dds { .. }, DoorError::Refused { door, why }) => {
            format!("dds: {door} can't be joined: {why}; is there a network?")
        }
        (Address::Zenoh { .. }, DoorError::Refused { door, why }) => format!(
            "zenoh: {door} can't be joined: {why}; is the router running (ros2 run rmw_zenoh_cpp rmw_zenohd), and does connect name it?"
        ),
        (_, error) => error.to_string(),
    }
}

/// Whether what is learned can be kept there.
fn store(folder: &Path) -> Option<String> {
    let key = format!("store.dir = {folder:?}");
    if let Err(error) = can_write_in(folder) {
        let why = format!(
            "{error}; name a folder that the monitor's user can write, and check as that user"
        );
        return Some(format!("{key}: {why}"));
    }
    let place = Place::Folder(folder.into());
    if !folder.join("watch.db").exists() {
        return None;
    }
    let looked = Reader::open(&place).and_then(|reader| reader.check());
    let error = looked.err()?;
    Some(format!("{key}: {}: {}", place.file(), error.in_words()))
}

/// Whether a file can be made in a folder, or in what is there of the way to it.
fn can_write_in(folder: &Path) -> std::io::Result<()> {
    let there = folder.ancestors().find(|path| path.exists());
    let there = match there {
        Some(path) if path.as_os_str().is_empty() => Path::new("."),
        Some(path) => path,
        None => Path::new("."),
    };
    if !there.is_dir() {
        let why = format!("{} is no folder", there.display());
        return Err(std::io::Error::new(ErrorKind::NotADirectory, why));
    }
    Temporary::create(there, "check").map(drop)
}

/// Whether the page can be had, and what others need for it.
fn page(web: &WebSettings, store: &Path) -> Vec<String> {
    let mut faults = Vec::new();
    let Some(bind) = web.bind else { return faults };
    match TcpListener::bind(bind) {
        // It may be the monitor's that runs.
        Ok(_) => {}
        Err(error) if error.kind() == ErrorKind::AddrInUse => {}
        Err(error) => faults.push(format!(
            "web.bind = {bind}: can't listen there: {error}; name an address of this computer, and a port that is free"
        )),
    }
    if web.needs_token() {
        faults.extend(web_token(web.token_file.as_ref(), store));
    }
    faults
}

fn web_token(own: Option<&PathBuf>, store: &Path) -> Option<String> {
    match own {
        // It is made at the first start.
        None => {
            let path = token::usual_place(store);
            let fault = token::read(&path).transpose()?.err()?;
            Some(format!("web.bind needs a token: {fault}"))
        }
        Some(path) => match token::read(path) {
            Ok(Some(_)) => None,
            Ok(None) => Some(format!(
                "web.token_file = {path:?}: it isn't there; write a token of {} characters or more into it, or leave token_file out, and one is made in the store",
                token::SHORTEST
            )),
            Err(fault) => Some(format!("web.token_file: {fault}")),
        },
    }
}

fn webhook(at: usize, hook: &Webhook) -> Option<String> {
    let path = hook.token_file.as_deref()?;
    let fault = webhooks::token(path).err()?;
    Some(format!("webhook[{at}].token_file = {path:?}: {fault}"))
}
