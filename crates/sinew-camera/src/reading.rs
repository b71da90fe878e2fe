//! How a scale is read, the scale itself, and one frame's reading.

use super::strips::Region;

/// Distance of the lines unless another is said, m.
pub const PITCH_M: f64 = 0.5e-3;
/// Change of pitch that is worth a note: 1 % is a camera 5 mm nearer at half a metre.
const STRETCH_NOTED: f64 = 0.01;

/// How a scale is read.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// Distance from line to line, m; `None`: half a millimetre, refused where the longer lines
    /// contradict it.
    pub pitch_m: Option<f64>,
    /// Where to look; `None`: everywhere.
    pub region: Option<Region>,
    /// The scale stands upright (true), lies (false) or is to be found out.
    pub upright: Option<bool>,
    /// Largest standard deviation of a frame's position, m.
    pub deviation_most_m: f64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            pitch_m: None,
            region: None,
            upright: None,
            deviation_most_m: 0.02e-3,
        }
    }
}

/// The scale as the reference frame shows it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scale {
    /// The scale runs from top to bottom.
    pub upright: bool,
    /// Box around it in the picture.
    pub region: Region,
    /// Pixels from line to line, across the lines, in the middle.
    pub pitch_px: f64,
    /// Distance from line to line, m.
    pub pitch_m: f64,
    /// Angle of the scale against the picture's rows (columns, where upright), rad.
    pub tilt_rad: f64,
    /// Change of the pitch from one end of the region to the other over itself: perspective.
    pub pitch_change_ratio: f64,
    /// Contrast of the lines: amplitude of their first harmonic over the light.
    pub contrast: f64,
    /// Visible lines.
    pub lines: usize,
    /// Every how many lines one is longer; `None` where all look alike.
    pub longer_every: Option<usize>,
}

/// One frame, read.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// How far the scale has moved since the reference frame, m; positive to the right, or
    /// downwards where it stands upright.
    pub position_m: f64,
    /// Standard deviation of the position from the scatter within the frame, m.
    pub position_deviation_m: f64,
    /// 0 to 1: visible share × agreement of the blocks × contrast against the usual.
    pub quality: f64,
    /// Contrast of the lines.
    pub contrast: f64,
    /// Share of the reference frame's scale that is visible and agrees.
    pub visible_share: f64,
    /// Scatter of the blocks against each other, m.
    pub residual_m: f64,
    /// Visible lines.
    pub lines: usize,
    /// Pitch against the reference frame, minus one.
    pub stretch: f64,
    /// The step was longer than half a graduation and was counted by the longer lines.
    pub jumped: bool,
}

impl Reading {
    /// Whether the pitch has changed so much that a person should know.
    pub(crate) fn is_stretched(&self) -> bool {
        self.stretch.abs() > STRETCH_NOTED
    }
}
