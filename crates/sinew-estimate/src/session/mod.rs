//! Absolute offsets of a session: learn a baseline after tensioning, then estimate since.
//!
//! [`learn`] takes a recording made right after tensioning, whose offsets are zero by definition,
//! and learns what disguises itself as an offset: stiffness, masses, friction, encoder errors. The
//! [`Baseline`](crate::baseline::Baseline) it returns is a small file. [`estimate`] takes a later
//! recording and that file, and gives each tendon's offset since then as a [`SessionEstimate`], an
//! unknown payload estimated along, contacts left out, slips found. Without a baseline the data-sheet
//! priors stand in, and the interval is as wide as that makes it.
//!
//! The estimator is [`sinew_model::offset::MapEstimator`]; [`crate::online`] runs it on the last two minutes of a running robot.
//!
//! Reading order: `recorder` (frames to blocks), `poses`, `witness` and `temperature` (what of them can be
//! believed), `segments` (blocks to posteriors), `predictive`, `detector` and `recent`
//! (contact or step in the last seconds), `changes`, `inflation`, `summary` and `checks` (posteriors to the [`result`](SessionEstimate)), `anchor` (stops and marks that were touched), `run`.

mod anchor;
mod changes;
mod checks;
mod context;
mod detector;
mod inflation;
mod late_step;
mod poses;
mod predictive;
mod recent;
mod recorder;
mod result;
mod revisits;
mod run;
mod segments;
mod sides;
mod stand;
pub mod stated;
mod summary;
mod temperature;
mod torque_range;
mod warning;
mod witness;
mod zero;

pub use crate::anchored::{AnchorReading, AnchoredOffset};
pub use crate::error::SessionError;
pub use crate::estimator::{SessionOptions, estimator};
pub use crate::touch::{Touch, TouchReading};
pub use poses::Poses;
pub(crate) use predictive::NEGLIGIBLE;
pub use recorder::{Recorded, Recorder, Window};
pub use result::{
    BlockEstimate, Doubt, LeftOut, LimitState, LiveBlock, LiveCourse, LiveTendon, MotorTorque,
    PayloadChange, RetensionLimit, SegmentEstimate, SessionEstimate, StiffnessSinceBefore,
    TemperatureSource, TendonChange, TendonChangeKind, TendonCreep, TendonEstimate, Verdict,
};
pub use run::{
    Learning, Since, estimate, estimate_recorded, estimate_stretch, estimate_with_replay, learn,
    learn_recorded,
};
pub(crate) use run::{Solved, continues, solve_stretch};
pub use sinew_model::offset::Payload;
pub use torque_range::TorqueRange;
pub use warning::{Warning, WitnessFault};
