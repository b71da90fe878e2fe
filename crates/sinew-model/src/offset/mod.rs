//! The offset of the motor position: the paper's eq. (5)–(6) on a running robot.

mod features;
mod map;
mod observer;
mod steps;

pub use features::{Block, FeatureConfig, FeatureObserver};
pub use map::{
    JointPrior, MapError, MapEstimate, MapEstimator, Nuisance, OffsetSpan, Prior, Tolerances,
};
pub use observer::{
    Comparison, OffsetConfig, OffsetConfigError, OffsetObserver, Sample, TorqueSource,
    VelocityFilter,
};
pub use steps::{StepCandidate, step_candidates};
