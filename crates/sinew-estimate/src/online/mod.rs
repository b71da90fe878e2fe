//! The online estimate: the estimator of whole recordings on a sliding window, and a check of the blocks that came since.
//!
//! ```text
//! samples → Recorder ─ring→ Window: check every block, solve every 2 s ─triple buffer→ OnlineAnswer
//! ```
//!
//! Reading order: `window` (what is held and when it is solved), `answer`, `estimator` (beside a control
//! loop), `trajectory` (over what was recorded).

mod answer;
mod estimator;
mod trajectory;
mod window;

pub use answer::{OnlineAnswer, OnlineJoint, Provisional};
pub use estimator::{OnlineEstimator, OnlineWorker, StepOutcome};
pub use trajectory::{replay, trajectory};
pub use window::Window;
