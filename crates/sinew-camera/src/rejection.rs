//! Why a frame, or a whole scale, is not used.

use serde::Serialize;

/// Darkest mean level of the region that still counts as lit, share of white.
pub(super) const DARK: f64 = 0.04;

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
        "ambiguous: the scale moved by {nearest:.2} or {other:.2} mm since the last frame used; take frames more often or show longer lines",
        nearest = 1e3 * nearest_m,
        other = 1e3 * other_m
    )]
    Ambiguous {
        /// Step to the nearest candidate, m.
        nearest_m: f64,
        /// Step to the next one, m.
        other_m: f64,
    },
    /// Blocks contradict each other.
    #[error(
        "unsure: standard deviation {:.4} mm, at most {} mm is allowed",
        1e3 * deviation_m,
        millimetres(*most_m)
    )]
    Unsure {
        /// Found, m.
        deviation_m: f64,
        /// Allowed, m.
        most_m: f64,
    },
    /// Time of another frame.
    #[error("same time as {0}")]
    Time(String),
}

impl Rejection {
    /// What kind it is, to count by.
    pub fn kind(&self) -> RejectionKind {
        match self {
            Self::Unreadable(_) => RejectionKind::Unreadable,
            Self::Size(..) => RejectionKind::OtherSize,
            Self::Dark { .. } => RejectionKind::Dark,
            Self::Glare { .. } => RejectionKind::Overexposed,
            Self::Blurred { .. } => RejectionKind::Blurred,
            Self::Covered { .. } => RejectionKind::Covered,
            Self::NoScale(_) => RejectionKind::NoScale,
            Self::Ambiguous { .. } => RejectionKind::Ambiguous,
            Self::Unsure { .. } => RejectionKind::Unsure,
            Self::Time(_) => RejectionKind::SameTime,
        }
    }
}

/// Kind of a [`Rejection`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RejectionKind {
    /// The file can't be decoded.
    Unreadable,
    /// Another size than the reference frame.
    OtherSize,
    /// Too little light.
    Dark,
    /// Too much light.
    Overexposed,
    /// Lines too faint to be trusted.
    Blurred,
    /// Something stands before the scale.
    Covered,
    /// No scale.
    NoScale,
    /// Whole graduations can't be counted.
    Ambiguous,
    /// Blocks contradict each other.
    Unsure,
    /// Time of another frame.
    SameTime,
}

impl std::fmt::Display for RejectionKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.serialize(f)
    }
}

/// A length in mm as a person wrote it: without the last digits that a factor of 1000 leaves.
pub(crate) fn millimetres(metres: f64) -> f64 {
    (1e12 * metres).round() / 1e9
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
