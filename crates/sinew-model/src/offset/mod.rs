//! The offset of the motor position: the paper's eq. (5)–(6) on a running robot, and the absolute
//! offset estimated with everything that disguises itself as one.
//!
//! Reading order: `observer` (a sample to every joint's offset), `features` (samples to blocks),
//! [`effects`] (parameters, priors and terms of everything that the estimate models), `layout` and `prior` (the state, and what is believed of it), `equations` (a block's
//! rows over the state), `batch` (a whole recording), [`beliefs`]
//! (from one recording to the next), [`alike`] (from robots of a type to the next), `shared_error` (what sessions since one baseline get wrong together),
//! [`misfit`] (what fits nothing).

pub mod alike;
mod batch;
mod belief;
pub mod beliefs;
mod block;
mod change;
mod config;
pub mod effects;
mod equations;
mod error;
mod estimate;
mod executor;
mod external_force;
mod features;
#[cfg(test)]
pub(crate) mod fixtures;
mod joint_prior;
mod joint_signals;
mod lag;
mod layout;
pub mod misfit;
mod mixture;
mod observer;
mod prior;
mod shared_error;
mod state_entry;

pub use batch::{Innovation, MapEstimator, MotorInnovation, Prediction};
pub use belief::{Belief, Payload, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD};
pub use block::Block;
pub use change::{ChangeKind, ChangePoint, Onset, SearchScope};
pub use config::{
    Comparison, FeatureConfig, OffsetConfig, OffsetConfigError, TorqueSource, VelocityFilter,
};
pub use effects::JointParameter;
pub use error::MapError;
pub use estimate::{
    ChangePosterior, Convergence, CreepEstimate, ForceEstimate, MapEstimate, StiffnessChange,
    Termination,
};
pub use executor::{Executor, Sequential};
pub use external_force::ExternalForce;
pub use features::FeatureObserver;
pub use joint_prior::JointPrior;
pub use lag::lag_s;
pub use observer::{OffsetObserver, Sample};
pub use prior::{PayloadRange, Prior};
pub use shared_error::{SharedError, shared_errors};
pub use state_entry::StateEntry;
