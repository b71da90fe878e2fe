//! Evidence about causes under a model error that depends on pose and direction of motion.
//!
//! The residuals of a real arm repeat with the pose: errors of gravity, friction, cables and encoders are no noise, and no
//! number of samples averages them out. A change of stiffness or a constant force is compared with such an error, which
//! is a Gaussian process over the positions of a joint and its neighbours, with a part that reverses with the direction
//! of motion. The baseline (0) stores its link equations in cells of pose and direction, and the recording (1) has the
//! same error up to a change:
//!
//! ```text
//! r₀ = A₀ (x₀ − x̂₀) + f₀(q, u) + ν,                r₁ = A₁ (x₁ − x̂₁) + f₁(q, u) + ν
//! x₁ = E[x₁] + (x₀ − x̂₀) + w,   w ~ N(0, Q)        f₁ = ρ f₀ + √(1 − ρ²) g
//! f₀, g ~ GP(0, (s₀² + s₁² u u') exp(−|q − q'|² / 2ℓ²)),   ν ~ N(0, σ²) per independent passage of a cell
//! ```
//!
//! * `r`, `A`: residuals and rows of the link equations of a joint, averaged over cells of pose and direction.
//! * `q`: positions of the joint and its neighbours; `u`: friction state, −1 to 1.
//! * `s₀`, `s₁`, `ℓ`, `σ`: hyperparameters of the joint, at the maximum of their posterior with `x` marginalised; the
//!   geometric mean of those of baseline and recording, weighted by their number of cells.
//! * `ρ`: correlation between the model errors of both, one of [`CORRELATIONS`]. A low one is the hypothesis that something
//!   else has changed than the causes that are listed.
//! * `Q`: variance that the state gains between baseline and recording.
//!
//! The posterior of the changes given `ρ` is Gaussian; it is that of the evidence. Offsets keep the noise model of
//! [`super::problem`].
//!
//! # Source
//! M. Kennedy, A. O'Hagan, *Bayesian calibration of computer models*, Journal of the Royal Statistical Society B 63,
//! 2001.

use super::normal::NormalEquations;
use super::problem::{Problem, same_again};
use super::schedule::OUTLIER_WEIGHT;
use super::solution::covariance;
use crate::cholesky::{self, Factor, dot};
use crate::offset::block::Block;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::equations::equation::{Equation, Equations, Side};
use crate::offset::equations::loaded::Content;
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use crate::offset::layout::Layout;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;

/// Edge of a cell, rad: the field is constant within it, as its correlation length is at least twice that.
const CELL_RAD: f64 = 0.15;
/// Maximum number of cells of a joint; above it the cells are larger. The time of the factorisations grows with the cube.
const MAX_CELLS: usize = 100;
/// Positions on which the field of a joint depends: its own and those of its neighbours.
const POSITIONS: usize = 3;

/// Hyperparameters of the field of a joint, in the order `s₀` (rad), `s₁` (rad), `ℓ` (rad), `σ` (rad).
type Hyperparameters = [f64; 4];

/// Medians of the log-normal prior of the hyperparameters, from three recordings of one LWR4+ arm and eight simulated
/// robots with rope drives: starting values, which cells of a few poses overrule.
const MEDIANS: Hyperparameters = [0.4e-3, 0.2e-3, 0.5, 0.4e-3];
/// Factors of one standard deviation of that prior.
const FACTORS: Hyperparameters = [4.0, 4.0, 1.8, 2.2];

/// Correlations between the model errors of a baseline and of a recording on another day, each with its prior probability.
/// The most probable one of three recordings of one LWR4+ arm was 0.8 between days and 0.96 within an hour.
const CORRELATIONS: [(f64, f64); 5] = [
    (0.98, 0.1),
    (0.9, 0.25),
    (0.8, 0.3),
    (0.6, 0.2),
    (0.3, 0.15),
];

/// Link equations of a baseline in cells of pose and direction of motion, with the rest of its information: what the
/// model error of a later recording is compared with.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ModelError {
    /// Information of the state by the prior and all equations except those of the links, lower triangle by rows.
    information_lower: Vec<f64>,
    /// Negative gradient of their cost at the state of the linearisation.
    gradient: Vec<f64>,
    /// Variance that each entry of the state gained between the baseline and the last recording of its chain.
    gained_variance: Vec<f64>,
    /// Cells of every joint.
    joints: Vec<Cells>,
}

