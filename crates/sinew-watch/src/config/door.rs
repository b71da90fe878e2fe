//! Where a robot is heard.

use sinew_files::{Bound, Fault, Fields as _, Located, Section};
use std::net::IpAddr;
use std::path::{Path, PathBuf};

/// Where a robot is heard.
#[derive(Debug, Clone, PartialEq)]
pub struct DoorSettings {
    /// The door its messages come through.
    pub address: Address,
    /// What its topics lie in; empty: anywhere.
    pub namespace: String,
}

/// A door that messages come through; robots with the same share it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Address {
    /// ROS 2 over DDS.
    Dds {
        /// Domain, as in `ROS_DOMAIN_ID`.
        domain: u16,
        /// Addresses of the interfaces used; none: all.
        interfaces: Vec<IpAddr>,
    },
    /// ROS 2 over Zenoh, with the keys of rmw_zenoh.
    Zenoh {
        /// Domain, as in `ROS_DOMAIN_ID`.
        domain: u16,
        /// Routers or peers, such as `tcp/127.0.0.1:7447`.
        connect: Vec<String>,
    },
    /// An MCAP that grows, or the newest of a folder.
    Mcap {
        /// File or folder.
        path: PathBuf,
        /// Whether what was recorded before counts as well.
        from_start: bool,
        /// Time from one look to the next, ms.
        look_every_ms: u64,
    },
}

impl Address {
    /// The name in records and messages, such as `dds:0` or `mcap:run.mcap`.
    pub fn name(&self) -> String {
        match self {
            Self::Dds { domain, .. } => format!("dds:{domain}"),
            Self::Zenoh { domain, .. } => format!("zenoh:{domain}"),
            Self::Mcap { path, .. } => format!("mcap:{}", path.display()),
        }
    }
}

impl DoorSettings {
    /// The source as records name it: `dds:0/arm7`, `mcap:run.mcap`.
    pub fn source(&self) -> String {
        format!("{}{}", self.address.name(), self.namespace)
    }
}

/// Reads the one door that a robot has.
pub(super) fn read(s: &Section<'_>, folder: &Path) -> Result<DoorSettings, Located> {
    let dds = s.read("dds", dds)?;
    let zenoh = s.read("zenoh", zenoh)?;
    let mcap = s.read("mcap", |s| mcap(s, folder))?;
    let mut doors = [dds, zenoh, mcap].into_iter().flatten();
    match (doors.next(), doors.next()) {
        (Some(door), None) => Ok(door),
        (Some(_), Some(_)) => {
            let two = "it is heard at two places: of dds, zenoh and mcap one";
            Err(s.here(Fault::Contradiction, two).cure("leave one of them"))
        }
        (None, _) => {
            let why = "where the robot is heard; or zenoh, or mcap = { path = \"FILE\" }. `sinew watch` without a file lists what is there";
            Ok(s.needed(
                None,
                "dds",
                why,
                DoorSettings {
                    address: Address::Dds {
                        domain: 0,
                        interfaces: Vec::new(),
                    },
                    namespace: String::new(),
                },
            ))
        }
    }
}

fn domain(s: &Section<'_>) -> Result<u16, Located> {
    /// The ports of the next one are above 65535.
    const DOMAIN_MOST: u64 = 232;
    match s.count("domain")?.unwrap_or(0) {
        domain if domain <= DOMAIN_MOST => Ok(domain as u16),
        _ => Err(s.refuse("domain", "0 to 232")),
    }
}

/// `/arm7`: empty, or with a slash before and none behind.
fn namespace(s: &Section<'_>) -> Result<String, Located> {
    let text = s.text("namespace")?.unwrap_or_default();
    let bare = text.trim_matches('/');
    let fits = |c: char| c.is_ascii_alphanumeric() || "_/".contains(c);
    if !bare.chars().all(fits) || bare.contains("//") {
        return Err(s.refuse(
            "namespace",
            "a ROS namespace, such as \"/arm7\": letters, digits, _ and /",
        ));
    }
    Ok(match bare {
        "" => String::new(),
        bare => format!("/{bare}"),
    })
}

fn dds(s: &Section<'_>) -> Result<DoorSettings, Located> {
    let mut interfaces = Vec::new();
    if let Some(value) = s.value("interfaces") {
        for address in value.list("a list of addresses")? {
            let must = "an address of this computer, such as \"192.168.1.5\"";
            interfaces.push(address.text()?.parse().map_err(|_| address.refuse(must))?);
        }
    }
    let domain = domain(s)?;
    Ok(DoorSettings {
        address: Address::Dds { domain, interfaces },
        namespace: namespace(s)?,
    })
}

fn zenoh(s: &Section<'_>) -> Result<DoorSettings, Located> {
    let mut connect = Vec::new();
    if let Some(value) = s.value("connect") {
        for endpoint in value.list("a list of endpoints")? {
            let text = endpoint.text()?;
            if !text.starts_with("tcp/") {
                return Err(endpoint.refuse("an endpoint, such as \"tcp/127.0.0.1:7447\""));
            }
            connect.push(text.to_owned());
        }
    }
    let domain = domain(s)?;
    Ok(DoorSettings {
        address: Address::Zenoh { domain, connect },
        namespace: namespace(s)?,
    })
}

fn mcap(s: &Section<'_>, folder: &Path) -> Result<DoorSettings, Located> {
    let path = s.need_text("path", "the recording that grows, or a folder of such")?;
    let namespace = namespace(s)?;
    let from = s.one_of("from", &[("start", true), ("now", false)])?;
    let every_s = s.number_or("look_every_s", Bound::Within(0.001, 60.0), 0.2)?;
    Ok(DoorSettings {
        address: Address::Mcap {
            path: folder.join(path),
            from_start: from.unwrap_or(false),
            look_every_ms: (1e3 * every_s).round() as u64,
        },
        namespace,
    })
}
