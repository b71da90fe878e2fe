//! Equations of a block: what is expected of it, and how that moves with the state.
//!
//! Reading order: `reduced_model` (parameters that blocks can tell apart), `measured` and `payload`
//! (what a block says whatever the state), `equation` (rows over the state), `loaded`, `linearise` and `coupled` (rows
//! around a state, of joints with tendons of their own and of tendons that cross several joints), `gram` (sums of products of rows), `estimation_model` (the prior, and noise and
//! lag of blocks), `robust`.

mod coupled;
pub(crate) mod equation;
pub(crate) mod estimation_model;
pub(crate) mod gram;
pub(crate) mod linearise;
pub(crate) mod loaded;
pub(crate) mod measured;
pub(crate) mod reduced_model;
pub(crate) mod robust;