/// Link equations of a joint, averaged over the cells of its positions and its direction of motion.
#[derive(Debug, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Cells {
    /// Scales and length of the model error, and its noise.
    hyperparameters: Hyperparameters,
    /// Number of independent passages of each cell.
    passages: Vec<f64>,
    /// Number of blocks of each cell, until they are averaged.
    #[cfg_attr(feature = "serde", serde(skip))]
    blocks: Vec<f64>,
    /// Mean positions, rad or m.
    positions: Vec<[f64; POSITIONS]>,
    /// Mean friction state.
    directions: Vec<f64>,
    /// Mean variance of unknown effects in addition to the noise, rad².
    added_rad2: Vec<f64>,
    /// Mean residual, rad.
    residuals: Vec<f64>,
    /// Mean rows, one after the other.
    rows: Vec<f64>,
}

/// Key of a cell: positions and direction.
type Key = [i32; POSITIONS + 1];

fn positions(block: &Block, joint: usize) -> [f64; POSITIONS] {
    let of = |k: Option<usize>| k.and_then(|k| block.q.get(k)).copied().unwrap_or_default();
    [
        of(joint.checked_sub(1)),
        of(Some(joint)),
        of(Some(joint + 1)),
    ]
}

fn key(block: &Block, joint: usize, edge_rad: f64) -> Key {
    let [a, b, c] = positions(block, joint).map(|q| libm::round(q / edge_rad) as i32);
    let u = block.z.get(joint).copied().unwrap_or_default();
    [a, b, c, libm::round(u) as i32]
}

impl Cells {
    fn len(&self) -> usize {
        self.residuals.len()
    }

    /// Adds a block to cell `k`, which may be a new one.
    fn add(
        &mut self,
        k: usize,
        (block, joint): (&Block, usize),
        (e, equations): (&Equation, &Equations),
        total: usize,
    ) {
        if k == self.len() {
            self.passages.push(0.0);
            self.blocks.push(0.0);
            self.positions.push([0.0; POSITIONS]);
            self.directions.push(0.0);
            self.added_rad2.push(0.0);
            self.residuals.push(0.0);
            self.rows.resize((k + 1) * total, 0.0);
        }
        self.blocks[k] += 1.0;
        for (sum, q) in self.positions[k].iter_mut().zip(positions(block, joint)) {
            *sum += q;
        }
        self.directions[k] += block.z.get(joint).copied().unwrap_or_default();
        self.added_rad2[k] += e.added_std * e.added_std;
        self.residuals[k] += e.residual;
        equations.add_to(e, 1.0, &mut self.rows[k * total..(k + 1) * total]);
    }

    /// Divides all sums by the number of blocks.
    fn average(&mut self, total: usize) {
        for (k, count) in core::mem::take(&mut self.blocks).iter().enumerate() {
            self.positions[k].iter_mut().for_each(|q| *q /= count);
            self.directions[k] /= count;
            self.added_rad2[k] /= count;
            self.residuals[k] /= count;
            let row = &mut self.rows[k * total..(k + 1) * total];
            row.iter_mut().for_each(|x| *x /= count);
        }
    }

    /// Covariance of the model error of cell `i` and of cell `k` of `other`.
    fn kernel(&self, i: usize, other: &Self, k: usize, h: &Hyperparameters) -> f64 {
        let [pose, direction, length, _] = h;
        let apart = self.positions[i].iter().zip(&other.positions[k]);
        let square: f64 = apart.map(|(a, b)| (a - b) * (a - b)).sum();
        let u = self.directions[i] * other.directions[k];
        (pose * pose + direction * direction * u) * libm::exp(-0.5 * square / (length * length))
    }

    /// Covariance of model error and noise, row-major.
    fn covariance(&self, h: &Hyperparameters) -> Vec<f64> {
        let m = self.len();
        let mut out = alloc::vec![0.0; m * m];
        for i in 0..m {
            for k in 0..=i {
                let value = self.kernel(i, self, k, h);
                (out[i * m + k], out[k * m + i]) = (value, value);
            }
            out[i * (m + 1)] += h[3] * h[3] / self.passages[i] + self.added_rad2[i];
        }
        out
    }

    /// Number of columns.
    fn width(&self) -> usize {
        self.rows.len() / self.len().max(1)
    }

