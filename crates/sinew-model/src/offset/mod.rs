//! The offset of the motor position: the paper's eq. (5)–(6) on a running robot.

mod observer;

pub use observer::{
    Comparison, OffsetConfig, OffsetConfigError, OffsetObserver, Sample, TorqueSource,
    VelocityFilter,
};
