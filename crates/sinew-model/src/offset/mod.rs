//! The offset of the motor position: the paper's eq. (5)–(6) on a running robot, and the absolute
//! offset estimated with everything that disguises itself as one.

mod block;
mod certainty;
mod chain;
mod changes;
mod config;
mod cost;
mod course;
#[cfg(test)]
pub(crate) mod drawn;
mod equation;
mod features;
mod filter;
mod fleet;
mod gram;
mod hands;
mod layout;
mod linear;
mod map;
mod measured;
mod mixture;
mod model;
mod moment;
mod normal;
mod observer;
mod payload;
mod prior;
mod recursive;
mod score;
mod since;
mod sizes;
mod solution;
mod solve;

pub use block::Block;
pub use certainty::Certainty;
pub use changes::{Change, Seek, What};
pub use config::{
    Comparison, FeatureConfig, OffsetConfig, OffsetConfigError, TorqueSource, VelocityFilter,
};
pub use features::FeatureObserver;
pub use hands::{Hands, OneHand};
pub use map::{MapError, MapEstimate, MapEstimator, StiffnessSince};
pub use observer::{OffsetObserver, Sample};
pub use prior::{
    Belief, Entry, JointParameter, JointPrior, Payload, Prior, TENSIONED_OFFSET_RAD,
    UNKNOWN_OFFSET_RAD,
};
pub use recursive::RecursiveOffsets;
