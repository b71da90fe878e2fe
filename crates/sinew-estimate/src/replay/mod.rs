//! From a recording to each tendon's elongation.
//!
//! [`run`] reads a [`Request`](crate::Request), opens the recording and the robot, takes every frame through
//! [`sinew_model::offset::OffsetObserver`] and returns an [`Estimate`].
//!
//! What happens to imperfect data:
//!
//! | in the recording | what happens |
//! |---|---|
//! | the first frames, and those after a gap or clock jump | the observer starts anew and settles; not used |
//! | a joint position missing or NaN | the frame is left out for all joints; the filters step over it |
//! | a motor position missing for up to 0.1 s | likewise |
//! | a motor position missing longer | that joint is not used until it is back and settled; the others go on |
//! | a joint of the robot that isn't recorded | refused, with the names there are |
//! | a recorded joint that the robot doesn't have | left out, with a warning |
//! | a joint without motor position or stiffness | no estimate for it; its motion still counts |
//! | an offset above 200 mrad | reported with a warning: units, gear ratio, sign or zero |

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
    Basis, Difference, Estimate, JointEstimate, JointRefusal, Loss, LossReason, Origin, Quantity,
    RecordingInfo, RobotInfo, Series, Settings, TorqueStatistics,
};
pub use run::run;
pub(crate) use run::{compare, reference};
