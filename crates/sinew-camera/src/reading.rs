//! Options, detected scale, and measurement of one frame.

use super::strips::Region;

/// Default distance of the lines, m.
pub const DEFAULT_PITCH_M: f64 = 0.5e-3;
/// Minimum relative change of pitch that is reported: 1 % is a camera 5 mm nearer at half a metre.
const MIN_REPORTED_PITCH_CHANGE: f64 = 0.01;

/// Options for reading a scale.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// Distance from line to line, m; `None`: 0.5 mm, rejected if the longer lines are inconsistent with it.
    pub pitch_m: Option<f64>,
    /// Region of the scale; `None`: whole picture.
    pub region: Option<Region>,
    /// Whether the scale is upright; `None`: detected automatically.
    pub upright: Option<bool>,
    /// Maximum standard deviation of the position of a frame, m.
    pub std_most_m: f64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            pitch_m: None,
            region: None,
            upright: None,
            std_most_m: 0.02e-3,
        }
    }
}

/// Scale in the reference frame.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scale {
    /// Whether the scale runs from top to bottom.
    pub upright: bool,
    /// Bounding box of the scale in the picture.
    pub region: Region,
    /// Pitch in the middle of the scale, perpendicular to the lines, px.
    pub pitch_px: f64,
    /// Distance from line to line, m.
    pub pitch_m: f64,
    /// Angle of the scale relative to the rows of the picture (columns if upright), rad.
    pub tilt_rad: f64,
    /// Relative change of the pitch from one end of the region to the other (perspective).
    pub pitch_change_ratio: f64,
    /// Contrast of the lines: amplitude of the first harmonic relative to the mean level.
    pub contrast: f64,
    /// Number of visible lines.
    pub lines: usize,
    /// Distance of the longer lines in graduations; `None` if all lines are identical.
    pub longer_every: Option<usize>,
}

/// Measurement of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ScaleMeasurement {
    /// Displacement of the scale since the reference frame, m; positive to the right, or downwards if the scale is
    /// upright.
    pub position_m: f64,
    /// Standard deviation of the position from the scatter within the frame, m.
    pub position_std_m: f64,
    /// Quality, 0 to 1: visible share × agreement of the blocks × contrast relative to normal.
    pub quality: f64,
    /// Contrast of the lines.
    pub contrast: f64,
    /// Share of the reference scale that is visible and consistent, 0 to 1.
    pub visible_share: f64,
    /// Scatter of the blocks, m.
    pub residual_m: f64,
    /// Number of visible lines.
    pub lines: usize,
    /// Pitch relative to the reference frame, minus one.
    pub stretch: f64,
    /// Whether the step was longer than half a graduation and was resolved by the longer lines.
    pub jumped: bool,
}

impl ScaleMeasurement {
    /// Whether the change of pitch is reported.
    pub(crate) fn is_stretched(&self) -> bool {
        self.stretch.abs() > MIN_REPORTED_PITCH_CHANGE
    }
}
