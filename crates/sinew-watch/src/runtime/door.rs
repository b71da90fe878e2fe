//! Which door robots come through, and how it is.

use crate::config::DoorSettings;
use serde::Serialize;
use std::net::IpAddr;
use std::path::PathBuf;

/// Which door; robots with the same share it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum DoorKey {
    /// A domain of DDS.
    Dds {
        /// Domain.
        domain: u16,
        /// Interfaces.
        interfaces: Vec<IpAddr>,
    },
    /// A network of Zenoh.
    Zenoh {
        /// Domain.
        domain: u16,
        /// Routers or peers.
        connect: Vec<String>,
    },
    /// A growing recording.
    Mcap {
        /// File or folder.
        path: PathBuf,
        /// Whether it is read from its start.
        from_start: bool,
        /// Time between looks, ms.
        look_every_ms: u64,
    },
}

impl DoorKey {
    /// The door of a robot.
    pub fn of(settings: &DoorSettings) -> Self {
        match settings {
            DoorSettings::Dds {
                domain, interfaces, ..
            } => Self::Dds {
                domain: *domain,
                interfaces: interfaces.clone(),
            },
            DoorSettings::Zenoh {
                domain, connect, ..
            } => Self::Zenoh {
                domain: *domain,
                connect: connect.clone(),
            },
            DoorSettings::Mcap {
                path,
                from_start,
                look_every_s,
                ..
            } => Self::Mcap {
                path: path.clone(),
                from_start: *from_start,
                look_every_ms: (1e3 * look_every_s).round() as u64,
            },
        }
    }

    /// As records and messages name it.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Dds { domain, .. } => format!("dds:{domain}"),
            Self::Zenoh { domain, .. } => format!("zenoh:{domain}"),
            Self::Mcap { path, .. } => format!("mcap:{}", path.display()),
        }
    }
}

/// Why a door is shut.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shut {
    /// Which, such as `dds:0`.
    pub door: String,
    /// What the system said.
    pub why: String,
}

/// How a door is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DoorNow {
    /// Its name, such as `dds:0` or `mcap:run.mcap`.
    pub door: String,
    /// Why nothing can come through it; `None`: it is open.
    pub shut: Option<String>,
    /// Messages received so far of topics that some robot wants.
    #[serde(skip)]
    pub messages: u64,
}
