//! Robust maximum-a-posteriori estimate of offsets and of what disguises itself as them.
//!
//! All joints are estimated together: a wrong mass shows at several joints, a stretched rope at
//! one. Every nuisance parameter has a prior from a data sheet's tolerance; a baseline recording,
//! taken right after tensioning, turns the prior into a posterior that later recordings start
//! from.
//!
//! ```text
//! y = delta_e + d − η d³ + encoder(q) + α_T ΔT + noise,     d = τ (1 + δκ + c_K ΔT) / K
//! τ = Φ (π₀ + δπ) + payload + F_c z + F_v dq + μ z |τ|
//! u = (1 + k)(τ + J ddtheta + F_m z_m + F_vm dtheta + μ_m z_m |τ|) + b + noise
//! ```
//!
//! Gauss–Newton on the whole posterior with a redescending weight on the joint normalised
//! residual of each block (all joints of a block share one weight: a contact shows at several),
//! annealed from a wide scale so that the start doesn't matter.

use super::changes::{Change, offset_columns};
use super::equation::{Equation, Equations, Side};
use super::features::{Block, FeatureConfig};
use super::normal::{Normal, Residuals, pose_runs};
use super::prior::{Belief, Payload, Prior};
use crate::cholesky;
use alloc::vec::Vec;

/// Why there is no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// Nothing to estimate from.
    #[error("the recording has no complete block of data")]
    NoData,
    /// The prior's covariance is not one.
    #[error("the prior's covariance is not positive definite at entry {0}")]
    Prior(usize),
    /// Prior and robot don't go together.
    #[error("the prior has {found} entries, this robot needs {expected}")]
    Dimension {
        /// Entries needed.
        expected: usize,
        /// Entries given.
        found: usize,
    },
}

/// The posterior.
#[derive(Debug, Clone, PartialEq)]
pub struct MapEstimate {
    /// Changes within the recording.
    pub changes: Vec<Change>,
    /// State of the robot as [`Prior`] lays it out, then the entries of every change.
    pub state: Vec<f64>,
    /// Their covariance, row-major.
    pub covariance: Vec<f64>,
    /// Temperature the offsets refer to, °C; NaN where unknown.
    pub temperature_c: f64,
    /// Robust noise of each joint's link equation, rad.
    pub noise_rad: Vec<f64>,
    /// Robust noise of each joint's motor equation, N·m.
    pub motor_noise_nm: Vec<f64>,
    /// Weight of each block, 0 (left out) to 1.
    pub weights: Vec<f64>,
    /// Half the robust chi-square of data and prior.
    pub cost: f64,
    /// Variance of a block's mean over that of independent noise, per block.
    pub(super) inflation: Vec<f64>,
}

impl MapEstimate {
    /// Offset of a joint at the end of the recording and its standard deviation, rad.
    pub fn offset(&self, prior: &Prior, joint: usize) -> [f64; 2] {
        self.offset_at(prior, joint, f64::INFINITY)
    }

    /// Offset of a joint at a time, s, and its standard deviation, rad.
    pub fn offset_at(&self, prior: &Prior, joint: usize, time_s: f64) -> [f64; 2] {
        self.sum(&offset_columns(prior, &self.changes, joint, time_s))
    }

    /// Size of change `k` (of a payload: its mass, kg) and its standard deviation.
    pub fn change(&self, prior: &Prior, k: usize) -> [f64; 2] {
        let before: usize = self.changes[..k].iter().map(|c| c.what.columns()).sum();
        self.sum(&[prior.dimension() + before])
    }

    /// Sum of entries of the state and its standard deviation.
    pub(super) fn sum(&self, columns: &[usize]) -> [f64; 2] {
        let total = self.state.len();
        let (mut mean, mut variance) = (0.0, 0.0);
        for &i in columns {
            mean += self.state[i];
            for &k in columns {
                variance += self.covariance[i * total + k];
            }
        }
        [mean, libm::sqrt(variance)]
    }

