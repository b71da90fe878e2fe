//! Frame by frame: from a picture to how far the scale has moved.

use super::find::{self, Found, NotFound, PITCH_LEAST_PX, STRIP_ROWS, TILT_MOST_DEG};
use super::marks::{self, BEYOND, Bands, Counted, Memory};
use super::phase::{self, PhaseMap, Shift};
use super::picture::Picture;
use super::rejection::{Rejection, WrongPitch};
use super::strips::{Blocks, Demodulator, Region, Strips};

/// Distance of the lines unless another is said, mm.
pub const PITCH_MM: f64 = 0.5;
/// Darkest mean level of the region that still counts as lit, share of white.
pub(super) const DARK: f64 = 0.04;
/// Share of white pixels above which lines drown.
const GLARE: f64 = 0.6;
/// Contrast below this share of the usual is blur. A carriage that moves by more than a
/// graduation within an exposure turns the lines' phase by half a turn while at most 0.217 of
/// their contrast is left (first side lobe of sin x / x): what passes can't be that.
const BLUR: f64 = 0.25;
/// Share of the scale that must be in sight.
const SIGHT: f64 = 0.4;
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

#[derive(Debug, Clone)]
struct Reference {
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
    memory: Memory,
    members: usize,
    reference_std: f64,
    usual: Vec<f64>,
    /// Last position as a coordinate, graduations (rises where the scale moves back).
    last: f64,
    missed: usize,
    scale: Scale,
}

/// What a frame's measurement saw, for drawing.
#[derive(Debug, Clone)]
pub(crate) struct Sight {
    pub(crate) upright: bool,
    pub(crate) blocks: Blocks,
    pub(crate) lined: Vec<bool>,
    pub(crate) shift: Shift,
    pub(crate) map: PhaseMap,
    pub(crate) window: Region,
    pub(crate) strip_rows: usize,
    pub(crate) window_px: usize,
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
    fn new(picture: &Picture, options: &ReadOptions) -> Result<(Self, Sight), Rejection> {
        let found = match find::find(picture, options.region, options.upright) {
            Ok(found) => found,
            Err(NotFound(reason)) => {
                let part = options.region.unwrap_or_else(|| Region::whole(picture));
                if part.height >= STRIP_ROWS {
                    check_light(&Strips::of(picture, part, STRIP_ROWS))?;
                }
                return Err(Rejection::NoScale(reason));
            }
        };
        let turned;
        let view = if found.upright {
            turned = picture.transposed();
            &turned
        } else {
            picture
        };
        let none = |why: &str| Rejection::NoScale(why.to_owned());
        let (map, shift) =
            phase::fit_map(&found).ok_or_else(|| none("lines don't follow each other evenly"))?;
        if shift.coherence < COHERENCE {
            return Err(none("lines don't follow each other evenly"));
        }
        if map.tilt_deg().abs() > TILT_MOST_DEG {
            return Err(Rejection::NoScale(format!(
                "lines lean by {:.0}°, at most {TILT_MOST_DEG}° is read; turn the camera",
                map.tilt_deg()
            )));
        }
        if map.pitch_px() < PITCH_LEAST_PX * 0.95 {
            return Err(Rejection::NoScale(format!(
                "lines {:.1} px apart, at least {PITCH_LEAST_PX} px are needed; move the camera nearer",
                map.pitch_px()
            )));
        }
        Ok(Self::build(picture, view, options, &found, map, &shift))
    }

