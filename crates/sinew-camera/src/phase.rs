//! How far the scale has moved on since the reference frame.
//!
//! Camera and rail stay as they are, so a later frame has the phase `s(x, y) − d/p` with the map
//! `s` of the reference frame: its blocks are turned back by the map and what is left is one
//! number, `d/p`, and two small slopes that let the scale rock. Every millimetre is measured
//! against the printed graduation that passes the same pixel; pixels per millimetre never enter.

use super::find::BLOCK_SHARE;
use super::phase_map::PhaseMap;
use super::robust::{self, Equation, median};
use super::strips::{Block, Blocks};
use std::f64::consts::TAU;

/// Noise of neighbouring windows is correlated: two Hann windows that overlap by half share 1/6.
/// The variance of a mean of many is larger by `1 + 2/6`.
const OVERLAP_VARIANCE: f64 = 4.0 / 3.0;
/// A block may weigh this many times the median one.
const WEIGHT_CAP: f64 = 3.0;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shift {
    /// Phase against the map at its origin, cycles, −½ to ½.
    pub(crate) phase: f64,
    /// Its standard deviation, cycles.
    pub(crate) phase_std: f64,
    /// Pitch now over pitch of the map, minus one.
    pub(crate) stretch: f64,
    /// Slope against the map along the scale, cycles per scaled length.
    pub(crate) du: f64,
    /// Length of the mean phasor of the blocks used: 1 where all agree.
    pub(crate) coherence: f64,
    /// Scatter of the blocks' phases, cycles.
    pub(crate) scatter: f64,
    /// Blocks that agree.
    pub(crate) agree: Vec<bool>,
}

pub(super) struct Used<'a> {
    pub(super) block: &'a Block,
    index: usize,
    /// Turned back by the map.
    re: f64,
    im: f64,
    pub(super) phase: f64,
    pub(super) weight: f64,
}

impl Used<'_> {
    fn turn_back(&mut self, map: &PhaseMap, (du, dv): (f64, f64)) {
        let row = map.row(self.block.x, self.block.y);
        self.phase -= du * row[1] + dv * row[2];
        let size = self.re.hypot(self.im);
        (self.re, self.im) = (
            size * (TAU * self.phase).cos(),
            size * (TAU * self.phase).sin(),
        );
    }
}

/// Length of the weighted mean phasor once two slopes are taken out.
fn agreement(used: &[Used<'_>], map: &PhaseMap, (du, dv): (f64, f64)) -> f64 {
    let (re, im) = used.iter().fold((0.0, 0.0), |(re, im), u| {
        let row = map.row(u.block.x, u.block.y);
        let (s, c) = (TAU * (u.phase - du * row[1] - dv * row[2])).sin_cos();
        (re + u.weight * c, im + u.weight * s)
    });
    re.hypot(im)
}

pub(super) fn collect<'a>(blocks: &'a Blocks, member: &[bool], map: &PhaseMap) -> Vec<Used<'a>> {
    let mut used: Vec<Used<'a>> = blocks
        .all
        .iter()
        .zip(member)
        .enumerate()
        .filter(|(_, (_, m))| **m)
        .map(|(index, (block, _))| {
            let (s, c) = (-TAU * map.at(block.x, block.y)).sin_cos();
            let re = block.re * c - block.im * s;
            let im = block.im * c + block.re * s;
            Used {
                block,
                index,
                re,
                im,
                phase: im.atan2(re) / TAU,
                // The phase's noise goes with 1/amplitude.
                weight: block.amplitude().powi(2),
            }
        })
        .collect();
    if let Some(median) = median(used.iter().map(|u| u.weight).collect()) {
        for u in &mut used {
            u.weight = (u.weight / median.max(f64::MIN_POSITIVE)).min(WEIGHT_CAP);
        }
    }
    used
}