    /// What is believed of the robot at the end of the recording: every change has become part of
    /// what it changed.
    pub fn belief(&self, prior: &Prior) -> Belief {
        let (d, total) = (prior.dimension(), self.state.len());
        // Place each column adds to.
        let mut places: Vec<usize> = (0..d).collect();
        for change in &self.changes {
            let base = change.what.place(prior);
            places.extend(base..base + change.what.columns());
        }
        let (mut mean, mut covariance) = (alloc::vec![0.0; d], alloc::vec![0.0; d * d]);
        for (i, &to_i) in places.iter().enumerate() {
            mean[to_i] += self.state[i];
            for (k, &to_k) in places.iter().enumerate() {
                covariance[to_i * d + to_k] += self.covariance[i * total + k];
            }
        }
        Belief {
            mean,
            covariance,
            temperature_c: self.temperature_c,
        }
    }
}

/// Solves for offsets and nuisance parameters together.
#[derive(Debug, Clone)]
pub struct MapEstimator {
    prior: Prior,
    /// Correlation time of the noise over the length of a block.
    inflation: f64,
    block_s: f64,
    /// No joint is trusted to better than this, rad.
    noise_floor_rad: f64,
    motor_torque: bool,
}

/// Scales of the redescending weight, in standard deviations: one Gauss–Newton step each. The
/// equations are so nearly linear that one step per scale is within 1 % of many.
const SCALES: [f64; 10] = [40.0, 40.0, 20.0, 10.0, 6.0, 4.0, 3.5, 3.0, 3.0, 3.0];
/// The same from a start that is nearly right.
const WARM_SCALES: [f64; 5] = [12.0, 6.0, 3.5, 3.0, 3.0];
/// The scale that decides.
const SCALE: f64 = 3.0;

impl MapEstimator {
    /// An estimator for the priors of a robot and blocks made with `features`.
    pub fn new(prior: Prior, features: &FeatureConfig) -> Self {
        /// Friction stays for a stroke.
        const STROKE_S: f64 = 0.3;
        // Two time constants of the low-pass every signal has gone through, and a stroke.
        let correlation_s = 2.0 / features.gain_per_s + STROKE_S;
        Self {
            prior,
            inflation: (correlation_s / features.block_s).max(1.0),
            block_s: features.block_s,
            noise_floor_rad: 0.12e-3,
            motor_torque: true,
        }
    }

    /// Whether a recorded motor torque is used; it is unless this says otherwise.
    #[must_use]
    pub fn with_motor_torque(mut self, used: bool) -> Self {
        self.motor_torque = used;
        self
    }

    /// Whether a recorded motor torque is used.
    pub fn uses_motor_torque(&self) -> bool {
        self.motor_torque
    }

    /// The priors.
    pub fn prior(&self) -> &Prior {
        &self.prior
    }

    pub(super) fn block_s(&self) -> f64 {
        self.block_s
    }

    /// The estimate from `blocks` with changes at known moments.
    ///
    /// `payload` is what was opened in `start`; it sets what a change of payload may be.
    ///
    /// # Errors
    /// [`MapError`].
    pub fn solve(
        &self,
        start: &Belief,
        changes: &[Change],
        payload: Payload,
        blocks: &[Block],
    ) -> Result<MapEstimate, MapError> {
        self.solve_from(start, changes, payload, blocks, None)
    }