    /// Covariance of the equations by the prior of the state, `A P Aᵀ`; `before`: the covariance `P`.
    fn prior_covariance(&self, before: &[f64], total: usize) -> Vec<f64> {
        let rows = || self.rows.chunks_exact(total);
        let mut out = Vec::with_capacity(self.len() * self.len());
        for row in rows() {
            let mut carried = alloc::vec![0.0; total];
            for (a, line) in row.iter().zip(before.chunks_exact(total)) {
                if *a != 0.0 {
                    let sums = carried.iter_mut().zip(line);
                    sums.for_each(|(sum, p)| *sum += a * p);
                }
            }
            out.extend(rows().map(|other| dot(&carried, other)));
        }
        out
    }

    /// Rounds all numbers.
    fn round(&mut self) {
        let positions = self.positions.iter_mut().flatten();
        let all = [
            &mut self.passages,
            &mut self.directions,
            &mut self.added_rad2,
            &mut self.residuals,
            &mut self.rows,
        ];
        (all.into_iter().flatten())
            .chain(positions)
            .chain(&mut self.hyperparameters)
            .for_each(|x| *x = rounded(*x));
    }

    /// Hyperparameters at the maximum of their posterior. `expected`: covariance of the residuals by the prior of the state,
    /// `y`: residuals from its mean.
    fn learn(&self, expected: &[f64], y: &[f64]) -> Hyperparameters {
        let m = self.len();
        if m == 0 {
            return MEDIANS;
        }
        let mut l = alloc::vec![0.0; m * m];
        let mut ln_posterior = |h: &Hyperparameters| {
            let mut s = self.covariance(h);
            s.iter_mut().zip(expected).for_each(|(s, x)| *s += x);
            if cholesky::factorise(&s, &mut l, m).is_err() {
                return f64::NEG_INFINITY;
            }
            let mut white = y.to_vec();
            cholesky::forward(&l, m, &mut white);
            let ln_root: f64 = (0..m).map(|i| libm::log(l[i * (m + 1)])).sum();
            let prior = (h.iter().zip(&MEDIANS).zip(&FACTORS)).map(|((h, median), factor)| {
                let z = libm::log(h / median) / libm::log(*factor);
                -0.5 * z * z
            });
            -0.5 * dot(&white, &white) - ln_root + prior.sum::<f64>()
        };
        let mut best = MEDIANS;
        let mut value = ln_posterior(&best);
        // Coordinate ascent with ever finer factors.
        for factor in [4.0, 2.0, 1.4] {
            for k in 0..best.len() {
                for factor in [factor, 1.0 / factor] {
                    loop {
                        let mut trial = best;
                        trial[k] *= factor;
                        let there = ln_posterior(&trial);
                        if !(there > value) {
                            break;
                        }
                        (best, value) = (trial, there);
                    }
                }
            }
        }
        best
    }
}

/// Gaussian posterior of a state under the model error with one correlation between baseline and recording.
pub(super) struct Posterior {
    /// Logarithm of the evidence for the correlation, with its prior.
    pub(super) ln_evidence: f64,
    pub(super) state: Vec<f64>,
    /// Entries of the unknowns that make up each entry of the state.
    sums: Vec<[Option<usize>; 2]>,
    factor: Factor,
}

impl Posterior {
    /// Covariance of some entries, row-major.
    pub(super) fn covariance(&self, columns: &[usize]) -> Vec<f64> {
        let through: Vec<Vec<f64>> = (columns.iter())
            .map(|&column| {
                let mut unit = alloc::vec![0.0; self.factor.dimension()];
                self.sums[column]
                    .iter()
                    .flatten()
                    .for_each(|&k| unit[k] = 1.0);
                self.factor.forward(&mut unit);
                unit
            })
            .collect();
        let pairs = through
            .iter()
            .flat_map(|a| through.iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| dot(a, b)).collect()
    }
}

/// Returns the weight of every posterior by its evidence; their sum is 1.
pub(super) fn weights(posteriors: &[Posterior]) -> Vec<f64> {
    let ln = || posteriors.iter().map(|p| p.ln_evidence);
    let most = ln().fold(f64::NEG_INFINITY, f64::max);
    let all: f64 = ln().map(|ln| libm::exp(ln - most)).sum();
    ln().map(|ln| libm::exp(ln - most) / all).collect()
}

/// Unknowns of the evidence: the error of the baseline's state, what entries gained since then, and the changes.
struct Unknowns {
    /// Entries of the state that gained variance, and that variance.
    gained: Vec<(usize, f64)>,
    /// Entries of the unknowns that make up each entry of the state and its changes.
    sums: Vec<[Option<usize>; 2]>,
    size: usize,
}

