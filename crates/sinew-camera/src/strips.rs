//! Phase of the graduation in small blocks of pixels.
//!
//! Rows are averaged in strips a few pixels high, which removes most of the noise and reduces the data to a thousandth.
//! Each strip is then correlated with one period of the graduation in windows of eight graduations that overlap by
//! half. Under a Hann window, longer lines (at ½, ¹⁄₁₀ and ¹⁄₂₀ of the frequency), uneven light and numbers hardly
//! affect the bin of the graduation.

use super::picture::{LEVEL_RATIO_16_TO_8, Picture};
use super::robust::wrap;
use std::f64::consts::TAU;

/// Rectangle of a picture, px.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Region {
    /// First column of the rectangle, px.
    pub x: usize,
    /// First row of the rectangle, px.
    pub y: usize,
    /// Number of columns of the rectangle.
    pub width: usize,
    /// Number of rows of the rectangle.
    pub height: usize,
}

impl Region {
    pub(crate) fn whole(picture: &Picture) -> Self {
        Self {
            x: 0,
            y: 0,
            width: picture.width(),
            height: picture.height(),
        }
    }

    /// Returns the evaluated region of a picture with the scale along the rows: the specified one, otherwise the whole
    /// picture.
    pub(crate) fn looked_at(named: Option<Self>, upright: bool, lying: &Picture) -> Self {
        match named {
            Some(part) if upright => part.transposed(),
            Some(part) => part,
            None => Self::whole(lying),
        }
    }

    pub(crate) fn transposed(self) -> Self {
        Self {
            x: self.y,
            y: self.x,
            width: self.height,
            height: self.width,
        }
    }
}

/// Number of rows per strip.
pub(crate) const STRIP_ROWS: usize = 8;

/// Mean grey levels of strips of rows, 0 to 1.
#[derive(Debug, Clone)]
pub(crate) struct Strips {
    pub(crate) region: Region,
    /// Number of strips in the region.
    pub(crate) count: usize,
    levels: Vec<f32>,
    /// Share of white pixels, 0 to 1.
    pub(crate) white: f64,
}

impl Strips {
    /// Averages the rows of `region` that fill whole strips.
    pub(crate) fn of(picture: &Picture, region: Region) -> Self {
        const WHITE: u16 = 254 * LEVEL_RATIO_16_TO_8;
        let count = region.height / STRIP_ROWS;
        let row = |y: usize| &picture.row(y)[region.x..][..region.width];
        let factor = 1.0 / (f32::from(u16::MAX) * STRIP_ROWS as f32);
        let mut levels = Vec::with_capacity(count * region.width);
        let mut sums = vec![0_u32; region.width];
        let mut white = 0_usize;
        for strip in 0..count {
            let first = region.y + strip * STRIP_ROWS;
            sums.fill(0);
            for y in first..first + STRIP_ROWS {
                for (sum, level) in sums.iter_mut().zip(row(y)) {
                    *sum += u32::from(*level);
                }
            }
            white += row(first).iter().filter(|level| **level >= WHITE).count();
            levels.extend(sums.iter().map(|sum| *sum as f32 * factor));
        }
        Self {
            region,
            count,
            levels,
            white: white as f64 / (count * region.width).max(1) as f64,
        }
    }

    /// Returns the levels of a strip, one per column from `region.x`.
    pub(crate) fn strip(&self, i: usize) -> &[f32] {
        &self.levels[i * self.region.width..][..self.region.width]
    }

    /// Returns the middle row of a strip in the picture, px.
    pub(crate) fn y(&self, i: usize) -> f64 {
        self.region.y as f64 + (i as f64 + 0.5) * STRIP_ROWS as f64 - 0.5
    }

    /// Returns the mean level of the region.
    pub(crate) fn mean(&self) -> f64 {
        let sum: f64 = self.levels.iter().map(|v| f64::from(*v)).sum();
        sum / self.levels.len().max(1) as f64
    }
}

/// Phase and amplitude of the graduation in a block of a strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    /// Middle of the block, px.
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// Phasor `A e^{2πi·s}` with the scale coordinate `s` in graduations, integer on a dark line; `A` in grey levels.
    pub(crate) re: f64,
    pub(crate) im: f64,
    /// Mean grey level of the block.
    pub(crate) level: f64,
}

impl Block {
    fn amplitude(&self) -> f64 {
        self.re.hypot(self.im)
    }

    /// Returns the weight of the phase: its noise is proportional to 1/amplitude.
    pub(crate) fn power(&self) -> f64 {
        self.amplitude().powi(2)
    }

    /// Returns the fractional part of the scale coordinate, graduations.
    pub(crate) fn phase(&self) -> f64 {
        self.im.atan2(self.re) / TAU
    }

