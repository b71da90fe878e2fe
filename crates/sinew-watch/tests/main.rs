//! Tests of the monitor, in one binary.

mod check;
#[cfg(feature = "schema")]
#[path = "../../sinew/tests/checker.rs"]
mod checker;
mod config;
mod http;
#[cfg(feature = "tls")]
mod notifications;
#[cfg(feature = "schema")]
mod openapi;
mod recording;
#[cfg(feature = "schema")]
mod reference;
mod ship;
mod store;
mod web;

/// Reason of the disconnection of a Zenoh transport without a router.
const WITHOUT_ZENOH: &str = if cfg!(feature = "zenoh") {
    "no router or peer is connected"
} else {
    "built without it"
};
