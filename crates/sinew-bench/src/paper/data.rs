//! Data of a figure of the paper.

use super::row::Row;
use super::sentence::Sentence;
use serde::Serialize;
use sinew_figure::Table;
use sinew_figure::plot::Figure;
use sinew_files::JsonDocument;
use std::path::PathBuf;

/// Name of a figure and of its files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum FigureName {
    /// Creep of nine ropes at 23 °C.
    #[value(help = "Creep of nine ropes at 23 °C")]
    Fig1,
    /// Creep of four ropes at 60 °C.
    #[value(help = "Creep of four ropes at 60 °C")]
    Fig2,
    /// The routings of the bending bench.
    #[value(help = "Routings of the bending bench, as we read the paper's words")]
    Fig3,
    /// A rope over guiding pulleys.
    #[value(help = "Elongation of a rope over guiding pulleys, cases A to D")]
    Fig4,
    /// A rope under changing force.
    #[value(help = "Elongation of a rope after a change of the force, cases E and F")]
    Fig5,
    /// The offset estimate in simulation.
    #[value(
        help = "Simulation: no model error; K + 20 %; M, C, g - 10 %; offsets of 0.010 and 0.015 rad"
    )]
    Fig6,
    /// The offset estimate on a simulated "real" elbow.
    #[value(
        help = "A simulated \"real\" elbow: injected offset, difference, rope relaxed and re-tensioned"
    )]
    Fig7,
    /// Table of the ropes.
    #[value(help = "The ropes as published, with their simulated creep test")]
    Table1,
    /// Control and collision detection with stretched ropes.
    #[value(
        help = "Control and collision detection with stretched ropes, before and after correction"
    )]
    Control,
}

impl std::fmt::Display for FigureName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.serialize(f)
    }
}

/// Reproduced figure of the paper. The JSON contains its data, without the drawing.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PaperFigure {
    /// Name of the figure.
    pub name: FigureName,
    /// Title in one line.
    pub title: String,
    /// Content of the figure and method, in paragraphs.
    #[serde(skip)]
    pub about: Vec<String>,
    /// Drawing of the figure.
    #[serde(skip)]
    pub figure: Figure,
    /// Tables with the numbers of the drawing.
    #[serde(skip)]
    pub tables: Vec<Table>,
    /// Statements of the paper and of Sinew, each assessed with the data.
    pub sentences: Vec<Sentence>,
    /// Statements or procedures of the paper that are not assessed with data, with the reason.
    pub not_assessed: Vec<String>,
    /// Numbers given in the text of the paper for comparison; it has no numerical curves.
    pub given: Vec<String>,
    /// Assumptions where the paper does not specify a value.
    pub assumptions: Vec<String>,
    /// Panels with the curves.
    pub panels: Vec<PanelData>,
    /// Rows of the table of [`control`](super::control()), one per robot and correction.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<Row>,
    /// Files written for the figure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub files: Option<Written>,
}

impl PaperFigure {
    /// Creates figure data that contain only a title and a plot.
    pub(super) fn new(name: FigureName, title: &str, figure: Figure) -> Self {
        Self {
            name,
            title: title.into(),
            about: Vec::new(),
            figure,
            tables: Vec::new(),
            sentences: Vec::new(),
            not_assessed: Vec::new(),
            given: Vec::new(),
            assumptions: Vec::new(),
            panels: Vec::new(),
            rows: Vec::new(),
            files: None,
        }
    }
}

impl JsonDocument for PaperFigure {
    const SCHEMA: &'static str = "sinew/paper/2";
}

/// Returns the numbers given in the text of the paper.
pub(super) fn given(numbers: &[&str]) -> Vec<String> {
    let first = "The paper's curves are not available as data: no curve here is compared with one of the paper's. The numbers of its text are the only reference values.";
    std::iter::once(first)
        .chain(numbers.iter().copied())
        .map(Into::into)
        .collect()
}

/// Returns the statements of the paper that are not assessed with data, each with the reason.
pub(super) fn not_assessed(sentences: &[[&str; 2]]) -> Vec<String> {
    sentences
        .iter()
        .map(|sentence| sentence.join(" "))
        .collect()
}

/// Files of one figure.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Written {
    /// The page: drawing, statements, assumptions.
    pub html: PathBuf,
    /// The drawing, scalable.
    pub svg: PathBuf,
    /// The drawing, 2 px per CSS px; none in a build that draws no PNG.
    pub png: Option<PathBuf>,
    /// The rows; none where the figure has no rows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub csv: Option<PathBuf>,
}

/// Curves that share axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PanelData {
    /// Title of the panel.
    pub title: String,
    /// Curves of the panel.
    pub series: Vec<SeriesData>,
}

/// One curve over time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SeriesData {
    /// Name of the curve.
    pub name: String,
    /// Times of the points, s.
    pub time_s: Vec<f64>,
    /// One value per time.
    #[serde(flatten)]
    pub curve: Curve,
}

/// Values of a curve; NaN (null) is a gap.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Curve {
    /// Offsets or errors of a position, rad.
    AngleRad(#[cfg_attr(feature = "schema", schemars(with = "Vec<Option<f64>>"))] Vec<f64>),
    /// Strains as ratios.
    StrainRatio(Vec<f64>),
}

impl SeriesData {
    /// Values as they are drawn: mrad or %.
    pub(super) fn drawn(&self) -> Vec<f64> {
        match &self.curve {
            Curve::AngleRad(values) => values.iter().map(|rad| 1e3 * rad).collect(),
            Curve::StrainRatio(values) => values.iter().map(|ratio| 1e2 * ratio).collect(),
        }
    }
}
