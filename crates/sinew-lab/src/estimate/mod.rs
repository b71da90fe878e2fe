//! From a recording to each tendon's elongation.

mod result;

pub use result::{
    Basis, Difference, Estimate, Injection, JointEstimate, Loss, RecordingInfo, RobotInfo, Series,
    Settings,
};
