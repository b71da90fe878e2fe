//! Tests of the monitor, in one binary.

mod check;
#[cfg(feature = "schema")]
#[path = "../../sinew/tests/checker.rs"]
mod checker;
mod config;
mod http;
#[cfg(feature = "schema")]
mod openapi;
mod recording;
#[cfg(feature = "schema")]
mod reference;
mod ship;
mod store;
mod web;
