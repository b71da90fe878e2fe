//! Reasons for the rejection of a frame or a scale.

use serde::Serialize;

/// Minimum mean level of the region, as a share of white.
pub(super) const MIN_LEVEL: f64 = 0.04;

/// Reason for the rejection of a frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Rejection {
    /// The file cannot be decoded.
    #[error("unreadable: {0}")]
    Unreadable(String),
    /// The size differs from that of the reference frame.
    #[error("{0} × {1} px, but the reference frame has {2} × {3} px")]
    Size(usize, usize, usize, usize),
    /// The picture is too dark.
    #[error("dark: mean level {level:.3} of white (minimum {MIN_LEVEL})")]
    Dark {
        /// Mean level, 0 to 1.
        level: f64,
    },
    /// The picture is overexposed.
    #[error("overexposed: {share:.0} % of the pixels are white", share = 100.0 * share)]
    Glare {
        /// Share of white pixels, 0 to 1.
        share: f64,
    },
    /// The lines are blurred.
    #[error("blurred: {share:.0} % of the normal contrast (minimum 25 %)", share = 100.0 * share)]
    Blurred {
        /// Contrast relative to normal.
        share: f64,
    },
    /// The scale is covered.
    #[error("covered: {share:.0} % of the scale visible (minimum 40 %)", share = 100.0 * share)]
    Covered {
        /// Visible share of the scale, 0 to 1.
        share: f64,
    },
    /// No scale was found.
    #[error("no scale: {0}")]
    NoScale(String),
    /// The number of whole graduations is ambiguous.
    #[error(
        "ambiguous: the scale moved by {nearest:.2} or {other:.2} mm since the last frame used; increase the frame rate or include longer lines",
        nearest = 1e3 * nearest_m,
        other = 1e3 * other_m
    )]
    Ambiguous {
        /// Step to the nearest candidate, m.
        nearest_m: f64,
        /// Step to the next candidate, m.
        other_m: f64,
    },
    /// The blocks are inconsistent.
    #[error(
        "uncertain: standard deviation {:.4} mm (maximum {} mm)",
        1e3 * std_m,
        millimetres(*most_m)
    )]
    Uncertain {
        /// Standard deviation of the position, m.
        std_m: f64,
        /// Maximum standard deviation, m.
        most_m: f64,
    },
    /// Another frame has the same time.
    #[error("same time as {0}")]
    Time(String),
}

impl Rejection {
    /// Returns the kind of the rejection.
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
            Self::Uncertain { .. } => RejectionKind::Uncertain,
            Self::Time(_) => RejectionKind::SameTime,
        }
    }
}

/// Kind of a [`Rejection`], for counting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RejectionKind {
    /// The file cannot be decoded.
    Unreadable,
    /// The size differs from that of the reference frame.
    OtherSize,
    /// The picture is too dark.
    Dark,
    /// The picture is overexposed.
    Overexposed,
    /// The lines are blurred.
    Blurred,
    /// The scale is covered.
    Covered,
    /// No scale was found.
    NoScale,
    /// The number of whole graduations is ambiguous.
    Ambiguous,
    /// The blocks are inconsistent.
    Uncertain,
    /// Another frame has the same time.
    SameTime,
}

impl std::fmt::Display for RejectionKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.serialize(f)
    }
}

/// Returns a length in mm without the rounding error of a factor of 1000.
pub(crate) fn millimetres(metres: f64) -> f64 {
    (1e12 * metres).round() / 1e9
}

/// The scale is inconsistent with the options.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "every {every}th line is longer, as on a scale of whole millimetres, but the expected pitch is 0.5 mm; set --pitch 1mm, or --pitch 0.5mm to confirm"
)]
pub struct WrongPitch {
    /// Distance of the longer lines, graduations.
    pub every: usize,
}