    /// Returns the amplitude relative to the mean level, which is independent of uneven light.
    pub(crate) fn contrast(&self) -> f64 {
        self.amplitude() / self.level.max(0.5 / 255.0)
    }
}

/// All blocks: strips from the top, windows from the left.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Blocks {
    pub(crate) windows: usize,
    /// Distance between windows, px.
    pub(crate) hop: f64,
    pub(crate) all: Vec<Block>,
}

impl Blocks {
    /// Returns the blocks that are members.
    pub(crate) fn members<'a>(&'a self, member: &'a [bool]) -> impl Iterator<Item = &'a Block> {
        let all = self.all.iter().zip(member);
        all.filter(|(_, member)| **member).map(|(block, _)| block)
    }

    /// Returns the neighbours of a block: right and left, below and above.
    fn neighbours(&self, at: usize) -> impl Iterator<Item = usize> {
        let (column, end) = (at % self.windows, self.all.len());
        let right = (column + 1 < self.windows).then_some(at + 1);
        let left = (column > 0).then(|| at - 1);
        let below = Some(at + self.windows).filter(|to| *to < end);
        let above = at.checked_sub(self.windows);
        [right, left, below, above].into_iter().flatten()
    }

    /// Returns the mean phase step of members to their neighbours, cycles: right and down.
    pub(crate) fn common_steps(&self, member: &[bool]) -> (f64, f64) {
        let mut turns = [(0.0, 0.0); 2];
        for (at, from) in self.all.iter().enumerate() {
            for to in self.neighbours(at).filter(|to| *to > at) {
                if member[at] && member[to] {
                    let to = &self.all[to];
                    let sum = &mut turns[usize::from(to.y > from.y)];
                    sum.0 += to.re * from.re + to.im * from.im;
                    sum.1 += to.im * from.re - to.re * from.im;
                }
            }
        }
        let [across, down] = turns.map(|(re, im): (f64, f64)| im.atan2(re) / TAU);
        (across, down)
    }

    /// Returns the strongest connected set of candidates whose phase steps agree with `step`, graduations: the blocks,
    /// and the scale coordinate of each relative to the first.
    pub(crate) fn unwrapped(
        &self,
        candidate: &[bool],
        step: impl Fn(&Block, &Block) -> f64,
    ) -> Vec<(usize, f64)> {
        let mut open = candidate.to_vec();
        let mut best = (0.0, Vec::new());
        for seed in 0..open.len() {
            if !std::mem::take(&mut open[seed]) {
                continue;
            }
            let mut set = vec![(seed, self.all[seed].phase())];
            let (mut weight, mut next) = (0.0, 0);
            while let Some(&(at, coordinate)) = set.get(next) {
                next += 1;
                weight += self.all[at].contrast();
                for to in self.neighbours(at) {
                    let expected = coordinate + step(&self.all[at], &self.all[to]);
                    let off = wrap(self.all[to].phase() - expected);
                    if open[to] && off.abs() < MAX_STEP_DIFFERENCE {
                        open[to] = false;
                        set.push((to, expected + off));
                    }
                }
            }
            if weight > best.0 {
                best = (weight, set);
            }
        }
        best.1
    }
}

/// Maximum difference of the phase step of connected neighbours from the common step, cycles. A window advances by four
/// graduations: a quarter of a cycle corresponds to a pitch difference of 6 %, which occurs with perspective; random
/// phases agree in half of the cases, but not for six consecutive neighbours.
const MAX_STEP_DIFFERENCE: f64 = 0.25;

/// Matched filter: one Hann-windowed period of a known frequency, without response to constant light.
#[derive(Debug, Clone)]
pub(crate) struct Demodulator {
    cos: Vec<f32>,
    sin: Vec<f32>,
    hann: Vec<f32>,
    hop: usize,
}

/// Number of graduations in a window. Eight place lines of double distance four bins away, twice the half-width of the
/// Hann window, and follow a pitch that changes by 10 % over the picture.
const WINDOW_PERIODS: f64 = 8.0;
/// Minimum number of graduations in a window of a narrow region.
const MIN_WINDOW_PERIODS: f64 = 4.0;

