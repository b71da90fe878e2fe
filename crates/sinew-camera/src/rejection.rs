//! Why a frame, or a whole scale, is not used.

use super::reference::DARK;

/// Why a frame is not used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Rejection {
    /// The file can't be decoded.
    #[error("unreadable: {0}")]
    Unreadable(String),
    /// Another size than the reference frame.
    #[error("{0} × {1} px, but the reference frame has {2} × {3} px")]
    Size(usize, usize, usize, usize),
    /// Too little light.
    #[error("dark: mean level {level:.3} of white, at least {DARK} is needed")]
    Dark {
        /// Mean level, 0 to 1.
        level: f64,
    },
    /// Too much light.
    #[error("overexposed: {share:.0} % of the pixels are white", share = 100.0 * share)]
    Glare {
        /// Share of white pixels, 0 to 1.
        share: f64,
    },
    /// Lines are there, too faint to be trusted.
    #[error("blurred: {share:.0} % of the usual contrast, at least 25 % is needed", share = 100.0 * share)]
    Blurred {
        /// Contrast over the usual one.
        share: f64,
    },
    /// Something stands before the scale.
    #[error("covered: {share:.0} % of the scale in sight, at least 40 % is needed", share = 100.0 * share)]
    Covered {
        /// Share in sight, 0 to 1.
        share: f64,
    },
    /// No scale.
    #[error("no scale: {0}")]
    NoScale(String),
    /// Whole graduations can't be counted.
    #[error(
        "ambiguous: the scale moved by {nearest_mm:.2} or {other_mm:.2} mm since the last frame used; take frames more often or show longer lines"
    )]
    Ambiguous {
        /// Step to the nearest candidate, mm.
        nearest_mm: f64,
        /// Step to the next one, mm.
        other_mm: f64,
    },
    /// Blocks contradict each other.
    #[error("unsure: standard deviation {std_mm:.4} mm, at most {most_mm} mm is allowed")]
    Unsure {
        /// Found, mm.
        std_mm: f64,
        /// Allowed, mm.
        most_mm: f64,
    },
    /// Time of another frame.
    #[error("same time as {0}")]
    Time(String),
}

impl Rejection {
    /// One word, to count by.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Unreadable(_) => "unreadable",
            Self::Size(..) => "other-size",
            Self::Dark { .. } => "dark",
            Self::Glare { .. } => "overexposed",
            Self::Blurred { .. } => "blurred",
            Self::Covered { .. } => "covered",
            Self::NoScale(_) => "no-scale",
            Self::Ambiguous { .. } => "ambiguous",
            Self::Unsure { .. } => "unsure",
            Self::Time(_) => "same-time",
        }
    }
}

/// The scale is not what the options say.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "every {every}th line is longer, as on a scale of whole millimetres, but a line every 0.5 mm was expected; say --pitch-mm 1, or --pitch-mm 0.5 if it is so"
)]
pub struct WrongPitch {
    /// Distance of the longer lines, graduations.
    pub every: usize,
}
