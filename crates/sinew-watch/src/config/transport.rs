//! Transport of a robot in the configuration.

use sinew_files::{Bound, Fault, Fields as _, Located, Section};
use std::net::IpAddr;
use std::path::{Path, PathBuf};

/// Transport and namespace of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct TransportSettings {
    /// Transport that its messages pass through.
    pub address: Address,
    /// Namespace of its topics; empty: any.
    pub namespace: String,
}

/// Address of a transport; robots with the same address share the transport.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Address {
    /// ROS 2 over DDS.
    Dds {
        /// Domain, as in `ROS_DOMAIN_ID`.
        domain: u16,
        /// Addresses of the network interfaces to use; empty: all.
        interfaces: Vec<IpAddr>,
    },
    /// ROS 2 over Zenoh, with the keys of rmw_zenoh.
    Zenoh {
        /// Domain, as in `ROS_DOMAIN_ID`.
        domain: u16,
        /// Routers or peers, such as `tcp/127.0.0.1:7447`.
        connect: Vec<String>,
    },
    /// Growing MCAP file, or the newest of a folder.
    Mcap {
        /// Path of the file or folder.
        path: PathBuf,
        /// Whether existing data are included.
        from_start: bool,
        /// Polling interval, ms.
        look_every_ms: u64,
    },
}

impl Address {
    /// Returns the name in records and messages, such as `dds:0` or `mcap:run.mcap`.
    pub fn name(&self) -> String {
        match self {
            Self::Dds { domain, .. } => format!("dds:{domain}"),
            Self::Zenoh { domain, .. } => format!("zenoh:{domain}"),
            Self::Mcap { path, .. } => format!("mcap:{}", path.display()),
        }
    }
}

impl TransportSettings {
    /// Returns the source as recorded: `dds:0/arm7`, `mcap:run.mcap`.
    pub fn source(&self) -> String {
        format!("{}{}", self.address.name(), self.namespace)
    }
}

/// Reads the only transport of a robot.
pub(super) fn read(s: &Section<'_>, folder: &Path) -> Result<TransportSettings, Located> {
    let dds = s.read("dds", dds)?;
    let zenoh = s.read("zenoh", zenoh)?;
    let mcap = s.read("mcap", |s| mcap(s, folder))?;
    let mut transports = [dds, zenoh, mcap].into_iter().flatten();
    match (transports.next(), transports.next()) {
        (Some(transport), None) => Ok(transport),
        (Some(_), Some(_)) => {
            let two = "dds, zenoh and mcap conflict: expected one transport";
            Err(s
                .here(Fault::Contradiction, two)
                .cure("remove all but one of them"))
        }
        (None, _) => {
            let reason = "set dds, zenoh or mcap = { path = \"FILE\" }, the transport of the robot; `sinew watch` without a file lists the robots found";
            Ok(s.needed(
                None,
                "dds",
                reason,
                TransportSettings {
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
    /// The ports of the next domain would exceed 65535.
    const MAX_DOMAIN: u64 = 232;
    match s.count("domain")?.unwrap_or(0) {
        domain if domain <= MAX_DOMAIN => Ok(domain as u16),
        _ => Err(s.invalid("domain", "0 to 232")),
    }
}

/// Reads a namespace `/arm7`: empty, or with a leading and without a trailing slash.
fn namespace(s: &Section<'_>) -> Result<String, Located> {
    let text = s.text("namespace")?.unwrap_or_default();
    let bare = text.trim_matches('/');
    let fits = |c: char| c.is_ascii_alphanumeric() || "_/".contains(c);
    if !bare.chars().all(fits) || bare.contains("//") {
        return Err(s.invalid(
            "namespace",
            "a ROS namespace, such as \"/arm7\": letters, digits, _ and /",
        ));
    }
    Ok(match bare {
        "" => String::new(),
        bare => format!("/{bare}"),
    })
}

fn dds(s: &Section<'_>) -> Result<TransportSettings, Located> {
    let mut interfaces = Vec::new();
    if let Some(value) = s.value("interfaces") {
        for address in value.list("a list of addresses")? {
            let must = "an address of this host, such as \"192.168.1.5\"";
            interfaces.push(address.text()?.parse().map_err(|_| address.invalid(must))?);
        }
    }
    let domain = domain(s)?;
    Ok(TransportSettings {
        address: Address::Dds { domain, interfaces },
        namespace: namespace(s)?,
    })
}

fn zenoh(s: &Section<'_>) -> Result<TransportSettings, Located> {
    let mut connect = Vec::new();
    if let Some(value) = s.value("connect") {
        for endpoint in value.list("a list of endpoints")? {
            let text = endpoint.text()?;
            if !text.starts_with("tcp/") {
                return Err(endpoint.invalid("an endpoint, such as \"tcp/127.0.0.1:7447\""));
            }
            connect.push(text.to_owned());
        }
    }
    let domain = domain(s)?;
    Ok(TransportSettings {
        address: Address::Zenoh { domain, connect },
        namespace: namespace(s)?,
    })
}

fn mcap(s: &Section<'_>, folder: &Path) -> Result<TransportSettings, Located> {
    let path = s.need_text(
        "path",
        "set the path of a growing recording, or of a folder of recordings",
    )?;
    let namespace = namespace(s)?;
    let from = s.one_of("from", &[("start", true), ("now", false)])?;
    let every_s = s.number_or("look_every_s", Bound::Within(0.001, 60.0), 0.2)?;
    Ok(TransportSettings {
        address: Address::Mcap {
            path: folder.join(path),
            from_start: from.unwrap_or(false),
            look_every_ms: (1e3 * every_s).round() as u64,
        },
        namespace,
    })
}
