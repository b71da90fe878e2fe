//! Offsets averaged over which joints' stiffness has changed since the prior was learned.

use crate::Gaussian;
use crate::cholesky;
use crate::offset::belief::Belief;
use crate::offset::equations::reduced_model::ReducedModel;
use crate::offset::error::MapError;
use crate::offset::mixture::{self, LOST_STIFFNESS, Mixture};
use crate::offset::parameter::JointParameter;
use alloc::vec::Vec;

/// Offsets averaged over the joints whose stiffness has changed, for an estimate that started with
/// every stiffness opened that was known.
///
/// A change `c ~ N(0, s²)` of some entries `E` of the prior `m₀, P₀` makes `P₀ + s² E Eᵀ` of its covariance.
/// From `x, P` since then
///
/// ```text
/// c = A (x − m₀),   cov c = A P Aᵀ + s² − s⁴ Eᵀ (P₀ + s² E Eᵀ)⁻¹ E,   cov(x, c) = P Aᵀ
/// A = s² Eᵀ (P₀ + s² E Eᵀ)⁻¹
/// ```
///
/// and the mixture is that of [`mixture::average`].
#[derive(Debug, Clone)]
pub(super) struct StiffnessAverage {
    joints: Vec<usize>,
    /// Places of their offsets in the state.
    offsets: Vec<usize>,
    /// `A`, a row per joint.
    towards: Vec<f64>,
    /// What of `cov c` no data takes away.
    left: Vec<f64>,
    /// `P Aᵀ`, a row per joint.
    shared: Vec<f64>,
    values: Vec<f64>,
    covariance: Vec<f64>,
    mixture: Mixture,
}

impl StiffnessAverage {
    /// Opens every stiffness in `start`, of the model's parameters, that is known, and in `whole`, of
    /// all bodies' parameters; allocates here only.
    pub(super) fn open(
        model: &ReducedModel,
        start: &mut Belief,
        whole: &mut Belief,
    ) -> Result<Self, MapError> {
        let d = start.mean.len();
        let joints = model.known_stiffness(start, LOST_STIFFNESS.deviation);
        let place = |parameter| {
            joints
                .iter()
                .map(move |&i| model.layout.place(i, parameter))
        };
        let entries: Vec<usize> = place(JointParameter::Compliance).collect();
        let variance = LOST_STIFFNESS.deviation * LOST_STIFFNESS.deviation;
        for &k in &entries {
            start.covariance[k * d + k] += variance;
            whole.covariance[k * (whole.mean.len() + 1)] += variance;
        }
        let information = cholesky::inverse(&start.covariance, d).map_err(MapError::Prior)?;
        let (mut towards, mut left) = (Vec::new(), Vec::new());
        for &k in &entries {
            let row = &information[k * d..(k + 1) * d];
            towards.extend(row.iter().map(|q| variance * q));
            for &other in &entries {
                let own = if other == k { variance } else { 0.0 };
                left.push(own - variance * variance * row[other]);
            }
        }
        let n = joints.len();
        Ok(Self {
            offsets: place(JointParameter::Offset).collect(),
            towards,
            left,
            shared: alloc::vec![0.0; n * d],
            values: alloc::vec![0.0; 2 * n],
            covariance: alloc::vec![0.0; 4 * n * n],
            mixture: Mixture::new(n, n),
            joints,
        })
    }

    /// Averages the posterior `now`; `start` is the prior with stiffness opened.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n d²).
    pub(super) fn average(&mut self, start: &Belief, now: &Belief) {
        for joint in 0..self.joints.len() {
            self.share(joint, now);
        }
        self.weigh(start, now);
    }

    /// Joints whose stiffness was known.
    pub(super) fn count(&self) -> usize {
        self.joints.len()
    }

