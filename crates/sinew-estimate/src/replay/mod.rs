//! Estimation of the elongation of each tendon from a recording, by the method of the paper.
//!
//! [`run`] reads a [`Request`](crate::Request), opens the recording and the robot, processes every frame with
//! [`sinew_model::offset::OffsetObserver`], and returns an [`Estimate`].
//!
//! Treatment of imperfect data:
//!
//! | in the recording | treatment |
//! |---|---|
//! | first frames, and those after a gap or a clock step | observer re-initialised; not used until it has settled |
//! | joint position missing or non-finite | frame excluded for all joints; filters bridge it |
//! | motor position missing for up to 0.1 s | frame excluded for all joints; filters bridge it |
//! | motor position missing for more than 0.1 s | joint not used until available and settled; other joints continue |
//! | joint of the robot that is not recorded | error with the recorded names |
//! | recorded joint that is not in the robot description | ignored, with a warning |
//! | joint without motor position or stiffness | not estimated; its motion is used |
//! | offset above 200 mrad | warning: check units, gear ratio, sign and zero |

mod basis;
mod checks;
mod frame_table;
mod frames;
mod health;
mod pass;
mod result;
mod run;
mod series;
mod tally;

pub(crate) use pass::Pass;
pub use result::{
    Basis, Difference, Estimate, JointError, JointEstimate, Loss, LossReason, Origin, Quantity,
    RecordingInfo, RobotInfo, Series, Settings, TorqueStatistics,
};
pub use run::run;
pub(crate) use run::{compare, reference};