impl Unknowns {
    /// `d`: entries of the state; `total`: with its changes.
    fn new(gained_variance: &[f64], d: usize, total: usize) -> Self {
        let gained: Vec<(usize, f64)> = (gained_variance.iter().copied().enumerate())
            .filter(|(_, variance)| *variance > 0.0)
            .collect();
        let mut sums: Vec<[Option<usize>; 2]> = (0..d).map(|k| [Some(k), None]).collect();
        for (place, (k, _)) in gained.iter().enumerate() {
            sums[*k][1] = Some(d + place);
        }
        let changes = d + gained.len();
        sums.extend((0..total - d).map(|k| [Some(changes + k), None]));
        Self {
            size: changes + total - d,
            gained,
            sums,
        }
    }

    /// Row over the unknowns of a row over the state and its changes.
    fn row(&self, row: &[f64]) -> Vec<f64> {
        let mut out = alloc::vec![0.0; self.size];
        for (value, sums) in row.iter().zip(&self.sums) {
            sums.iter().flatten().for_each(|&k| out[k] += value);
        }
        out
    }
}

/// Returns the posterior of the state around `at`: one for each correlation between the model errors of baseline and
/// recording, or a single one without a stored model error.
///
/// `stored`: model error of the baseline if the recording is compared with it, not a continued recording.
///
/// # Errors
/// Returns a [`MapError`] if a linear system cannot be solved.
pub(super) fn posteriors(
    problem: &Problem<'_>,
    at: &MapEstimate,
    stored: Option<&ModelError>,
) -> Result<Vec<Posterior>, MapError> {
    let (d, total) = (problem.start.mean.len(), at.state.len());
    // The state of another selection of equations has another layout.
    let stored = stored.filter(|stored| {
        stored.gradient.len() == d && stored.joints.len() == problem.layout().joints
    });
    let distance: Vec<f64> = (problem.origin(total).iter().zip(&at.state))
        .map(|(a, b)| a - b)
        .collect();
    let gained = stored.map_or(&[][..], |stored| &stored.gained_variance);
    let unknowns = Unknowns::new(gained, d, total);
    let (session, motor) = session_equations(problem, at);
    let n = unknowns.size;
    let mut information = alloc::vec![0.0; n * n];
    let mut gradient = alloc::vec![0.0; n];
    match stored {
        Some(stored) => {
            let mut entries = stored.information_lower.iter();
            for i in 0..d {
                for (to, value) in information[i * n..=i * n + i].iter_mut().zip(&mut entries) {
                    *to = *value;
                }
            }
            gradient[..d].copy_from_slice(&stored.gradient);
        }
        None => {
            let own = covariance(&problem.start.covariance, d)?;
            for (to, row) in information.chunks_exact_mut(n).zip(own.chunks_exact(d)) {
                to[..d].copy_from_slice(row);
            }
        }
    }
    for (place, (_, variance)) in unknowns.gained.iter().enumerate() {
        information[(d + place) * (n + 1)] = 1.0 / variance;
    }
    let stds = at.changes.iter().flat_map(|change| problem.stds(change));
    for (k, std) in (d + unknowns.gained.len()..n).zip(stds) {
        information[k * (n + 1)] = 1.0 / (std * std);
    }
    // The other equations of the recording, around the expected state.
    for i in 0..total {
        let row: Vec<f64> = (0..total)
            .map(|k| motor.information[i.max(k) * total + i.min(k)])
            .collect();
        if row.iter().all(|x| *x == 0.0) {
            continue;
        }
        let pull = motor.gradient[i] - dot(&row, &distance);
        let row = unknowns.row(&row);
        for &k in unknowns.sums[i].iter().flatten() {
            gradient[k] += pull;
            let own = &mut information[k * n..=k * n + k];
            own.iter_mut().zip(&row).for_each(|(to, x)| *to += x);
        }
    }
    let before = prior_covariance(problem, &at.changes, total);
    let joints: Vec<JointEquations<'_>> = (session.iter().enumerate())
        .map(|(joint, cells)| {
            let baseline = stored.and_then(|stored| stored.joints.get(joint));
            JointEquations::new((cells, baseline), &unknowns, &before, &distance)
        })
        .collect();
    let correlations: &[(f64, f64)] = match stored {
        Some(_) => &CORRELATIONS,
        None => &[(0.0, 1.0)],
    };
    let of = |(correlation, probability): &(f64, f64)| {
        let mut normal = Normal {
            information: information.clone(),
            gradient: gradient.clone(),
            ln_evidence: libm::log(*probability),
        };
        for joint in &joints {
            joint.add(*correlation, &mut normal)?;
        }
        let factor = Factor::of(&normal.information, n).map_err(MapError::Prior)?;
        let mut step = normal.gradient.clone();
        factor.solve(&mut step);
        let expected = problem.origin(total);
        let state = expected.iter().zip(&unknowns.sums).map(|(x, sums)| {
            let steps = sums.iter().flatten().map(|&k| step[k]);
            x + steps.sum::<f64>()
        });
        Ok(Posterior {
            ln_evidence: normal.ln_evidence + 0.5 * dot(&normal.gradient, &step)
                - 0.5 * factor.ln_determinant(),
            state: state.collect(),
            sums: unknowns.sums.clone(),
            factor,
        })
    };
    correlations.iter().map(of).collect()
}

