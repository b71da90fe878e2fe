//! ROS 2 over DDS, without an installation of ROS.
//!
//! One participant for each domain. It reads the topics that some robot wants, best effort and volatile, which
//! matches every publisher; a robot's description reliable and transient local. It announces at most two
//! writers: those of [`Outgoing`](crate::Outgoing).
//!
//! Ports are those of the standard (RTPS 9.6.1): 7400 + 250 × domain for discovery, and two more for each
//! participant of a computer.

mod domains;
mod participant;
mod qos;
mod raw;
mod writers;

pub use domains::active_domains;

use crate::found::DomainFound;
use crate::handle::{Door, DoorError, Shared};
use crate::network::{self, End, Listening, Network};
use crate::publish::{Publisher, Publishing};
use crate::received::Clock;
use crate::route::Routes;
use participant::Participant;
use std::net::IpAddr;
use std::time::Duration;

/// Highest domain: the ports of the next one are above 65535.
pub const DOMAIN_MOST: u16 = 232;

/// Which network is listened to.
#[derive(Debug, Clone)]
pub struct DdsOptions {
    /// Domain, as in `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// Addresses of the interfaces used; none: all.
    pub interfaces: Vec<IpAddr>,
    /// What may be published.
    pub publishing: Publishing,
    /// Longest message taken, bytes.
    pub message_most_bytes: usize,
}

impl Default for DdsOptions {
    fn default() -> Self {
        DdsOptions {
            domain: 0,
            interfaces: Vec::new(),
            publishing: Publishing::default(),
            message_most_bytes: 4 << 20,
        }
    }
}

/// Opens the door; it listens until it is dropped. The publisher lives as long as the door.
///
/// # Errors
/// A domain above 232. A network that can't be used is a [`Trouble`](crate::Trouble): it may come back.
pub fn open(
    options: &DdsOptions,
    routes: &Routes,
    clock: Clock,
) -> Result<(Door, Box<dyn Publisher>), DoorError> {
    let (door, publisher, _directory) = network::open(options, routes, clock)?;
    Ok((door, publisher))
}

/// Joins the network and leaves it again: whether a door could be opened there now.
///
/// # Errors
/// A domain above 232; a network or interface that can't be used, with what the system says.
pub fn check(options: &DdsOptions) -> Result<(), DoorError> {
    options.refuse()?;
    let joined = participant::join(options).map(drop);
    joined.map_err(|why| network::refused(options, why))
}

impl Network for DdsOptions {
    type Joined<'a> = Participant<'a>;

    fn name(&self) -> String {
        format!("dds:{}", self.domain)
    }

    fn publishing(&mut self) -> &mut Publishing {
        &mut self.publishing
    }

    fn refuse(&self) -> Result<(), DoorError> {
        if self.domain > DOMAIN_MOST {
            return Err(DoorError::Option {
                what: "domain",
                value: self.domain.to_string(),
                why: format!("it is 0 to {DOMAIN_MOST}"),
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

/// Listens to a domain for a while and says what there is. Publishes nothing.
///
/// # Errors
/// As [`open`].
pub fn discover(
    options: &DdsOptions,
    clock: Clock,
    length: Duration,
) -> Result<DomainFound, DoorError> {
    network::discover(options, clock, length)
}
