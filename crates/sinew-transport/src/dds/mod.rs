//! ROS 2 over DDS, without an installation of ROS.
//!
//! One participant per domain. It subscribes to the topics that a robot requires, best effort and volatile, which is
//! compatible with every publisher, and to the robot description reliable and transient local. It announces at most
//! two writers: those of [`Outgoing`](crate::Outgoing).
//!
//! Ports follow the standard (RTPS 9.6.1): 7400 + 250 × domain for discovery, and two more per participant of a host.

mod domains;
mod participant;
mod qos;
mod raw;
mod writers;

pub use domains::active_domains;

use crate::found::DomainFound;
use crate::handle::{Shared, Transport, TransportError};
use crate::network::{self, End, Listening, Network};
use crate::publish::{Publisher, Publishing};
use crate::received::Clock;
use crate::route::Routes;
use participant::Participant;
use std::net::IpAddr;
use std::time::Duration;

/// Highest domain: the ports of the next one would exceed 65535.
pub const MAX_DOMAIN: u16 = 232;

/// DDS network to connect to.
#[derive(Debug, Clone)]
pub struct DdsOptions {
    /// Domain, as in `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// Addresses of the network interfaces to use; empty: all.
    pub interfaces: Vec<IpAddr>,
    /// Messages that may be published.
    pub publishing: Publishing,
    /// Maximum length of a received message, bytes.
    pub max_message_bytes: usize,
}

impl Default for DdsOptions {
    fn default() -> Self {
        DdsOptions {
            domain: 0,
            interfaces: Vec::new(),
            publishing: Publishing::default(),
            max_message_bytes: 4 << 20,
        }
    }
}

/// Opens the transport; it receives until it is dropped. The publisher lives as long as the transport.
///
/// # Errors
/// Returns [`TransportError::Option`] if the domain is above 232. A network that cannot be used is no error but a
/// [`TransportFault`](crate::TransportFault): the connection is retried.
pub fn open(
    options: &DdsOptions,
    routes: &Routes,
    clock: Clock,
) -> Result<(Transport, Box<dyn Publisher>), TransportError> {
    let (transport, publisher, _directory) = network::open(options, routes, clock)?;
    Ok((transport, publisher))
}

/// Joins the network and leaves it again: checks whether a transport could connect now.
///
/// # Errors
/// Returns [`TransportError::Option`] if the domain is above 232, and [`TransportError::Rejected`] with the reason of
/// the system if a network or interface cannot be used.
pub fn check(options: &DdsOptions) -> Result<(), TransportError> {
    options.check_options()?;
    let joined = participant::join(options).map(drop);
    joined.map_err(|reason| network::rejected(options, reason))
}

impl Network for DdsOptions {
    type Joined<'a> = Participant<'a>;

    fn name(&self) -> String {
        format!("dds:{}", self.domain)
    }

    fn publishing(&mut self) -> &mut Publishing {
        &mut self.publishing
    }

    fn check_options(&self) -> Result<(), TransportError> {
        if self.domain > MAX_DOMAIN {
            return Err(TransportError::Option {
                what: "domain",
                value: self.domain.to_string(),
                reason: format!("expected 0 to {MAX_DOMAIN}"),
            });
        }
        Ok(())
    }

    fn join<'a>(
        &self,
        listening: &'a Listening,
        shared: &'a Shared,
    ) -> Result<Participant<'a>, String> {
        Participant::join(self, listening, shared)
    }

    fn listen(joined: Participant<'_>) -> End {
        joined.listen()
    }
}

/// Listens to a domain for a while and returns its topics, publishers and robots. Publishes nothing.
///
/// # Errors
/// Same as [`open`].
pub fn discover(
    options: &DdsOptions,
    clock: Clock,
    length: Duration,
) -> Result<DomainFound, TransportError> {
    network::discover(options, clock, length)
}
