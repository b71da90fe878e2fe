//! Time-series figures: stacked or side-by-side panels with lines, bands and annotations, as SVG and PNG.
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
//! The SVG is written directly, without a charting crate. A figure needs a legend outside the data, labels that avoid
//! each other, subscripts, gaps at NaN, text that remains text, and a picture that can be repeated in one HTML page (no
//! ids, no style sheet). PNG (feature `png`) is rendered by `resvg` with an embedded font, so that it is identical on a
//! host without fonts.
//!
//! Text may contain subscripts: `τ_{el}`. NaN and infinite values are gaps.

mod annotation_labels;
mod axis;
mod data;
mod description;
mod draw;
mod ink;
mod label;
mod layout;
mod panel;
mod png;
mod series;

use sinew_files::{OutputError, write_file};
use std::path::{Path, PathBuf};

pub(crate) use ink::page_colours;
pub use label::escape_xml;
pub use panel::{Annotation, Panel, SecondaryAxis, XValues};
pub use png::{Pixels, PngError, pixels};
pub use series::{Band, Colour, Dash, Line, Points, Series};

/// Error in writing a figure.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// The file name has neither of the two supported extensions.
    #[error("{}: the name of a figure must end in .svg or .png", .0.display())]
    Ending(PathBuf),
    /// The PNG cannot be rendered.
    #[error(transparent)]
    Png(#[from] PngError),
    /// The file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Figure with one or more panels under a title.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Bold first line; may be empty.
    pub title: String,
    /// Second line, wrapped; may be empty.
    pub subtitle: String,
    /// Text alternative for screen readers: the result in sentences. A description of every curve is added
    /// automatically.
    pub seen: String,
    /// Width of the figure, CSS px.
    pub width_px: f64,
    /// Height of the figure, CSS px.
    pub height_px: f64,
    /// Number of panels per row; 0 counts as 1.
    pub columns: usize,
    /// Panels in row-major order.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// Creates an empty figure of 720 × 320 px with one column.
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

    /// Sets the text alternative.
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

    /// Sets the number of panels per row.
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

    /// Renders the figure as SVG text, for a file or for embedding in HTML.
    pub fn svg(&self) -> String {
        draw::svg(self)
    }

    /// Renders the figure as SVG text for one page: at full size, and for narrow windows with the same curves.
    pub(crate) fn wide_and_narrow(&self) -> [String; 2] {
        draw::wide_and_narrow(self)
    }

    /// Writes the figure as SVG, or as PNG with two pixels per CSS px, selected by the file extension.
    ///
    /// # Errors
    /// Returns a [`FigureError`] if the extension is unsupported, the PNG cannot be rendered or the file cannot be
    /// written.
    pub fn write(&self, path: &Path) -> Result<(), FigureError> {
        let bytes = match path.extension().and_then(|e| e.to_str()) {
            Some("svg") => self.svg().into_bytes(),
            Some("png") => self.png(2.0)?,
            _ => return Err(FigureError::Ending(path.to_path_buf())),
        };
        Ok(write_file(path, &bytes)?)
    }

    /// Renders the figure as PNG on white; `scale` is pixels per CSS px (2 for print).
    ///
    /// # Errors
    /// Returns a [`PngError`] if the size is not positive or too large, or without the feature `png`.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, PngError> {
        png::render(&self.svg(), scale)
    }
}
