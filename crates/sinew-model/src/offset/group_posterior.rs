//! Posterior of the tendons of a group with one equation per joint: combinations of their elongations.
//!
//! The joints' motion determines only `Rᵀ K delta`: as many numbers as joints. With the posterior covariance `C` of the
//! elongations of a group and the standard deviations `s` of the prior, the eigenvectors of `S⁻¹ C S⁻¹`, `S = diag(s)`,
//! are directions with independent information of the recording, and the eigenvalues are the shares of the prior
//! variance that remain.
//!
//! ```text
//! joint offset = (rhoᵀ K rho)⁻¹ rhoᵀ K delta
//! ```

use super::effects::JointParameter as P;
use super::prior::Prior;
use super::state_estimate::StateEstimate;
use crate::Gaussian;
use crate::cholesky::{self, Factor, dot};
use crate::eigen;
use crate::routings::{PulledGroup, Routings};
use alloc::vec::Vec;

/// A direction is unseen where more of the prior's variance is left: half of its standard deviation.
const UNOBSERVABLE_VARIANCE: f64 = 0.25;
/// A tendon belongs to an unobservable direction with a larger weight, each scaled by its prior.
const MIN_WEIGHT: f64 = 0.1;

/// Posterior of the tendons of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupPosterior {
    /// Joints, by axis, increasing.
    pub joints: Vec<usize>,
    /// Axes of the tendons, increasing.
    pub tendons: Vec<usize>,
    /// Combinations of elongations that the recording does not determine.
    pub unobservable: Vec<UnobservableDirection>,
    /// Offset of every joint, rad: its rotation by the elongations at the same motor positions. `None` if the tendons
    /// do not determine the joints, e.g. one rope over two joints.
    pub joint_offsets_rad: Option<Vec<Gaussian>>,
}

/// Combination of elongations that a recording does not determine.
#[derive(Debug, Clone, PartialEq)]
pub struct UnobservableDirection {
    /// Axes of its tendons, with elongations relative to the largest, which is 1.
    pub weights: Vec<(usize, f64)>,
    /// Standard deviation of the elongation of the tendon with the largest weight along this direction, rad.
    pub std_rad: f64,
}

/// Computes the posterior of every group with one equation per joint; empty for a robot on which every tendon has a
/// separate equation. Allocates.
///
/// * `before`, `after`: prior and posterior of the recording.
/// * `stiffness`: tangent of tension over extension of the tendon on every axis, in the mean over the recording,
///   N·m/rad.
pub fn group_posteriors(
    prior: &Prior,
    before: &StateEstimate,
    after: &StateEstimate,
    stiffness: &[f64],
) -> Vec<GroupPosterior> {
    let Some(routes) = prior.routings() else {
        return Vec::new();
    };
    let d = prior.dimension();
    let is_other = |state_estimate: &&StateEstimate| state_estimate.check_dimension(d).is_err();
    if [before, after].iter().any(is_other) || stiffness.len() != prior.joints() {
        return Vec::new();
    }
    let groups = routes.groups();
    let of = groups.into_iter().map(|PulledGroup { joints, tendons }| {
        let places: Vec<usize> = tendons.iter().map(|i| prior.place(*i, P::Offset)).collect();
        let cell = |a: usize, b: usize| after.covariance[a * d + b];
        let covariance: Vec<f64> = (places.iter())
            .flat_map(|a| places.iter().map(|b| cell(*a, *b)))
            .collect();
        let scale: Vec<f64> = places.iter().map(|k| before.entry(*k).std).collect();
        let mean: Vec<f64> = places.iter().map(|k| after.mean[*k]).collect();
        let stiffness: Vec<f64> = tendons.iter().map(|i| stiffness[*i]).collect();
        GroupPosterior {
            unobservable: unobservable(&tendons, &covariance, &scale),
            joint_offsets_rad: joint_offsets(
                routes,
                (&joints, &tendons),
                &stiffness,
                (&mean, &covariance),
            ),
            joints,
            tendons,
        }
    });
    of.collect()
}

/// Returns the directions in which the recording provides almost no information.
fn unobservable(
    tendons: &[usize],
    covariance: &[f64],
    scale: &[f64],
) -> Vec<UnobservableDirection> {
    let n = tendons.len();
    let whitened = (0..n * n).map(|k| covariance[k] / (scale[k / n] * scale[k % n]));
    let (values, vectors) = eigen::symmetric(whitened.collect(), n);
    let directions = values.iter().zip(vectors.chunks_exact(n.max(1)));
    let directions = directions.filter(|(value, _)| **value > UNOBSERVABLE_VARIANCE);
    let of = directions.map(|(value, vector)| {
        let elongations: Vec<f64> = vector.iter().zip(scale).map(|(v, s)| v * s).collect();
        let largest =
            (elongations.iter()).fold(0.0, |a: f64, b| if b.abs() > a.abs() { *b } else { a });
        let members = tendons.iter().zip(&elongations).zip(vector);
        let members = members.filter(|(_, v)| v.abs() > MIN_WEIGHT);
        UnobservableDirection {
            weights: members.map(|((i, x), _)| (*i, x / largest)).collect(),
            std_rad: libm::sqrt(*value) * largest.abs(),
        }
    });
    of.collect()
}

/// `(rhoᵀ K rho)⁻¹ rhoᵀ K delta` with its covariance's diagonal; `None` where the matrix has no full rank.
fn joint_offsets(
    routes: &Routings,
    (joints, tendons): (&[usize], &[usize]),
    stiffness: &[f64],
    (mean, covariance): (&[f64], &[f64]),
) -> Option<Vec<Gaussian>> {
    let (n, t) = (joints.len(), tendons.len());
    if t < n {
        return None;
    }
    let arm = |i: usize, j: usize| routes.moment_arm(tendons[i], joints[j]);
    let mut square = alloc::vec![0.0; n * n];
    for (k, to) in square.iter_mut().enumerate() {
        let (a, b) = (k / n, k % n);
        *to = (0..t).map(|i| arm(i, a) * stiffness[i] * arm(i, b)).sum();
    }
    let size = cholesky::inverse(&square, n).ok()?;
    // Nearly dependent moment arms provide no information.
    let condition = (0..n).map(|j| square[j * (n + 1)] * size[j * (n + 1)]);
    if condition.fold(0.0, f64::max) > crate::tendons::MAX_CONDITION * crate::tendons::MAX_CONDITION
    {
        return None;
    }
    let factor = Factor::of(&square, n).ok()?;
    // Rows of (rhoᵀ K rho)⁻¹ rhoᵀ K.
    let mut rows = alloc::vec![0.0; n * t];
    for i in 0..t {
        let mut column: Vec<f64> = (0..n).map(|j| arm(i, j) * stiffness[i]).collect();
        factor.solve(&mut column);
        for (j, x) in column.into_iter().enumerate() {
            rows[j * t + i] = x;
        }
    }
    let of_joint = rows.chunks_exact(t).map(|row| {
        let lines = covariance.chunks_exact(t);
        let variance: f64 = row
            .iter()
            .zip(lines)
            .map(|(x, line)| x * dot(line, row))
            .sum();
        Gaussian::new(dot(row, mean), libm::sqrt(variance.max(0.0)))
    });
    Some(of_joint.collect())
}
