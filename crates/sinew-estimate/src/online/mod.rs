//! Online estimate: the estimator of whole recordings on a sliding window, and a check of the blocks since the last
//! solution.
//!
//! ```text
//! samples → Recorder ─ring→ Window: check every block, solve every 2 s ─triple buffer→ OnlineAnswer
//! ```
//!
//! Reading order: `window` (content and schedule), `answer`, `estimator` (in a control
//! loop), `trajectory` (over a recording).

mod answer;
mod estimator;
mod trajectory;
mod window;

pub use answer::{OnlineAnswer, OnlineJoint, Provisional};
pub use estimator::{OnlineEstimator, OnlineWorker, StepOutcome};
pub(crate) use trajectory::TrajectoryBuilder;
pub use trajectory::{replay, trajectory};
pub use window::Window;