    fn build(
        picture: &Picture,
        view: &Picture,
        options: &ReadOptions,
        found: &Found,
        map: PhaseMap,
        shift: &Shift,
    ) -> (Self, Sight) {
        let whole = match options.region {
            Some(region) if found.upright => region.transposed(),
            Some(region) => region,
            None => Region::whole(view),
        };
        let window = room(found.region, whole);
        let demodulator = Demodulator::new(found.frequency, whole.width);
        let bands = Bands::around(&found.blocks, &found.member, &map);
        let strips = Strips::of(view, window, STRIP_ROWS);
        let blocks = demodulator.blocks(&strips);
        let strong = strong(&blocks, found.region);
        let rows = rows(found.region);
        let lined = phase::lined(&blocks, strong, rows);
        // The map's own frame is measured once more, on the grid of all later frames.
        let shift = phase::measure(&blocks, &lined, &map, false).unwrap_or_else(|| shift.clone());
        let members = shift.agree.iter().filter(|a| **a).count().max(1);
        let covered = cover(&blocks, &shift.agree, demodulator.length());
        let code = marks::read(&strips, &map, &shift, bands, &covered);
        let mut memory = Memory::default();
        memory.learn(&code, 0);
        let lines = lines_in_sight(&map, &shift, &blocks);
        let upright = found.upright;
        let (from, to) = (
            found.region.x as f64,
            (found.region.x + found.region.width) as f64,
        );
        let pitch_at = |x: f64| 1.0 / map.slope(x, map.y0).0;
        let scale = Scale {
            upright,
            region: if upright {
                found.region.transposed()
            } else {
                found.region
            },
            pitch_px: map.pitch_px(),
            pitch_mm: options.pitch_mm.unwrap_or(PITCH_MM),
            tilt_deg: map.tilt_deg(),
            pitch_change_percent: 100.0 * (pitch_at(to) / pitch_at(from) - 1.0),
            contrast: strong,
            lines,
            longer_every: memory.longer_every(),
        };
        let sight = Sight {
            upright,
            lined,
            shift: shift.clone(),
            map: map.clone(),
            window,
            strip_rows: STRIP_ROWS,
            window_px: demodulator.length(),
            blocks,
        };
        let reference = Self {
            size: (picture.width(), picture.height()),
            upright,
            demodulator,
            window,
            rows,
            whole,
            bands,
            memory,
            members,
            reference_std: shift.phase_std.hypot(FOLDING / map.pitch_px().powi(3)),
            usual: Vec::new(),
            last: shift.phase,
            missed: 0,
            scale,
            map,
        };
        (reference, sight)
    }

