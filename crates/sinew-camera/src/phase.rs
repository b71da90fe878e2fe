//! Displacement of the scale since the reference frame.
//!
//! Camera and rail are stationary, so a later frame has the phase `s(x, y) − d/p` with the map `s` of the reference
//! frame. The phases of its blocks minus the map leave one number, `d/p`, and two small slopes that permit the scale to
//! tilt. Every millimetre is measured against the printed graduation that passes the same pixel; pixels per millimetre
//! are not used.

use super::find::MIN_BLOCK_AMPLITUDE_SHARE;
use super::phase_map::PhaseMap;
use super::robust::{self, Equation, wrap};
use super::strips::{Block, Blocks};
use std::f64::consts::TAU;

/// Variance factor for correlated noise of neighbouring windows: two Hann windows that overlap by half share 1/6, so
/// the variance of a mean of many is larger by `1 + 2/6`.
const OVERLAP_VARIANCE: f64 = 4.0 / 3.0;
/// Maximum residual of a consistent block, cycles; noise of a good block is 1 % of it.
const AGREE_CYCLES: f64 = 0.12;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shift {
    /// Phase relative to the map at its origin, cycles, −½ to ½.
    pub(crate) phase: f64,
    /// Standard deviation of the phase, cycles.
    pub(crate) phase_std: f64,
    /// Pitch relative to the pitch of the map, minus one.
    pub(crate) stretch: f64,
    /// Slope relative to the map along the scale, cycles per scaled length.
    pub(crate) du: f64,
    /// Length of the mean phasor of the used blocks: 1 if all agree.
    pub(crate) coherence: f64,
    /// Scatter of the phases of the blocks, cycles.
    pub(crate) scatter: f64,
    /// Number of consistent blocks.
    pub(crate) agree: Vec<bool>,
}

/// Measures the phase of a frame relative to the map from the blocks in `member`.
pub(crate) fn measure(blocks: &Blocks, member: &[bool], map: &PhaseMap) -> Option<Shift> {
    let used: Vec<usize> = (0..member.len()).filter(|at| member[*at]).collect();
    let weights = robust::capped(used.iter().map(|at| blocks.all[*at].power()));
    let equation = |block: &Block, value: f64, weight: f64| {
        let row = map.row(block.x, block.y);
        Equation {
            row: [1.0, row[1], row[2], 0.0, 0.0, 0.0],
            value,
            weight,
        }
    };
    // A large tilt would wrap the phases of the blocks: it is estimated first from neighbours.
    let step = |a: &Block, b: &Block| map.at(b.x, b.y) - map.at(a.x, a.y);
    let region: Vec<Equation> = (blocks.unwrapped(member, step).into_iter())
        .map(|(at, coordinate)| {
            let block = &blocks.all[at];
            equation(block, coordinate - map.at(block.x, block.y), block.power())
        })
        .collect();
    let first = robust::fit(&region, 3)?;
    // Blocks apart from them are compared with this result.
    let all: Vec<Equation> = (used.iter().zip(weights))
        .map(|(at, weight)| {
            let block = &blocks.all[*at];
            let mut equation = equation(block, block.phase() - map.at(block.x, block.y), weight);
            equation.value = first.at(&equation) + wrap(first.residual(&equation));
            equation
        })
        .collect();
    let fit = robust::fit(&all, 3)?;
    let mut agree = vec![false; member.len()];
    let (mut re, mut im, mut total) = (0.0, 0.0, 0.0);
    for (at, equation) in used.iter().zip(&all) {
        let off = wrap(fit.residual(equation));
        agree[*at] = off.abs() < AGREE_CYCLES;
        re += equation.weight * (TAU * off).cos();
        im += equation.weight * (TAU * off).sin();
        total += equation.weight;
    }
    let [phase, du, ..] = fit.coefficients;
    Some(Shift {
        phase: wrap(phase),
        phase_std: fit.first_std * OVERLAP_VARIANCE.sqrt(),
        stretch: -du / map.half_width * map.pitch_px(),
        du,
        coherence: re.hypot(im) / total.max(f64::MIN_POSITIVE),
        scatter: fit.scatter,
        agree,
    })
}

/// Selects blocks in the rows of the lines with a fair share of the contrast of this frame. If there are enough, their
/// left and right neighbours must also qualify, because a window that is half covered, or half beyond the end of the
/// scale, contains the longer lines.
pub(crate) fn lined(blocks: &Blocks, strong: f64, rows: (f64, f64)) -> Vec<bool> {
    let own: Vec<bool> = blocks
        .all
        .iter()
        .map(|b| {
            b.contrast() >= MIN_BLOCK_AMPLITUDE_SHARE * strong && b.y >= rows.0 && b.y <= rows.1
        })
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
