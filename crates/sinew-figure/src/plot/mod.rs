//! Figures over time: stacked or side-by-side panels of lines, bands and marks, as SVG and PNG.
//!
//! ```
//! use sinew_figure::plot::{Band, Colour, Figure, Line, Panel};
//! let time_s: Vec<f64> = (0..200).map(|i| 0.1 * f64::from(i)).collect();
//! let offset: Vec<f64> = time_s.iter().map(|t| 10.0 * (1.0 - (-t / 4.0).exp())).collect();
//! let low = offset.iter().map(|y| y - 1.0).collect();
//! let high = offset.iter().map(|y| y + 1.0).collect();
//! let figure = Figure::new("Offset of the elbow").panel(
//!     Panel::new("", "time (s)", "offset (mrad)")
//!         .band(Band::new("± 1 mrad", time_s.clone(), low, high))
//!         .line(Line::new("estimate", time_s, offset).colour(Colour::Blue))
//!         .reference(10.0, "injected")
//!         .event(2.0, "rope slips"),
//! );
//! assert!(figure.svg().starts_with("<svg"));
//! ```
//!
//! The SVG is written here rather than by a charting crate: a legend outside the data, labels that
//! step aside for each other, subscripts, gaps at NaN, text that stays text, and a picture that can
//! be put several times into one HTML page (no ids, no style sheet) are what a figure needs, and
//! together they are shorter than bending a general chart to them. PNG (feature `png`) goes through
//! `resvg` with a font carried along, so that it looks the same on a machine without fonts.
//!
//! Text may carry subscripts: `τ_{el}`. Values that are NaN or infinite are gaps.

mod axis;
mod data;
mod draw;
mod ink;
mod label;
mod layout;
mod panel;
mod png;
mod seen;
mod series;
mod words;

use sinew_files::{OutputError, write_file};
use std::path::{Path, PathBuf};

pub(crate) use ink::page_colours;
pub use label::escape_xml;
pub use panel::{Mark, Panel, RightAxis, XValues};
pub use png::{Pixels, PngError, pixels};
pub use series::{Band, Colour, Dash, Line, Points, Series};

/// Why a figure was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// Neither of the two formats.
    #[error("{}: the name of a figure must end in .svg or .png", .0.display())]
    Ending(PathBuf),
    /// No PNG could be made.
    #[error(transparent)]
    Png(#[from] PngError),
    /// The system refused.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// A figure: one or more panels under a title.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Bold first line; may be empty.
    pub title: String,
    /// Second line, wrapped; may be empty.
    pub subtitle: String,
    /// What it shows, in sentences, for who can't see it: the answer, not the kind of plot. What every
    /// curve does is added by itself.
    pub seen: String,
    /// Width, CSS px.
    pub width_px: f64,
    /// Height, CSS px.
    pub height_px: f64,
    /// Panels side by side before a new row begins; 0 counts as 1.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// An empty figure of 720 × 320 px with one column.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            subtitle: String::new(),
            seen: String::new(),
            width_px: 720.0,
            height_px: 320.0,
            columns: 1,
            panels: Vec::new(),
        }
    }

    /// Sets the second line.
    #[must_use]
    pub fn subtitle(mut self, text: impl Into<String>) -> Self {
        self.subtitle = text.into();
        self
    }

    /// Says what it shows.
    #[must_use]
    pub fn seen(mut self, text: impl Into<String>) -> Self {
        self.seen = text.into();
        self
    }

    /// Sets width and height, CSS px.
    #[must_use]
    pub fn size(mut self, width_px: f64, height_px: f64) -> Self {
        self.width_px = width_px;
        self.height_px = height_px;
        self
    }

    /// Sets how many panels stand side by side.
    #[must_use]
    pub fn columns(mut self, columns: usize) -> Self {
        self.columns = columns;
        self
    }

    /// Adds a panel.
    #[must_use]
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// The figure as SVG text, to stand alone or inside HTML.
    pub fn svg(&self) -> String {
        draw::svg(self)
    }

    /// Writes the figure as SVG or as PNG with two pixels per CSS px, by the end of the file's name.
    ///
    /// # Errors
    /// [`FigureError`].
    pub fn write(&self, path: &Path) -> Result<(), FigureError> {
        let bytes = match path.extension().and_then(|e| e.to_str()) {
            Some("svg") => self.svg().into_bytes(),
            Some("png") => self.png(2.0)?,
            _ => return Err(FigureError::Ending(path.to_path_buf())),
        };
        Ok(write_file(path, &bytes)?)
    }

    /// The figure as PNG on white; `scale` is pixels per CSS px (2 for print).
    ///
    /// # Errors
    /// [`PngError`] when the size is not positive or too large to hold, or without the feature `png`.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, PngError> {
        png::render(&self.svg(), scale)
    }
}
