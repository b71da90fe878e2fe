//! Which line is which: the longer lines and the numbers as a code.
//!
//! The phase repeats at every graduation. How dark each line is in twelve bands across the scale
//! tells lines of different lengths apart, and the numbers print on some of them.

use super::map::PhaseMap;
use super::phase::Shift;
use super::strips::{Blocks, Strips};

/// Bands across the scale.
const BANDS: usize = 12;
/// Points from line to line at which each band is looked at: the numbers' strokes are a third of
/// a graduation wide.
const POINTS: usize = 4;
/// Values that describe a line.
pub(super) const VALUES: usize = BANDS * POINTS;
/// Longest lines and numbers stand out: bands reach beyond the rows with many lines by this share
/// of their height.
pub(crate) const BEYOND: f64 = 1.0;
/// Half of the width whose mean level a line is compared with, graduations: a whole one holds one
/// line wherever it begins.
const NEIGHBOURHOOD: f64 = 1.5;

/// Level at and between lines in each band, relative to the neighbourhood; NaN beyond the picture.
pub(super) type Line = [f32; VALUES];

/// Lines of one frame, in order; `None` where the line is covered.
#[derive(Debug, Clone)]
pub(crate) struct Code {
    /// Number of the first line, in the map's coordinate moved on by the fraction.
    pub(super) first: i64,
    pub(super) lines: Vec<Option<Line>>,
}

/// Where across the scale the bands lie, px from the map's middle line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bands {
    from: f64,
    to: f64,
}

impl Bands {
    /// Around the blocks that belong to the scale.
    pub(crate) fn around(blocks: &Blocks, member: &[bool], map: &PhaseMap) -> Self {
        let (sin, cos) = map.tilt_deg().to_radians().sin_cos();
        let mut across: Vec<f64> = blocks
            .all
            .iter()
            .zip(member)
            .filter(|(_, m)| **m)
            .map(|(b, _)| (b.y - map.y0) * cos - (b.x - map.x0) * sin)
            .collect();
        across.sort_unstable_by(f64::total_cmp);
        let share = |p: f64| across[((across.len() - 1) as f64 * p).round() as usize];
        if across.is_empty() {
            return Self { from: 0.0, to: 0.0 };
        }
        let (from, to) = (share(0.02), share(0.98));
        let beyond = BEYOND * (to - from) + 4.0;
        Self {
            from: from - beyond,
            to: to + beyond,
        }
    }
}

/// Lines found in a frame, for the code and for drawing: place of the line's middle and its number
/// before whole graduations are counted.
pub(crate) fn places(map: &PhaseMap, shift: &Shift, left: f64, right: f64) -> Vec<(i64, f64, f64)> {
    let tan = map.tilt_deg().to_radians().tan();
    let y_at = |x: f64| map.y0 + tan * (x - map.x0);
    let at = |x: f64| map.at(x, y_at(x)) + shift.phase + shift.du * (map.at_u(x));
    let (low, high) = (at(left), at(right));
    let mut out = Vec::new();
    let mut x = left;
    for number in low.ceil() as i64..=high.floor() as i64 {
        // Newton from the line before: the map is nearly straight.
        for _ in 0..4 {
            let y = y_at(x);
            let (a, b) = map.slope(x, y);
            let step = (number as f64 - at(x)) / (a + b * tan);
            x += step;
            if step.abs() < 1e-3 {
                break;
            }
        }
        if !(left - 1.0..=right + 1.0).contains(&x) {
            break;
        }
        out.push((number, x, y_at(x)));
    }
    out
}

/// Reads the code of a frame.
pub(crate) fn read(
    strips: &Strips,
    map: &PhaseMap,
    shift: &Shift,
    bands: Bands,
    covered: &dyn Fn(f64) -> bool,
) -> Code {
    let region = strips.region;
    let (left, right) = (region.x as f64, (region.x + region.width) as f64 - 1.0);
    let (sin, cos) = map.tilt_deg().to_radians().sin_cos();
    let places = places(map, shift, left, right);
    let pitch = map.pitch_px();
    if strips.count < 2 {
        return Code {
            first: 0,
            lines: Vec::new(),
        };
    }
    let half_line = (0.12 * pitch).max(0.75);
    let height = (bands.to - bands.from) / BANDS as f64;
    // One look per strip in a band.
    let looks = (height / strips.rows as f64).ceil().max(1.0) as usize;
    let mut code = Code {
        first: places.first().map_or(0, |p| p.0),
        lines: Vec::with_capacity(places.len()),
    };
    for &(_, x, y) in &places {
        if covered(x) {
            code.lines.push(None);
            continue;
        }
        let mut line = [0.0_f32; VALUES];
        let mut cut = false;
        for band in 0..BANDS {
            let mut sums = [0.0; POINTS];
            let mut count = 0.0;
            for look in 0..looks {
                let across =
                    bands.from + height * (band as f64 + (look as f64 + 0.5) / looks as f64);
                let (px, py) = (x - across * sin, y + across * cos);
                let place = (py - region.y as f64 + 0.5) / strips.rows as f64 - 0.5;
                if place < 0.0 || place > strips.count as f64 - 1.0 {
                    continue;
                }
                // Between two strips each has its share.
                let above = (place as usize).min(strips.count - 2);
                for (strip, share) in [
                    (above, 1.0 - (place - above as f64)),
                    (above + 1, place - above as f64),
                ] {
                    let levels = strips.strip(strip);
                    // A strip's lines lean away from where its middle row has them.
                    let lean = (strips.y(strip) - py) * sin / cos;
                    let at = px - lean - left;
                    let around = level(levels, at, NEIGHBOURHOOD * pitch);
                    // A line of which the picture's side cuts a part is not compared.
                    cut |= around.is_nan();
                    let scale = share / around.max(0.5 / 255.0);
                    for (point, sum) in sums.iter_mut().enumerate() {
                        let shift = point as f64 / POINTS as f64 * pitch;
                        *sum += scale * level(levels, at + shift, half_line) - share;
                    }
                }
                count += 1.0;
            }
            for (point, sum) in sums.iter().enumerate() {
                line[band * POINTS + point] = (sum / count) as f32;
            }
        }
        code.lines.push((!cut).then_some(line));
    }
    code
}

/// Mean level over `x ± half`, pixels in part counted in part; NaN beyond the edge.
fn level(levels: &[f32], x: f64, half: f64) -> f64 {
    // Pixel `i` reaches from i − ½ to i + ½.
    let (from, to) = (x - half + 0.5, x + half + 0.5);
    if from < 0.0 || to >= levels.len() as f64 {
        return f64::NAN;
    }
    let (first, last) = (from as usize, to as usize);
    let part = |i: usize| {
        let (low, high) = (from.max(i as f64), to.min(i as f64 + 1.0));
        (high - low) * f64::from(levels[i])
    };
    (first..=last).map(part).sum::<f64>() / (to - from)
}
