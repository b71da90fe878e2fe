//! The frame a series is measured against, and every later frame held against it.

use super::find::{self, Found, PITCH_LEAST_PX, TILT_MOST_DEG};
use super::line_index::LineIndex;
use super::marks::{self, Bands};
use super::phase;
use super::phase_map::PhaseMap;
use super::picture::Picture;
use super::reading::{PITCH_M, ReadOptions, Reading, Scale};
use super::rejection::{DARK, Rejection};
use super::robust::median;
use super::strips::{Demodulator, Region, STRIP_ROWS, Strips};
use super::visibility::{View, line_contrast, line_rows, occlusion, search_window, visible_lines};

/// Share of white pixels above which lines drown.
const GLARE: f64 = 0.6;
/// Contrast below this share of the usual is blur. A carriage that moves by more than a
/// graduation within an exposure turns the lines' phase by half a turn while at most 0.217 of
/// their contrast is left (first side lobe of sin x / x): what passes can't be that.
const BLUR: f64 = 0.25;
/// Share of the scale that must be visible.
const VISIBLE: f64 = 0.4;
/// Phases of the blocks that are used must agree to this: the mean phasor of random ones is
/// shorter.
const COHERENCE: f64 = 0.75;
/// Frames over which the usual contrast is taken.
const USUAL_FRAMES: usize = 20;
/// What pixels as large as a line's width leave, graduations times the pitch's third power: the
/// print's harmonics next to the sampling frequency fold back onto the first. Found with sharp
/// pictures whose pitch is a whole number of pixels and which don't lean, the worst case: 0.004
/// graduations at 5 px, 0.0005 at 10 px.
const FOLDING: f64 = 0.5;

/// The reference frame's scale, and what has been learned since.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    size: (usize, usize),
    upright: bool,
    map: PhaseMap,
    demodulator: Demodulator,
    /// Part of the picture that is looked at: the scale with the numbers beside it.
    window: Region,
    /// Rows in which lines are expected: numbers have phases of their own.
    rows: (f64, f64),
    whole: Region,
    bands: Bands,
    line_index: LineIndex,
    /// Blocks of the scale.
    members: usize,
    /// Standard deviation of the reference frame's own phase, graduations.
    reference_std: f64,
    /// Contrast of the first frames used.
    usual: Vec<f64>,
    /// Last position as a coordinate, graduations (rises where the scale moves back).
    last: f64,
    /// Frames without a reading since the last one with.
    pub(super) missed: usize,
    pub(super) scale: Scale,
}

/// Darkness and glare, before anything else is blamed.
fn check_light(strips: &Strips) -> Result<(), Rejection> {
    let level = strips.mean();
    if level < DARK {
        return Err(Rejection::Dark { level });
    }
    if strips.white > GLARE {
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
    ) -> Result<(Self, Reading, View), Rejection> {
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
        let uneven = || Rejection::NoScale("lines don't follow each other evenly".into());
        let map = PhaseMap::fit(&found).ok_or_else(uneven)?;
        let lean_deg = map.tilt_rad().to_degrees();
        if lean_deg.abs() > TILT_MOST_DEG {
            return Err(Rejection::NoScale(format!(
                "lines lean by {lean_deg:.0}°, at most {TILT_MOST_DEG}° is read; turn the camera"
            )));
        }
        if map.pitch_px() < PITCH_LEAST_PX * 0.95 {
            return Err(Rejection::NoScale(format!(
                "lines {:.1} px apart, at least {PITCH_LEAST_PX} px are needed; move the camera nearer",
                map.pitch_px()
            )));
        }
        let mut reference = Self::new(picture, options, &found, map);
        // The map's own frame is measured once more, on the grid of all later frames.
        let (reading, view) = match reference.read(picture, options) {
            Err(Rejection::Covered { .. }) => return Err(uneven()),
            read => read?,
        };
        if view.shift.coherence < COHERENCE {
            return Err(uneven());
        }
        reference.members = view.agreeing();
        reference.reference_std = reading.position_deviation_m / reference.scale.pitch_m;
        reference.scale.contrast = reading.contrast;
        reference.scale.lines = reading.lines;
        reference.scale.longer_every = reference.line_index.longer_every();
        let reading = Reading {
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
            reference_std: FOLDING / map.pitch_px().powi(3),
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
    ) -> Result<(Reading, View), Rejection> {
        let (width, height) = (picture.width(), picture.height());
        if (width, height) != self.size {
            return Err(Rejection::Size(width, height, self.size.0, self.size.1));
        }
        let view = picture.lying(self.upright);
        let result = self.read_in(&view, self.window, options);
        // The scale may have left the part it was first seen in.
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
    ) -> Result<(Reading, View), Rejection> {
        let strips = Strips::of(view, window);
        check_light(&strips)?;
        let rows = match window == self.window {
            true => self.rows,
            false => (f64::MIN, f64::MAX),
        };
        let blocks = self.demodulator.blocks(&strips);
        let strong = line_contrast(&blocks, self.members, rows);
        let lined = phase::lined(&blocks, strong, rows);
        let none = || Rejection::NoScale("no lines at the distance of the reference frame".into());
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
        if share < BLUR {
            // Blurred lines still follow each other; anything else is no line.
            let even = shift.coherence > COHERENCE && visible_share > VISIBLE;
            return Err(if even {
                Rejection::Blurred { share }
            } else {
                none()
            });
        }
        if visible_share < VISIBLE {
            let left = phase::lined(blocks, usual, rows).contains(&true) && view.agreeing() > 0;
            let share = visible_share;
            return Err(if left {
                Rejection::Covered { share }
            } else {
                none()
            });
        }
        let pitch_m = self.scale.pitch_m;
        let deviation_m = shift.phase_std.hypot(self.reference_std) * pitch_m;
        if deviation_m.is_nan() || deviation_m > options.deviation_most_m {
            return Err(Rejection::Unsure {
                deviation_m,
                most_m: options.deviation_most_m,
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
        if self.usual.len() < USUAL_FRAMES {
            self.usual.push(strong);
        }
        let reading = Reading {
            position_m: -self.last * pitch_m,
            position_deviation_m: deviation_m,
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

/// The scale as the map describes it; contrast and lines are still to come.
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
        pitch_m: options.pitch_m.unwrap_or(PITCH_M),
        tilt_rad: map.tilt_rad(),
        pitch_change_ratio: pitch_at(to) / pitch_at(from) - 1.0,
        contrast: 0.0,
        lines: 0,
        longer_every: None,
    }
}