/// Normal equations of the unknowns, the lower half, and the part of the logarithm of the evidence that they do not
/// contain.
struct Normal {
    information: Vec<f64>,
    gradient: Vec<f64>,
    ln_evidence: f64,
}

/// Link equations of a joint in baseline and recording.
struct JointEquations<'a> {
    cells: (&'a Cells, Option<&'a Cells>),
    hyperparameters: Hyperparameters,
    /// Residuals around the expected state, those of the recording first.
    residuals: Vec<f64>,
    /// Columns over the unknowns that are not zero.
    columns: Vec<(usize, Vec<f64>)>,
}

impl<'a> JointEquations<'a> {
    /// `before`: covariance of the state before the recording; `distance`: its mean less the state of the linearisation.
    fn new(
        (cells, baseline): (&'a Cells, Option<&'a Cells>),
        unknowns: &Unknowns,
        before: &[f64],
        distance: &[f64],
    ) -> Self {
        let total = distance.len();
        let mut residuals: Vec<f64> = (cells.residuals.iter().zip(cells.rows.chunks_exact(total)))
            .map(|(residual, row)| residual - dot(row, distance))
            .collect();
        let mut hyperparameters = cells.learn(&cells.prior_covariance(before, total), &residuals);
        let mut rows: Vec<Vec<f64>> = (cells.rows.chunks_exact(total))
            .map(|row| unknowns.row(row))
            .collect();
        if let Some(baseline) = baseline.filter(|baseline| baseline.len() > 0) {
            let share = cells.len() as f64 / (cells.len() + baseline.len()) as f64;
            let both = hyperparameters.iter_mut().zip(&baseline.hyperparameters);
            both.for_each(|(own, then)| {
                *own = libm::pow(*own, share) * libm::pow(*then, 1.0 - share);
            });
            residuals.extend(&baseline.residuals);
            rows.extend(baseline.rows.chunks_exact(baseline.width()).map(|row| {
                let mut row = row.to_vec();
                row.resize(unknowns.size, 0.0);
                row
            }));
        }
        let columns = (0..unknowns.size)
            .map(|k| (k, rows.iter().map(|row| row[k]).collect::<Vec<f64>>()))
            .filter(|(_, column)| column.iter().any(|x| *x != 0.0));
        Self {
            cells: (cells, baseline),
            hyperparameters,
            columns: columns.collect(),
            residuals,
        }
    }

    /// Covariance of model error and noise of all cells, row-major.
    fn covariance(&self, correlation: f64) -> Vec<f64> {
        let (own, h) = (self.cells.0, &self.hyperparameters);
        let Some(then) = self.cells.1 else {
            return own.covariance(h);
        };
        let (first, n) = (own.len(), own.len() + then.len());
        let mut out = alloc::vec![0.0; n * n];
        for (cells, from) in [(own, 0), (then, first)] {
            let square = cells.covariance(h);
            for (i, row) in square.chunks_exact(cells.len().max(1)).enumerate() {
                let to = (from + i) * n + from;
                out[to..to + row.len()].copy_from_slice(row);
            }
        }
        for i in 0..then.len() {
            for k in 0..first {
                let value = correlation * then.kernel(i, own, k, h);
                out[(first + i) * n + k] = value;
                out[k * n + first + i] = value;
            }
        }
        out
    }

