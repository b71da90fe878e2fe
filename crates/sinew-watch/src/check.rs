//! Check of a configuration (`sinew watch --check`): files, addresses and folders are tested, and nothing is started
//! or created.

use crate::config::{Address, Config, Receiver, RobotSettings, WebSettings};
use crate::runtime::check_transport;
use crate::store::{Place, Reader};
use crate::{stream, token};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir;
use sinew_files::Temporary;
use sinew_log::Mapping;
use sinew_transport::TransportError;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::net::TcpListener;
use std::path::{Path, PathBuf};

/// Returns the faults of the files and addresses named by a configuration, one sentence each: key, value, reason and
/// remedy.
pub fn faults(config: &Config) -> Vec<String> {
    let mut faults = Vec::new();
    faults.extend(store(&config.store));
    faults.extend(page(&config.web, &config.store));
    faults.extend(receivers(config));
    faults.extend(config.robots.iter().flat_map(robot_files));
    faults.extend(transports(&config.robots));
    faults
}

fn robot_files(robot: &RobotSettings) -> Vec<String> {
    let name = &robot.name;
    let mut faults = Vec::new();
    // Without a URDF the description published by the robot is used.
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

/// Checks each transport once, for all robots behind it.
fn transports(robots: &[RobotSettings]) -> Vec<String> {
    let mut behind: BTreeMap<&Address, Vec<&RobotSettings>> = BTreeMap::new();
    for robot in robots {
        behind
            .entry(&robot.transport.address)
            .or_default()
            .push(robot);
    }
    let faults = behind.into_iter().filter_map(|(address, robots)| {
        let error = check_transport(address).err()?;
        Some(format!(
            "{}: {}",
            names(&robots),
            transport_fault(address, &error)
        ))
    });
    faults.collect()
}

/// Formats a list of robots: `arm-7, arm-8`; of many the first ones.
fn names(robots: &[&RobotSettings]) -> String {
    const MAX_NAMES: usize = 3;
    let first: Vec<&str> = robots
        .iter()
        .take(MAX_NAMES)
        .map(|r| r.name.as_str())
        .collect();
    match robots.len().saturating_sub(MAX_NAMES) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}

fn transport_fault(address: &Address, error: &TransportError) -> String {
    match (address, error) {
        (Address::Mcap { path, .. }, TransportError::Io { source, .. }) => {
            let cure = match source.kind() {
                ErrorKind::NotFound => {
                    "start the recorder first, or set the file or folder that it writes"
                }
                _ => "grant read permission to this user",
            };
            format!("mcap.path = {path:?}: {source}; {cure}")
        }
        (Address::Mcap { path, .. }, TransportError::Content { reason, .. }) => {
            format!(
                "mcap.path = {path:?}: cannot be read: {reason}; set the file that the recorder writes"
            )
        }
        (Address::Dds { interfaces, .. }, TransportError::Rejected { transport, reason })
            if !interfaces.is_empty() =>
        {
            format!(
                "dds: {transport} cannot connect: {reason}; set an address of this host in interfaces, or remove the key"
            )
        }
        (Address::Dds { .. }, TransportError::Rejected { transport, reason }) => {
            format!("dds: {transport} cannot connect: {reason}; check the network")
        }
        (Address::Zenoh { .. }, TransportError::Rejected { transport, reason }) => format!(
            "zenoh: {transport} cannot connect: {reason}; start the router (ros2 run rmw_zenoh_cpp rmw_zenohd) and check its address in connect"
        ),
        (_, error) => error.to_string(),
    }
}

/// Checks whether the store can be written.
fn store(folder: &Path) -> Option<String> {
    let key = format!("store.dir = {folder:?}");
    if let Err(error) = can_write_in(folder) {
        let reason = format!(
            "{error}; set a folder that the user of the monitor can write, and run the check as that user"
        );
        return Some(format!("{key}: {reason}"));
    }
    let place = Place::Folder(folder.into());
    if !folder.join("watch.db").exists() {
        return None;
    }
    let looked = Reader::open(&place).and_then(|reader| reader.check());
    let error = looked.err()?;
    Some(format!("{key}: {}: {}", place.file(), error.in_words()))
}

/// Tests whether a file can be created in a folder, or in its nearest existing parent.
fn can_write_in(folder: &Path) -> std::io::Result<()> {
    let there = folder.ancestors().find(|path| path.exists());
    let there = match there {
        Some(path) if path.as_os_str().is_empty() => Path::new("."),
        Some(path) => path,
        None => Path::new("."),
    };
    if !there.is_dir() {
        let reason = format!("{} is not a folder", there.display());
        return Err(std::io::Error::new(ErrorKind::NotADirectory, reason));
    }
    Temporary::create(there, "check").map(drop)
}

/// Checks the address of the page and its tokens.
fn page(web: &WebSettings, store: &Path) -> Vec<String> {
    let mut faults = Vec::new();
    let Some(bind) = web.bind else { return faults };
    match TcpListener::bind(bind) {
        // The address may belong to a running monitor.
        Ok(_) => {}
        Err(error) if error.kind() == ErrorKind::AddrInUse => {}
        Err(error) => faults.push(format!(
            "web.bind = {bind}: cannot listen: {error}; set an address of this host and a free port"
        )),
    }
    if web.needs_token() {
        faults.extend(web_token(web.token_file.as_ref(), store));
        for (name, _, path) in token::files(web, store).into_iter().skip(1) {
            // A missing file is created at the first start.
            let fault = token::read(&path).err();
            faults.extend(fault.map(|fault| format!("token {name}: {fault}")));
        }
    }
    faults
}

fn web_token(own: Option<&PathBuf>, store: &Path) -> Option<String> {
    match own {
        // The token is created at the first start.
        None => {
            let path = token::default_place(store);
            let fault = token::read(&path).transpose()?.err()?;
            Some(format!("web.bind requires a token: {fault}"))
        }
        Some(path) => match token::read(path) {
            Ok(Some(_)) => None,
            Ok(None) => Some(format!(
                "web.token_file = {path:?}: file not found; write a token of at least {} characters into it, or remove token_file to create a token in the store",
                token::MIN_CHARS
            )),
            Err(fault) => Some(format!("web.token_file: {fault}")),
        },
    }
}

/// Checks the files of secrets and certificate authorities.
fn receivers(config: &Config) -> Vec<String> {
    let (mut hooks, mut mails) = (0, 0);
    let of_receivers = config.receivers.iter().map(|receiver| match receiver {
        Receiver::Webhook(of) => {
            hooks += 1;
            let at = format!("webhook[{}]", hooks - 1);
            (at, "token_file", &of.token_file, &of.ca_file)
        }
        Receiver::Mail(of) => {
            mails += 1;
            let at = format!("mail[{}]", mails - 1);
            (at, "password_file", &of.password_file, &of.ca_file)
        }
    });
    let of_broker = config.mqtt.iter();
    let of_broker = of_broker.map(|of| {
        (
            "mqtt".into(),
            "password_file",
            &of.password_file,
            &of.ca_file,
        )
    });
    let mut faults = Vec::new();
    for (at, key, secret, ca_file) in of_receivers.chain(of_broker) {
        if let Some(path) = secret
            && let Err(fault) = token::secret(path)
        {
            faults.push(format!("{at}.{key} = {path:?}: {fault}"));
        }
        if let Some(path) = ca_file
            && let Err(fault) = stream::check_authorities(path)
        {
            faults.push(format!("{at}.ca_file = {path:?}: {fault}"));
        }
    }
    faults
}
