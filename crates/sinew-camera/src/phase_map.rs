//! Scale coordinate at every pixel of the reference frame: a smooth map `s(x, y)`, in graduations, of a plane (pitch
//! and tilt), a bend and a twist (perspective) and a cubic term along the scale (lens).

use super::find::Found;
use super::robust::{self, Equation, MAX_TERMS};
use std::collections::HashSet;

/// Map `s(x, y)` in graduations, integer on a dark line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PhaseMap {
    /// Origin of the terms and the length by which they are scaled, px.
    pub(crate) x0: f64,
    pub(crate) y0: f64,
    pub(super) half_width: f64,
    half_height: f64,
    /// Coefficients of `1, u, v, u², uv, u³`.
    c: [f64; MAX_TERMS],
}

/// Ratio of the scatter with all terms to the scatter with fewer terms from which the fewer terms are sufficient.
const MAX_SCATTER_RATIO: f64 = 0.97;

impl PhaseMap {
    /// Fits the map to the blocks of the scale, whose coordinates follow from neighbours in the first frame.
    pub(crate) fn fit(found: &Found) -> Option<Self> {
        let scale: Vec<_> = (found.scale.iter())
            .map(|(at, coordinate)| (&found.blocks.all[*at], *coordinate))
            .collect();
        let mean =
            |of: &dyn Fn(usize) -> f64| (0..scale.len()).map(of).sum::<f64>() / scale.len() as f64;
        let (x0, y0) = (mean(&|i| scale[i].0.x), mean(&|i| scale[i].0.y));
        let reach =
            |of: &dyn Fn(usize) -> f64| (0..scale.len()).map(|i| of(i).abs()).fold(8.0, f64::max);
        let mut map = Self {
            x0,
            y0,
            half_width: reach(&|i| scale[i].0.x - x0),
            half_height: reach(&|i| scale[i].0.y - y0),
            c: [0.0; MAX_TERMS],
        };
        let weights = robust::capped(scale.iter().map(|(block, _)| block.power()));
        let equations: Vec<Equation> = (scale.iter().zip(weights))
            .map(|((block, coordinate), weight)| Equation {
                row: map.row(block.x, block.y),
                value: *coordinate,
                weight,
            })
            .collect();
        map.c = fit_needed(&equations, terms(found))?.coefficients;
        Some(map)
    }

    pub(super) fn row(&self, x: f64, y: f64) -> [f64; MAX_TERMS] {
        let (u, v) = (
            (x - self.x0) / self.half_width,
            (y - self.y0) / self.half_height,
        );
        [1.0, u, v, u * u, u * v, u * u * u]
    }

    /// Returns the coordinate at a pixel, graduations.
    pub(crate) fn at(&self, x: f64, y: f64) -> f64 {
        self.row(x, y).iter().zip(&self.c).map(|(r, c)| r * c).sum()
    }

    /// Returns the scaled coordinate that belongs to [`Shift::du`].
    pub(crate) fn at_u(&self, x: f64) -> f64 {
        (x - self.x0) / self.half_width
    }

    /// Returns the gradient `(∂s/∂x, ∂s/∂y)`, graduations per pixel.
    pub(crate) fn slope(&self, x: f64, y: f64) -> (f64, f64) {
        let (u, v) = (
            (x - self.x0) / self.half_width,
            (y - self.y0) / self.half_height,
        );
        let c = &self.c;
        (
            (c[1] + 2.0 * c[3] * u + c[4] * v + 3.0 * c[5] * u * u) / self.half_width,
            (c[2] + c[4] * u) / self.half_height,
        )
    }

    /// Returns the distance of a pixel from the middle line of the map, across the scale, px.
    pub(crate) fn across(&self, x: f64, y: f64) -> f64 {
        let (sin, cos) = self.tilt_rad().sin_cos();
        (y - self.y0) * cos - (x - self.x0) * sin
    }

    /// Returns the pitch at the origin, perpendicular to the lines, px.
    pub(crate) fn pitch_px(&self) -> f64 {
        let (a, b) = self.slope(self.x0, self.y0);
        1.0 / a.hypot(b)
    }

    /// Returns the angle of the scale relative to the rows, rad; positive if it falls to the right.
    pub(crate) fn tilt_rad(&self) -> f64 {
        let (a, b) = self.slope(self.x0, self.y0);
        b.atan2(a)
    }
}

/// Returns the fit with the fewest sufficient terms: a bend fitted to noise would extrapolate badly outside the
/// original region of the scale.
fn fit_needed(equations: &[Equation], most: usize) -> Option<robust::Fit> {
    let all: Vec<robust::Fit> = (3..=most)
        .map_while(|terms| robust::fit(equations, terms))
        .collect();
    let best = all.last()?.scatter;
    all.into_iter()
        .find(|fit| MAX_SCATTER_RATIO * fit.scatter <= best)
}

/// Returns the number of terms that the blocks determine: a cubic term needs more windows than a plane.
fn terms(found: &Found) -> usize {
    let windows = found.blocks.windows;
    let count = |of: fn(usize, usize) -> usize| {
        let all: HashSet<usize> = found.scale.iter().map(|(at, _)| of(*at, windows)).collect();
        all.len()
    };
    match (
        count(|at, windows| at % windows),
        count(|at, windows| at / windows),
    ) {
        (..=4, _) => 3,
        (5..=6, _) => 4,
        (_, ..=2) => 4,
        (7..=9, _) => 5,
        _ => 6,
    }
}
