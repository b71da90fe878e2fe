//! ROS 2 over Zenoh, with the keys of rmw_zenoh, without an installation of ROS.
//!
//! A client of a router or a peer: it opens no port. Every publisher has a liveliness token; topics that a robot
//! requires are subscribed to, and a robot description is queried, because it may have been published before. At most
//! two writers are announced: those of [`Outgoing`](crate::Outgoing).

mod keys;
mod reader;
mod session;
mod writers;

use crate::found::DomainFound;
use crate::handle::{Shared, Transport, TransportError};
use crate::network::{self, End, Listening, Network};
use crate::publish::{Publisher, Publishing};
use crate::received::Clock;
use crate::route::Routes;
use session::Session;
use std::time::Duration;

/// Default endpoint of the rmw_zenoh router.
pub const ROUTER: &str = "tcp/127.0.0.1:7447";

/// Zenoh network to connect to.
#[derive(Debug, Clone)]
pub struct ZenohOptions {
    /// Domain, as in `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// Routers or peers, such as `tcp/192.168.1.5:7447`; the first that responds is used. Empty: [`ROUTER`].
    pub connect: Vec<String>,
    /// Messages that may be published.
    pub publishing: Publishing,
    /// Maximum length of a received message, bytes.
    pub max_message_bytes: usize,
}

impl Default for ZenohOptions {
    fn default() -> Self {
        ZenohOptions {
            domain: 0,
            connect: Vec::new(),
            publishing: Publishing::default(),
            max_message_bytes: 4 << 20,
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

/// Opens the transport; it receives until it is dropped. The publisher lives as long as the transport.
///
/// # Errors
/// Returns [`TransportError::Io`] if no thread can be started. A missing router is no error but a
/// [`TransportFault`](crate::TransportFault): the connection is retried.
pub fn open(
    options: &ZenohOptions,
    routes: &Routes,
    clock: Clock,
) -> Result<(Transport, Box<dyn Publisher>), TransportError> {
    let (transport, publisher, _directory) = network::open(options, routes, clock)?;
    Ok((transport, publisher))
}

/// Connects and disconnects: checks whether a transport could connect now.
///
/// # Errors
/// Returns [`TransportError::Rejected`] if an endpoint is invalid, or no router or peer responds.
pub fn check(options: &ZenohOptions) -> Result<(), TransportError> {
    let joined = session::join(options).map(drop);
    joined.map_err(|reason| network::rejected(options, reason))
}

/// Returns the domains of ROS 2 with at least one token, in ascending order.
///
/// # Errors
/// Same as [`check`].
pub fn active_domains(options: &ZenohOptions) -> Result<Vec<u16>, TransportError> {
    let domains = session::active_domains(options);
    domains.map_err(|reason| network::rejected(options, reason))
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

/// Listens to a domain for a while and returns its topics, publishers and robots. Publishes nothing.
///
/// # Errors
/// Same as [`open`].
pub fn discover(
    options: &ZenohOptions,
    clock: Clock,
    length: Duration,
) -> Result<DomainFound, TransportError> {
    network::discover(options, clock, length)
}
