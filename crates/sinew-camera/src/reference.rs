//! Reference frame of a series, and comparison of every later frame with it.

use super::find::{self, Found, MAX_TILT_DEG, MIN_PITCH_PX};
use super::line_index::LineIndex;
use super::marks::{self, Bands};
use super::phase;
use super::phase_map::PhaseMap;
use super::picture::Picture;
use super::reading::{DEFAULT_PITCH_M, ReadOptions, Scale, ScaleMeasurement};
use super::rejection::{MIN_LEVEL, Rejection};
use super::robust::median;
use super::strips::{Demodulator, Region, STRIP_ROWS, Strips};
use super::visibility::{View, line_contrast, line_rows, occlusion, search_window, visible_lines};

/// Maximum share of white pixels.
const MAX_WHITE_SHARE: f64 = 0.6;
/// Minimum contrast relative to normal. If the carriage moves by more than one graduation within an exposure, the phase
/// reverses, but at most 0.217 of the contrast remains (first side lobe of sin x / x), which is below this limit.
const MIN_CONTRAST_SHARE: f64 = 0.25;
/// Minimum visible share of the scale.
const MIN_VISIBLE_SHARE: f64 = 0.4;
/// Minimum length of the mean phasor of the used blocks; that of random phases is shorter.
const MIN_COHERENCE: f64 = 0.75;
/// Number of frames that define the normal contrast.
const CONTRAST_FRAMES: usize = 20;
/// Aliasing error, graduations times pitch³ in px: harmonics of the print near the sampling frequency fold back onto
/// the first. Determined with sharp, untilted pictures whose pitch is an integer number of pixels, the worst case:
/// 0.004 graduations at 5 px, 0.0005 at 10 px.
const ALIASING_ERROR: f64 = 0.5;

/// Scale of the reference frame and the data accumulated since.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    size: (usize, usize),
    upright: bool,
    map: PhaseMap,
    demodulator: Demodulator,
    /// Evaluated part of the picture: the scale with its numbers.
    window: Region,
    /// Rows in which lines are expected; numbers have other phases.
    rows: (f64, f64),
    whole: Region,
    bands: Bands,
    line_index: LineIndex,
    /// Blocks of the scale.
    members: usize,
    /// Standard deviation of the phase of the reference frame, graduations.
    reference_std: f64,
    /// Contrast of the first used frames.
    usual: Vec<f64>,
    /// Last position as a coordinate, graduations (increases if the scale moves back).
    last: f64,
    /// Number of rejected frames since the last used one.
    pub(super) missed: usize,
    pub(super) scale: Scale,
}

/// Checks illumination first.
fn check_light(strips: &Strips) -> Result<(), Rejection> {
    let level = strips.mean();
    if level < MIN_LEVEL {
        return Err(Rejection::Dark { level });
    }
    if strips.white > MAX_WHITE_SHARE {
        return Err(Rejection::Glare {
            share: strips.white,
        });
    }
    Ok(())
}

impl Reference {
    /// Reads the frame that becomes the reference.
    pub(super) fn first(
        picture: &Picture,
        options: &ReadOptions,
    ) -> Result<(Self, ScaleMeasurement, View), Rejection> {
        let found = match find::find(picture, options.region, options.upright) {
            Ok(found) => found,
            Err(reason) => {
                let part = options.region.unwrap_or_else(|| Region::whole(picture));
                if part.height >= STRIP_ROWS {
                    check_light(&Strips::of(picture, part))?;
                }
                return Err(Rejection::NoScale(reason));
            }
        };
        let uneven = || Rejection::NoScale("lines are not evenly spaced".into());
        let map = PhaseMap::fit(&found).ok_or_else(uneven)?;
        let lean_deg = map.tilt_rad().to_degrees();
        if lean_deg.abs() > MAX_TILT_DEG {
            return Err(Rejection::NoScale(format!(
                "lines are tilted by {lean_deg:.0}° (maximum {MAX_TILT_DEG}°); rotate the camera"
            )));
        }
        if map.pitch_px() < MIN_PITCH_PX * 0.95 {
            return Err(Rejection::NoScale(format!(
                "pitch of the lines is {:.1} px (minimum {MIN_PITCH_PX} px); move the camera nearer",
                map.pitch_px()
            )));
        }
        let mut reference = Self::new(picture, options, &found, map);
        // The reference frame is measured again on the grid of all later frames.
        let (reading, view) = match reference.read(picture, options) {
            Err(Rejection::Covered { .. }) => return Err(uneven()),
            read => read?,
        };
        if view.shift.coherence < MIN_COHERENCE {
            return Err(uneven());
        }
        reference.members = view.agreeing();
        reference.reference_std = reading.position_std_m / reference.scale.pitch_m;
        reference.scale.contrast = reading.contrast;
        reference.scale.lines = reading.lines;
        reference.scale.longer_every = reference.line_index.longer_every();
        let reading = ScaleMeasurement {
            position_m: 0.0,
            quality: view.shift.coherence,
            visible_share: 1.0,
            stretch: 0.0,
            ..reading
        };
        Ok((reference, reading, view))
    }