    /// The `i`-th row of `P Aᵀ`.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(d²).
    pub(super) fn share(&mut self, i: usize, now: &Belief) {
        let d = now.mean.len().max(1);
        let row = i * d..(i + 1) * d;
        let shared = self.shared.get_mut(row.clone()).unwrap_or_default();
        shared.fill(0.0);
        // Row by row, so that a processor adds side by side.
        let own = self.towards.get(row).unwrap_or_default();
        for (a, line) in own.iter().zip(now.covariance.chunks_exact(d)) {
            for (to, p) in shared.iter_mut().zip(line) {
                *to += a * p;
            }
        }
    }

    /// Averages the posterior, of which all joints' rows are [shared](StiffnessAverage::share).
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n² d).
    pub(super) fn weigh(&mut self, start: &Belief, now: &Belief) {
        let (n, d) = (self.joints.len(), now.mean.len().max(1));
        let at = |x: &[f64], i: usize| x.get(i).copied().unwrap_or(f64::NAN);
        let rows = self.towards.chunks_exact(d);
        let changes = rows.map(|own| {
            let from = now.mean.iter().zip(&start.mean).map(|(x, m)| x - m);
            own.iter().zip(from).map(|(a, x)| a * x).sum()
        });
        let offsets = self.offsets.iter().map(|&k| at(&now.mean, k));
        for (to, value) in self.values.iter_mut().zip(changes.chain(offsets)) {
            *to = value;
        }
        let lines = self.covariance.chunks_exact_mut((2 * n).max(1));
        for (i, line) in lines.enumerate() {
            for (k, to) in line.iter_mut().enumerate() {
                // The one with the change, if there is one.
                let (low, high) = (i.min(k), i.max(k));
                let shared = self.shared.get(low * d..(low + 1) * d).unwrap_or_default();
                *to = if high < n {
                    let own = self.towards.get(high * d..(high + 1) * d);
                    let pairs = own.unwrap_or_default().iter().zip(shared);
                    at(&self.left, high * n + low) + pairs.map(|(a, g)| a * g).sum::<f64>()
                } else if low < n {
                    at(shared, self.offsets.get(high - n).copied().unwrap_or(d))
                } else {
                    let places = (self.offsets.get(low - n), self.offsets.get(high - n));
                    match places {
                        (Some(a), Some(b)) => at(&now.covariance, a * d + b),
                        _ => f64::NAN,
                    }
                };
            }
        }
        self.mixture
            .weigh(&self.values, &self.covariance, LOST_STIFFNESS);
    }

    /// The posterior, averaged as the offsets are. `now` is what [`StiffnessAverage::average`] had last. Allocates.
    pub(super) fn averaged(&self, now: &Belief) -> Result<Belief, MapError> {
        let (n, d) = (self.joints.len(), now.mean.len());
        let mut averaged = now.clone();
        let change = &self.values[..n];
        let rows = self.covariance.chunks_exact((2 * n).max(1)).take(n);
        let own: Vec<f64> = rows.flat_map(|row| row.iter().take(n).copied()).collect();
        let shared: Vec<f64> = (0..d)
            .flat_map(|k| (0..n).map(move |i| self.shared[i * d + k]))
            .collect();
        let (mean, covariance) = (&mut averaged.mean, &mut averaged.covariance);
        mixture::apply((change, &own), &shared, &self.mixture, mean, covariance)?;
        Ok(averaged)
    }

    /// Offset of a joint, rad; `None` for one whose stiffness was not known.
    pub(super) fn offset(&self, joint: usize) -> Option<Gaussian> {
        let n = self.joints.len();
        let i = n + self.joints.iter().position(|own| *own == joint)?;
        let (mean, variance) = (
            self.mixture.mean.get(i)?,
            self.mixture.spread.get(i * 2 * n + i)?,
        );
        Some(Gaussian::new(*mean, libm::sqrt(*variance)))
    }

    /// Probability that the stiffness of a joint has changed.
    pub(super) fn probability(&self, joint: usize) -> Option<f64> {
        let i = self.joints.iter().position(|own| *own == joint)?;
        self.mixture.probability.get(i).copied()
    }
}
