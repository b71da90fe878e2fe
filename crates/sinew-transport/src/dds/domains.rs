//! Discovery of active DDS domains: participants announce themselves periodically on the domain's port.

use super::MAX_DOMAIN;
use socket2::{Domain, Protocol, Socket, Type};
use std::net::{IpAddr, Ipv4Addr, SocketAddrV4, UdpSocket};
use std::time::{Duration, Instant};

/// Multicast group in which participants announce themselves (RTPS 9.6.1).
const GROUP: Ipv4Addr = Ipv4Addr::new(239, 255, 0, 1);
const PORT_BASE: u16 = 7_400;
const PORT_PER_DOMAIN: u16 = 250;
/// Time between two polls of all ports.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Returns the domains in which a participant announced itself within `length`, in ascending order. Only listens:
/// participants announce themselves every 3 to 30 s, so that 10 s find most of them.
///
/// A port that another process uses exclusively is skipped.
pub fn active_domains(interfaces: &[IpAddr], length: Duration) -> Vec<u16> {
    let sockets = (0..=MAX_DOMAIN).filter_map(|domain| {
        let socket = listen(domain, interfaces).ok()?;
        Some((domain, socket))
    });
    let mut silent: Vec<(u16, UdpSocket)> = sockets.collect();
    let mut active = Vec::new();
    let begun = Instant::now();
    while begun.elapsed() < length && !silent.is_empty() {
        silent.retain(|(domain, socket)| {
            let is_silent = !has_message(socket);
            if !is_silent {
                active.push(*domain);
            }
            is_silent
        });
        std::thread::sleep(POLL_INTERVAL.min(length));
    }
    active.sort_unstable();
    active
}

fn listen(domain: u16, interfaces: &[IpAddr]) -> std::io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    // Shares the port with the participants of this host.
    socket.set_reuse_address(true)?;
    #[cfg(unix)]
    socket.set_reuse_port(true)?;
    socket.set_nonblocking(true)?;
    let port = PORT_BASE + PORT_PER_DOMAIN * domain;
    // Bound to the group: unicast messages to this port, meant for other participants, are not received.
    socket.bind(&SocketAddrV4::new(GROUP, port).into())?;
    let socket = UdpSocket::from(socket);
    let addresses = interfaces.iter().filter_map(|address| match address {
        IpAddr::V4(address) => Some(*address),
        IpAddr::V6(_) => None,
    });
    let mut joined = socket.join_multicast_v4(&GROUP, &Ipv4Addr::UNSPECIFIED);
    for address in addresses.chain([Ipv4Addr::LOCALHOST]) {
        joined = joined.or(socket.join_multicast_v4(&GROUP, &address));
    }
    joined?;
    Ok(socket)
}

/// Whether an RTPS message has been received.
fn has_message(socket: &UdpSocket) -> bool {
    let mut head = [0; 1_500];
    while let Ok(length) = socket.recv(&mut head) {
        if head[..length].starts_with(b"RTPS") {
            return true;
        }
    }
    false
}