    fn new(picture: &Picture, options: &ReadOptions, found: &Found, map: PhaseMap) -> Self {
        let view = picture.lying(found.upright);
        let whole = Region::looked_at(options.region, found.upright, &view);
        Self {
            size: (picture.width(), picture.height()),
            upright: found.upright,
            demodulator: Demodulator::new(found.frequency, whole.width),
            window: search_window(found.region, whole),
            rows: line_rows(found.region),
            whole,
            bands: Bands::around(found.members(), &map),
            line_index: LineIndex::default(),
            members: found.scale.len(),
            reference_std: ALIASING_ERROR / map.pitch_px().powi(3),
            usual: Vec::new(),
            last: 0.0,
            missed: 0,
            scale: scale_of(found, &map, options),
            map,
        }
    }

    pub(super) fn read(
        &mut self,
        picture: &Picture,
        options: &ReadOptions,
    ) -> Result<(ScaleMeasurement, View), Rejection> {
        let (width, height) = (picture.width(), picture.height());
        if (width, height) != self.size {
            return Err(Rejection::Size(width, height, self.size.0, self.size.1));
        }
        let view = picture.lying(self.upright);
        let result = self.read_in(&view, self.window, options);
        // The scale may have left its original region.
        match result {
            Err(Rejection::NoScale(_) | Rejection::Covered { .. }) if self.window != self.whole => {
                let again = self.read_in(&view, self.whole, options);
                if again.is_ok() { again } else { result }
            }
            _ => result,
        }
    }

    fn read_in(
        &mut self,
        view: &Picture,
        window: Region,
        options: &ReadOptions,
    ) -> Result<(ScaleMeasurement, View), Rejection> {
        let strips = Strips::of(view, window);
        check_light(&strips)?;
        let rows = match window == self.window {
            true => self.rows,
            false => (f64::MIN, f64::MAX),
        };
        let blocks = self.demodulator.blocks(&strips);
        let strong = line_contrast(&blocks, self.members, rows);
        let lined = phase::lined(&blocks, strong, rows);
        let none = || Rejection::NoScale("no lines with the pitch of the reference frame".into());
        let shift = phase::measure(&blocks, &lined, &self.map).ok_or_else(none)?;
        let view = View {
            upright: self.upright,
            lined,
            shift,
            map: self.map.clone(),
            window,
            window_px: self.demodulator.length(),
            blocks,
        };
        let visible_share = (view.agreeing() as f64 / self.members as f64).min(1.0);
        let usual = median(self.usual.clone()).unwrap_or(strong);
        let share = strong / usual;
        let (shift, blocks) = (&view.shift, &view.blocks);
        if share < MIN_CONTRAST_SHARE {
            // Blurred lines still have consistent phases; other patterns are not lines.
            let even = shift.coherence > MIN_COHERENCE && visible_share > MIN_VISIBLE_SHARE;
            return Err(if even {
                Rejection::Blurred { share }
            } else {
                none()
            });
        }
        if visible_share < MIN_VISIBLE_SHARE {
            let left = phase::lined(blocks, usual, rows).contains(&true) && view.agreeing() > 0;
            let share = visible_share;
            return Err(if left {
                Rejection::Covered { share }
            } else {
                none()
            });
        }
        let pitch_m = self.scale.pitch_m;
        let std_m = shift.phase_std.hypot(self.reference_std) * pitch_m;
        if std_m.is_nan() || std_m > options.std_most_m {
            return Err(Rejection::Uncertain {
                std_m,
                most_m: options.std_most_m,
            });
        }
        let occluded = occlusion(blocks, &shift.agree, self.demodulator.length());
        let code = marks::read(&strips, &self.map, shift, self.bands, &occluded);
        let counted = self
            .line_index
            .count(&code, shift.phase, self.last, self.missed);
        let (whole, jumped) = counted.map_err(|steps| {
            let [nearest_m, other_m] = steps.map(|step| -step * pitch_m);
            Rejection::Ambiguous { nearest_m, other_m }
        })?;
        self.line_index.learn(&code, whole);
        self.last = shift.phase + whole as f64;
        self.missed = 0;
        if self.usual.len() < CONTRAST_FRAMES {
            self.usual.push(strong);
        }
        let reading = ScaleMeasurement {
            position_m: -self.last * pitch_m,
            position_std_m: std_m,
            quality: visible_share * shift.coherence * share.min(1.0),
            contrast: strong,
            visible_share,
            residual_m: shift.scatter * pitch_m,
            lines: visible_lines(&self.map, shift, blocks),
            stretch: shift.stretch,
            jumped,
        };
        Ok((reading, view))
    }
}

/// Returns the scale as described by the map; contrast and lines are added later.
fn scale_of(found: &Found, map: &PhaseMap, options: &ReadOptions) -> Scale {
    let (from, to) = (
        found.region.x as f64,
        (found.region.x + found.region.width) as f64,
    );
    let pitch_at = |x: f64| 1.0 / map.slope(x, map.y0).0;
    Scale {
        upright: found.upright,
        region: if found.upright {
            found.region.transposed()
        } else {
            found.region
        },
        pitch_px: map.pitch_px(),
        pitch_m: options.pitch_m.unwrap_or(DEFAULT_PITCH_M),
        tilt_rad: map.tilt_rad(),
        pitch_change_ratio: pitch_at(to) / pitch_at(from) - 1.0,
        contrast: 0.0,
        lines: 0,
        longer_every: None,
    }
}
