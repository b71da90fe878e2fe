//! Frame by frame: from a picture to how far the scale has moved.

use super::picture::Picture;
use super::reading::{ReadOptions, Reading, Scale};
use super::reference::Reference;
use super::rejection::{Rejection, WrongPitch};
use super::visibility::View;

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

    /// Whether the longer lines contradict the pitch that was taken for granted.
    ///
    /// # Errors
    /// [`WrongPitch`] where every fifth line is longer and no pitch was said.
    pub fn check_pitch(&self) -> Result<(), WrongPitch> {
        match self.scale().and_then(|s| s.longer_every) {
            Some(every @ 5) if self.options.pitch_m.is_none() => Err(WrongPitch { every }),
            _ => Ok(()),
        }
    }

    pub(crate) fn look(&mut self, picture: &Picture) -> Result<(Reading, View), Rejection> {
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
