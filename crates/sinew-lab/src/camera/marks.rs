//! Which line is which: the longer lines and the numbers as a code.
//!
//! The phase repeats at every graduation. How dark each line is in twelve bands across the scale
//! tells lines of different lengths apart, and the numbers print on some of them. These values are
//! kept for every line ever seen. A new frame's lines are laid beside them at every offset; where
//! they fit best is how many whole graduations the scale has moved, whatever happened between the
//! frames.

use super::phase::{PhaseMap, Shift};
use super::strips::{Blocks, Strips};

/// Bands across the scale.
const BANDS: usize = 12;
/// Points from line to line at which each band is looked at: the numbers' strokes are a third of
/// a graduation wide.
const POINTS: usize = 4;
/// Values that describe a line.
const VALUES: usize = BANDS * POINTS;
/// Longest lines and numbers stand out: bands reach beyond the rows with many lines by this share
/// of their height.
pub(crate) const BEYOND: f64 = 1.0;
/// Share of the lines in sight that must overlap for an offset to be judged, and their number.
const OVERLAP: f64 = 0.5;
const OVERLAP_LEAST: usize = 6;
/// Half of the width whose mean level a line is compared with, graduations: a whole one holds one
/// line wherever it begins.
const NEIGHBOURHOOD: f64 = 1.5;
/// An offset at which the code differs by less, in units of its spread, may be the right one; noise
/// and dirt add what they add to the best. In
/// drawn scales the right one differs by 0.001 to 0.03, one with wrong numbers by 0.03 to 0.06, one
/// with wrong lengths by 0.2 to 1.
const FITS: f64 = 0.1;
const FITS_NOISE: f64 = 1.2;
/// A code that differs by more at the best offset is not the one that is remembered.
const KNOWN: f64 = 0.4;
/// Up to this step, graduations, the nearest offset that fits is taken, for lines of different
/// lengths tell it from its neighbours: unless the numbers say clearly that it is a multiple of
/// 10 mm elsewhere, where the difference is less than this share.
const STEP_SURE: f64 = 5.0;
const ELSEWHERE: f64 = 0.45;
/// Otherwise the best offset must differ by less than this share of any other's difference...
const CLEARLY: f64 = 0.6;
/// ...unless that step is this many times as long...
const FARTHER: f64 = 4.0;
/// ...and few lines make a small difference less sure.
const FEW_LINES: f64 = 0.15;
/// A line that differs by more from what is remembered is not learned: something covers it.
const STRANGE: f32 = 0.3;
/// Spread of the lines about their mean, relative darkness, below which all lines look alike: the
/// longer lines of a faint print have 0.05.
const SPREAD_LEAST: f64 = 0.01;
/// A period at which half of the code repeats.
const REPEATS: f64 = 0.5;
/// Without a code a step must stay this far within half a graduation, graduations.
pub(crate) const STEP_MOST: f64 = 0.4;
/// Frames a line's value is averaged over.
const MEMORY: f32 = 20.0;

/// Level at and between lines in each band, relative to the neighbourhood; NaN beyond the picture.
type Line = [f32; VALUES];

/// Lines of one frame, in order; `None` where the line is covered.
#[derive(Debug, Clone)]
pub(crate) struct Code {
    /// Number of the first line, in the map's coordinate moved on by the fraction.
    first: i64,
    lines: Vec<Option<Line>>,
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

/// How many whole graduations were counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Counted {
    /// Number of graduations, and whether the code was needed: the step was longer than half a
    /// graduation, or too long to count without.
    Graduations {
        /// Whole graduations.
        whole: i64,
        /// Nearest to the last frame was not it.
        jumped: bool,
    },
    /// Two numbers fit as well, or there is no code and the step is too long.
    Ambiguous {
        /// Step to the nearest candidate, graduations.
        nearest: f64,
        /// Step to the next.
        other: f64,
    },
}

/// Every line seen so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Memory {
    first: i64,
    lines: Vec<Option<(Line, f32)>>,
}