    /// Adds the equations to those of the unknowns.
    ///
    /// # Errors
    /// Returns [`MapError::Prior`] if the covariance is not positive definite.
    fn add(&self, correlation: f64, normal: &mut Normal) -> Result<(), MapError> {
        let m = self.residuals.len();
        if m == 0 {
            return Ok(());
        }
        let factor = Factor::of(&self.covariance(correlation), m).map_err(MapError::Prior)?;
        let mut residual = self.residuals.clone();
        factor.forward(&mut residual);
        normal.ln_evidence -= 0.5 * (dot(&residual, &residual) + factor.ln_determinant());
        let n = normal.gradient.len();
        let mut white: Vec<(usize, Vec<f64>)> = Vec::with_capacity(self.columns.len());
        for (k, column) in &self.columns {
            let mut column = column.clone();
            factor.forward(&mut column);
            normal.gradient[*k] += dot(&column, &residual);
            for (j, other) in &white {
                normal.information[k * n + j] += dot(&column, other);
            }
            normal.information[k * (n + 1)] += dot(&column, &column);
            white.push((*k, column));
        }
        Ok(())
    }
}

/// Returns the model error of a baseline: its link equations around the estimate `at` without changes, and its other
/// information.
///
/// # Errors
/// Returns a [`MapError`] if a linear system cannot be solved.
pub(super) fn learned(problem: &Problem<'_>, at: &MapEstimate) -> Result<ModelError, MapError> {
    let total = at.state.len();
    let before = prior_covariance(problem, &[], total);
    let information = covariance(&before, total)?;
    let distance: Vec<f64> = (problem.origin(total).iter().zip(&at.state))
        .map(|(a, b)| a - b)
        .collect();
    let (mut joints, motor) = session_equations(problem, at);
    for cells in &mut joints {
        let moved: Vec<f64> = (cells.residuals.iter().zip(cells.rows.chunks_exact(total)))
            .map(|(residual, row)| residual - dot(row, &distance))
            .collect();
        cells.hyperparameters = cells.learn(&cells.prior_covariance(&before, total), &moved);
        cells.round();
    }
    let rows = information.chunks_exact(total).enumerate();
    let lower = rows.flat_map(|(i, row)| {
        let motor = &motor.information[i * total..=i * total + i];
        row.iter().zip(motor).map(|(a, b)| a + b)
    });
    let pulls = information.chunks_exact(total).zip(&motor.gradient);
    Ok(ModelError {
        information_lower: lower.collect(),
        gradient: pulls
            .map(|(row, motor)| dot(row, &distance) + motor)
            .collect(),
        gained_variance: alloc::vec![0.0; total],
        joints,
    })
}

/// Returns a value with nine significant digits, which are enough for an equation and short in a file.
fn rounded(x: f64) -> f64 {
    /// Number of significant digits.
    const DIGITS: f64 = 9.0;
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let digits = DIGITS - 1.0 - libm::floor(libm::log10(x.abs()));
    let scale = libm::pow(10.0, digits.abs());
    if digits > 0.0 {
        libm::round(x * scale) / scale
    } else {
        libm::round(x / scale) * scale
    }
}

/// Covariance of the state before the recording, row-major.
fn prior_covariance(problem: &Problem<'_>, changes: &[ChangePoint], total: usize) -> Vec<f64> {
    let d = problem.start.mean.len();
    let mut out = alloc::vec![0.0; total * total];
    let rows = problem.start.covariance.chunks_exact(d);
    for (to, row) in out.chunks_exact_mut(total).zip(rows) {
        to[..d].copy_from_slice(row);
    }
    let stds = changes.iter().flat_map(|change| problem.stds(change));
    for (k, std) in (d..total).zip(stds) {
        out[k * (total + 1)] = std * std;
    }
    out
}

/// Returns the cells of every joint, and the equations of motors and tension sensors, from blocks that are no outliers.
fn session_equations(problem: &Problem<'_>, at: &MapEstimate) -> (Vec<Cells>, NormalEquations) {
    let mut normal = NormalEquations::new(at.state.len(), problem.layout(), &at.changes);
    let layout = problem.layout();
    let total = at.state.len();
    let weight = |b: usize| at.weights.get(b).copied().unwrap_or(1.0);
    let counts = |b: &usize| weight(*b) > OUTLIER_WEIGHT;
    let accepted = || (0..problem.blocks.len()).filter(counts);
    let mut indices: Vec<(f64, BTreeMap<Key, usize>, Option<Key>)> = (0..layout.joints)
        .map(|joint| {
            let blocks = || accepted().map(|b| &problem.blocks[b]);
            (edge(blocks, joint), BTreeMap::new(), None)
        })
        .collect();
    let mut all: Vec<Cells> = (0..layout.joints).map(|_| Cells::default()).collect();
    let mut equations = Equations::new(layout, &at.changes);
    for b in accepted() {
        let block = &problem.blocks[b];
        problem.equations(at, b, Content::Rows, &mut equations);
        let information = |e: &Equation| match e.side {
            Side::Link => 0.0,
            Side::Motor | Side::Tension => weight(b) * problem.shared_information_of(e, at, b),
        };
        normal.add_gradient(&equations, information);
        normal.add_information(&equations, information);
        for e in equations.list.iter().filter(|e| e.side == Side::Link) {
            let (Some(cells), Some((edge, of, last))) =
                (all.get_mut(e.joint), indices.get_mut(e.joint))
            else {
                continue;
            };
            let key = key(block, e.joint, *edge);
            let new = of.len();
            let k = *of.entry(key).or_insert(new);
            cells.add(k, (block, e.joint), (e, &equations), total);
            if *last != Some(key) {
                cells.passages[k] += 1.0 / same_again(block);
                *last = Some(key);
            }
        }
    }
    all.iter_mut().for_each(|cells| cells.average(total));
    normal.flush();
    (all, normal)
}

