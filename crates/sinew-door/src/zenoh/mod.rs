//! ROS 2 over Zenoh, with the keys of rmw_zenoh, without an installation of ROS.
//!
//! A client of a router, or of a peer: it opens no port. Whoever publishes has a liveliness token; topics that some
//! robot wants are subscribed to, and a robot's description is asked for, as it was published before. Two writers
//! may be announced at most: those of [`Outgoing`](crate::Outgoing).

mod keys;
mod reader;
mod session;
mod writers;

use crate::found::DomainFound;
use crate::handle::{Door, DoorError, Shared};
use crate::network::{self, End, Listening, Network};
use crate::publish::{Publisher, Publishing};
use crate::received::Clock;
use crate::route::Routes;
use session::Session;
use std::time::Duration;

/// Where rmw_zenoh's router listens.
pub const ROUTER: &str = "tcp/127.0.0.1:7447";

/// Which network is listened to.
#[derive(Debug, Clone)]
pub struct ZenohOptions {
    /// Domain, as in `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// Routers or peers, such as `tcp/192.168.1.5:7447`: the first that answers. None: [`ROUTER`].
    pub connect: Vec<String>,
    /// What may be published.
    pub publishing: Publishing,
    /// Longest message taken, bytes.
    pub message_most_bytes: usize,
}

impl Default for ZenohOptions {
    fn default() -> Self {
        ZenohOptions {
            domain: 0,
            connect: Vec::new(),
            publishing: Publishing::default(),
            message_most_bytes: 4 << 20,
        }
    }
}

impl ZenohOptions {
    fn endpoints(&self) -> Vec<String> {
        match self.connect.as_slice() {
            [] => vec![ROUTER.to_owned()],
            some => some.to_vec(),
        }
    }
}

/// Opens the door; it listens until it is dropped. The publisher lives as long as the door.
///
/// # Errors
/// No thread can be started. A router that isn't there is a [`Trouble`](crate::Trouble): it may come.
pub fn open(
    options: &ZenohOptions,
    routes: &Routes,
    clock: Clock,
) -> Result<(Door, Box<dyn Publisher>), DoorError> {
    let (door, publisher, _directory) = network::open(options, routes, clock)?;
    Ok((door, publisher))
}

/// Connects and leaves again: whether a door could be opened there now.
///
/// # Errors
/// An endpoint that is none; no router or peer that answers.
pub fn check(options: &ZenohOptions) -> Result<(), DoorError> {
    let joined = session::join(options).map(drop);
    joined.map_err(|why| network::refused(options, why))
}

/// Domains of ROS 2 in which somebody has a token, in their order.
///
/// # Errors
/// As [`check`].
pub fn active_domains(options: &ZenohOptions) -> Result<Vec<u16>, DoorError> {
    let domains = session::active_domains(options);
    domains.map_err(|why| network::refused(options, why))
}

impl Network for ZenohOptions {
    type Joined<'a> = Session<'a>;

    fn name(&self) -> String {
        format!("zenoh:{}", self.domain)
    }

    fn publishing(&mut self) -> &mut Publishing {
        &mut self.publishing
    }

    fn join<'a>(
        &self,
        listening: &'a Listening,
        shared: &'a Shared,
    ) -> Result<Session<'a>, String> {
        Session::join(self, listening, shared)
    }

    fn listen(joined: Session<'_>) -> End {
        joined.listen()
    }
}

/// Listens to a domain for a while and says what there is. Publishes nothing.
///
/// # Errors
/// As [`open`].
pub fn discover(
    options: &ZenohOptions,
    clock: Clock,
    length: Duration,
) -> Result<DomainFound, DoorError> {
    network::discover(options, clock, length)
}
