//! Reproduction of the paper's evaluation: its creep tests and bending bench with virtual ropes (`fig1` to `fig5`,
//! `table1`), `fig6` in simulation, `fig7` on a simulated "real" elbow, and the errors that it
//! attributes to elongation, with numbers (`control`).
//!
//! Each figure carries its data, its drawing, and the paper's statements, assessed with the data by a stated
//! criterion. Nothing is fitted to agree: motion, gains and poses are defined in [`staircase`], once for both
//! figures.
//!
//! A [`Sentence`] is the paper's or Sinew's ([`ClaimedBy`]).
//!
//! Reading order: [`staircase`] (the motion), `analytic` (its analytic values), `trial` (one simulation, several
//! estimates), [`fig6()`], [`fig7()`], `page`; for ropes `assessment`, [`fig1`], [`fig2`], [`fig3()`], [`fig4()`],
//! [`fig5()`], [`table1()`]; [`control()`]; [`bending()`] and the table of all statements, [`statements_table`].
//!
//! # Source
//! J. Kirchhoff, O. von Stryk, *New Insights in Synthetic Fiber Rope Elongation and its Detection
//! for Ultra Lightweight Tendon Driven Series Elastic Robots*, IROS 2018, sections III and V.

mod analytic;
mod assessment;
mod bending;
mod control;
mod creep;
mod data;
mod fig3;
mod fig4;
mod fig5;
mod fig6;
mod fig7;
mod page;
mod render;
mod row;
mod sentence;
pub mod staircase;
mod statements;
mod table1;
mod trial;

pub use control::{Effort, Knowledge, RobotCase, Row, control, elongation_errors, table};
pub use creep::{fig1, fig2};
pub use data::{Curve, FigureName, PanelData, PaperFigure, SeriesData, Written};
pub use fig3::fig3;
pub use fig4::fig4;
pub use fig5::fig5;
pub use fig6::fig6;
pub use fig7::fig7;
pub use page::write;
pub use render::render;
pub use sentence::{Basis, ClaimedBy, Sentence, Unit, Verdict};
pub use statements::{bending, not_assessed_table, statements_table, tension_lost_n};
pub use table1::table1;

use sinew_files::Located;
use sinew_model::StepError;
use sinew_model::arm::ArmError;
use sinew_model::offset::OffsetConfigError;
use sinew_model::robot::{BIOROB_LIKE, Robot, RobotFile};
use sinew_sim::SimulateError;

/// Returns the BioRob-like arm, which ships with the program.
///
/// # Errors
/// Returns a [`Located`] if the shipped description is invalid, which a test excludes.
pub fn shipped_robot() -> Result<Robot, Located> {
    RobotFile::parse(BIOROB_LIKE.robot_toml, "robot.toml")?.build(BIOROB_LIKE.urdf)
}

/// Errors of a figure.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PaperError {
    /// The robot lacks the joint that the figure requires.
    #[error(
        "robot '{robot}' has no joint '{joint}', which {figure} requires; available: {available}"
    )]
    Joint {
        /// Name of the robot.
        robot: String,
        /// Name of the required joint.
        joint: &'static str,
        /// Name of the figure.
        figure: &'static str,
        /// Available joints, separated by commas.
        available: String,
    },
    /// A rigid joint has no offset.
    #[error(
        "joint '{joint}' of robot '{robot}' is rigid; set its stiffness_nm_per_rad in robot.toml"
    )]
    Rigid {
        /// Name of the robot.
        robot: String,
        /// Name of the joint.
        joint: String,
    },
    /// The catalogue is invalid.
    #[error(transparent)]
    Catalogue(#[from] sinew_rope::CatalogueError),
    /// A rope or case that the figure requires is missing.
    #[error("'{0}', which the figure requires, is missing")]
    Rope(String),
    /// The load of a virtual rope is invalid.
    #[error("the load of a virtual rope is invalid: {0}")]
    Load(#[from] sinew_rope::law::LoadError),
    /// The simulation failed.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The estimator could not be created.
    #[error(transparent)]
    Estimator(#[from] OffsetConfigError),
    /// A model with errors could not be built.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// The estimator rejected a sample.
    #[error("the estimator rejected a simulated sample: {0}")]
    Step(#[from] StepError),
    /// The drawing could not be created.
    #[error(transparent)]
    Png(#[from] sinew_figure::plot::PngError),
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] sinew_files::OutputError),
}
