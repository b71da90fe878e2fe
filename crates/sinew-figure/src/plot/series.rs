//! Curves, bands, points, colours and dashes.

/// Data series of a panel.
#[derive(Debug, Clone, PartialEq)]
pub enum Series {
    /// Curve through data points.
    Line(Line),
    /// Shaded band between two curves.
    Band(Band),
    /// Individual data points.
    Points(Points),
}

impl Series {
    /// Name in the legend; empty: not in the legend.
    pub fn name(&self) -> &str {
        match self {
            Self::Line(line) => &line.name,
            Self::Band(band) => &band.name,
            Self::Points(points) => &points.name,
        }
    }

    /// Returns the colour of the series.
    pub fn colour(&self) -> Colour {
        match self {
            Self::Line(line) => line.colour,
            Self::Band(band) => band.colour,
            Self::Points(points) => points.colour,
        }
    }

    /// Returns the horizontal values of the series.
    pub fn x(&self) -> &[f64] {
        match self {
            Self::Line(line) => &line.x,
            Self::Band(band) => &band.x,
            Self::Points(points) => &points.x,
        }
    }

    /// Returns the vertical values: one list for a line or points, three with intervals, and the two edges for a band.
    pub(super) fn ys(&self) -> impl Iterator<Item = &[f64]> {
        let all: [&[f64]; 3] = match self {
            Self::Line(line) => [&line.y, &[], &[]],
            Self::Band(band) => [&band.low, &band.high, &[]],
            Self::Points(points) => [&points.y, &points.low, &points.high],
        };
        all.into_iter().filter(|y| !y.is_empty())
    }
}

/// Curve through `(x, y)`; the shorter of the two determines its length.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend; empty: not in the legend.
    pub name: String,
    /// Horizontal values, increasing.
    pub x: Vec<f64>,
    /// Vertical values; NaN is a gap.
    pub y: Vec<f64>,
    /// Colour of the line.
    pub colour: Colour,
    /// Style of the line: solid, dashed or dotted.
    pub dash: Dash,
    /// Stroke width, CSS px.
    pub width_px: f64,
    /// Whether each value is held until the next one (steps).
    pub step: bool,
}

impl Line {
    /// Creates a solid blue line.
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

    /// Holds each value until the next one (steps).
    #[must_use]
    pub fn step(mut self) -> Self {
        self.step = true;
        self
    }
}

/// Area between `low` and `high`; NaN in either is a gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Name in the legend; empty: not in the legend.
    pub name: String,
    /// Horizontal values, increasing.
    pub x: Vec<f64>,
    /// Values of the lower edge.
    pub low: Vec<f64>,
    /// Values of the upper edge.
    pub high: Vec<f64>,
    /// Colour of the band, drawn light.
    pub colour: Colour,
}

impl Band {
    /// Creates a light blue band.
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

/// Individual data points, drawn as dots with vertical bars for their intervals.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Points {
    /// Name in the legend; empty: not in the legend.
    pub name: String,
    /// Horizontal values of the points.
    pub x: Vec<f64>,
    /// Vertical values; NaN is a missing value.
    pub y: Vec<f64>,
    /// Lower bounds of the intervals; empty: none.
    pub low: Vec<f64>,
    /// Upper bounds of the intervals; empty: none.
    pub high: Vec<f64>,
    /// Names of the points in the tooltip; empty: name of the series.
    pub labels: Vec<String>,
    /// Colour of the points.
    pub colour: Colour,
    /// Diameter of a dot, CSS px.
    pub size_px: f64,
}

impl Points {
    /// Creates blue dots without intervals.
    pub fn new(name: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            x,
            y,
            size_px: 5.0,
            ..Self::default()
        }
    }

    /// Sets the colour.
    #[must_use]
    pub fn colour(mut self, colour: Colour) -> Self {
        self.colour = colour;
        self
    }

    /// Sets the diameter of a dot, CSS px.
    #[must_use]
    pub fn size(mut self, size_px: f64) -> Self {
        self.size_px = size_px;
        self
    }

    /// Sets the bounds of the intervals.
    #[must_use]
    pub fn intervals(mut self, low: Vec<f64>, high: Vec<f64>) -> Self {
        (self.low, self.high) = (low, high);
        self
    }

    /// Sets the names of the points.
    #[must_use]
    pub fn labels(mut self, labels: Vec<String>) -> Self {
        self.labels = labels;
        self
    }
}

/// Colours that are distinguishable with any colour vision (Okabe and Ito, 2008).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Colour {
    /// Blue, first colour of the cycle.
    #[default]
    Blue,
    /// Vermilion, second colour of the cycle.
    Orange,
    /// Bluish green, third colour of the cycle.
    Green,
    /// Reddish purple, fourth colour of the cycle.
    Purple,
    /// Sky blue, fifth colour of the cycle.
    Sky,
    /// Amber, sixth colour of the cycle.
    Amber,
    /// Specified or expected values.
    Grey,
    /// True values of a simulation.
    Black,
}

impl Colour {
    /// First six colours in the order of use.
    pub const CYCLE: [Colour; 6] = [
        Colour::Blue,
        Colour::Orange,
        Colour::Green,
        Colour::Purple,
        Colour::Sky,
        Colour::Amber,
    ];

    /// Returns the colour as `#rrggbb`.
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

/// Dash pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dash {
    /// Solid line without gaps.
    #[default]
    Solid,
    /// Line with long dashes.
    Dashed,
    /// Line of dots.
    Dotted,
    /// Dashes and dots in turn.
    DashDotted,
    /// Line with longer dashes and short gaps.
    LongDashed,
    /// A dash and two dots in turn.
    DashDotDotted,
}

impl Dash {
    /// All patterns in the order of use; with [`Colour::CYCLE`], lines differ without their colours.
    pub const CYCLE: [Dash; 6] = [
        Dash::Solid,
        Dash::Dashed,
        Dash::Dotted,
        Dash::DashDotted,
        Dash::LongDashed,
        Dash::DashDotDotted,
    ];
}
