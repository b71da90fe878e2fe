//! A pair of axes and what stands on it that is not data.

use super::series::{Band, Line, Points, Series};

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
    /// Names at places of the horizontal axis instead of numbers, the most wanted first: one that
    /// has no room beside those before is left out. Empty: numbers.
    pub x_names: Vec<(f64, String)>,
    /// What the horizontal values count.
    pub x_values: XValues,
    /// Names at places of the vertical axis instead of numbers. Empty: numbers.
    pub y_names: Vec<(f64, String)>,
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

    /// Adds single readings.
    #[must_use]
    pub fn points(mut self, points: Points) -> Self {
        self.series.push(Series::Points(points));
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

    /// Makes the horizontal axis, a decadic logarithm of seconds, one of times that everybody knows.
    #[must_use]
    pub fn x_times(mut self) -> Self {
        const MINUTE: f64 = 60.0;
        const HOUR: f64 = 60.0 * MINUTE;
        const DAY: f64 = 24.0 * HOUR;
        // Whole units first: what stands between them fills gaps.
        let times = [
            (1.0, "1 s"),
            (MINUTE, "1 min"),
            (HOUR, "1 h"),
            (DAY, "1 day"),
            (365.25 * DAY, "1 year"),
            (10.0, "10 s"),
            (10.0 * MINUTE, "10 min"),
            (30.4375 * DAY, "1 month"),
            (3652.5 * DAY, "10 years"),
            (5.0 * HOUR, "5 h"),
            (5.0 * DAY, "5 days"),
            (30.0, "30 s"),
            (3.0, "3 s"),
            (3.0 * MINUTE, "3 min"),
            (30.0 * MINUTE, "30 min"),
            (12.0 * HOUR, "12 h"),
            (2.0 * HOUR, "2 h"),
            (182.625 * DAY, "6 months"),
        ];
        self.x_names = times
            .into_iter()
            .map(|(s, name): (f64, _)| (s.log10(), name.to_owned()))
            .collect();
        self.x_values = XValues::LogSeconds;
        self
    }

    /// Says that the horizontal values are days since a moment, s since 1970 UTC: who points at one reads
    /// its date.
    #[must_use]
    pub fn x_days_since(mut self, utc_s: f64) -> Self {
        self.x_values = XValues::DaysSince { utc_s };
        self
    }

    /// Names rows of the vertical axis.
    #[must_use]
    pub fn y_names(mut self, names: Vec<(f64, String)>) -> Self {
        self.y_names = names;
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

/// What the values of a horizontal axis count.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum XValues {
    /// What the label says.
    #[default]
    Plain,
    /// Decadic logarithms of seconds.
    LogSeconds,
    /// Days since a moment.
    DaysSince {
        /// The moment, s since 1970 UTC.
        utc_s: f64,
    },
}

/// The left axis in another unit.
#[derive(Debug, Clone, PartialEq)]
pub struct RightAxis {
    /// Label with its unit.
    pub label: String,
    /// Value on the right divided by value on the left; not zero.
    pub factor: f64,
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