impl Memory {
    /// Adds a frame's lines, `whole` graduations on.
    pub(crate) fn learn(&mut self, code: &Code, whole: i64) {
        if code.lines.is_empty() {
            return;
        }
        let first = code.first + whole;
        if self.lines.is_empty() {
            self.first = first;
        }
        let before = (self.first - first).max(0) as usize;
        if before > 0 {
            self.lines.splice(0..0, std::iter::repeat_n(None, before));
            self.first = first;
        }
        let offset = (first - self.first) as usize;
        if self.lines.len() < offset + code.lines.len() {
            self.lines.resize(offset + code.lines.len(), None);
        }
        let spread = self.spread();
        let strange = self.differences(code, whole, spread.max(SPREAD_LEAST * SPREAD_LEAST));
        for (i, (line, held)) in code.lines.iter().zip(&mut self.lines[offset..]).enumerate() {
            let Some(line) = line else { continue };
            if strange.as_ref().is_some_and(|d| d[i] > STRANGE) {
                continue;
            }
            match held {
                None => *held = Some((*line, 1.0)),
                Some((mean, count)) => {
                    *count = (*count + 1.0).min(MEMORY);
                    for (mean, value) in mean.iter_mut().zip(line) {
                        if mean.is_nan() {
                            *mean = *value;
                        } else if value.is_finite() {
                            *mean += (value - *mean) / *count;
                        }
                    }
                }
            }
        }
    }

    /// How much each line differs from the remembered one, `whole` graduations on: mean square in
    /// units of `spread`, at most 1; NaN where there is nothing to compare. `None` where too few
    /// lines overlap.
    fn differences(&self, code: &Code, whole: i64, spread: f64) -> Option<Vec<f32>> {
        let start = code.first + whole - self.first;
        let (skip, offset) = ((-start).max(0) as usize, start.max(0) as usize);
        if skip >= code.lines.len() || offset >= self.lines.len() {
            return None;
        }
        let scale = 1.0 / spread as f32;
        let mut out = vec![f32::NAN; code.lines.len()];
        let mut compared = 0;
        for ((line, held), out) in code.lines[skip..]
            .iter()
            .zip(&self.lines[offset..])
            .zip(&mut out[skip..])
        {
            if let (Some(a), Some((b, _))) = (line, held) {
                let (mut sum, mut count) = (0.0_f32, 0.0_f32);
                for k in 0..VALUES {
                    let d = a[k] - b[k];
                    // NaN compares false.
                    let both = d.abs() <= f32::MAX;
                    sum += if both { d * d } else { 0.0 };
                    count += if both { 1.0 } else { 0.0 };
                }
                if count >= VALUES as f32 / 2.0 {
                    *out = (scale * sum / count).min(1.0);
                    compared += 1;
                }
            }
        }
        let seen = code.lines.iter().filter(|l| l.is_some()).count();
        (compared >= ((OVERLAP * seen as f64) as usize).max(OVERLAP_LEAST)).then_some(out)
    }

    /// Mean square spread of the remembered lines about the mean of each band.
    fn spread(&self) -> f64 {
        let mut sums = [[0.0_f64; VALUES]; 3];
        for (line, _) in self.lines.iter().flatten() {
            for k in 0..VALUES {
                if line[k].is_finite() {
                    let v = f64::from(line[k]);
                    sums[0][k] += 1.0;
                    sums[1][k] += v;
                    sums[2][k] += v * v;
                }
            }
        }
        let used = || (0..VALUES).filter(|k| sums[0][*k] > 0.0);
        let variance = |k: usize| {
            let n: f64 = sums[0][k];
            sums[2][k] / n - (sums[1][k] / n).powi(2)
        };
        used().map(variance).sum::<f64>() / used().count().max(1) as f64
    }

    /// Counts whole graduations. `fraction` is the phase's part of the position, `last` the last
    /// position, both in graduations; `missed` frames lie between.
    pub(crate) fn count(&self, code: &Code, fraction: f64, last: f64, missed: usize) -> Counted {
        let nearest = (last - fraction).round() as i64;
        let step = |whole: i64| fraction + whole as f64 - last;
        let next = nearest + if step(nearest) < 0.0 { 1 } else { -1 };
        match self.choose(code, fraction, last) {
            None if step(nearest).abs() <= STEP_MOST / (1.0 + missed as f64) => {
                Counted::Graduations {
                    whole: nearest,
                    jumped: false,
                }
            }
            None => Counted::Ambiguous {
                nearest: step(nearest),
                other: step(next),
            },
            Some((first, Some(rival))) => Counted::Ambiguous {
                nearest: step(first),
                other: step(rival),
            },
            Some((first, None)) => Counted::Graduations {
                whole: first,
                jumped: first != nearest,
            },
        }
    }

