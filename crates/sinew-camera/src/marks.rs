//! Identification of lines by a code of the longer lines and the numbers.
//!
//! The phase repeats at every graduation. The darkness of each line in twelve bands across the scale distinguishes
//! lines of different lengths, and numbers are printed on some of them.

use super::phase::Shift;
use super::phase_map::PhaseMap;
use super::robust::quantile;
use super::strips::{Block, STRIP_ROWS, Strips};

/// Number of bands across the scale.
const BANDS: usize = 12;
/// Number of samples per graduation in each band: the strokes of the numbers are a third of a graduation wide.
const SAMPLES_PER_LINE: usize = 4;
/// Number of values that describe a line.
pub(super) const VALUES_PER_LINE: usize = BANDS * SAMPLES_PER_LINE;
/// Margin of the bands beyond the rows with many lines, as a share of their height, for the longest lines and the
/// numbers.
pub(crate) const BAND_MARGIN_SHARE: f64 = 1.0;
/// Half-width of the neighbourhood with which a line is compared, graduations: a whole graduation contains exactly one
/// line wherever it begins.
const NEIGHBOURHOOD_HALF_WIDTH: f64 = 1.5;

/// Level at and between lines in each band, relative to the neighbourhood; NaN outside the picture.
pub(super) type Line = [f32; VALUES_PER_LINE];

/// Lines of one frame, in order; `None` for a covered line.
#[derive(Debug, Clone)]
pub(crate) struct Code {
    /// Number of the first line, in the coordinate of the map shifted by the fraction.
    pub(super) first: i64,
    pub(super) lines: Vec<Option<Line>>,
}

/// Positions of the bands across the scale, px from the middle line of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bands {
    from: f64,
    to: f64,
}

impl Bands {
    /// Determines the positions from the blocks of the scale.
    pub(crate) fn around<'a>(blocks: impl Iterator<Item = &'a Block>, map: &PhaseMap) -> Self {
        let across: Vec<f64> = blocks.map(|b| map.across(b.x, b.y)).collect();
        let share = |p: f64| quantile(across.clone(), p);
        let (Some(from), Some(to)) = (share(0.02), share(0.98)) else {
            return Self { from: 0.0, to: 0.0 };
        };
        let beyond = BAND_MARGIN_SHARE * (to - from) + 4.0;
        Self {
            from: from - beyond,
            to: to + beyond,
        }
    }
}

/// Returns the lines of a frame, for the code and for drawing: position of the middle of each line and its number
/// before whole graduations are counted.
pub(crate) fn places(map: &PhaseMap, shift: &Shift, left: f64, right: f64) -> Vec<(i64, f64, f64)> {
    let tan = map.tilt_rad().tan();
    let y_at = |x: f64| map.y0 + tan * (x - map.x0);
    let at = |x: f64| map.at(x, y_at(x)) + shift.phase + shift.du * (map.at_u(x));
    let (low, high) = (at(left), at(right));
    let mut out = Vec::new();
    let mut x = left;
    for number in low.ceil() as i64..=high.floor() as i64 {
        // Newton iteration from the previous line: the map is nearly linear.
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
    occluded: &dyn Fn(f64) -> bool,
) -> Code {
    if strips.count < 2 {
        return Code {
            first: 0,
            lines: Vec::new(),
        };
    }
    let region = strips.region;
    let (left, right) = (region.x as f64, (region.x + region.width) as f64 - 1.0);
    let places = places(map, shift, left, right);
    let looking = Looking::new(strips, map, bands);
    Code {
        first: places.first().map_or(0, |p| p.0),
        lines: places
            .iter()
            .map(|&(_, x, y)| (!occluded(x)).then(|| looking.line(x, y)).flatten())
            .collect(),
    }
}

/// Sampling of the lines of a frame.
struct Looking<'a> {
    strips: &'a Strips,
    sums: Sums,
    bands: Bands,
    pitch: f64,
    sin: f64,
    cos: f64,
    /// Height of a band, px, and number of samples in it: one per strip.
    height: f64,
    looks: usize,
}

impl<'a> Looking<'a> {
    fn new(strips: &'a Strips, map: &PhaseMap, bands: Bands) -> Self {
        let (sin, cos) = map.tilt_rad().sin_cos();
        let height = (bands.to - bands.from) / BANDS as f64;
        Self {
            strips,
            sums: Sums::of(strips),
            bands,
            pitch: map.pitch_px(),
            sin,
            cos,
            height,
            looks: (height / STRIP_ROWS as f64).ceil().max(1.0) as usize,
        }
    }

