//! The C interface: opaque handles made from texts, stepped in a control loop.
//!
//! The one crate of Sinew with unsafe code: pointers of the caller are checked for null, lengths are compared, and
//! everything else is the caller's promise, stated at each function. Nothing is computed here.
//!
//! Every function says its realtime class. Constructors allocate and may fail with a sentence; steps allocate, lock and
//! log nothing. A panic, which would be a fault of Sinew, becomes `Status::Panic` and never crosses into C.
//!
//! Reading order: [`status`], `borrow` (pointers to references), [`robot`], [`offsets`], [`observer`], [`momentum`].
//! `include/sinew.h` is made from this by `header/`.

// Pointers come from C.
#![allow(unsafe_code)]
// Each unsafe block says why it may.
#![warn(clippy::undocumented_unsafe_blocks)]

mod borrow;
pub mod momentum;
pub mod observer;
pub mod offsets;
pub mod robot;
pub mod status;
