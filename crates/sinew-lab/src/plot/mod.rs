//! Figures over time: stacked or side-by-side panels of lines, bands and marks, as SVG and PNG.
//!
//! ```
//! use sinew_lab::plot::{Band, Colour, Figure, Line, Panel};
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
//! together they are shorter than bending a general chart to them. PNG goes through `resvg` with a
//! font carried along, so that it looks the same on a machine without fonts.
//!
//! Text may carry subscripts: `τ_{el}`. Values that are NaN or infinite are gaps.

mod axis;
mod draw;
mod label;
mod layout;
mod png;

pub(crate) use label::escape_xml;
pub use png::PngError;
pub(crate) use png::render as png_of;

/// A figure: one or more panels under a title.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Bold first line; may be empty.
    pub title: String,
    /// Second line, wrapped; may be empty.
    pub subtitle: String,
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

    /// The figure as PNG on white; `scale` is pixels per CSS px (2 for print).
    ///
    /// # Errors
    /// [`PngError`] when the size is not positive or too large to hold.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, PngError> {
        png::render(&self.svg(), scale)
    }
}

/// One pair of axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// Bold, above the axes; may be empty.
    pub title: String,
    /// Horizontal axis with its unit. Empty: neither label nor tick values, for a panel whose lower
    /// neighbour shows the same axis.
    pub x_label: String,
    /// Vertical axis with its unit.
    pub y_label: String,
    /// The vertical axis in a second unit, on the right.
    pub y_right: Option<RightAxis>,
    /// From, to; `None` fits the data.
    pub x_range: Option<(f64, f64)>,
    /// From, to; `None` fits the data and the reference lines with a margin.
    pub y_range: Option<(f64, f64)>,
    /// Height relative to the panels of other rows; 0 counts as 1.
    pub weight: f64,
    /// Curves, drawn in this order; the legend names them in the same order.
    pub series: Vec<Series>,
    /// Lines and words that are not data.
    pub marks: Vec<Mark>,
}

impl Panel {
    /// A panel without data.
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
    ) -> Self {
        Self {
            title: title.into(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            ..Self::default()
        }
    }

    /// Adds a line.
    #[must_use]
    pub fn line(mut self, line: Line) -> Self {
        self.series.push(Series::Line(line));
        self
    }

    /// Adds a band.
    #[must_use]
    pub fn band(mut self, band: Band) -> Self {
        self.series.push(Series::Band(band));
        self
    }

    /// Adds a horizontal reference line at `y` with a word at its end.
    #[must_use]
    pub fn reference(mut self, y: f64, label: impl Into<String>) -> Self {
        self.marks.push(Mark::Reference {
            y,
            label: label.into(),
        });
        self
    }

    /// Adds a vertical line at `x` with a word at its top.
    #[must_use]
    pub fn event(mut self, x: f64, label: impl Into<String>) -> Self {
        self.marks.push(Mark::Event {
            x,
            label: label.into(),
        });
        self
    }

    /// Shades `from..to` of the horizontal axis, with a word at its top.
    #[must_use]
    pub fn span(mut self, from: f64, to: f64, label: impl Into<String>) -> Self {
        self.marks.push(Mark::Span {
            from,
            to,
            label: label.into(),
        });
        self
    }

    /// Writes a word at a place of the data.
    #[must_use]
    pub fn note(mut self, x: f64, y: f64, text: impl Into<String>) -> Self {
        self.marks.push(Mark::Note {
            x,
            y,
            text: text.into(),
        });
        self
    }

    /// Fixes the horizontal axis.
    #[must_use]
    pub fn x_range(mut self, from: f64, to: f64) -> Self {
        self.x_range = Some((from, to));
        self
    }

    /// Fixes the vertical axis.
    #[must_use]
    pub fn y_range(mut self, from: f64, to: f64) -> Self {
        self.y_range = Some((from, to));
        self
    }

    /// Shows the vertical axis in a second unit, `factor` times the first.
    #[must_use]
    pub fn y_right(mut self, label: impl Into<String>, factor: f64) -> Self {
        self.y_right = Some(RightAxis {
            label: label.into(),
            factor,
        });
        self
    }

    /// Sets the height relative to panels of other rows.
    #[must_use]
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

/// The left axis in another unit.
#[derive(Debug, Clone, PartialEq)]
pub struct RightAxis {
    /// Label with its unit.
    pub label: String,
    /// Value on the right divided by value on the left; not zero.
    pub factor: f64,
}

/// What a panel draws from data.
#[derive(Debug, Clone, PartialEq)]
pub enum Series {
    /// A curve.
    Line(Line),
    /// A shaded stretch between two curves.
    Band(Band),
}

/// A curve through `(x, y)`; the shorter of the two ends it.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend; empty: not in the legend.
    pub name: String,
    /// Horizontal values, rising.
    pub x: Vec<f64>,
    /// Vertical values; NaN is a gap.
    pub y: Vec<f64>,
    /// Colour.
    pub colour: Colour,
    /// Solid, dashed or dotted.
    pub dash: Dash,
    /// Stroke width, CSS px.
    pub width_px: f64,
    /// Holds each value until the next instead of joining them.
    pub step: bool,
}

