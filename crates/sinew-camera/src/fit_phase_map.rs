//! Fits the [`PhaseMap`] to the phases of the blocks.

use super::find::Found;
use super::phase::{Shift, collect, mean_phase, measure, wrap};
use super::phase_map::PhaseMap;
use super::robust::{self, Equation};
use super::strips::{Block, Blocks};
use std::f64::consts::TAU;

/// Fits the map to the blocks that belong to the scale; also returns the blocks that agree.
pub(crate) fn fit_phase_map(found: &Found) -> Option<(PhaseMap, Shift)> {
    let blocks = &found.blocks;
    let mut map = start(found)?;
    let mut shift = None;
    for _ in 0..3 {
        let terms = terms(blocks, &found.member);
        let used = collect(blocks, &found.member, &map);
        let mean = mean_phase(&used);
        let equations: Vec<Equation> = used
            .iter()
            .map(|u| Equation {
                row: map.row(u.block.x, u.block.y),
                value: wrap(u.phase - mean) + mean,
                weight: u.weight,
            })
            .collect();
        let (fit, terms) = fit_needed(&equations, terms)?;
        for k in 0..terms {
            map.c[k] += fit.coefficients[k];
        }
        shift = measure(blocks, &found.member, &map, true);
    }
    Some((map, shift?))
}

/// Terms beyond the plane are kept where the scatter falls by this.
const WORTH: f64 = 0.97;

/// The fit with as few terms as do: a bend that is only noise would lead far astray beside the
/// part of the picture where the scale was.
fn fit_needed(equations: &[Equation], most: usize) -> Option<(robust::Fit, usize)> {
    let all: Vec<robust::Fit> = (3..=most)
        .map_while(|terms| robust::fit(equations, terms))
        .collect();
    let best = all.last()?.scatter;
    let index = all.iter().position(|fit| WORTH * fit.scatter <= best)?;
    Some((all[index], index + 3))
}

/// How many terms the blocks can carry: a third power needs more windows than a plane.
fn terms(blocks: &Blocks, member: &[bool]) -> usize {
    let column = |w: usize| (0..blocks.strips).any(|s| member[s * blocks.windows + w]);
    let row = |s: usize| (0..blocks.windows).any(|w| member[s * blocks.windows + w]);
    let windows = (0..blocks.windows).filter(|w| column(*w)).count();
    let strips = (0..blocks.strips).filter(|s| row(*s)).count();
    match (windows, strips) {
        (..=4, _) => 3,
        (5..=6, _) => 4,
        (_, ..=2) => 4,
        (7..=9, _) => 5,
        _ => 6,
    }
}

/// Pitch, tilt, bend and twist from the phase steps between neighbours, which need no unwrapping.
fn start(found: &Found) -> Option<PhaseMap> {
    let blocks = &found.blocks;
    let members = || blocks.members(&found.member);
    let count = members().count();
    if count == 0 {
        return None;
    }
    let x0 = members().map(|b| b.x).sum::<f64>() / count as f64;
    let y0 = members().map(|b| b.y).sum::<f64>() / count as f64;
    let half = |of: &dyn Fn(&Block) -> f64, middle: f64| {
        members()
            .map(|b| (of(b) - middle).abs())
            .fold(8.0, f64::max)
    };
    let (half_width, half_height) = (half(&|b| b.x, x0), half(&|b| b.y, y0));
    let (across, bend) = steps(blocks, &found.member, (0, 1), x0, found.frequency);
    let (down, twist) = steps(blocks, &found.member, (1, 0), x0, 0.0);
    Some(PhaseMap {
        x0,
        y0,
        half_width,
        half_height,
        c: [
            0.0,
            (found.frequency + across) * half_width,
            down * half_height,
            0.5 * bend * half_width * half_width,
            twist * half_width * half_height,
            0.0,
        ],
    })
}

/// Phase slope per pixel between neighbours, beyond the frequency along them, and its change along x.
fn steps(
    blocks: &Blocks,
    member: &[bool],
    neighbour: (usize, usize),
    x0: f64,
    frequency: f64,
) -> (f64, f64) {
    let mut equations = Vec::new();
    for window in 0..blocks.windows.saturating_sub(neighbour.1) {
        let (mut re, mut im, mut middle, mut apart) = (0.0_f64, 0.0_f64, 0.0, 1.0);
        for (a, b) in blocks.pairs_in(member, neighbour, window) {
            let turn = a.turn_to(b);
            re += turn.0;
            im += turn.1;
            middle = 0.5 * (a.x + b.x);
            apart = (b.x - a.x) + (b.y - a.y);
        }
        let weight = re.hypot(im);
        if weight > 0.0 {
            equations.push(Equation {
                row: [1.0, (middle - x0) / 1000.0, 0.0, 0.0, 0.0, 0.0],
                value: wrap(im.atan2(re) / TAU - frequency * apart) / apart,
                weight,
            });
        }
    }
    let terms = if equations.len() >= 6 { 2 } else { 1 };
    match robust::fit(&equations, terms) {
        Some(fit) => (fit.coefficients[0], fit.coefficients[1] / 1000.0),
        None => (equations.first().map_or(0.0, |e| e.value), 0.0),
    }
}
