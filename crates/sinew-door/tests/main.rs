//! Every test of the doors, in one binary. What needs other people's programs is under `scripts/doors`.

mod inbox;
mod intake;
mod publish;
mod replay;
mod support;
mod tail;
#[cfg(feature = "zenoh")]
mod zenoh;
