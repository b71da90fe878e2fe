//! Absolute offsets of a session: estimation of a baseline after tensioning, and of the offsets since then.
//!
//! [`learn`] takes a recording made directly after tensioning, whose offsets are zero by definition,
//! and estimates the parameters that could be mistaken for an offset: stiffness, masses, friction and encoder errors.
//! The [`Baseline`](crate::baseline::Baseline) it returns is a small file. [`estimate`] takes a later recording and
//! that file, and returns the offset of each tendon since then as a [`SessionEstimate`]. An unknown payload is
//! estimated jointly, contacts are rejected and slips are detected. Without a baseline the priors are the tolerances of
//! the data sheets, and the intervals are correspondingly wide.
//!
//! The estimator is [`sinew_model::offset::MapEstimator`]; [`crate::online`] runs it on the last two minutes of a
//! running robot.
//!
//! Reading order: `recorder` (frames to blocks), `poses`, `transmission_loss`, `frozen_encoder`,
//! `independent_torque` and `temperature` (validity of the recorded channels), `segments` (blocks to posteriors), `predictive`, `detector` and `recent`
//! (contact or step in the last seconds), `encoder_slips`, `changes`, `inflation`, `summary` and `checks`
//! (posteriors to the [`result`](SessionEstimate)), `anchor` (reference contacts and index marks),
//! `cables` (tendons with friction along their path), `run`; `parts` joins the results of the parts of a long recording.

mod anchor;
mod cables;
mod changes;
mod checks;
mod context;
mod detector;
mod encoder_slips;
mod frozen_encoder;
mod groups;
mod independent_torque;
mod inflation;
mod late_step;
mod parts;
mod poses;
mod predictive;
mod recent;
mod recorder;
mod repeated_motion;
mod rest_phase;
mod result;
mod run;
mod segments;
mod sides;
pub mod stated;
mod summary;
mod temperature;
mod torque_range;
mod transmission_loss;
mod warning;
mod zero;

pub use crate::anchored::{ReferenceMeasurement, ReferenceOffset};
pub use crate::error::SessionError;
pub use crate::estimator::{SessionOptions, estimator};
pub use crate::touch::{Touch, TouchReading};
pub use poses::Poses;
pub(crate) use predictive::NEGLIGIBLE;
pub use recorder::{Recorded, Recorder, Window};
pub use result::{
    BlockEstimate, JointOffset, LimitState, MotorTorque, OnlineBlock, OnlineTendon,
    OnlineTrajectory, PayloadChange, ProvisionalInterval, RejectedInterval, Remedy, RetensionLimit,
    SegmentEstimate, SessionEstimate, StiffnessSinceBefore, TemperatureSource, TendonChange,
    TendonChangeKind, TendonCreep, TendonEstimate, TendonWeight, UnattributedChange,
    UnobservableCombination, Verdict,
};
pub use run::{
    Learning, Since, estimate, estimate_recorded, estimate_segment, estimate_with_replay, learn,
    learn_recorded, learn_runs,
};
pub(crate) use run::{Solved, continues, solve_stretch};
pub use sinew_model::offset::Payload;
pub use torque_range::TorqueRange;
pub use warning::{MotorTorqueError, Warning};