/// Edge of the cells of a joint, rad, so that they are at most [`MAX_CELLS`].
fn edge<'a, I: Iterator<Item = &'a Block>>(blocks: impl Fn() -> I, joint: usize) -> f64 {
    /// Factor between the sizes that are tried.
    const FACTOR: f64 = 1.25;
    let mut edge_rad = CELL_RAD;
    let count = |edge_rad: f64| {
        let keys = blocks().map(|block| (key(block, joint, edge_rad), ()));
        keys.collect::<BTreeMap<Key, ()>>().len()
    };
    // Three positions and a direction: at most three cells remain of a motion within one edge.
    while count(edge_rad) > MAX_CELLS {
        edge_rad *= FACTOR;
    }
    edge_rad
}

/// Columns of the changes of a kind in a state whose changes begin at `first`, each with its change.
pub(super) fn columns(
    layout: Layout,
    changes: &[ChangePoint],
    of: impl Fn(&ChangePoint) -> bool,
) -> Vec<(usize, ChangeKind)> {
    let mut column = layout.dimension();
    let mut out = Vec::new();
    for change in changes {
        if of(change) {
            out.extend((0..change.kind.columns()).map(|k| (column + k, change.kind)));
        }
        column += change.kind.columns();
    }
    out
}

impl ModelError {
    /// Adds the variance that the state gained since the previous recording of the chain.
    pub(super) fn gain(&mut self, variance: impl Iterator<Item = f64>) {
        let sums = self.gained_variance.iter_mut().zip(variance);
        sums.for_each(|(sum, variance)| *sum += variance.max(0.0));
    }

    /// Whether all numbers are finite and each has its place, for a check of files.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let d = self.gradient.len();
        let numbers = [
            &self.information_lower,
            &self.gradient,
            &self.gained_variance,
        ];
        let mut numbers = numbers.into_iter().flatten();
        self.information_lower.len() == d * (d + 1) / 2
            && self.gained_variance.len() == d
            && numbers.all(|x| x.is_finite())
            && self.joints.iter().all(|cells| cells.is_valid(d))
    }
}

