//! Frame by frame: from a picture to how far the scale has moved.

use super::picture::Picture;
use super::reference::Reference;
use super::rejection::{Rejection, WrongPitch};
use super::sight::Sight;
use super::strips::Region;

/// Distance of the lines unless another is said, mm.
pub const PITCH_MM: f64 = 0.5;
/// Change of pitch that is told: 1 % is a camera 5 mm nearer at half a metre.
const STRETCH_TOLD: f64 = 0.01;

/// How a scale is read.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// Distance from line to line, mm; `None`: half a millimetre, refused where the longer lines
    /// speak against it.
    pub pitch_mm: Option<f64>,
    /// Where to look; `None`: everywhere.
    pub region: Option<Region>,
    /// The scale stands upright (true), lies (false) or is to be found out.
    pub upright: Option<bool>,
    /// Largest standard deviation of a frame's position, mm.
    pub std_most_mm: f64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            pitch_mm: None,
            region: None,
            upright: None,
            std_most_mm: 0.02,
        }
    }
}

/// The scale as the reference frame shows it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Scale {
    /// The scale runs from top to bottom.
    pub upright: bool,
    /// Box around it in the picture.
    pub region: Region,
    /// Pixels from line to line, across the lines, in the middle.
    pub pitch_px: f64,
    /// Distance from line to line, mm.
    pub pitch_mm: f64,
    /// Angle of the scale against the picture's rows (columns, where upright), degrees.
    pub tilt_deg: f64,
    /// Change of the pitch from one end of the region to the other, %: perspective.
    pub pitch_change_percent: f64,
    /// Contrast of the lines: amplitude of their first harmonic over the light.
    pub contrast: f64,
    /// Lines in sight.
    pub lines: usize,
    /// Every how many lines one is longer; `None` where all look alike.
    pub longer_every: Option<usize>,
}

/// One frame, read.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Reading {
    /// How far the scale has moved since the reference frame, mm; positive to the right, or
    /// downwards where it stands upright.
    pub position_mm: f64,
    /// Standard deviation of the position from the scatter within the frame, mm.
    pub position_std_mm: f64,
    /// 0 to 1: share in sight × agreement of the blocks × contrast against the usual.
    pub quality: f64,
    /// Contrast of the lines.
    pub contrast: f64,
    /// Share of the reference frame's scale that is in sight and agrees.
    pub in_sight: f64,
    /// Scatter of the blocks against each other, mm.
    pub residual_mm: f64,
    /// Lines in sight.
    pub lines: usize,
    /// Pitch against the reference frame, minus one.
    pub stretch: f64,
    /// The step was longer than half a graduation and was counted by the longer lines.
    pub jumped: bool,
}

/// Reads frames one after the other.
///
/// The first frame with a scale becomes the reference: its position is 0. Steps between frames
/// may have any length where longer lines or numbers tell the lines apart. On a scale whose lines
/// all look alike a step must stay below 0.4 graduations (0.2 mm), and is refused beyond, because
/// it can't be told from a step of 0.6 the other way.
#[derive(Debug, Clone)]
pub struct ScaleReader {
    options: ReadOptions,
    reference: Option<Reference>,
}

impl ScaleReader {
    /// A reader that has seen nothing.
    pub fn new(options: ReadOptions) -> Self {
        Self {
            options,
            reference: None,
        }
    }

    /// The scale, once a frame has shown it.
    pub fn scale(&self) -> Option<&Scale> {
        self.reference.as_ref().map(|r| &r.scale)
    }

    /// Reads the next frame.
    ///
    /// # Errors
    /// [`Rejection`]; the frame leaves no trace but that one is missing.
    pub fn read(&mut self, picture: &Picture) -> Result<Reading, Rejection> {
        self.look(picture).map(|(reading, _)| reading)
    }

    /// Whether the longer lines speak against the pitch that was taken for granted.
    ///
    /// # Errors
    /// [`WrongPitch`] where every fifth line is longer and no pitch was said.
    pub fn check_pitch(&self) -> Result<(), WrongPitch> {
        match self.scale().and_then(|s| s.longer_every) {
            Some(every @ 5) if self.options.pitch_mm.is_none() => Err(WrongPitch { every }),
            _ => Ok(()),
        }
    }

    pub(crate) fn look(&mut self, picture: &Picture) -> Result<(Reading, Sight), Rejection> {
        if let Some(reference) = &mut self.reference {
            let result = reference.read(picture, &self.options);
            if result.is_err() {
                reference.missed += 1;
            }
            return result;
        }
        let (mut reference, sight) = Reference::new(picture, &self.options)?;
        let std_mm = reference.reference_std * reference.scale.pitch_mm;
        if std_mm > self.options.std_most_mm {
            return Err(Rejection::Unsure {
                std_mm,
                most_mm: self.options.std_most_mm,
            });
        }
        let reading = Reading {
            position_mm: 0.0,
            position_std_mm: std_mm,
            quality: sight.shift.coherence,
            contrast: reference.scale.contrast,
            in_sight: 1.0,
            residual_mm: sight.shift.scatter * reference.scale.pitch_mm,
            lines: reference.scale.lines,
            stretch: 0.0,
            jumped: false,
        };
        reference.usual.push(reference.scale.contrast);
        self.reference = Some(reference);
        Ok((reading, sight))
    }
}

/// Whether a change of pitch should be told.
pub(crate) fn stretched(reading: &Reading) -> bool {
    reading.stretch.abs() > STRETCH_TOLD
}
