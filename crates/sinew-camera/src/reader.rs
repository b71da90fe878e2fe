//! Frame-by-frame measurement of the displacement of the scale.

use super::picture::Picture;
use super::reading::{ReadOptions, Scale, ScaleMeasurement};
use super::reference::Reference;
use super::rejection::{Rejection, WrongPitch};
use super::visibility::View;

/// Sequential reader of frames.
///
/// The first frame with a scale becomes the reference: its position is 0. Steps between frames may have any length if
/// longer lines or numbers identify the lines. On a scale with identical lines a step must be below 0.4 graduations
/// (0.2 mm); a longer step is rejected, because it is indistinguishable from a step of 0.6 in the opposite direction.
#[derive(Debug, Clone)]
pub struct ScaleReader {
    options: ReadOptions,
    reference: Option<Reference>,
}

impl ScaleReader {
    /// Creates a reader without a reference.
    pub fn new(options: ReadOptions) -> Self {
        Self {
            options,
            reference: None,
        }
    }

    /// Returns the scale, once a frame contains it.
    pub fn scale(&self) -> Option<&Scale> {
        self.reference.as_ref().map(|r| &r.scale)
    }

    /// Reads the next frame.
    ///
    /// # Errors
    /// Returns a [`Rejection`] if the frame is not usable; the frame then only counts as missing.
    pub fn read(&mut self, picture: &Picture) -> Result<ScaleMeasurement, Rejection> {
        self.look(picture).map(|(reading, _)| reading)
    }

    /// Checks the default pitch against the longer lines.
    ///
    /// # Errors
    /// Returns [`WrongPitch`] if every fifth line is longer and no pitch is specified.
    pub fn check_pitch(&self) -> Result<(), WrongPitch> {
        match self.scale().and_then(|s| s.longer_every) {
            Some(every @ 5) if self.options.pitch_m.is_none() => Err(WrongPitch { every }),
            _ => Ok(()),
        }
    }

    pub(crate) fn look(
        &mut self,
        picture: &Picture,
    ) -> Result<(ScaleMeasurement, View), Rejection> {
        if let Some(reference) = &mut self.reference {
            let result = reference.read(picture, &self.options);
            if result.is_err() {
                reference.missed += 1;
            }
            return result;
        }
        let (reference, reading, view) = Reference::first(picture, &self.options)?;
        self.reference = Some(reference);
        Ok((reading, view))
    }
}
