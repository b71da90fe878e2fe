//! What a figure of the paper consists of.

use super::row::Row;
use super::sentence::Sentence;
use serde::Serialize;
use sinew_figure::Table;
use sinew_figure::plot::Figure;
use sinew_files::JsonDocument;
use std::path::PathBuf;

/// Which figure; its files have this name.
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
    /// A rope over guiding pulleys.
    #[value(help = "A rope over guiding pulleys, routings A to D")]
    Fig4,
    /// A rope under changing force.
    #[value(help = "A rope under changing force, E and F")]
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
    /// The ropes.
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

/// A figure of the paper, done again. As JSON its data, without the drawing.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PaperFigure {
    /// Which one.
    pub name: FigureName,
    /// One line.
    pub title: String,
    /// What is shown and how it was made, in paragraphs.
    #[serde(skip)]
    pub about: Vec<String>,
    /// The drawing.
    #[serde(skip)]
    pub figure: Figure,
    /// Numbers behind the drawing, where tables show them better.
    #[serde(skip)]
    pub tables: Vec<Table>,
    /// What the paper says, and what Sinew adds, each held against the data.
    pub sentences: Vec<Sentence>,
    /// What the paper says or did that no data judge, with the reason.
    pub not_judged: Vec<String>,
    /// What the paper gives to compare with: numbers of its text, no curves.
    pub given: Vec<String>,
    /// What is assumed because the paper doesn't tell.
    pub assumptions: Vec<String>,
    /// The curves.
    pub panels: Vec<PanelData>,
    /// Of [`control`](super::control()): one row per robot and knowledge.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<Row>,
    /// What was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub files: Option<Written>,
}

impl PaperFigure {
    /// Title and drawing, nothing else yet.
    pub(super) fn new(name: FigureName, title: &str, figure: Figure) -> Self {
        Self {
            name,
            title: title.into(),
            about: Vec::new(),
            figure,
            tables: Vec::new(),
            sentences: Vec::new(),
            not_judged: Vec::new(),
            given: Vec::new(),
            assumptions: Vec::new(),
            panels: Vec::new(),
            rows: Vec::new(),
            files: None,
        }
    }
}

impl JsonDocument for PaperFigure {
    const SCHEMA: &'static str = "sinew/paper/1";
}

/// What the paper gives: numbers of its text.
pub(super) fn given(numbers: &[&str]) -> Vec<String> {
    let first = "The paper's curves are not available as data: no curve here is compared with one of the paper's. Numbers of its text are the only anchors.";
    std::iter::once(first)
        .chain(numbers.iter().copied())
        .map(Into::into)
        .collect()
}

/// What the paper says that no data of ours judge: its sentences, each with the reason.
pub(super) fn not_judged(sentences: &[[&str; 2]]) -> Vec<String> {
    sentences
        .iter()
        .map(|sentence| sentence.join(" "))
        .collect()
}

/// Files of one figure.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Written {
    /// The page: drawing, sentences, assumptions.
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
    /// What the panel shows.
    pub title: String,
    /// Its curves.
    pub series: Vec<SeriesData>,
}

/// One curve over time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SeriesData {
    /// What it is.
    pub name: String,
    /// Time, s.
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
    /// Strains.
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
