//! Equations of a block: what is expected of it, and how that moves with the state.
//!
//! Reading order: `reduced_model` (parameters that blocks can tell apart), `measured` and `payload`
//! (what a block says whatever the state), `equation` (rows over the state), `linearise` (rows
//! around a state), `gram` (sums of products of rows), `estimation_model` (the prior, and noise and
//! lag of blocks), `robust`.

pub(crate) mod equation;
pub(crate) mod estimation_model;
pub(crate) mod gram;
pub(crate) mod linearise;
pub(crate) mod measured;
pub(crate) mod reduced_model;
pub(crate) mod robust;
