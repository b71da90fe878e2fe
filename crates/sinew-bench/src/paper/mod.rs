//! The paper's evaluation, done again: its creep tests and bending bench with virtual ropes
//! (`fig1`, `fig2`, `fig4`, `fig5`, `table1`), `fig6` in simulation, `fig7` on a simulated "real"
//! elbow; and what it says elongation spoils, with numbers (`control`).
//!
//! Each figure carries its data, its drawing, and the paper's sentences judged from the data by a
//! stated criterion. Nothing is fitted to come out right: motion, gains and poses stand in
//! [`staircase`], once for both figures.
//!
//! A [`Sentence`] is the paper's or Sinew's ([`SaidBy`]).
//!
//! Reading order: [`staircase`] (the motion), `by_hand` (what it should show), `trial` (simulate once, estimate
//! often), [`fig6()`], [`fig7()`], `page`; for ropes `judge`, [`fig1`], [`fig2`], [`fig4()`], [`fig5()`], [`table1()`];
//! [`control()`].
//!
//! # Source
//! J. Kirchhoff, O. von Stryk, *New Insights in Synthetic Fiber Rope Elongation and its Detection
//! for Ultra Lightweight Tendon Driven Series Elastic Robots*, IROS 2018, sections III and V.

mod bending;
mod by_hand;
mod control;
mod creep;
mod data;
mod fig4;
mod fig5;
mod fig6;
mod fig7;
mod judge;
mod page;
mod render;
mod row;
mod sentence;
pub mod staircase;
mod table1;
mod trial;

pub use control::{Effort, Knowledge, RobotCase, Row, control, table};
pub use creep::{fig1, fig2};
pub use data::{Curve, FigureName, PanelData, PaperFigure, SeriesData, Written};
pub use fig4::fig4;
pub use fig5::fig5;
pub use fig6::fig6;
pub use fig7::fig7;
pub use page::write;
pub use render::render;
pub use sentence::{SaidBy, Sentence, Unit, Verdict};
pub use table1::table1;

use sinew_model::StepError;
use sinew_model::arm::ArmError;
use sinew_model::offset::OffsetConfigError;
use sinew_sim::SimulateError;

/// Why a figure could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PaperError {
    /// The robot hasn't the joint the figure is about.
    #[error("robot '{robot}' has no joint '{joint}', which {figure} is about; it has {known}")]
    Joint {
        /// Robot's name.
        robot: String,
        /// Joint looked for.
        joint: &'static str,
        /// Which figure.
        figure: &'static str,
        /// Joints there are.
        known: String,
    },
    /// A rigid joint has no offset.
    #[error(
        "joint '{joint}' of robot '{robot}' is rigid; say its stiffness_nm_per_rad in robot.toml"
    )]
    Rigid {
        /// Robot's name.
        robot: String,
        /// Joint.
        joint: String,
    },
    /// The catalogue was refused.
    #[error(transparent)]
    Catalogue(#[from] sinew_rope::CatalogueError),
    /// A rope or case the figure is about isn't there.
    #[error("'{0}', which the figure is about, is not there")]
    Rope(String),
    /// A virtual rope refused its load.
    #[error("a virtual rope refused its load: {0}")]
    Load(#[from] sinew_rope::law::LoadError),
    /// The simulation was refused.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The estimator was refused.
    #[error(transparent)]
    Estimator(#[from] OffsetConfigError),
    /// A model with errors could not be built.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A sample was refused.
    #[error("the estimator refused a simulated sample: {0}")]
    Step(#[from] StepError),
    /// The drawing could not be made.
    #[error(transparent)]
    Png(#[from] sinew_figure::plot::PngError),
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] sinew_files::OutputError),
}
