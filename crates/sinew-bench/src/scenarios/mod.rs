//! The scenario bench: accuracy of the absolute offset over many recordings with known truth.
//!
//! Reading order: [`Plan`](sinew_sim::protocol::Plan) (a scenario of the protocol: arm, motion, draws), [`record`]
//! (one recording, simulated and assessed), [`run`] (many, in parallel, resumable), [`ScenarioReport`] (their
//! summary).

mod bound;
mod end;
mod end_score;
mod estimator;
mod options;
mod outcome;
mod paper;
mod recording;
mod result;
mod rows;
mod run;
mod simulated;
mod summary;
mod table;
mod trajectory;
mod trajectory_report;

pub use end::render_ends;
pub use end_score::{End, EndScore, Form, Sessions};
pub use options::Options;
pub use outcome::RejectedRecording;
pub use recording::{FoundStep, JointScore, Recording, StepScore, record};
pub use result::{EndSummary, ScenarioJoint, ScenarioReport, ScenarioSummary, SlipSummary};
pub use rows::rows;
pub use run::{run, run_recordings};
pub use table::render_table;
pub use trajectory::{FalseChange, JointTrajectory, SlipTrajectory, Trajectory, trajectory};
pub use trajectory_report::{
    SlipFigures, TrajectoryFigures, TrajectoryReport, TrajectorySummary, render_trajectories,
    run_trajectories,
};

use crate::journal::JournalError;
use sinew_estimate::robot_dir::RobotDirError;
use sinew_estimate::session::SessionError;
use sinew_model::offset::OffsetConfigError;
use sinew_sim::SimulateError;
use sinew_sim::protocol::PlanError;

/// Errors of the scenario bench.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The scenario does not exist.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The simulator returned an error.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The robot could not be loaded.
    #[error(transparent)]
    RobotDir(#[from] RobotDirError),
    /// The paper's estimator rejected the robot.
    #[error(transparent)]
    Paper(#[from] OffsetConfigError),
    /// The estimator rejected a recording.
    #[error("scenario {scenario}, seed {seed}: {error}")]
    Session {
        /// Name of the scenario.
        scenario: String,
        /// Seed of the recording.
        seed: u64,
        /// Error of the session.
        error: Box<SessionError>,
    },
    /// The threads could not be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The file of results.
    #[error(transparent)]
    Journal(#[from] JournalError),
}