pub(super) fn mean_phase(used: &[Used<'_>]) -> f64 {
    let (re, im) = used.iter().fold((0.0, 0.0), |(re, im), u| {
        let size = u.re.hypot(u.im).max(f64::MIN_POSITIVE);
        (re + u.weight * u.re / size, im + u.weight * u.im / size)
    });
    im.atan2(re) / TAU
}

/// Measures the phase of a frame against the map from the blocks in `member`. `still`: without the
/// two slopes.
pub(crate) fn measure(
    blocks: &Blocks,
    member: &[bool],
    map: &PhaseMap,
    still: bool,
) -> Option<Shift> {
    let mut used = collect(blocks, member, map);
    if used.len() < 4 {
        return None;
    }
    // A rock larger than the blocks' own phases would wrap: neighbours tell its slope first.
    let mut du = 0.0;
    if !still {
        let slope = (
            rock(blocks, member, map, (0, 1)) * map.half_width,
            rock(blocks, member, map, (1, 0)) * map.half_height,
        );
        // Where much is covered, the neighbours' steps may come from what covers it.
        if agreement(&used, map, slope) > agreement(&used, map, (0.0, 0.0)) {
            du = slope.0;
            for u in &mut used {
                u.turn_back(map, slope);
            }
        }
    }
    let mean = mean_phase(&used);
    let equations: Vec<Equation> = used
        .iter()
        .map(|u| {
            let row = map.row(u.block.x, u.block.y);
            Equation {
                row: [1.0, row[1], row[2], 0.0, 0.0, 0.0],
                value: wrap(u.phase - mean),
                weight: u.weight,
            }
        })
        .collect();
    let fit = robust::fit(&equations, if still { 1 } else { 3 })?;
    let c = fit.coefficients;
    let mut agree = vec![false; member.len()];
    let (mut re, mut im, mut total) = (0.0, 0.0, 0.0);
    for (u, e) in used.iter().zip(&equations) {
        let off = wrap(e.value - c[0] - c[1] * e.row[1] - c[2] * e.row[2]);
        agree[u.index] = off.abs() < AGREE_CYCLES;
        re += e.weight * (TAU * off).cos();
        im += e.weight * (TAU * off).sin();
        total += e.weight;
    }
    du += c[1];
    Some(Shift {
        phase: wrap(mean + c[0]),
        phase_std: fit.first_std * OVERLAP_VARIANCE.sqrt(),
        stretch: -du / map.half_width * map.pitch_px(),
        du,
        coherence: re.hypot(im) / total.max(f64::MIN_POSITIVE),
        scatter: fit.scatter,
        agree,
    })
}

/// A block agrees with the fit within this: noise of a good block is a hundredth of it.
const AGREE_CYCLES: f64 = 0.12;

/// Common phase step between neighbours once the map is taken out, cycles per pixel.
fn rock(blocks: &Blocks, member: &[bool], map: &PhaseMap, neighbour: (usize, usize)) -> f64 {
    let (mut re, mut im, mut apart) = (0.0, 0.0, 1.0);
    for (a, b) in blocks.pairs(member, neighbour) {
        let (sin, cos) = (-TAU * (map.at(b.x, b.y) - map.at(a.x, a.y))).sin_cos();
        let (r, i) = a.turn_to(b);
        re += r * cos - i * sin;
        im += i * cos + r * sin;
        apart = (b.x - a.x) + (b.y - a.y);
    }
    im.atan2(re) / TAU / apart
}

/// Blocks in the rows of the lines whose contrast is a fair share of what lines have in this
/// frame. Where there are enough of them, so must the neighbours left and right: a window that is
/// half covered, or half beyond the scale's end, hears the longer lines.
pub(crate) fn lined(blocks: &Blocks, strong: f64, rows: (f64, f64)) -> Vec<bool> {
    let own: Vec<bool> = blocks
        .all
        .iter()
        .map(|b| b.contrast() >= BLOCK_SHARE * strong && b.y >= rows.0 && b.y <= rows.1)
        .collect();
    let windows = blocks.windows;
    let inner: Vec<bool> = (0..own.len())
        .map(|i| {
            let w = i % windows.max(1);
            own[i] && (w == 0 || own[i - 1]) && (w + 1 == windows || own[i + 1])
        })
        .collect();
    let count = |v: &[bool]| v.iter().filter(|l| **l).count();
    if 2 * count(&inner) >= count(&own) {
        inner
    } else {
        own
    }
}

/// To −½ … ½.
pub(crate) fn wrap(cycles: f64) -> f64 {
    cycles - cycles.round()
}
