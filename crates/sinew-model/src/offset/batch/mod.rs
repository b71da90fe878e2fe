//! Offline estimate from a recording, including its change points.
//!
//! Reading order: `map_estimator` (the entry point), `problem` (a recording and its prior), `schedule`, `normal` and
//! `gauss_newton` (one minimisation), `cost` and `solution` (its result), `search` (change points), `candidates` and
//! `score` (screening of change points), `changepoint_time`, `posterior`, `model_error`, `lost_stiffness`, `initial_friction`,
//! `prediction` (prediction of the next block).

mod candidates;
mod changepoint_time;
mod cost;
mod creep;
mod force;
mod gauss_newton;
mod initial_friction;
mod lost_stiffness;
mod map_estimator;
mod model_error;
mod normal;
mod posterior;
mod prediction;
mod problem;
mod schedule;
mod score;
mod search;
mod solution;

pub use map_estimator::MapEstimator;
pub use model_error::ModelError;
pub use prediction::{Innovation, MotorInnovation, Prediction};
