//! The estimate from a whole recording, with the sudden changes in it.
//!
//! Reading order: `map_estimator` (the way in), `problem` (a recording and the belief before
//! it), `schedule`, `normal` and `gauss_newton` (one descent), `cost` and `solution` (what it ends
//! with), `search` (change points), `candidates` and `score` (where to look for them),
//! `changepoint_time`, `posterior`, `lost_stiffness`, `stuck_friction`, `prediction` (what the next block should be).

mod candidates;
mod changepoint_time;
mod cost;
mod creep;
mod force;
mod gauss_newton;
mod lost_stiffness;
mod map_estimator;
mod normal;
mod posterior;
mod prediction;
mod problem;
mod schedule;
mod score;
mod search;
mod solution;
mod stuck_friction;

pub use map_estimator::MapEstimator;
pub use prediction::{Innovation, MotorInnovation, Prediction};