    /// [`MapEstimator::solve`] from a state that is nearly right, with its noise.
    pub(super) fn solve_from(
        &self,
        start: &Belief,
        changes: &[Change],
        payload: Payload,
        blocks: &[Block],
        warm: Option<(&[f64], &MapEstimate)>,
    ) -> Result<MapEstimate, MapError> {
        let d = self.prior.dimension();
        if start.mean.len() != d || start.covariance.len() != d * d {
            return Err(MapError::Dimension {
                expected: d,
                found: start.mean.len(),
            });
        }
        if blocks.is_empty() {
            return Err(MapError::NoData);
        }
        let n = self.prior.joints();
        let total = d + changes.iter().map(|c| c.what.columns()).sum::<usize>();
        let prior_information = self.prior_information(start, changes, payload, total)?;
        let mut state = start.mean.clone();
        state.resize(total, 0.0);
        let origin = state.clone();
        let mut at = MapEstimate {
            changes: changes.to_vec(),
            state,
            covariance: Vec::new(),
            temperature_c: start.temperature_c,
            noise_rad: alloc::vec![1e-3; n],
            motor_noise_nm: (0..n).map(|i| self.motor_floor(i)).collect(),
            weights: alloc::vec![1.0; blocks.len()],
            cost: 0.0,
            inflation: pose_runs(blocks)
                .iter()
                .map(|r| r.max(self.inflation))
                .collect(),
        };
        let mut scales = SCALES.as_slice();
        if let Some((state, known)) = warm {
            at.state.copy_from_slice(state);
            at.noise_rad.copy_from_slice(&known.noise_rad);
            at.motor_noise_nm.copy_from_slice(&known.motor_noise_nm);
            scales = &WARM_SCALES;
        }
        let mut normal = Normal::new(total);
        let mut residuals = Residuals::new(n, blocks.len());
        for (stage, &scale) in scales.iter().enumerate() {
            normal.start(&prior_information, &origin, &at.state);
            for (b, block) in blocks.iter().enumerate() {
                self.equations(&at, block, &mut normal.equations);
                let chi = self.chi(&normal.equations, &at);
                let w = scale * scale / (scale * scale + chi);
                at.weights[b] = w * w;
                residuals.keep(b, &normal.equations);
                for k in 0..normal.equations.list.len() {
                    let e = normal.equations.list[k];
                    let information = w * w * self.information_of(&e, &at, b);
                    normal.add(&e, information);
                }
            }
            normal.solve()?;
            for (x, step) in at.state.iter_mut().zip(&normal.gradient) {
                *x += step;
            }
            // Noise from the residuals, once they mean something.
            if stage >= 2 || warm.is_some() {
                for i in 0..n {
                    at.noise_rad[i] = residuals.noise(i, Side::Link).max(self.noise_floor_rad);
                    at.motor_noise_nm[i] = residuals.noise(i, Side::Motor).max(self.motor_floor(i));
                }
            }
        }
        normal.mirror();
        at.covariance = cholesky::inverse(&normal.information, total).map_err(MapError::Prior)?;
        at.cost = self.cost(&prior_information, &origin, &at, &at, blocks);
        Ok(at)
    }

    /// What a block's link equations leave, `n`, rad; 0 for a rigid joint.
    pub fn residuals(&self, at: &MapEstimate, block: &Block, out: &mut [f64]) {
        let mut equations = Equations::default();
        self.equations(at, block, &mut equations);
        out.fill(0.0);
        for e in equations.list.iter().filter(|e| e.side == Side::Link) {
            if let Some(slot) = out.get_mut(e.joint) {
                *slot = e.residual;
            }
        }
    }

    /// Equations of a block around a state without changes.
    pub(super) fn linearise(
        &self,
        block: &Block,
        reference_c: f64,
        x: &[f64],
        out: &mut Equations,
    ) {
        self.prior
            .linearise(block, reference_c, &[], self.motor_torque, x, out);
    }

    /// Variance of a block's mean over that of independent noise.
    pub(super) fn inflation(&self) -> f64 {
        self.inflation
    }

    pub(super) fn noise_floor_rad(&self) -> f64 {
        self.noise_floor_rad
    }

    /// Least noise of a motor equation, N·m: ripple and what a friction law leaves.
    pub(super) fn motor_floor(&self, i: usize) -> f64 {
        const PART: f64 = 0.1;
        self.prior.joints[i].as_ref().map_or(1.0, |j| {
            (PART * j.motor_coulomb_nm).max(1e-4 * j.stiffness_nm_per_rad)
        })
    }