impl Line {
    /// A solid blue line.
    pub fn new(name: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            x,
            y,
            colour: Colour::Blue,
            dash: Dash::Solid,
            width_px: 1.5,
            step: false,
        }
    }

    /// Sets the colour.
    #[must_use]
    pub fn colour(mut self, colour: Colour) -> Self {
        self.colour = colour;
        self
    }

    /// Sets the dash.
    #[must_use]
    pub fn dash(mut self, dash: Dash) -> Self {
        self.dash = dash;
        self
    }

    /// Sets the stroke width, CSS px.
    #[must_use]
    pub fn width(mut self, width_px: f64) -> Self {
        self.width_px = width_px;
        self
    }

    /// Draws steps.
    #[must_use]
    pub fn step(mut self) -> Self {
        self.step = true;
        self
    }
}

/// The area between `low` and `high`; NaN in either is a gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Name in the legend; empty: not in the legend.
    pub name: String,
    /// Horizontal values, rising.
    pub x: Vec<f64>,
    /// Lower edge.
    pub low: Vec<f64>,
    /// Upper edge.
    pub high: Vec<f64>,
    /// Colour, drawn light.
    pub colour: Colour,
}

impl Band {
    /// A light blue band.
    pub fn new(name: impl Into<String>, x: Vec<f64>, low: Vec<f64>, high: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            x,
            low,
            high,
            colour: Colour::Blue,
        }
    }

    /// Sets the colour.
    #[must_use]
    pub fn colour(mut self, colour: Colour) -> Self {
        self.colour = colour;
        self
    }
}

/// What a panel shows that is not data.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// Horizontal line.
    Reference {
        /// Where.
        y: f64,
        /// Word at its end; may be empty.
        label: String,
    },
    /// Vertical line.
    Event {
        /// Where.
        x: f64,
        /// Word at its top; left out where there is no room for it.
        label: String,
    },
    /// Shaded stretch of the horizontal axis.
    Span {
        /// Start.
        from: f64,
        /// End.
        to: f64,
        /// Word at its top; left out where there is no room for it.
        label: String,
    },
    /// Word at a place.
    Note {
        /// Left end of the word.
        x: f64,
        /// Its middle.
        y: f64,
        /// The word.
        text: String,
    },
}

/// Colours that people with any colour vision tell apart (Okabe and Ito, 2008).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// First choice.
    Blue,
    /// Second choice: vermilion.
    Orange,
    /// Third choice: bluish green.
    Green,
    /// Fourth choice: reddish purple.
    Purple,
    /// Sky blue.
    Sky,
    /// Amber.
    Amber,
    /// What is given, or was expected.
    Grey,
    /// What is true.
    Black,
}

impl Colour {
    /// The first six, in the order of choice.
    pub const CYCLE: [Colour; 6] = [
        Colour::Blue,
        Colour::Orange,
        Colour::Green,
        Colour::Purple,
        Colour::Sky,
        Colour::Amber,
    ];

    /// As `#rrggbb`.
    pub fn hex(self) -> &'static str {
        match self {
            Colour::Blue => "#0072b2",
            Colour::Orange => "#d55e00",
            Colour::Green => "#009e73",
            Colour::Purple => "#b3578f",
            Colour::Sky => "#56b4e9",
            Colour::Amber => "#e69f00",
            Colour::Grey => "#8a8f98",
            Colour::Black => "#1d1f24",
        }
    }
}

/// How a line is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dash {
    /// Not at all.
    #[default]
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
}
