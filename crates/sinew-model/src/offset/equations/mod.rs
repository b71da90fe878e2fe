//! Equations of a block: expected values, and their derivatives with respect to the state.
//!
//! Reading order: `reduced_model` (identifiable combinations of the parameters), `measured` and `payload` (quantities
//! of a block that are independent of the state), `equation` (rows over the state), `loaded`, `linearise`, `coupled`
//! and `joint_rows` (rows around a state: of joints with one tendon each, of tendons that cross several joints, of
//! joints with several tendons), `gram` (sums of products of rows), `estimation_model` (the prior, and noise and lag of
//! blocks), `robust`.

mod coupled;
pub(crate) mod equation;
pub(crate) mod estimation_model;
pub(crate) mod gram;
mod joint_rows;
pub(crate) mod linearise;
pub(crate) mod loaded;
pub(crate) mod measured;
mod pull_state;
pub(crate) mod reduced_model;
pub(crate) mod robust;
