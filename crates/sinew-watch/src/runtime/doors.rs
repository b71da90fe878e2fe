//! The doors that stand open, each shared by the robots behind it.

use super::door::DoorNow;
use super::health::Health;
use super::tell::TellHandle;
use crate::config::Address;
use sinew_door::tail::{From, TailOptions};
use sinew_door::{Clock, Door, DoorError, Publisher, Publishing, Route, Routes, tail};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// One that can't be opened is tried again after so long.
const TRY_AGAIN: Duration = Duration::from_secs(30);

/// A door that robots are behind: open, or why it can't be opened and when that is tried again.
struct Wanted {
    door: Result<Door, (DoorError, Instant)>,
    routes: Routes,
    publishing: Publishing,
}

impl Wanted {
    /// Tries to open a door.
    fn open(
        address: &Address,
        routes: Routes,
        publishing: Publishing,
        (clock, tell): (Clock, &TellHandle),
    ) -> Self {
        let opened = open(address, &routes, publishing, clock).map(|(door, publisher)| {
            if let Some(publisher) = publisher {
                tell.add(address.clone(), publisher);
            }
            door
        });
        Self {
            door: opened.map_err(|error| (error, Instant::now() + TRY_AGAIN)),
            routes,
            publishing,
        }
    }

    /// How it is.
    fn now(&self, address: &Address) -> DoorNow {
        match &self.door {
            Ok(door) => {
                let status = door.status();
                DoorNow {
                    door: status.name,
                    shut: status.shut,
                    messages: status.messages,
                }
            }
            Err((error, _)) => DoorNow {
                door: address.name(),
                shut: Some(error.to_string()),
                messages: 0,
            },
        }
    }
}

/// The doors that stand open, and those that should.
#[derive(Default)]
pub struct Doors {
    all: BTreeMap<Address, Wanted>,
    /// Why they were shut when that was said last.
    said: BTreeMap<Address, Option<String>>,
}

impl Doors {
    /// From now on these robots are behind these doors. A door that stays loses no message; one that no robot is
    /// behind is shut; what can't be opened is tried again.
    pub fn set(
        &mut self,
        wanted: BTreeMap<Address, Vec<Route>>,
        publishing: Publishing,
        with: (Clock, &TellHandle),
    ) {
        self.all.retain(|address, known| {
            // A recording publishes nothing: opened anew it would be read again.
            let same = matches!(address, Address::Mcap { .. }) || known.publishing == publishing;
            let stays = wanted.contains_key(address) && same && known.door.is_ok();
            if !stays {
                with.1.remove(address);
            }
            stays
        });
        self.said.retain(|address, _| wanted.contains_key(address));
        for (address, routes) in wanted {
            match self.all.get(&address) {
                Some(known) => known.routes.replace(routes),
                None => {
                    let known = Wanted::open(&address, Routes::new(routes), publishing, with);
                    self.all.insert(address, known);
                }
            }
        }
    }

    /// Tries again what couldn't be opened, and tells the log what became shut or open.
    pub fn look(&mut self, with: (Clock, &TellHandle), health: &Health) {
        for (address, known) in &mut self.all {
            if matches!(&known.door, Err((_, next_try)) if *next_try <= Instant::now()) {
                *known = Wanted::open(address, known.routes.clone(), known.publishing, with);
            }
        }
        let all = self.now();
        for (address, door) in &all {
            let said = self.said.get(address);
            if said != Some(&door.shut) {
                match &door.shut {
                    Some(why) => health.say(&format!("{}: shut: {why}; tried again", door.door)),
                    // A door that is just opened may find that it can't be: it says so at once.
                    None => health.say(&format!("{}: open", door.door)),
                }
                self.said.insert(address.clone(), door.shut.clone());
            }
        }
        health.set_doors(all.into_values().collect());
    }

    /// How they are.
    pub fn now(&self) -> BTreeMap<Address, DoorNow> {
        let all = self.all.iter();
        all.map(|(address, known)| (address.clone(), known.now(address)))
            .collect()
    }

    /// Shuts all doors.
    pub fn shut(&mut self) {
        self.all.clear();
    }

    /// Takes a door that was opened elsewhere: of the demonstration.
    pub fn adopt(&mut self, address: Address, door: Door, routes: Routes) {
        let known = Wanted {
            door: Ok(door),
            routes,
            publishing: Publishing::NOTHING,
        };
        self.all.insert(address, known);
    }
}

/// A door, and its way out where it has one.
type Opened = (Door, Option<Box<dyn Publisher>>);

#[cfg_attr(
    not(any(feature = "dds", feature = "zenoh")),
    expect(unused_variables, reason = "a recording publishes nothing")
)]
fn open(
    address: &Address,
    routes: &Routes,
    publishing: Publishing,
    clock: Clock,
) -> Result<Opened, DoorError> {
    match address {
        #[cfg(feature = "dds")]
        Address::Dds { domain, interfaces } => {
            let options = dds(*domain, interfaces, publishing);
            let (door, publisher) = sinew_door::dds::open(&options, routes, clock)?;
            Ok((door, Some(publisher)))
        }
        #[cfg(feature = "zenoh")]
        Address::Zenoh { domain, connect } => {
            let options = zenoh(*domain, connect, publishing);
            let (door, publisher) = sinew_door::zenoh::open(&options, routes, clock)?;
            Ok((door, Some(publisher)))
        }
        Address::Mcap {
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
        #[cfg(not(all(feature = "dds", feature = "zenoh")))]
        other => Err(without(other)),
    }
}

/// Looks whether a door could be opened now; nothing is started.
///
/// # Errors
/// Why not.
pub fn check(address: &Address) -> Result<(), DoorError> {
    match address {
        #[cfg(feature = "dds")]
        Address::Dds { domain, interfaces } => {
            sinew_door::dds::check(&dds(*domain, interfaces, Publishing::NOTHING))
        }
        #[cfg(feature = "zenoh")]
        Address::Zenoh { domain, connect } => {
            sinew_door::zenoh::check(&zenoh(*domain, connect, Publishing::NOTHING))
        }
        Address::Mcap { path, .. } => tail::check(path),
        #[cfg(not(all(feature = "dds", feature = "zenoh")))]
        other => Err(without(other)),
    }
}

#[cfg(feature = "dds")]
fn dds(
    domain: u16,
    interfaces: &[std::net::IpAddr],
    publishing: Publishing,
) -> sinew_door::dds::DdsOptions {
    sinew_door::dds::DdsOptions {
        domain,
        interfaces: interfaces.to_vec(),
        publishing,
        ..Default::default()
    }
}

#[cfg(feature = "zenoh")]
fn zenoh(
    domain: u16,
    connect: &[String],
    publishing: Publishing,
) -> sinew_door::zenoh::ZenohOptions {
    sinew_door::zenoh::ZenohOptions {
        domain,
        connect: connect.to_vec(),
        publishing,
        ..Default::default()
    }
}

#[cfg(not(all(feature = "dds", feature = "zenoh")))]
fn without(address: &Address) -> DoorError {
    let feature = match address {
        Address::Zenoh { .. } => "zenoh",
        _ => "dds",
    };
    DoorError::Refused {
        door: address.name(),
        why: format!(
            "this sinew-watch was built without it; cargo install --path crates/sinew-watch --features {feature}"
        ),
    }
}