    fn read(
        &mut self,
        picture: &Picture,
        options: &ReadOptions,
    ) -> Result<(Reading, Sight), Rejection> {
        let (width, height) = (picture.width(), picture.height());
        if (width, height) != self.size {
            return Err(Rejection::Size(width, height, self.size.0, self.size.1));
        }
        let turned;
        let view = if self.upright {
            turned = picture.transposed();
            &turned
        } else {
            picture
        };
        let result = self.read_in(view, self.window, options);
        // The scale may have left the part it was first seen in.
        match result {
            Err(Rejection::NoScale(_) | Rejection::Covered { .. }) if self.window != self.whole => {
                let again = self.read_in(view, self.whole, options);
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
    ) -> Result<(Reading, Sight), Rejection> {
        let strips = Strips::of(view, window, STRIP_ROWS);
        check_light(&strips)?;
        let blocks = self.demodulator.blocks(&strips);
        let usual = self.usual();
        let rows = if window == self.window {
            self.rows
        } else {
            (f64::MIN, f64::MAX)
        };
        let all = phase::lined(&blocks, usual, rows);
        let strong = strongest(&blocks, self.members, rows);
        let share = strong / usual;
        let lined = phase::lined(&blocks, strong, rows);
        let none = || Rejection::NoScale("no lines at the distance of the reference frame".into());
        let shift = phase::measure(&blocks, &lined, &self.map, false).ok_or_else(none)?;
        let agree = shift.agree.iter().filter(|a| **a).count();
        let in_sight = (agree as f64 / self.members as f64).min(1.0);
        if share < BLUR {
            // Blurred lines still follow each other; anything else is no line.
            let even = shift.coherence > COHERENCE && in_sight > SIGHT;
            return Err(if even {
                Rejection::Blurred { share }
            } else {
                none()
            });
        }
        if in_sight < SIGHT {
            let left = all.iter().filter(|l| **l).count();
            return Err(if left == 0 || agree == 0 {
                none()
            } else {
                Rejection::Covered { share: in_sight }
            });
        }
        let pitch_mm = self.scale.pitch_mm;
        let std_mm = shift.phase_std.hypot(self.reference_std) * pitch_mm;
        if std_mm.is_nan() || std_mm > options.std_most_mm {
            return Err(Rejection::Unsure {
                std_mm,
                most_mm: options.std_most_mm,
            });
        }
        let covered = cover(&blocks, &shift.agree, self.demodulator.length());
        let code = marks::read(&strips, &self.map, &shift, self.bands, &covered);
        let (whole, jumped) = match self
            .memory
            .count(&code, shift.phase, self.last, self.missed)
        {
            Counted::Graduations { whole, jumped } => (whole, jumped),
            Counted::Ambiguous { nearest, other } => {
                return Err(Rejection::Ambiguous {
                    nearest_mm: -nearest * pitch_mm,
                    other_mm: -other * pitch_mm,
                });
            }
        };
        self.memory.learn(&code, whole);
        let lines = lines_in_sight(&self.map, &shift, &blocks);
        self.last = shift.phase + whole as f64;
        self.missed = 0;
        if self.usual.len() < USUAL_FRAMES {
            self.usual.push(strong);
        }
        let reading = Reading {
            position_mm: -self.last * pitch_mm,
            position_std_mm: std_mm,
            quality: in_sight * shift.coherence * share.min(1.0),
            contrast: strong,
            in_sight,
            residual_mm: shift.scatter * pitch_mm,
            lines,
            stretch: shift.stretch,
            jumped,
        };
        let sight = Sight {
            upright: self.upright,
            lined,
            shift,
            map: self.map.clone(),
            window,
            strip_rows: STRIP_ROWS,
            window_px: self.demodulator.length(),
            blocks,
        };
        Ok((reading, sight))
    }

    /// Median contrast of the first frames used.
    fn usual(&self) -> f64 {
        let mut usual = self.usual.clone();
        usual.sort_unstable_by(f64::total_cmp);
        usual[usual.len() / 2]
    }
}

/// Whether a change of pitch should be told.
pub(crate) fn stretched(reading: &Reading) -> bool {
    reading.stretch.abs() > STRETCH_TOLD
}

/// The scale with room to wander across, all along.
fn room(region: Region, whole: Region) -> Region {
    let margin = ((region.height as f64 * BEYOND) as usize).max(3 * STRIP_ROWS);
    let y = region.y.saturating_sub(margin).max(whole.y);
    Region {
        x: whole.x,
        y,
        width: whole.width,
        height: (region.y + region.height + margin).min(whole.y + whole.height) - y,
    }
}

/// Rows of the lines with a little room to wander across.
fn rows(region: Region) -> (f64, f64) {
    let margin = (region.height as f64 / 8.0).max(STRIP_ROWS as f64);
    let top = region.y as f64;
    (top - margin, top + region.height as f64 + margin)
}

/// Contrast of the reference frame's strong blocks: those within the scale's box.
fn strong(blocks: &Blocks, region: Region) -> f64 {
    let inside = |x: f64, y: f64| {
        x >= region.x as f64
            && x <= (region.x + region.width) as f64
            && y >= region.y as f64
            && y <= (region.y + region.height) as f64
    };
    let mut contrasts: Vec<f64> = blocks
        .all
        .iter()
        .filter(|b| inside(b.x, b.y))
        .map(|b| b.contrast())
        .collect();
    quantile(&mut contrasts, 0.8)
}

/// Contrast that a fifth of as many blocks as the scale has exceed.
fn strongest(blocks: &Blocks, members: usize, rows: (f64, f64)) -> f64 {
    let mut contrasts: Vec<f64> = blocks
        .all
        .iter()
        .filter(|b| b.y >= rows.0 && b.y <= rows.1)
        .map(|b| b.contrast())
        .collect();
    let share = 0.2 * members as f64 / contrasts.len().max(1) as f64;
    quantile(&mut contrasts, 1.0 - share)
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let place = (share.clamp(0.0, 1.0) * (values.len() - 1) as f64).round() as usize;
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Whether the scale is covered at a column: in a window that reaches there fewer than two thirds
/// of the usual number of strips agree.
fn cover(blocks: &Blocks, agree: &[bool], window_px: usize) -> impl Fn(f64) -> bool + use<> {
    let count: Vec<usize> = (0..blocks.windows)
        .map(|w| {
            (0..blocks.strips)
                .filter(|s| agree[s * blocks.windows + w])
                .count()
        })
        .collect();
    let mut sorted: Vec<usize> = count.iter().copied().filter(|c| *c > 0).collect();
    sorted.sort_unstable();
    let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(usize::MAX);
    let reach = window_px as f64 / 2.0;
    let middle: Vec<f64> = (0..blocks.windows).map(|w| blocks.at(0, w).x).collect();
    let ends = (
        middle.first().copied().unwrap_or(0.0),
        middle.last().copied().unwrap_or(0.0),
    );
    move |x| {
        // Beyond the last window's middle there is only that one.
        let x = x.clamp(ends.0, ends.1);
        middle
            .iter()
            .zip(&count)
            .filter(|(m, _)| (*m - x).abs() < 1.25 * reach)
            .any(|(_, count)| 3 * count < 2 * usual)
    }
}

/// Lines between the outermost blocks that agree.
fn lines_in_sight(map: &PhaseMap, shift: &Shift, blocks: &Blocks) -> usize {
    let (mut left, mut right) = (f64::MAX, f64::MIN);
    for (block, _) in blocks.all.iter().zip(&shift.agree).filter(|(_, a)| **a) {
        left = left.min(block.x);
        right = right.max(block.x);
    }
    if left > right {
        return 0;
    }
    marks::places(map, shift, left, right).len()
}