    /// Returns the line with its middle at a pixel; `None` if the edge of the picture cuts it.
    fn line(&self, x: f64, y: f64) -> Option<Line> {
        let mut line = [0.0_f32; VALUES_PER_LINE];
        for band in 0..BANDS {
            let mut levels = [0.0; SAMPLES_PER_LINE];
            let mut count = 0.0;
            for look in 0..self.looks {
                let part = (look as f64 + 0.5) / self.looks as f64;
                let across = self.bands.from + self.height * (band as f64 + part);
                count += self.add(x, y, across, &mut levels)?;
            }
            for (point, level) in levels.iter().enumerate() {
                line[band * SAMPLES_PER_LINE + point] = (level / count) as f32;
            }
        }
        Some(line)
    }

    /// Adds the levels at a position across the line; returns 1 if it lies in the picture, otherwise 0.
    fn add(
        &self,
        x: f64,
        y: f64,
        across: f64,
        levels: &mut [f64; SAMPLES_PER_LINE],
    ) -> Option<f64> {
        let (px, py) = (x - across * self.sin, y + across * self.cos);
        let region = self.strips.region;
        let place = (py - region.y as f64 + 0.5) / STRIP_ROWS as f64 - 0.5;
        if place < 0.0 || place > self.strips.count as f64 - 1.0 {
            return Some(0.0);
        }
        let half_line = (0.12 * self.pitch).max(0.75);
        // Linear interpolation between two strips.
        let above = (place as usize).min(self.strips.count - 2);
        let below = place - above as f64;
        for (strip, share) in [(above, 1.0 - below), (above + 1, below)] {
            // Tilted lines of a strip are shifted relative to its middle row.
            let lean = (self.strips.y(strip) - py) * self.sin / self.cos;
            let at = px - lean - region.x as f64;
            let mean = |x, half| self.sums.mean(self.strips, strip, x, half);
            let scale = share / mean(at, NEIGHBOURHOOD_HALF_WIDTH * self.pitch)?.max(0.5 / 255.0);
            for (point, level) in levels.iter_mut().enumerate() {
                let shift = point as f64 / SAMPLES_PER_LINE as f64 * self.pitch;
                *level += scale * mean(at + shift, half_line)? - share;
            }
        }
        Some(1.0)
    }
}

/// Cumulative sums of the strip levels: the mean over any section is a difference of two.
struct Sums(Vec<f64>);

impl Sums {
    fn of(strips: &Strips) -> Self {
        let mut sums = Vec::with_capacity(strips.count * (strips.region.width + 1));
        for i in 0..strips.count {
            let mut sum = 0.0;
            sums.push(sum);
            for level in strips.strip(i) {
                sum += f64::from(*level);
                sums.push(sum);
            }
        }
        Self(sums)
    }

    /// Returns the mean level over `x ± half`, with partial pixels weighted; `None` beyond the edge.
    fn mean(&self, strips: &Strips, strip: usize, x: f64, half: f64) -> Option<f64> {
        let levels = strips.strip(strip);
        let sums = &self.0[strip * (levels.len() + 1)..];
        // Pixel `i` extends from i − ½ to i + ½.
        let (from, to) = (x - half + 0.5, x + half + 0.5);
        if from < 0.0 || to >= levels.len() as f64 {
            return None;
        }
        let until = |at: f64| {
            let pixel = at as usize;
            sums[pixel] + (at - pixel as f64) * f64::from(levels[pixel])
        };
        Some((until(to) - until(from)) / (to - from))
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture::Picture;
    use super::*;

    #[test]
    fn band_mean_weights_partial_pixels_to_edge() {
        let picture = Picture::from_luma8(
            10,
            8,
            [0, 51, 102, 153, 204, 255, 0, 51, 102, 153].repeat(8),
        )
        .unwrap();
        let region = super::super::strips::Region::whole(&picture);
        let strips = Strips::of(&picture, region);
        let sums = Sums::of(&strips);
        // From 1.25 to 3.75 in pixel edges: ¾ of 0.2, all of 0.4, ¾ of 0.6.
        let mean = sums.mean(&strips, 0, 2.0, 1.25).unwrap();
        assert!((mean - (0.15 + 0.4 + 0.45) / 2.5).abs() < 1e-6, "{mean}");
        assert_eq!(sums.mean(&strips, 0, 0.5, 1.25), None);
        assert_eq!(sums.mean(&strips, 0, 8.5, 1.25), None);
    }
}
