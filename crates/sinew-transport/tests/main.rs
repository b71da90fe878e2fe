//! Tests of the transports, in one binary. Tests with external programs are in `scripts/transports`.

mod inbox;
mod intake;
mod publish;
mod replay;
mod support;
mod tail;
#[cfg(feature = "zenoh")]
mod zenoh;
