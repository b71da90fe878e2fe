//! Curves, bands, colours and dashes.

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
