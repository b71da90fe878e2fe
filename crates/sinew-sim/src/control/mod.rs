//! Effect of a stretched rope on a controller and on collision detection, and the effect of correcting for it.
//!
//! A scenario is run with its specified correction and without any. The external torque is estimated from the
//! recorded positions, and both runs are scored against the truth: control error of the joints, missed contacts, and
//! duration of false alarms.
//!
//! Reading order: [`run`], `detection` (observer and detectors on a simulation), `score`.

mod detection;
mod run;
mod score;

pub use detection::DetectionSample;
pub use run::{
    Comparison, Outcome, Sensitivity, Simulated, compare, noise_nm, run, run_with_detectors,
};
pub use score::{ContactScore, JointScore, Score};
