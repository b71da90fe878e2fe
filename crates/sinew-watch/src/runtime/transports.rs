//! Open transports, each shared by the robots behind it.

use super::health::Health;
use super::publish::PublishHandle;
use super::transport::TransportView;
use crate::config::Address;
use crate::words;
use sinew_transport::tail::{From, TailOptions};
use sinew_transport::{
    Clock, Publisher, Publishing, Route, Routes, Transport, TransportError, tail,
};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Waiting time before the next attempt after a failure.
const RETRY_INTERVAL: Duration = Duration::from_secs(30);

/// Required transport: open, or with the reason of the failure and the time of the next attempt.
struct ManagedTransport {
    transport: Result<Transport, (TransportError, Instant)>,
    routes: Routes,
    publishing: Publishing,
}

impl ManagedTransport {
    /// Opens a transport.
    fn open(
        address: &Address,
        routes: Routes,
        publishing: Publishing,
        (clock, publish): (Clock, &PublishHandle),
    ) -> Self {
        let result = open(address, &routes, publishing, clock).map(|(transport, publisher)| {
            if let Some(publisher) = publisher {
                publish.add(address.clone(), publisher);
            }
            transport
        });
        Self {
            transport: result.map_err(|error| (error, Instant::now() + RETRY_INTERVAL)),
            routes,
            publishing,
        }
    }

    /// Returns the present state.
    fn now(&self, address: &Address) -> TransportView {
        match &self.transport {
            Ok(transport) => {
                let status = transport.status();
                TransportView {
                    transport: status.name,
                    disconnected: status.disconnected,
                    messages: status.messages,
                }
            }
            Err((error, _)) => TransportView {
                transport: address.name(),
                disconnected: Some(error.to_string()),
                messages: 0,
            },
        }
    }
}

/// Required transports with their state.
#[derive(Default)]
pub struct Transports {
    all: BTreeMap<Address, ManagedTransport>,
    /// Reasons of the disconnections at the last report.
    reported: BTreeMap<Address, Option<String>>,
}

impl Transports {
    /// Sets the robots behind each transport. A transport that remains loses no message; one without robots is
    /// closed; a failed one is retried later.
    pub fn set(
        &mut self,
        wanted: BTreeMap<Address, Vec<Route>>,
        publishing: Publishing,
        with: (Clock, &PublishHandle),
    ) {
        self.all.retain(|address, entry| {
            // A recording publishes nothing: reopening would read it again.
            let same = matches!(address, Address::Mcap { .. }) || entry.publishing == publishing;
            let stays = wanted.contains_key(address) && same && entry.transport.is_ok();
            if !stays {
                with.1.remove(address);
            }
            stays
        });
        self.reported
            .retain(|address, _| wanted.contains_key(address));
        for (address, routes) in wanted {
            match self.all.get(&address) {
                Some(entry) => entry.routes.replace(routes),
                None => {
                    let entry =
                        ManagedTransport::open(&address, Routes::new(routes), publishing, with);
                    self.all.insert(address, entry);
                }
            }
        }
    }

    /// Opens failed transports again, and logs changed connection states.
    pub fn look(&mut self, with: (Clock, &PublishHandle), health: &Health) {
        for (address, entry) in &mut self.all {
            let failed = entry.transport.as_ref().ok().map(Transport::status);
            if let Some(status) = failed.filter(|status| status.failed) {
                let error = TransportError::Content {
                    transport: status.name,
                    reason: status.disconnected.unwrap_or_default(),
                };
                entry.transport = Err((error, Instant::now() + RETRY_INTERVAL));
            }
            if matches!(&entry.transport, Err((_, next_try)) if *next_try <= Instant::now()) {
                *entry =
                    ManagedTransport::open(address, entry.routes.clone(), entry.publishing, with);
            }
        }
        let all = self.now();
        for (address, transport) in &all {
            let reported = self.reported.get(address);
            if reported != Some(&transport.disconnected) {
                match &transport.disconnected {
                    Some(reason) => {
                        health.log(&words::log::disconnected(&transport.transport, reason));
                    }
                    // A new transport may report its failure immediately.
                    None => health.log(&words::log::connected(&transport.transport)),
                }
                self.reported
                    .insert(address.clone(), transport.disconnected.clone());
            }
        }
        health.set_transports(all.into_values().collect());
    }

    /// Returns the present state of all transports.
    pub fn now(&self) -> BTreeMap<Address, TransportView> {
        let all = self.all.iter();
        all.map(|(address, entry)| (address.clone(), entry.now(address)))
            .collect()
    }

    /// Closes all transports.
    pub fn close(&mut self) {
        self.all.clear();
    }

    /// Adopts a transport created elsewhere, such as that of the demonstration.
    pub fn adopt(&mut self, address: Address, transport: Transport, routes: Routes) {
        let entry = ManagedTransport {
            transport: Ok(transport),
            routes,
            publishing: Publishing::DISABLED,
        };
        self.all.insert(address, entry);
    }
}

/// Open transport with its publisher, if any.
type TransportWithPublisher = (Transport, Option<Box<dyn Publisher>>);

#[cfg_attr(
    not(any(feature = "dds", feature = "zenoh")),
    expect(unused_variables, reason = "a recording publishes nothing")
)]
fn open(
    address: &Address,
    routes: &Routes,
    publishing: Publishing,
    clock: Clock,
) -> Result<TransportWithPublisher, TransportError> {
    match address {
        #[cfg(feature = "dds")]
        Address::Dds { domain, interfaces } => {
            let options = dds(*domain, interfaces, publishing);
            let (transport, publisher) = sinew_transport::dds::open(&options, routes, clock)?;
            Ok((transport, Some(publisher)))
        }
        #[cfg(feature = "zenoh")]
        Address::Zenoh { domain, connect } => {
            let options = zenoh(*domain, connect, publishing);
            let (transport, publisher) = sinew_transport::zenoh::open(&options, routes, clock)?;
            Ok((transport, Some(publisher)))
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

/// Checks whether a transport could connect now; starts nothing.
///
/// # Errors
/// Returns the reason if the transport is not available.
pub fn check(address: &Address) -> Result<(), TransportError> {
    match address {
        #[cfg(feature = "dds")]
        Address::Dds { domain, interfaces } => {
            sinew_transport::dds::check(&dds(*domain, interfaces, Publishing::DISABLED))
        }
        #[cfg(feature = "zenoh")]
        Address::Zenoh { domain, connect } => {
            sinew_transport::zenoh::check(&zenoh(*domain, connect, Publishing::DISABLED))
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
) -> sinew_transport::dds::DdsOptions {
    sinew_transport::dds::DdsOptions {
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
) -> sinew_transport::zenoh::ZenohOptions {
    sinew_transport::zenoh::ZenohOptions {
        domain,
        connect: connect.to_vec(),
        publishing,
        ..Default::default()
    }
}

#[cfg(not(all(feature = "dds", feature = "zenoh")))]
fn without(address: &Address) -> TransportError {
    let feature = match address {
        Address::Zenoh { .. } => "zenoh",
        _ => "dds",
    };
    TransportError::Rejected {
        transport: address.name(),
        reason: format!(
            "built without it; run cargo install --path crates/sinew-watch --features {feature}"
        ),
    }
}
