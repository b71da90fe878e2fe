//! The momentum observer and the filters that match its lag.
//!
//! Reading order: `pole` (first-order filter, exact for any step), `state_variable` (velocities
//! from encoders), `momentum` (the observer).

mod momentum;
mod pole;
mod state_variable;

pub use momentum::{GainError, MomentumObserver};
pub use pole::{ExactPole, FirstOrder};
pub use state_variable::{DoublePole, StateVariableFilter};
