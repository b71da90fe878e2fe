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
    /// Places of their compliances in the state.
    compliances: Vec<usize>,
    /// Places of their offsets.
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
    dimension: usize,
    /// Rows of `P` that are gone over in a slice.
    rows_at_once: usize,
    /// Sets of changes that are weighed in one.
    sets_at_once: usize,
}

/// A slice is a quarter of `d²` terms, as a band of `P` that is written is.
const ROWS_OVER_BAND: usize = 4;
/// How much longer a set of `n` changes among `2n` values takes than `n³` terms of a row do: measured.
const SET_OVER_ROW: usize = 100;

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
            compliances: entries,
            dimension: d,
            rows_at_once: (d / (ROWS_OVER_BAND * n).max(1)).max(1),
            sets_at_once: (d * d / (SET_OVER_ROW * n * n * n).max(1)).max(1),
            joints,
        })
    }

    /// Places of the compliances that may change.
    pub(super) fn compliances(&self) -> &[usize] {
        &self.compliances
    }

    /// Averages the posterior `now`; `start` is the prior with stiffness opened.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n d²), and O(n³) a set of changes.
    pub(super) fn average(&mut self, start: &Belief, now: &Belief) {
        for slice in 0..self.slices() {
            self.slice(slice, start, now);
        }
    }

    /// Slices of work that an average takes.
    pub(super) fn slices(&self) -> usize {
        self.shares() + 2 + self.mixture.sets().div_ceil(self.sets_at_once.max(1))
    }

    /// Slices in which `P Aᵀ` is made.
    fn shares(&self) -> usize {
        self.dimension.div_ceil(self.rows_at_once.max(1))
    }

    /// One of the slices. Until the last, offsets and probabilities are those of the average before.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(d²).
    pub(super) fn slice(&mut self, slice: usize, start: &Belief, now: &Belief) {
        let behind = slice.checked_sub(self.shares());
        if slice + 1 == self.slices() {
            self.mixture.finish();
        } else if let Some(behind) = behind {
            let Some(nth) = behind.checked_sub(1) else {
                self.gather(start, now);
                self.mixture.begin();
                return;
            };
            let first = nth * self.sets_at_once;
            let end = self.mixture.sets().min(first + self.sets_at_once);
            let open = (self.values.as_slice(), self.covariance.as_slice());
            self.mixture.weigh_some(first..end, open, LOST_STIFFNESS);
        } else {
            self.share(slice * self.rows_at_once, now);
        }
    }

    /// What some rows of `P` add to `P Aᵀ`, from the `first` on: every row is read once, for all joints. O(n d) a row.
    fn share(&mut self, first: usize, now: &Belief) {
        let d = self.dimension.max(1);
        if first == 0 {
            self.shared.fill(0.0);
        }
        let lines = now.covariance.chunks_exact(d).enumerate();
        for (row, line) in lines.skip(first).take(self.rows_at_once) {
            let own = self.towards.chunks_exact(d);
            for (shared, own) in self.shared.chunks_exact_mut(d).zip(own) {
                let a = own.get(row).copied().unwrap_or_default();
                for (to, p) in shared.iter_mut().zip(line) {
                    *to += a * p;
                }
            }
        }
    }

    /// Changes and offsets, with their covariance, of a posterior all of whose rows are [shared](StiffnessAverage::share).
    /// O(n² d).
    fn gather(&mut self, start: &Belief, now: &Belief) {
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
