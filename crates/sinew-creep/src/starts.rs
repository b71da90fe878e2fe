//! Starts of a search.

use super::model::Model;
use super::options::NoiseKind;

/// Number of starts of a search, the best of those tried.
const STARTS: usize = 3;
/// Number of grid points per parameter, by the number of parameters.
const GRID: [usize; 5] = [1, 12, 7, 5, 4];
/// Number of points tried if a grid would be too large.
const SCATTERED: usize = 400;
/// Bases of the Halton sequence.
const PRIMES: [u32; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

/// Best points over the shapes, with independent and with slow noise.
pub(super) fn starts(model: &Model) -> Vec<Vec<f64>> {
    let mut white = model.clone();
    white.noise = NoiseKind::White;
    let mut points: Vec<(f64, Vec<f64>)> = tried(model)
        .into_iter()
        .map(|x| (white.solve(&x, false).squares, x))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.truncate(STARTS);
    match model.noise {
        NoiseKind::White => points.into_iter().map(|(_, x)| x).collect(),
        NoiseKind::Correlated => points
            .iter()
            .cycle()
            .zip([(0.1, 0.5), (0.6, 0.5), (0.5, 0.8)])
            .map(|((_, x), (share, memory))| [&x[..], &[share, memory]].concat())
            .collect(),
    }
}

/// Grid over few shapes, quasi-random points over many, and the values of the base rope.
fn tried(model: &Model) -> Vec<Vec<f64>> {
    let shapes = model.shapes.len();
    let mut points: Vec<Vec<f64>> = match GRID.get(shapes) {
        Some(&per) => (0..per.pow(shapes as u32))
            .map(|index| grid_point(index, per, shapes))
            .collect(),
        None => (1..=SCATTERED as u32)
            .map(|index| (0..shapes).map(|j| halton(index, PRIMES[j % 12])).collect())
            .collect(),
    };
    if let Some(plan) = &model.rope {
        let base = plan.base_values();
        let point = model.shapes.iter().zip(base).map(|(s, v)| s.coordinate(v));
        points.push(point.collect());
    }
    points
}

fn grid_point(index: usize, per: usize, shapes: usize) -> Vec<f64> {
    let mut rest = index;
    (0..shapes)
        .map(|_| {
            let unit = (rest % per) as f64 + 0.5;
            rest /= per;
            unit / per as f64
        })
        .collect()
}

/// Halton sequence: digits of the index in a base, mirrored at the point (Halton, Numer. Math. 2,
/// 1960).
fn halton(index: u32, base: u32) -> f64 {
    let (mut rest, mut share, mut value) = (index, 1.0, 0.0);
    while rest > 0 {
        share /= f64::from(base);
        value += share * f64::from(rest % base);
        rest /= base;
    }
    value
}
