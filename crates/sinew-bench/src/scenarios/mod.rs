//! The scenario bench: how good is the absolute offset, over many recordings with known truth?
//!
//! Reading order: [`Plan`](sinew_sim::protocol::Plan) (a scenario of the protocol: arm, motion, what is drawn), [`record`]
//! (one recording, simulated and judged), [`run`] (many, in parallel, resumable), [`ScenarioReport`]
//! (what they say together).

mod bound;
mod course;
mod course_report;
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

pub use course::{Course, FalseChange, JointCourse, SlipCourse, course};
pub use course_report::{
    CourseFigures, CourseReport, CourseSummary, SlipFigures, render_courses, run_courses,
};
pub use end::render_ends;
pub use end_score::{End, EndScore, Form, Sessions};
pub use options::Options;
pub use outcome::Refusal;
pub use recording::{FoundStep, JointScore, Recording, StepScore, record};
pub use result::{EndSummary, ScenarioJoint, ScenarioReport, ScenarioSummary, SlipSummary};
pub use rows::rows;
pub use run::{run, run_recordings};
pub use table::render_table;

use crate::journal::JournalError;
use sinew_estimate::robot_dir::RobotDirError;
use sinew_estimate::session::SessionError;
use sinew_model::offset::OffsetConfigError;
use sinew_sim::SimulateError;
use sinew_sim::protocol::PlanError;

/// Why the bench could not run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// There is no such scenario.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The simulator refused.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The robot could not be loaded.
    #[error(transparent)]
    RobotDir(#[from] RobotDirError),
    /// The paper's estimator refused the robot.
    #[error(transparent)]
    Paper(#[from] OffsetConfigError),
    /// The estimate refused a recording.
    #[error("scenario {scenario}, seed {seed}: {error}")]
    Session {
        /// The scenario.
        scenario: String,
        /// Its seed.
        seed: u64,
        /// Why.
        error: Box<SessionError>,
    },
    /// There are no threads to work on.
    #[error("can't start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The file of results.
    #[error(transparent)]
    Journal(#[from] JournalError),
}