    /// Equations of a block around an estimate.
    pub(super) fn equations(&self, at: &MapEstimate, block: &Block, out: &mut Equations) {
        self.prior.linearise(
            block,
            at.temperature_c,
            &at.changes,
            self.motor_torque,
            &at.state,
            out,
        );
    }

    /// Mean square of a block's residuals over what they may be.
    pub(super) fn chi(&self, equations: &Equations, at: &MapEstimate) -> f64 {
        let sum: f64 = equations
            .list
            .iter()
            .map(|e| e.residual * e.residual / variance(e, at))
            .sum();
        sum / equations.list.len().max(1) as f64
    }

    /// Information of an equation of block `b` at full weight.
    pub(super) fn information_of(&self, e: &Equation, at: &MapEstimate, b: usize) -> f64 {
        1.0 / (variance(e, at) * at.inflation[b])
    }

    fn prior_information(
        &self,
        start: &Belief,
        changes: &[Change],
        payload: Payload,
        total: usize,
    ) -> Result<Vec<f64>, MapError> {
        let d = self.prior.dimension();
        let own = cholesky::inverse(&start.covariance, d).map_err(MapError::Prior)?;
        let mut information = alloc::vec![0.0; total * total];
        for i in 0..d {
            information[i * total..i * total + d].copy_from_slice(&own[i * d..(i + 1) * d]);
        }
        let mut k = d;
        for change in changes {
            for deviation in self.change_deviations(change.what, payload) {
                information[k * total + k] = 1.0 / (deviation * deviation);
                k += 1;
            }
        }
        Ok(information)
    }

    /// Normal equations of the prior alone around the state `x`.
    pub(super) fn prior_equations(
        &self,
        start: &Belief,
        changes: &[Change],
        payload: Payload,
        x: &[f64],
    ) -> Result<(Vec<f64>, Vec<f64>), MapError> {
        let total = x.len();
        let information = self.prior_information(start, changes, payload, total)?;
        let mut origin = start.mean.clone();
        origin.resize(total, 0.0);
        let gradient = (0..total)
            .map(|i| {
                (0..total)
                    .map(|k| information[i * total + k] * (origin[k] - x[k]))
                    .sum()
            })
            .collect();
        Ok((information, gradient))
    }

    /// Cost of `at` if the noise were that of `noise`.
    pub(super) fn cost_at(
        &self,
        start: &Belief,
        at: &MapEstimate,
        noise: &MapEstimate,
        payload: Payload,
        blocks: &[Block],
    ) -> Result<f64, MapError> {
        let total = at.state.len();
        let information = self.prior_information(start, &at.changes, payload, total)?;
        let mut origin = start.mean.clone();
        origin.resize(total, 0.0);
        Ok(self.cost(&information, &origin, at, noise, blocks))
    }

    fn cost(
        &self,
        prior_information: &[f64],
        origin: &[f64],
        at: &MapEstimate,
        noise: &MapEstimate,
        blocks: &[Block],
    ) -> f64 {
        let total = at.state.len();
        let mut cost = 0.0;
        for i in 0..total {
            for k in 0..total {
                cost += 0.5
                    * prior_information[i * total + k]
                    * (at.state[i] - origin[i])
                    * (at.state[k] - origin[k]);
            }
        }
        let mut equations = Equations::default();
        for (b, block) in blocks.iter().enumerate() {
            self.equations(at, block, &mut equations);
            let chi = self.chi(&equations, noise);
            let count = equations.list.len() as f64;
            cost += 0.5 * count * SCALE * SCALE * chi / (SCALE * SCALE + chi) / noise.inflation[b];
        }
        cost
    }
}

/// Variance of an equation's residual.
fn variance(e: &Equation, at: &MapEstimate) -> f64 {
    let noise = match e.side {
        Side::Link => at.noise_rad[e.joint],
        Side::Motor => at.motor_noise_nm[e.joint],
    };
    noise * noise + e.unsure * e.unsure
}
