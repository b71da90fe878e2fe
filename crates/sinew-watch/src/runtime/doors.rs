//! The doors that stand open, each shared by the robots behind it.

use super::health::Health;
use super::tell::TellHandle;
use crate::config::{DoorSettings, Publish};
use sinew_door::tail::{From, TailOptions};
use sinew_door::{Clock, Door, DoorError, DoorStatus, Publisher, Publishing, Route, Routes, tail};
use std::collections::BTreeMap;
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
}

struct Open {
    door: Door,
    routes: Routes,
    publish: Publish,
}

/// The doors that stand open.
#[derive(Default)]
pub struct Doors {
    open: BTreeMap<DoorKey, Open>,
}

impl Doors {
    /// From now on these robots are behind these doors. A door that stays loses no message; one that no robot is
    /// behind is shut; what can't be opened is given back with why.
    pub fn set(
        &mut self,
        wanted: BTreeMap<DoorKey, Vec<Route>>,
        publish: Publish,
        (clock, tell): (Clock, &TellHandle),
        health: &Health,
    ) -> Vec<(DoorKey, DoorError)> {
        self.open.retain(|key, open| {
            // A recording publishes nothing: opened anew it would be read again.
            let same = matches!(key, DoorKey::Mcap { .. }) || open.publish == publish;
            let stays = wanted.contains_key(key) && same;
            if !stays {
                tell.remove(key);
            }
            stays
        });
        let mut faults = Vec::new();
        for (key, routes) in wanted {
            if let Some(open) = self.open.get(&key) {
                open.routes.replace(routes);
                continue;
            }
            let routes = Routes::new(routes);
            match open(&key, &routes, publish, clock) {
                Ok((door, publisher)) => {
                    health.say(&format!("{}: open", door.status().name));
                    if let Some(publisher) = publisher {
                        tell.add(key.clone(), publisher);
                    }
                    self.open.insert(
                        key,
                        Open {
                            door,
                            routes,
                            publish,
                        },
                    );
                }
                Err(error) => {
                    health.say(&error.to_string());
                    faults.push((key, error));
                }
            }
        }
        faults
    }

    /// What they say of themselves.
    pub fn status(&self) -> Vec<DoorStatus> {
        self.open.values().map(|open| open.door.status()).collect()
    }

    /// Shuts all.
    pub fn shut(&mut self) {
        self.open.clear();
    }

    /// One that was opened elsewhere: of the demonstration.
    pub fn adopt(&mut self, key: DoorKey, door: Door, routes: Routes) {
        let publish = Publish {
            diagnostics: false,
            tendons: false,
        };
        self.open.insert(
            key,
            Open {
                door,
                routes,
                publish,
            },
        );
    }
}

/// A door, and its way out where it has one.
type Opened = (Door, Option<Box<dyn Publisher>>);

fn open(
    key: &DoorKey,
    routes: &Routes,
    publish: Publish,
    clock: Clock,
) -> Result<Opened, DoorError> {
    let publishing = Publishing {
        diagnostics: publish.diagnostics,
        tendons: publish.tendons,
    };
    match key {
        DoorKey::Dds { domain, interfaces } => dds(*domain, interfaces, publishing, routes, clock),
        DoorKey::Zenoh { domain, connect } => zenoh(*domain, connect, publishing, routes, clock),
        DoorKey::Mcap {
            path,
            from_start,
            look_every_ms,
        } => {
            let options = TailOptions {
                from: if *from_start { From::Start } else { From::Now },
                look_every_s: 1e-3 * *look_every_ms as f64,
                ..TailOptions::of(path.clone())
            };
            Ok((tail::open(&options, routes, clock)?, None))
        }
    }
}

/// Looks whether a door could be opened now; nothing is started.
///
/// # Errors
/// Why not.
pub fn check(key: &DoorKey) -> Result<(), DoorError> {
    match key {
        DoorKey::Dds { domain, interfaces } => check_dds(*domain, interfaces),
        DoorKey::Zenoh { domain, .. } => Err(without(format!("zenoh:{domain}"), "zenoh")),
        DoorKey::Mcap { path, .. } => tail::check(path),
    }
}

#[cfg(feature = "dds")]
fn check_dds(domain: u16, interfaces: &[IpAddr]) -> Result<(), DoorError> {
    sinew_door::dds::check(&sinew_door::dds::DdsOptions {
        domain,
        interfaces: interfaces.to_vec(),
        publishing: Publishing::NOTHING,
        ..Default::default()
    })
}

#[cfg(not(feature = "dds"))]
fn check_dds(domain: u16, _: &[IpAddr]) -> Result<(), DoorError> {
    Err(without(format!("dds:{domain}"), "dds"))
}

#[cfg(feature = "dds")]
fn dds(
    domain: u16,
    interfaces: &[IpAddr],
    publishing: Publishing,
    routes: &Routes,
    clock: Clock,
) -> Result<Opened, DoorError> {
    let options = sinew_door::dds::DdsOptions {
        domain,
        interfaces: interfaces.to_vec(),
        publishing,
        ..Default::default()
    };
    let (door, publisher) = sinew_door::dds::open(&options, routes, clock)?;
    Ok((door, Some(publisher)))
}

#[cfg(not(feature = "dds"))]
fn dds(
    domain: u16,
    _: &[IpAddr],
    _: Publishing,
    _: &Routes,
    _: Clock,
) -> Result<Opened, DoorError> {
    Err(without(format!("dds:{domain}"), "dds"))
}

fn zenoh(
    domain: u16,
    _: &[String],
    _: Publishing,
    _: &Routes,
    _: Clock,
) -> Result<Opened, DoorError> {
    Err(without(format!("zenoh:{domain}"), "zenoh"))
}

fn without(door: String, feature: &str) -> DoorError {
    DoorError::Refused {
        door,
        why: format!(
            "this sinew-watch was built without it; cargo install --path crates/sinew-watch --features {feature}"
        ),
    }
}