impl Demodulator {
    /// Creates a filter for `frequency` in graduations per pixel and a region `width` px wide.
    pub(crate) fn new(frequency: f64, width: usize) -> Self {
        let periods = (width as f64 * frequency / 2.0).clamp(MIN_WINDOW_PERIODS, WINDOW_PERIODS);
        let length = ((periods / frequency).round() as usize).max(8);
        let middle = (length as f64 - 1.0) / 2.0;
        let hann = hann(length);
        let total: f64 = hann.iter().sum();
        let mut cos: Vec<f64> = Vec::with_capacity(length);
        let mut sin = Vec::with_capacity(length);
        for (i, h) in hann.iter().enumerate() {
            let phase = TAU * frequency * (i as f64 - middle);
            // Darkness is used, so that lines lie at integers.
            cos.push(-2.0 * h * phase.cos() / total);
            sin.push(2.0 * h * phase.sin() / total);
        }
        // The sine part is antisymmetric and has zero mean; the mean of the cosine part is removed.
        let mean: f64 = cos.iter().sum::<f64>() / total;
        for (c, h) in cos.iter_mut().zip(&hann) {
            *c -= mean * h;
        }
        let narrow = |v: Vec<f64>| v.into_iter().map(|v| v as f32).collect();
        Self {
            cos: narrow(cos),
            sin: narrow(sin),
            hann: hann.iter().map(|h| (h / total) as f32).collect(),
            hop: (length / 2).max(1),
        }
    }

    /// Returns the number of pixels in a window.
    pub(crate) fn length(&self) -> usize {
        self.cos.len()
    }

    /// Correlates every strip with the graduation.
    pub(crate) fn blocks(&self, strips: &Strips) -> Blocks {
        let length = self.length();
        let mut all = Vec::new();
        for strip in 0..strips.count {
            let windows = strips.strip(strip).windows(length).step_by(self.hop);
            for (window, part) in windows.enumerate() {
                let start = strips.region.x + window * self.hop;
                all.push(Block {
                    x: start as f64 + (length as f64 - 1.0) / 2.0,
                    y: strips.y(strip),
                    re: dot(part, &self.cos),
                    im: dot(part, &self.sin),
                    level: dot(part, &self.hann),
                });
            }
        }
        Blocks {
            windows: all.len() / strips.count.max(1),
            hop: self.hop as f64,
            all,
        }
    }
}

/// Returns the weights of a Hann window.
pub(crate) fn hann(length: usize) -> Vec<f64> {
    let weight = |i| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / length as f64).cos();
    (0..length).map(weight).collect()
}

/// Computes a dot product in eight lanes: the language fixes the order of floating-point sums, and only separate lanes
/// permit vector registers.
fn dot(a: &[f32], b: &[f32]) -> f64 {
    const LANES: usize = 8;
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0_f32; LANES];
    for (a, b) in a.iter().zip(b) {
        for i in 0..LANES {
            sums[i] += a[i] * b[i];
        }
    }
    let rest = a_rest.iter().zip(b_rest).map(|(a, b)| a * b);
    f64::from(sums.into_iter().chain(rest).sum::<f32>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws thin dark lines at `offset + k * pitch`, with the covered share of each pixel.
    fn comb(width: usize, height: usize, pitch: f64, offset: f64) -> Picture {
        let levels = (0..width * height)
            .map(|i| {
                let x = (i % width) as f64;
                let covered: f64 = (-2..width as i64)
                    .map(|k| {
                        let line = offset + k as f64 * pitch;
                        let (from, to) = (line - 1.0, line + 1.0);
                        ((x + 0.5).min(to) - (x - 0.5).max(from)).max(0.0)
                    })
                    .sum();
                (52_000.0 - 40_000.0 * covered) as u16
            })
            .collect();
        Picture::from_luma16(width, height, levels).unwrap()
    }

    #[test]
    fn block_phase_equals_scale_coordinate() {
        let (pitch, offset) = (10.37, 3.2);
        let picture = comb(300, 16, pitch, offset);
        let strips = Strips::of(&picture, Region::whole(&picture));
        let blocks = Demodulator::new(1.0 / pitch, 300).blocks(&strips);
        assert_eq!((blocks.all.len(), blocks.windows), (2 * 6, 6));
        for block in &blocks.all {
            let want = (block.x - offset) / pitch;
            let found = block.im.atan2(block.re) / TAU;
            let apart = want - found - (want - found).round();
            // The remaining error is the ninth and eleventh harmonic folded onto the first by the pixels (10.37 px is
            // nearly 10) and the side lobes of the Hann window.
            assert!(apart.abs() < 2e-3, "{apart} graduations at {}", block.x);
        }
    }

    #[test]
    fn block_without_lines_has_no_phase() {
        let levels = (0..200 * 8).map(|i| (i % 200) as u8 / 2 + 60).collect();
        let picture = Picture::from_luma8(200, 8, levels).unwrap();
        let strips = Strips::of(&picture, Region::whole(&picture));
        for block in &Demodulator::new(0.1, 200).blocks(&strips).all {
            assert!(block.contrast() < 5e-3, "{block:?}");
        }
    }
}
