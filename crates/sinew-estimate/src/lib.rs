//! From frames to tendon offsets: replay, session estimate, baseline, proposed poses.
//!
//! Reading order: [`feeder`] (a frame to an observer), [`replay`] (the paper's estimate of a
//! recording), [`session`] (absolute offsets since a [`baseline`]), [`jumps`] (rope or encoder),
//! [`cable`] (tendons with friction along their path), [`excitation`] (poses that make offsets identifiable). Results are data in SI units; `sinew-report` formats them.

mod anchored;
mod answer;
pub mod baseline;
pub mod cable;
mod cause;
mod decimated;
mod document;
mod each;
mod error;
mod estimator;
pub mod excitation;
pub mod executor;
pub mod feeder;
mod given;
pub mod init;
pub mod jumps;
mod nuisance;
mod one_signal;
pub mod online;
mod recording;
pub mod replay;
mod request;
pub mod robot_check;
pub mod robot_dir;
pub mod robot_toml;
mod sample;
pub mod session;
pub mod strand_duty;
pub mod thermal;
mod touch;
mod warning;

pub use answer::{Plan, estimate};
pub use cause::{Cause, UnknownCause};
pub use document::{BaselineDocument, EstimateDocument, Method};
pub use each::{EachDocument, RecordingOutcome, estimate_each};
pub use error::EstimateError;
pub use given::{Given, Opener};
pub use nuisance::NuisanceChange;
pub use recording::axes;
pub use request::{Progress, Request};
pub use warning::RecordingWarning;
