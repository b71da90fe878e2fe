//! Robust maximum-a-posteriori estimate of offsets and of what disguises itself as them.
//!
//! All joints are estimated together: a wrong mass shows at several joints, a stretched rope at
//! one. Every nuisance parameter has a prior from a data sheet's tolerance; a baseline recording,
//! taken right after tensioning, turns the prior into a posterior that later recordings start
//! from.
//!
//! ```text
//! LP[x + η x³] = τ (1 + δκ + c_K ΔT) / K,   x = theta_measured − q − delta_e − encoder(q) − α_T ΔT
//! τ = Φ (π₀ + δπ) + payload + F_c z + F_v dq + μ z |τ|
//! u = (1 + k)(τ + J ddtheta + F_m z_m + F_vm dtheta + μ_m z_m |τ|) + b + noise
//! ```
//!
//! Gauss–Newton on the whole posterior with a redescending weight on the joint normalised
//! residual of each block (all joints of a block share one weight: a contact shows at several),
//! annealed from a wide scale so that the start doesn't matter.

use super::block::Block;
use super::certainty::Certainty;
use super::changes::{Change, offset_columns};
use super::config::FeatureConfig;
use super::equation::{Equations, Side};
use super::hands::{Hands, OneHand};
use super::model::Model;
use super::prior::{Belief, Payload, Prior};
use super::solve::Problem;
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

/// Stiffness that may have changed since what was believed before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffnessSince {
    /// Probability that it has.
    pub probability: f64,
    /// By how much the compliance rose if it has, over nominal.
    pub softer: f64,
    /// Standard deviation of that.
    pub deviation: f64,
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
    /// Whether each joint's stiffness has changed since what was believed before; `None` where that
    /// isn't sought.
    pub stiffness_since: Vec<Option<StiffnessSince>>,
    /// How sure each change that was found is ([`MapEstimate::certainty`]).
    pub certainties: Vec<Certainty>,
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
        let mut all = self.clone();
        all.fold(prior, |_| true);
        Belief {
            mean: all.state,
            covariance: all.covariance,
            temperature_c: all.temperature_c,
        }
    }

    /// Makes some changes part of what they changed.
    pub(super) fn fold(&mut self, prior: &Prior, which: impl Fn(&Change) -> bool) {
        let (d, total) = (prior.dimension(), self.state.len());
        // Place each column adds to.
        let mut places: Vec<usize> = (0..d).collect();
        let mut left = d;
        for change in &self.changes {
            let columns = change.what.columns();
            let base = if which(change) {
                change.what.place(prior.layout())
            } else {
                left += columns;
                left - columns
            };
            places.extend(base..base + columns);
        }
        let (mut mean, mut covariance) = (alloc::vec![0.0; left], alloc::vec![0.0; left * left]);
        for (i, &to_i) in places.iter().enumerate() {
            mean[to_i] += self.state[i];
            for (k, &to_k) in places.iter().enumerate() {
                covariance[to_i * left + to_k] += self.covariance[i * total + k];
            }
        }
        self.changes.retain(|change| !which(change));
        (self.state, self.covariance) = (mean, covariance);
    }
}

/// Solves for offsets and nuisance parameters together.
#[derive(Debug, Clone)]
pub struct MapEstimator {
    prior: Prior,
    model: Model,
    /// Correlation time of the noise over the length of a block.
    inflation: f64,
    block_s: f64,
    /// By how much blocks lag behind what happens, s.
    delay_s: f64,
    /// No joint is trusted to better than this, rad.
    noise_floor_rad: f64,
    motor_torque: bool,
    hands: &'static dyn Hands,
}

impl MapEstimator {
    /// An estimator for the priors of a robot and blocks made with `features`.
    pub fn new(prior: Prior, features: &FeatureConfig) -> Self {
        /// Friction stays for a stroke.
        const STROKE_S: f64 = 0.3;
        // Two time constants of the low-pass every signal has gone through, and a stroke.
        let correlation_s = 2.0 / features.gain_per_s + STROKE_S;
        Self {
            model: Model::new(&prior),
            prior,
            inflation: (correlation_s / features.block_s).max(1.0),
            block_s: features.block_s,
            delay_s: features.delay_s(),
            noise_floor_rad: 0.12e-3,
            motor_torque: true,
            hands: &OneHand,
        }
    }

    /// Whether a recorded motor torque is used; it is unless this says otherwise.
    #[must_use]
    pub fn with_motor_torque(mut self, used: bool) -> Self {
        self.motor_torque = used;
        self
    }

    /// Who does what can be done at once; one thing goes after the other unless this says otherwise.
    #[must_use]
    pub fn with_hands(mut self, hands: &'static dyn Hands) -> Self {
        self.hands = hands;
        self
    }

    pub(super) fn hands(&self) -> &dyn Hands {
        self.hands
    }

    /// Whether a recorded motor torque is used.
    pub fn uses_motor_torque(&self) -> bool {
        self.motor_torque
    }

    /// The priors.
    pub fn prior(&self) -> &Prior {
        &self.prior
    }

    /// What blocks can tell apart.
    pub(super) fn model(&self) -> &Model {
        &self.model
    }

    pub(super) fn block_s(&self) -> f64 {
        self.block_s
    }

    pub(super) fn delay_s(&self) -> f64 {
        self.delay_s
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
        let problem = Problem::new(self, start, payload, blocks)?;
        problem.complete(problem.solve(changes)?)
    }

    /// What a block's link equations leave, `n`, rad; 0 for a rigid joint.
    pub fn residuals(&self, at: &MapEstimate, block: &Block, out: &mut [f64]) {
        let mut equations = Equations::new(self.model.layout, &at.changes);
        self.model.linearise(
            block,
            at.temperature_c,
            &at.changes,
            self.motor_torque,
            &self.model.reduced(&at.state),
            &mut equations,
        );
        out.fill(0.0);
        for e in equations.list.iter().filter(|e| e.side == Side::Link) {
            if let Some(slot) = out.get_mut(e.joint) {
                *slot = e.residual;
            }
        }
    }

    /// Equations of a block around a state of the model, without changes.
    pub(super) fn linearise(
        &self,
        block: &Block,
        reference_c: f64,
        x: &[f64],
        out: &mut Equations,
    ) {
        self.model
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
        let joint = self.prior.joints.get(i).and_then(Option::as_ref);
        joint.map_or(1.0, |j| {
            (PART * j.drive_coulomb_nm()).max(1e-4 * j.stiffness_nm_per_rad)
        })
    }
}
