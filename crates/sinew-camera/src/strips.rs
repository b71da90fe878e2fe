//! From pixels to the phase of the graduation in small blocks.
//!
//! Rows are summed in strips a few pixels high, which takes most of the noise out and leaves a
//! thousandth of the work. Each strip is then compared with one period of the graduation in
//! windows of eight graduations that overlap by half. Under a Hann window, longer lines (at ½, ¹⁄₁₀
//! and ¹⁄₂₀ of the frequency), uneven light and numbers hardly reach the graduation's own bin.

use super::picture::{DEEPER, Picture};
use super::robust::wrap;
use std::f64::consts::TAU;

/// A rectangle of a picture, px.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Region {
    /// First column.
    pub x: usize,
    /// First row.
    pub y: usize,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
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

    /// The part that is looked at of a picture, lying: what is named, else the whole.
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

/// Rows of a strip.
pub(crate) const STRIP_ROWS: usize = 8;

/// Mean grey levels of strips of rows, 0 to 1.
#[derive(Debug, Clone)]
pub(crate) struct Strips {
    pub(crate) region: Region,
    /// Number of strips.
    pub(crate) count: usize,
    levels: Vec<f32>,
    /// Share of pixels at the white end.
    pub(crate) white: f64,
}

impl Strips {
    /// Averages the rows of `region` that fill whole strips.
    pub(crate) fn of(picture: &Picture, region: Region) -> Self {
        const WHITE: u16 = 254 * DEEPER;
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

    /// Levels of a strip, column by column from `region.x`.
    pub(crate) fn strip(&self, i: usize) -> &[f32] {
        &self.levels[i * self.region.width..][..self.region.width]
    }

    /// Row of the middle of a strip in the picture, px.
    pub(crate) fn y(&self, i: usize) -> f64 {
        self.region.y as f64 + (i as f64 + 0.5) * STRIP_ROWS as f64 - 0.5
    }

    /// Mean level of the whole.
    pub(crate) fn mean(&self) -> f64 {
        let sum: f64 = self.levels.iter().map(|v| f64::from(*v)).sum();
        sum / self.levels.len().max(1) as f64
    }
}

/// Phase and amplitude of the graduation in a block of a strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    /// Middle, px.
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// `A e^{2πi·s}` with `s` the scale's coordinate in graduations, whole on a dark line; `A` in
    /// grey levels.
    pub(crate) re: f64,
    pub(crate) im: f64,
    /// Mean grey level.
    pub(crate) level: f64,
}

impl Block {
    fn amplitude(&self) -> f64 {
        self.re.hypot(self.im)
    }

    /// What a phase weighs: its noise goes with 1/amplitude.
    pub(crate) fn power(&self) -> f64 {
        self.amplitude().powi(2)
    }

    /// The scale's coordinate without its whole graduations.
    pub(crate) fn phase(&self) -> f64 {
        self.im.atan2(self.re) / TAU
    }

    /// Amplitude relative to the light: what uneven light leaves alone.
    pub(crate) fn contrast(&self) -> f64 {
        self.amplitude() / self.level.max(0.5 / 255.0)
    }
}

/// All blocks: strips from the top, windows from the left.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Blocks {
    pub(crate) windows: usize,
    /// From window to window, px.
    pub(crate) hop: f64,
    pub(crate) all: Vec<Block>,
}

impl Blocks {
    /// The blocks that are members.
    pub(crate) fn members<'a>(&'a self, member: &'a [bool]) -> impl Iterator<Item = &'a Block> {
        let all = self.all.iter().zip(member);
        all.filter(|(_, member)| **member).map(|(block, _)| block)
    }

    /// Blocks that stand beside a block: right and left, below and above.
    fn neighbours(&self, at: usize) -> impl Iterator<Item = usize> {
        let (column, end) = (at % self.windows, self.all.len());
        let right = (column + 1 < self.windows).then_some(at + 1);
        let left = (column > 0).then(|| at - 1);
        let below = Some(at + self.windows).filter(|to| *to < end);
        let above = at.checked_sub(self.windows);
        [right, left, below, above].into_iter().flatten()
    }

