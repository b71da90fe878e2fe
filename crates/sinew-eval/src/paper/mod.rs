//! The paper's evaluation, done again: its creep tests and bending bench with virtual ropes
//! (`fig1`, `fig2`, `fig4`, `fig5`, `table1`), `fig6` in simulation, `fig7` on a simulated "real"
//! elbow; and what it says elongation spoils, with numbers (`control`).
//!
//! Each figure carries its data, its drawing, and the paper's sentences judged from the data by a
//! stated criterion. Nothing is fitted to come out right: motion, gains and poses stand in
//! [`staircase`], once for both figures.
//!
//! Reading order: [`staircase`] (the motion), `trial` (simulate once, estimate often), [`fig6()`],
//! [`fig7()`], `page`; for ropes `judge`, [`fig1`], [`fig2`], [`fig4`], [`fig5`], [`table1()`]; [`control()`].
//!
//! # Source
//! J. Kirchhoff, O. von Stryk, *New Insights in Synthetic Fiber Rope Elongation and its Detection
//! for Ultra Lightweight Tendon Driven Series Elastic Robots*, IROS 2018, sections III and V.

mod bending;
mod control;
mod creep;
mod fig6;
mod fig7;
mod judge;
mod page;
mod sentence;
pub mod staircase;
mod table1;
mod trial;

pub use bending::{fig4, fig5};
pub use control::{Control, Effort, Row, control, table, write_control};
pub use creep::{fig1, fig2};
pub use fig6::fig6;
pub use fig7::fig7;
pub use page::{Written, write};
pub use table1::table1;

pub use sinew_figure::Sentence;

use serde::Serialize;
use sinew_figure::Table;
use sinew_figure::plot::Figure;
use sinew_model::StepError;
use sinew_model::arm::ArmError;
use sinew_model::offset::OffsetConfigError;
use sinew_sim::SimulateError;

/// A figure of the paper, done again.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperFigure {
    /// `fig1` … `table1`: how its files are called.
    pub name: &'static str,
    /// One line.
    pub title: String,
    /// What is shown and how it was made, in paragraphs.
    pub about: Vec<String>,
    /// The curves.
    pub panels: Vec<PanelData>,
    /// The drawing.
    pub figure: Figure,
    /// What the paper (or its follow-up) says, and whether the data say so too.
    pub sentences: Vec<Sentence>,
    /// What the paper says or did that the data can't show, with the reason.
    pub not_judged: Vec<String>,
    /// Numbers behind the drawing, where tables show them better.
    pub tables: Vec<Table>,
    /// What is assumed because the paper doesn't tell.
    pub assumptions: Vec<String>,
}

/// Curves that share axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PanelData {
    /// What the panel shows.
    pub title: String,
    /// Its curves.
    pub series: Vec<SeriesData>,
}

/// One curve, in one of the units.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct SeriesData {
    /// What it is.
    pub name: String,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Value, mrad; empty where the curve is a strain.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub value_mrad: Vec<f64>,
    /// Value, %; empty where the curve is an offset.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub value_percent: Vec<f64>,
}

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
    /// The catalogue was refused.
    #[error(transparent)]
    Catalogue(#[from] sinew_rope::CatalogueError),
    /// A rope or case the figure is about isn't there.
    #[error("'{0}', which the figure is about, is not there")]
    Rope(String),
    /// A virtual rope refused its load.
    #[error("a virtual rope refused its load: {0}")]
    Load(#[from] sinew_model::rope::LoadError),
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
