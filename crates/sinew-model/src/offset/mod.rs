//! The offset of the motor position: the paper's eq. (5)–(6) on a running robot, and the absolute offset estimated
//! jointly with all effects that are similar to one.
//!
//! Reading order: `observer` (offset of every joint per sample), `features` (samples to blocks), [`effects`]
//! (parameters, priors and terms of all modelled effects), `layout` and `prior` (the state and its prior), `equations`
//! (a block's rows over the state), `batch` (a whole recording), [`state_estimates`] (between recordings),
//! [`shared_parameters`] (between robots of a type), `systematic_error` (common error of the sessions since one
//! baseline), [`excess_residual`] (unexplained residuals).

mod batch;
mod block;
mod change;
mod config;
pub mod effects;
mod equations;
mod error;
mod estimate;
pub mod excess_residual;
mod executor;
mod external_force;
mod features;
#[cfg(test)]
pub(crate) mod fixtures;
mod group_posterior;
mod joint_prior;
mod joint_signals;
mod lag;
mod layout;
mod mixture;
mod observer;
mod prior;
pub mod shared_parameters;
mod state_entry;
mod state_estimate;
pub mod state_estimates;
pub mod stated_payload;
mod systematic_error;

pub use batch::{Innovation, MapEstimator, ModelError, MotorInnovation, Prediction};
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
pub use group_posterior::{GroupPosterior, UnobservableDirection, group_posteriors};
pub use joint_prior::JointPrior;
pub use lag::lag_s;
pub use observer::{OffsetObserver, Sample};
pub use prior::{PayloadRange, Prior};
pub use state_entry::StateEntry;
pub use state_estimate::{Payload, StateEstimate, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD};
pub use systematic_error::{SharedError, shared_errors};