    /// Mean phase step of members to their neighbours, cycles: to the right, and down.
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

    /// The strongest connected set of candidates whose phases follow each other in about the steps
    /// that `step` expects, graduations: which blocks, and the scale's coordinate at each, counted
    /// from the first.
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
                    if open[to] && off.abs() < STEP_TOLERANCE {
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

/// Phases of neighbours that belong together differ from the common step by less, cycles. A window
/// moves on by four graduations: a quarter of a cycle is a pitch that differs by 6 %, which
/// perspective does; chance agrees in half of the cases, and not in six neighbours running.
const STEP_TOLERANCE: f64 = 0.25;

/// The matched filter: one Hann-windowed period of a known frequency, without response to
/// constant light.
#[derive(Debug, Clone)]
pub(crate) struct Demodulator {
    cos: Vec<f32>,
    sin: Vec<f32>,
    hann: Vec<f32>,
    hop: usize,
}

/// Graduations in a window. Eight keep the lines of double distance four bins away, twice the
/// Hann window's half width, and follow a pitch that changes by a tenth over the picture.
const WINDOW_PERIODS: f64 = 8.0;
/// Fewest graduations in a window of a narrow region.
const WINDOW_PERIODS_LEAST: f64 = 4.0;

impl Demodulator {
    /// For `frequency` in graduations per pixel and a region `width` px wide.
    pub(crate) fn new(frequency: f64, width: usize) -> Self {
        let periods = (width as f64 * frequency / 2.0).clamp(WINDOW_PERIODS_LEAST, WINDOW_PERIODS);
        let length = ((periods / frequency).round() as usize).max(8);
        let middle = (length as f64 - 1.0) / 2.0;
        let hann = hann(length);
        let total: f64 = hann.iter().sum();
        let mut cos: Vec<f64> = Vec::with_capacity(length);
        let mut sin = Vec::with_capacity(length);
        for (i, h) in hann.iter().enumerate() {
            let phase = TAU * frequency * (i as f64 - middle);
            // Darkness, so that lines stand at whole numbers.
            cos.push(-2.0 * h * phase.cos() / total);
            sin.push(2.0 * h * phase.sin() / total);
        }
        // The sine part is odd and has no mean; the cosine's is taken out.
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

    /// Pixels in a window.
    pub(crate) fn length(&self) -> usize {
        self.cos.len()
    }

    /// Compares every strip with the graduation.
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

/// Weights of a Hann window.
pub(crate) fn hann(length: usize) -> Vec<f64> {
    let weight = |i| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / length as f64).cos();
    (0..length).map(weight).collect()
}

/// Dot product. Sums are kept in eight lanes because the order of a sum of floats is fixed by the
/// language: only so can the compiler use vector registers.
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

    /// Thin dark lines at `offset + k * pitch`, each pixel with the share of its width they cover.
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
    fn the_phase_is_the_scales_coordinate() {
        let (pitch, offset) = (10.37, 3.2);
        let picture = comb(300, 16, pitch, offset);
        let strips = Strips::of(&picture, Region::whole(&picture));
        let blocks = Demodulator::new(1.0 / pitch, 300).blocks(&strips);
        assert_eq!((blocks.all.len(), blocks.windows), (2 * 6, 6));
        for block in &blocks.all {
            let want = (block.x - offset) / pitch;
            let found = block.im.atan2(block.re) / TAU;
            let apart = want - found - (want - found).round();
            // What is left is the ninth and eleventh harmonic folded onto the first by the
            // pixels (10.37 px is nearly 10) and the Hann window's side lobes.
            assert!(apart.abs() < 2e-3, "{apart} graduations at {}", block.x);
        }
    }

    #[test]
    fn light_without_lines_has_no_phase() {
        let levels = (0..200 * 8).map(|i| (i % 200) as u8 / 2 + 60).collect();
        let picture = Picture::from_luma8(200, 8, levels).unwrap();
        let strips = Strips::of(&picture, Region::whole(&picture));
        for block in &Demodulator::new(0.1, 200).blocks(&strips).all {
            assert!(block.contrast() < 5e-3, "{block:?}");
        }
    }
}