impl Cells {
    /// Whether all numbers are finite and each has its place; `d`: entries of the state.
    fn is_valid(&self, d: usize) -> bool {
        let m = self.len();
        let vectors = [
            &self.passages,
            &self.directions,
            &self.added_rad2,
            &self.residuals,
        ];
        let numbers = (vectors.into_iter().flatten())
            .chain(&self.rows)
            .chain(self.positions.iter().flatten());
        vectors.iter().all(|v| v.len() == m)
            && self.positions.len() == m
            && self.rows.len() == m * d
            && m <= 10 * MAX_CELLS
            && numbers.copied().all(f64::is_finite)
            && self.passages.iter().all(|x| *x > 0.0)
            && self
                .hyperparameters
                .iter()
                .all(|x| *x > 0.0 && x.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::random;

    /// Unknowns of the tests.
    const N: usize = 3;

    fn cells(count: usize, seed: &mut u64) -> Cells {
        let mut some =
            |scale: f64| -> Vec<f64> { (0..count).map(|_| scale * random(seed)).collect() };
        Cells {
            passages: alloc::vec![2.0; count],
            directions: some(1.0),
            added_rad2: alloc::vec![1e-8; count],
            residuals: some(1e-3),
            positions: some(0.6).into_iter().map(|q| [q, -q, 0.5 * q]).collect(),
            ..Cells::default()
        }
    }

    /// Posterior and evidence by normal equations equal those by the covariance of all equations.
    #[test]
    fn normal_equations_equal_conditional_gaussian() {
        let mut seed = 7;
        let (own, then) = (cells(5, &mut seed), cells(4, &mut seed));
        let m = own.len() + then.len();
        let columns: Vec<(usize, Vec<f64>)> = (0..N)
            .map(|k| (k, (0..m).map(|_| random(&mut seed)).collect()))
            .collect();
        let joint = JointEquations {
            cells: (&own, Some(&then)),
            hyperparameters: [0.8e-3, 0.4e-3, 0.5, 0.3e-3],
            residuals: own
                .residuals
                .iter()
                .chain(&then.residuals)
                .copied()
                .collect(),
            columns: columns.clone(),
        };
        let prior_std = [1e-3, 2e-3, 0.5e-3];
        let mut constant = None;
        for correlation in [0.98, 0.6, 0.3] {
            let mut normal = Normal {
                information: alloc::vec![0.0; N * N],
                gradient: alloc::vec![0.0; N],
                ln_evidence: 0.0,
            };
            for (k, std) in prior_std.iter().enumerate() {
                normal.information[k * (N + 1)] = 1.0 / (std * std);
            }
            joint.add(correlation, &mut normal).unwrap();
            let factor = Factor::of(&normal.information, N).unwrap();
            let mut step = normal.gradient.clone();
            factor.solve(&mut step);
            let ln_evidence = normal.ln_evidence + 0.5 * dot(&normal.gradient, &step)
                - 0.5 * factor.ln_determinant();

            let mut all = joint.covariance(correlation);
            for (k, column) in &columns {
                for i in 0..m {
                    for j in 0..m {
                        all[i * m + j] += prior_std[*k] * prior_std[*k] * column[i] * column[j];
                    }
                }
            }
            let whole = Factor::of(&all, m).unwrap();
            let mut white = joint.residuals.clone();
            whole.solve(&mut white);
            for (k, column) in &columns {
                let direct = prior_std[*k] * prior_std[*k] * dot(column, &white);
                assert!((direct - step[*k]).abs() < 1e-9, "{direct} {}", step[*k]);
            }
            let direct = -0.5 * dot(&joint.residuals, &white) - 0.5 * whole.ln_determinant();
            // Both differ by the determinant of the prior.
            let difference = direct - ln_evidence;
            let first = *constant.get_or_insert(difference);
            assert!((difference - first).abs() < 1e-8, "{difference} {first}");
        }
    }

    /// Two equal equations of baseline and recording: a common model error cancels, an independent one does not.
    #[test]
    fn common_model_error_cancels() {
        let one = |residual_rad: f64| Cells {
            passages: alloc::vec![1.0],
            directions: alloc::vec![1.0],
            added_rad2: alloc::vec![0.0],
            residuals: alloc::vec![residual_rad],
            positions: alloc::vec![[0.2; POSITIONS]],
            ..Cells::default()
        };
        let (own, then) = (one(2e-3), one(2e-3));
        let joint = JointEquations {
            cells: (&own, Some(&then)),
            hyperparameters: [2e-3, 1e-9, 0.5, 0.1e-3],
            residuals: alloc::vec![2e-3, 2e-3],
            // A change that only the recording has.
            columns: alloc::vec![(0, alloc::vec![1.0, 0.0])],
        };
        let std = |correlation: f64| {
            let mut normal = Normal {
                information: alloc::vec![0.0],
                gradient: alloc::vec![0.0],
                ln_evidence: 0.0,
            };
            joint.add(correlation, &mut normal).unwrap();
            libm::sqrt(1.0 / normal.information[0])
        };
        // √(σ² (1 + …)): difference of two readings with noise, and twice the variance of the field.
        assert!(
            (std(1.0) - 0.1e-3 * core::f64::consts::SQRT_2).abs() < 2e-6,
            "{}",
            std(1.0)
        );
        assert!((std(0.0) - 2.0025e-3).abs() < 1e-6, "{}", std(0.0));
    }

    #[test]
    fn rounded_values_are_short() {
        assert_eq!(
            alloc::format!("{}", rounded(0.123_456_789_123)),
            "0.123456789"
        );
        assert_eq!(
            alloc::format!("{}", rounded(-1.234_567_891e-7)),
            "-0.000000123456789"
        );
        assert_eq!(rounded(123_456_789_123.0), 123_456_789_000.0);
        assert_eq!(rounded(0.0), 0.0);
    }
}
