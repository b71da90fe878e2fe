//! Panels: a pair of axes with data and annotations.

use super::series::{Band, Line, Points, Series};

/// Panel with one pair of axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// Bold title above the axes; may be empty.
    pub title: String,
    /// Label of the horizontal axis with its unit. Empty: neither label nor tick values, for a panel whose lower
    /// neighbour has the same axis.
    pub x_label: String,
    /// Label of the vertical axis with its unit.
    pub y_label: String,
    /// Secondary vertical axis in another unit, on the right.
    pub y_right: Option<SecondaryAxis>,
    /// Named positions of the horizontal axis instead of numbers, in descending priority; a name without room next to
    /// earlier ones is omitted. Empty: numbers.
    pub x_names: Vec<(f64, String)>,
    /// Meaning of the horizontal values.
    pub x_values: XValues,
    /// Named positions of the vertical axis instead of numbers. Empty: numbers.
    pub y_names: Vec<(f64, String)>,
    /// Range of the horizontal axis; `None` fits the data.
    pub x_range: Option<(f64, f64)>,
    /// Range of the vertical axis; `None` fits the data and the reference lines with a margin.
    pub y_range: Option<(f64, f64)>,
    /// Height relative to the panels of other rows; 0 counts as 1.
    pub weight: f64,
    /// Data series in the order of drawing and of the legend.
    pub series: Vec<Series>,
    /// Annotations of the panel.
    pub marks: Vec<Annotation>,
}

impl Panel {
    /// Creates a panel without data.
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

    /// Adds individual data points.
    #[must_use]
    pub fn points(mut self, points: Points) -> Self {
        self.series.push(Series::Points(points));
        self
    }

    /// Adds a horizontal reference line at `y` with a label at its end.
    #[must_use]
    pub fn reference(mut self, y: f64, label: impl Into<String>) -> Self {
        self.marks.push(Annotation::Reference {
            y,
            label: label.into(),
        });
        self
    }

    /// Adds a vertical line at `x` with a label at its top.
    #[must_use]
    pub fn event(mut self, x: f64, label: impl Into<String>) -> Self {
        self.marks.push(Annotation::Event {
            x,
            label: label.into(),
        });
        self
    }

    /// Shades `from..to` of the horizontal axis, with a label at its top.
    #[must_use]
    pub fn span(mut self, from: f64, to: f64, label: impl Into<String>) -> Self {
        self.marks.push(Annotation::Span {
            from,
            to,
            label: label.into(),
        });
        self
    }

    /// Adds a text at a data position.
    #[must_use]
    pub fn note(mut self, x: f64, y: f64, text: impl Into<String>) -> Self {
        self.marks.push(Annotation::Note {
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

    /// Labels the horizontal axis, a decadic logarithm of seconds, with common durations.
    #[must_use]
    pub fn x_times(mut self) -> Self {
        const MINUTE: f64 = 60.0;
        const HOUR: f64 = 60.0 * MINUTE;
        const DAY: f64 = 24.0 * HOUR;
        // Whole units come first; intermediate values fill gaps.
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

    /// Defines the horizontal values as days since `utc_s`, s since 1970 UTC; the tooltip shows the date.
    #[must_use]
    pub fn x_days_since(mut self, utc_s: f64) -> Self {
        self.x_values = XValues::DaysSince { utc_s };
        self
    }

    /// Sets the named rows of the vertical axis.
    #[must_use]
    pub fn y_names(mut self, names: Vec<(f64, String)>) -> Self {
        self.y_names = names;
        self
    }

    /// Adds a secondary vertical axis, `factor` times the first.
    #[must_use]
    pub fn y_right(mut self, label: impl Into<String>, factor: f64) -> Self {
        self.y_right = Some(SecondaryAxis {
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

/// Meaning of the values of a horizontal axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum XValues {
    /// Quantity given by the axis label.
    #[default]
    Plain,
    /// Decadic logarithms of seconds.
    LogSeconds,
    /// Days since a reference time.
    DaysSince {
        /// Reference time, s since 1970 UTC.
        utc_s: f64,
    },
}

/// Secondary axis: the left axis in another unit.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondaryAxis {
    /// Label of the axis with its unit.
    pub label: String,
    /// Value on the right divided by value on the left; not zero.
    pub factor: f64,
}

/// Annotation of a panel.
#[derive(Debug, Clone, PartialEq)]
pub enum Annotation {
    /// Horizontal reference line.
    Reference {
        /// Vertical position of the line.
        y: f64,
        /// Label at the end of the line; may be empty.
        label: String,
    },
    /// Vertical line at an event.
    Event {
        /// Horizontal position of the line.
        x: f64,
        /// Label at the top; omitted without room.
        label: String,
    },
    /// Shaded range of the horizontal axis.
    Span {
        /// Start of the range.
        from: f64,
        /// End of the range.
        to: f64,
        /// Label at the top; omitted without room.
        label: String,
    },
    /// Text at a data position.
    Note {
        /// Left end of the text.
        x: f64,
        /// Vertical middle of the text.
        y: f64,
        /// Text of the annotation.
        text: String,
    },
}
