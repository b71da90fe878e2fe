//! C interface of Sinew: opaque handles, created from texts and stepped in a control loop.
//!
//! The only crate of Sinew with unsafe code: pointers of the caller are checked for null, lengths are compared, and
//! everything else is guaranteed by the caller, stated at each function. The crate contains no computations.
//!
//! Every function states its realtime class. Constructors allocate and may fail with a message; steps do not allocate,
//! lock or log. A panic, which indicates a defect of Sinew, becomes `Status::Panic` and never crosses into C.
//!
//! Reading order: [`status`], `borrow` (pointers to references), [`robot`], [`offsets`], [`observer`], [`momentum`].
//! `header/` generates `include/sinew.h` from this crate.

// Pointers come from C.
#![allow(unsafe_code)]
// Each unsafe block states its justification.
#![warn(clippy::undocumented_unsafe_blocks)]

mod borrow;
pub mod momentum;
pub mod observer;
pub mod offsets;
pub mod robot;
pub mod status;
