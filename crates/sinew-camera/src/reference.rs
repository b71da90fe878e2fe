//! The frame a series is measured against, and every later frame held against it.

use super::find::{self, Found, PITCH_LEAST_PX, TILT_MOST_DEG};
use super::fit_phase_map::fit_phase_map;
use super::line_index::{Counted, LineIndex};
use super::marks::{self, Bands, Code};
use super::phase::{self, Shift};
use super::phase_map::PhaseMap;
use super::picture::Picture;
use super::reading::{PITCH_M, ReadOptions, Reading, Scale};
use super::rejection::{DARK, Rejection};
use super::robust::median;
use super::strips::{Blocks, Demodulator, Region, STRIP_ROWS, Strips};
use super::visibility::{
    View, line_contrast, line_rows, occlusion, scale_contrast, search_window, visible_lines,
};

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
    members: usize,
    /// Standard deviation of the reference frame's own phase, graduations.
    pub(super) reference_std: f64,
    /// Contrast of the first frames used.
    pub(super) usual: Vec<f64>,
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
    pub(super) fn new(picture: &Picture, options: &ReadOptions) -> Result<(Self, View), Rejection> {
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
        let view = picture.lying(found.upright);
        let none = |why: &str| Rejection::NoScale(why.to_owned());
        let (map, shift) =
            fit_phase_map(&found).ok_or_else(|| none("lines don't follow each other evenly"))?;
        if shift.coherence < COHERENCE {
            return Err(none("lines don't follow each other evenly"));
        }
        if map.tilt_rad().to_degrees().abs() > TILT_MOST_DEG {
            return Err(Rejection::NoScale(format!(
                "lines lean by {:.0}°, at most {TILT_MOST_DEG}° is read; turn the camera",
                map.tilt_rad().to_degrees()
            )));
        }
        if map.pitch_px() < PITCH_LEAST_PX * 0.95 {
            return Err(Rejection::NoScale(format!(
                "lines {:.1} px apart, at least {PITCH_LEAST_PX} px are needed; move the camera nearer",
                map.pitch_px()
            )));
        }
        Ok(Self::build(picture, &view, options, &found, map, &shift))
    }

    fn build(
        picture: &Picture,
        view: &Picture,
        options: &ReadOptions,
        found: &Found,
        map: PhaseMap,
        shift: &Shift,
    ) -> (Self, View) {
        let whole = match options.region {
            Some(region) if found.upright => region.transposed(),
            Some(region) => region,
            None => Region::whole(view),
        };
        let window = search_window(found.region, whole);
        let demodulator = Demodulator::new(found.frequency, whole.width);
        let bands = Bands::around(&found.blocks, &found.member, &map);
        let strips = Strips::of(view, window);
        let blocks = demodulator.blocks(&strips);
        let strong = scale_contrast(&blocks, found.region);
        let rows = line_rows(found.region);
        let lined = phase::lined(&blocks, strong, rows);
        // The map's own frame is measured once more, on the grid of all later frames.
        let shift = phase::measure(&blocks, &lined, &map, false).unwrap_or_else(|| shift.clone());
        let members = shift.agree.iter().filter(|a| **a).count().max(1);
        let occluded = occlusion(&blocks, &shift.agree, demodulator.length());
        let code = marks::read(&strips, &map, &shift, bands, &occluded);
        let mut line_index = LineIndex::default();
        line_index.learn(&code, 0);
        let mut scale = scale_of(found, &map, options);
        scale.contrast = strong;
        scale.lines = visible_lines(&map, &shift, &blocks);
        scale.longer_every = line_index.longer_every();
        let reference = Self {
            size: (picture.width(), picture.height()),
            upright: found.upright,
            demodulator,
            window,
            rows,
            whole,
            bands,
            line_index,
            members,
            reference_std: shift.phase_std.hypot(FOLDING / map.pitch_px().powi(3)),
            usual: Vec::new(),
            last: shift.phase,
            missed: 0,
            scale,
            map,
        };
        let view = reference.view(window, blocks, lined, shift);
        (reference, view)
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
        let blocks = self.demodulator.blocks(&strips);
        let measured = self.measure(&blocks, window)?;
        let shift = &measured.shift;
        let pitch_m = self.scale.pitch_m;
        let deviation_m = shift.phase_std.hypot(self.reference_std) * pitch_m;
        if deviation_m.is_nan() || deviation_m > options.deviation_most_m {
            return Err(Rejection::Unsure {
                deviation_m,
                most_m: options.deviation_most_m,
            });
        }
        let occluded = occlusion(&blocks, &shift.agree, self.demodulator.length());
        let code = marks::read(&strips, &self.map, shift, self.bands, &occluded);
        let (whole, jumped) = self.count(&code, shift.phase)?;
        self.line_index.learn(&code, whole);
        self.last = shift.phase + whole as f64;
        self.missed = 0;
        if self.usual.len() < USUAL_FRAMES {
            self.usual.push(measured.strong);
        }
        let reading = Reading {
            position_m: -self.last * pitch_m,
            position_deviation_m: deviation_m,
            quality: measured.visible_share * shift.coherence * measured.share.min(1.0),
            contrast: measured.strong,
            visible_share: measured.visible_share,
            residual_m: shift.scatter * pitch_m,
            lines: visible_lines(&self.map, shift, &blocks),
            stretch: shift.stretch,
            jumped,
        };
        let view = self.view(window, blocks, measured.lined, measured.shift);
        Ok((reading, view))
    }

    /// Phase of a frame's blocks against the map, or why it can't be trusted.
    fn measure(&self, blocks: &Blocks, window: Region) -> Result<Measured, Rejection> {
        let usual = self.usual();
        let rows = if window == self.window {
            self.rows
        } else {
            (f64::MIN, f64::MAX)
        };
        let strong = line_contrast(blocks, self.members, rows);
        let share = strong / usual;
        let lined = phase::lined(blocks, strong, rows);
        let none = || Rejection::NoScale("no lines at the distance of the reference frame".into());
        let shift = phase::measure(blocks, &lined, &self.map, false).ok_or_else(none)?;
        let agree = shift.agree.iter().filter(|a| **a).count();
        let visible_share = (agree as f64 / self.members as f64).min(1.0);
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
            let left = phase::lined(blocks, usual, rows).contains(&true);
            return Err(if left && agree > 0 {
                Rejection::Covered {
                    share: visible_share,
                }
            } else {
                none()
            });
        }
        Ok(Measured {
            lined,
            shift,
            strong,
            share,
            visible_share,
        })
    }

    /// Whole graduations to add to a phase, and whether they were counted by the longer lines.
    fn count(&self, code: &Code, phase: f64) -> Result<(i64, bool), Rejection> {
        match self.line_index.count(code, phase, self.last, self.missed) {
            Counted::Graduations { whole, jumped } => Ok((whole, jumped)),
            Counted::Ambiguous { nearest, other } => Err(Rejection::Ambiguous {
                nearest_m: -nearest * self.scale.pitch_m,
                other_m: -other * self.scale.pitch_m,
            }),
        }
    }

    fn view(&self, window: Region, blocks: Blocks, lined: Vec<bool>, shift: Shift) -> View {
        View {
            upright: self.upright,
            lined,
            shift,
            map: self.map.clone(),
            window,
            window_px: self.demodulator.length(),
            blocks,
        }
    }

    /// Median contrast of the first frames used.
    fn usual(&self) -> f64 {
        median(self.usual.clone()).unwrap_or(0.0)
    }
}

/// A frame's phase with what it rests on.
struct Measured {
    lined: Vec<bool>,
    shift: Shift,
    /// Contrast of the strong blocks.
    strong: f64,
    /// The same over the usual.
    share: f64,
    /// Share of the reference frame's blocks that agree.
    visible_share: f64,
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
