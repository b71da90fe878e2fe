//! Curves, bands, colours and dashes.

/// What a panel draws from data.
#[derive(Debug, Clone, PartialEq)]
pub enum Series {
    /// A curve.
    Line(Line),
    /// A shaded stretch between two curves.
    Band(Band),
    /// Single readings.
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

    /// Colour.
    pub fn colour(&self) -> Colour {
        match self {
            Self::Line(line) => line.colour,
            Self::Band(band) => band.colour,
            Self::Points(points) => points.colour,
        }
    }

    /// Horizontal values.
    pub fn x(&self) -> &[f64] {
        match self {
            Self::Line(line) => &line.x,
            Self::Band(band) => &band.x,
            Self::Points(points) => &points.x,
        }
    }

    /// Vertical values: of a line or of points one list, with intervals three, of a band its edges.
    pub(super) fn ys(&self) -> impl Iterator<Item = &[f64]> {
        let all: [&[f64]; 3] = match self {
            Self::Line(line) => [&line.y, &[], &[]],
            Self::Band(band) => [&band.low, &band.high, &[]],
            Self::Points(points) => [&points.y, &points.low, &points.high],
        };
        all.into_iter().filter(|y| !y.is_empty())
    }
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

/// Single readings, each a dot, with an upright bar where its interval is given.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Points {
    /// Name in the legend; empty: not in the legend.
    pub name: String,
    /// Horizontal values.
    pub x: Vec<f64>,
    /// Vertical values; NaN is no reading.
    pub y: Vec<f64>,
    /// Lower ends of the intervals; empty: none.
    pub low: Vec<f64>,
    /// Upper ends of the intervals; empty: none.
    pub high: Vec<f64>,
    /// What each is called when a reader points at it; empty: as the series.
    pub labels: Vec<String>,
    /// Colour.
    pub colour: Colour,
    /// Width of a dot, CSS px.
    pub size_px: f64,
}

impl Points {
    /// Blue dots without intervals.
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

    /// Sets the width of a dot, CSS px.
    #[must_use]
    pub fn size(mut self, size_px: f64) -> Self {
        self.size_px = size_px;
        self
    }

    /// Sets the ends of the intervals.
    #[must_use]
    pub fn intervals(mut self, low: Vec<f64>, high: Vec<f64>) -> Self {
        (self.low, self.high) = (low, high);
        self
    }

    /// Names each.
    #[must_use]
    pub fn labels(mut self, labels: Vec<String>) -> Self {
        self.labels = labels;
        self
    }
}

/// Colours that people with any colour vision tell apart (Okabe and Ito, 2008).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Colour {
    /// First choice.
    #[default]
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