    /// The offset the code speaks for, and one it can't be told from; `None` where it says nothing.
    fn choose(&self, code: &Code, fraction: f64, last: f64) -> Option<(i64, Option<i64>)> {
        let spread = self.spread();
        if spread < SPREAD_LEAST * SPREAD_LEAST {
            return None;
        }
        let step = |whole: i64| (fraction + whole as f64 - last).abs();
        let nearest = (last - fraction).round() as i64;
        let reach = (code.lines.len() + self.lines.len()) as i64;
        // Difference of each offset that fits; infinite where lines in common are missing.
        let mut open: Vec<(i64, f64, f64)> = (nearest - reach..=nearest + reach)
            .map(|whole| match self.differences(code, whole, spread) {
                None => (whole, f64::INFINITY, f64::INFINITY),
                Some(d) => {
                    let (mean, count) = mean(&d);
                    (whole, mean, mean + FEW_LINES / count)
                }
            })
            .collect();
        let best = open.iter().map(|o| o.2).fold(f64::INFINITY, f64::min);
        if best > KNOWN {
            return None;
        }
        open.retain(|o| o.1 < FITS + FITS_NOISE * best || o.1.is_infinite());
        open.sort_by(|a, b| step(a.0).total_cmp(&step(b.0)));
        let first = *open.iter().find(|o| o.1.is_finite())?;
        let near = |of: i64| {
            open.iter()
                .find(|o| o.0 != of && step(o.0) < step(of) + 2.0 * STEP_MOST)
                .map(|o| o.0)
        };
        let best = *open.iter().min_by(|a, b| a.2.total_cmp(&b.2))?;
        let elsewhere = if step(first.0) <= STEP_SURE {
            best.2 < ELSEWHERE * first.1
        } else if step(first.0) <= 2.0 * STEP_SURE {
            best.2 < CLEARLY * first.2
        } else {
            best.0 != first.0
        };
        if !elsewhere {
            return Some((first.0, near(first.0)));
        }
        let equal = open
            .iter()
            .filter(|o| o.0 != best.0 && o.1.is_finite())
            .filter(|o| step(o.0) < FARTHER * step(best.0))
            .find(|o| best.2 > CLEARLY * o.2);
        Some((best.0, equal.map(|o| o.0)))
    }

    /// Distance of the longer lines in graduations: the smallest of 2, 4, 5, 10, 20 at which the
    /// code repeats. `None` where all lines look alike.
    pub(crate) fn longer_every(&self) -> Option<usize> {
        let code = Code {
            first: self.first,
            lines: self.lines.iter().map(|l| l.map(|(line, _)| line)).collect(),
        };
        let spread = self.spread();
        if spread < SPREAD_LEAST * SPREAD_LEAST {
            return None;
        }
        let at = |lag: usize| Some(1.0 - mean(&self.differences(&code, lag as i64, spread)?).0);
        let periods: Vec<(usize, f64)> = [2, 4, 5, 10, 20]
            .into_iter()
            .filter_map(|lag| Some((lag, at(lag)?)))
            .collect();
        let best = periods.iter().map(|p| p.1).fold(f64::MIN, f64::max);
        if best < REPEATS {
            return None;
        }
        // On a scale with lines of 1, 5 and 10 mm every second line is longer, though the fifth is
        // longer still: half of the best is enough.
        periods.into_iter().find(|p| p.1 >= 0.5 * best).map(|p| p.0)
    }
}

/// Mean and number of the lines compared.
fn mean(differences: &[f32]) -> (f64, f64) {
    let compared = differences.iter().filter(|d| d.is_finite());
    let (sum, count) = compared.fold((0.0, 0.0), |(s, n), d| (s + f64::from(*d), n + 1.0));
    (sum / count, count)
}
