//! What a stretched rope does to a controller and to collision detection, and what correcting for
//! it gives back.
//!
//! A scenario is run with the correction it states and without any, the external torque is
//! estimated from the recording's own positions, and both are scored against the truth: how far
//! the joints are from where they were asked to be, which contacts were missed, and for how long
//! there seemed to be one that wasn't.
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
