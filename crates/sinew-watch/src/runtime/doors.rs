//! The doors that stand open, each shared by the robots behind it.

use super::door::{DoorKey, DoorNow};
use super::health::Health;
use super::tell::TellHandle;
use crate::config::Publish;
use sinew_door::tail::{From, TailOptions};
use sinew_door::{Clock, Door, DoorError, Publisher, Publishing, Route, Routes, tail};
use std::collections::BTreeMap;
use std::net::IpAddr;
use std::time::{Duration, Instant};

struct Open {
    door: Door,
    routes: Routes,
    publish: Publish,
}

/// One that can't be opened is tried again after so long.
const TRY_AGAIN: Duration = Duration::from_secs(30);

/// What couldn't be opened.
struct Failed {
    error: DoorError,
    routes: Routes,
    publish: Publish,
    next_try: Instant,
}

/// The doors that stand open, and those that should.
#[derive(Default)]
pub struct Doors {
    open: BTreeMap<DoorKey, Open>,
    failed: BTreeMap<DoorKey, Failed>,
    /// Why they were shut when that was said last.
    said: BTreeMap<DoorKey, Option<String>>,
}

impl Doors {
    /// From now on these robots are behind these doors. A door that stays loses no message; one that no robot is
    /// behind is shut; what can't be opened is tried again.
    pub fn set(
        &mut self,
        wanted: BTreeMap<DoorKey, Vec<Route>>,
        publish: Publish,
        (clock, tell): (Clock, &TellHandle),
    ) {
        self.open.retain(|key, open| {
            // A recording publishes nothing: opened anew it would be read again.
            let same = matches!(key, DoorKey::Mcap { .. }) || open.publish == publish;
            let stays = wanted.contains_key(key) && same;
            if !stays {
                tell.remove(key);
            }
            stays
        });
        self.failed.clear();
        self.said.retain(|key, _| wanted.contains_key(key));
        for (key, routes) in wanted {
            match self.open.get(&key) {
                Some(open) => open.routes.replace(routes),
                None => self.try_open(key, Routes::new(routes), publish, (clock, tell)),
            }
        }
    }

    fn try_open(
        &mut self,
        key: DoorKey,
        routes: Routes,
        publish: Publish,
        (clock, tell): (Clock, &TellHandle),
    ) {
        match open(&key, &routes, publish, clock) {
            Ok((door, publisher)) => {
                if let Some(publisher) = publisher {
                    tell.add(key.clone(), publisher);
                }
                let open = Open {
                    door,
                    routes,
                    publish,
                };
                self.open.insert(key, open);
            }
            Err(error) => {
                let failed = Failed {
                    error,
                    routes,
                    publish,
                    next_try: Instant::now() + TRY_AGAIN,
                };
                self.failed.insert(key, failed);
            }
        }
    }

    /// Tries again what couldn't be opened, and tells the log what became shut or open.
    pub fn look(&mut self, with: (Clock, &TellHandle), health: &Health) {
        let now = Instant::now();
        let failed = std::mem::take(&mut self.failed);
        for (key, failed) in failed {
            match failed.next_try <= now {
                true => self.try_open(key, failed.routes, failed.publish, with),
                false => {
                    self.failed.insert(key, failed);
                }
            }
        }
        let all = self.now();
        for (key, door) in &all {
            let said = self.said.get(key);
            if said != Some(&door.shut) {
                match &door.shut {
                    Some(why) => health.say(&format!("{}: shut: {why}; tried again", door.door)),
                    // A door that is just opened may find that it can't be: it says so at once.
                    None => health.say(&format!("{}: open", door.door)),
                }
                self.said.insert(key.clone(), door.shut.clone());
            }
        }
        health.set_doors(all.into_values().collect());
    }

    /// How they are.
    pub fn now(&self) -> BTreeMap<DoorKey, DoorNow> {
        let open = self.open.iter().map(|(key, open)| {
            let status = open.door.status();
            let door = DoorNow {
                door: status.name,
                shut: status.shut,
                messages: status.messages,
            };
            (key.clone(), door)
        });
        let failed = self.failed.iter().map(|(key, failed)| {
            let door = DoorNow {
                door: key.name(),
                shut: Some(failed.error.to_string()),
                messages: 0,
            };
            (key.clone(), door)
        });
        open.chain(failed).collect()
    }

    /// Shuts all.
    pub fn shut(&mut self) {
        self.open.clear();
        self.failed.clear();
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
        DoorKey::Zenoh { domain, connect } => check_zenoh(*domain, connect),
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

#[cfg(feature = "zenoh")]
fn check_zenoh(domain: u16, connect: &[String]) -> Result<(), DoorError> {
    sinew_door::zenoh::check(&sinew_door::zenoh::ZenohOptions {
        domain,
        connect: connect.to_vec(),
        publishing: Publishing::NOTHING,
        ..Default::default()
    })
}

#[cfg(not(feature = "zenoh"))]
fn check_zenoh(domain: u16, _: &[String]) -> Result<(), DoorError> {
    Err(without(format!("zenoh:{domain}"), "zenoh"))
}

#[cfg(feature = "zenoh")]
fn zenoh(
    domain: u16,
    connect: &[String],
    publishing: Publishing,
    routes: &Routes,
    clock: Clock,
) -> Result<Opened, DoorError> {
    let options = sinew_door::zenoh::ZenohOptions {
        domain,
        connect: connect.to_vec(),
        publishing,
        ..Default::default()
    };
    let (door, publisher) = sinew_door::zenoh::open(&options, routes, clock)?;
    Ok((door, Some(publisher)))
}

#[cfg(not(feature = "zenoh"))]
fn zenoh(
    domain: u16,
    _: &[String],
    _: Publishing,
    _: &Routes,
    _: Clock,
) -> Result<Opened, DoorError> {
    Err(without(format!("zenoh:{domain}"), "zenoh"))
}

#[cfg(not(all(feature = "dds", feature = "zenoh")))]
fn without(door: String, feature: &str) -> DoorError {
    DoorError::Refused {
        door,
        why: format!(
            "this sinew-watch was built without it; cargo install --path crates/sinew-watch --features {feature}"
        ),
    }
}
