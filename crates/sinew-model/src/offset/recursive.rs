//! The absolute offset, block by block: a small Kalman step five times a second.

use super::block::Block;
use super::equation::{Equation, Equations, Side};
use super::map::MapEstimator;
use super::prior::{Belief, JointParameter, PAYLOAD, PER_JOINT};
use crate::StepError;
use crate::arm::PARAMETERS_PER_BODY;
use alloc::vec::Vec;

/// Recursive form of [`MapEstimator::solve`]: the same equations, priors and joint block weights,
/// one block at a time, with a state that never grows.
///
/// ```text
/// e = residual,  s = h P hᵀ,  R = σ² ι / w,   w = (c²/(c² + χ))²,  χ = mean e²/(s + σ²)
/// x ← x + P hᵀ e/(s + R),     P ← P − P hᵀ h P/(s + R)
/// ```
///
/// The scale `c` of the redescending weight falls from wide to 3 with the data, as the batch
/// form's does from iteration to iteration; `ι` spreads the information of correlated blocks, and
/// a stand counts as one block. Noise `σ` follows the median of the innovations.
///
/// A block is weighed twice: when it comes, and a quarter of a minute later, with what is known by
/// then, `χ = mean e²/σ²`. What it then says more or less than it did goes in as a measurement of
/// the information `Δ = (w₂/σ₂² − w₁/σ₁²)/ι`, less than nothing where a contact is left out:
///
/// ```text
/// x ← x + P hᵀ e/(s + 1/Δ),     P ← P − P hᵀ h P/(s + 1/Δ)
/// ```
///
/// # Realtime
/// [`RecursiveOffsets::step`]: no allocation, lock, panic or clock; `O(n d²)`. Keeps 75 blocks,
/// `600 (10 n² + 22 n)` bytes.
#[derive(Debug, Clone)]
pub struct RecursiveOffsets {
    estimator: MapEstimator,
    belief: Belief,
    /// Noise of link and motor equations.
    noise: [Vec<f64>; 2],
    equations: Equations,
    /// State the equations were linearised around.
    origin: Vec<f64>,
    /// `P hᵀ` of the equation at work.
    gain: Vec<f64>,
    /// Pose the arm stands at, and for how many blocks.
    pose: Vec<f64>,
    stood: f64,
    blocks: f64,
    weight: f64,
    /// Mean weight of late: a filter that leaves most out has no say in what was right.
    trust: f64,
    /// Blocks that are weighed once so far, a ring.
    young: Vec<Young>,
    /// Where the next block goes, which is where the oldest is.
    next: usize,
}

/// Blocks after which one is weighed again.
const AGAIN: usize = 75;

/// A block that has been weighed once.
#[derive(Debug, Clone)]
struct Young {
    block: Block,
    /// Share of its information that counts; 0: none of it went in.
    share: f64,
    /// Information each of its equations went in with.
    information: Vec<f64>,
}

/// The scale of the weight that decides, standard deviations.
const SCALE: f64 = 3.0;

/// Weight of a block whose mean normalised square residual is `chi`.
fn redescending(chi: f64, scale: f64) -> f64 {
    let w = scale * scale / (scale * scale + chi);
    w * w
}

impl RecursiveOffsets {
    /// A filter that starts from `belief`; allocates here only.
    ///
    /// # Errors
    /// [`super::MapError::Dimension`] when the belief is of another robot.
    pub fn new(estimator: MapEstimator, belief: Belief) -> Result<Self, super::MapError> {
        /// Noise before any innovation, rad: what a good sensor leaves.
        const START_RAD: f64 = 0.5e-3;
        let d = estimator.prior().dimension();
        if belief.mean.len() != d || belief.covariance.len() != d * d {
            return Err(super::MapError::Dimension {
                expected: d,
                found: belief.mean.len(),
            });
        }
        let n = estimator.prior().joints();
        let row = PER_JOINT + n * PARAMETERS_PER_BODY + PAYLOAD;
        Ok(Self {
            belief,
            noise: [
                alloc::vec![START_RAD; n],
                (0..n).map(|i| 3.0 * estimator.motor_floor(i)).collect(),
            ],
            equations: Equations::with_capacity(2 * n * row, 2 * n),
            origin: alloc::vec![0.0; d],
            gain: alloc::vec![0.0; d],
            pose: alloc::vec![f64::NAN; n],
            stood: 0.0,
            blocks: 0.0,
            weight: 0.0,
            trust: 1.0,
            young: alloc::vec![
                Young {
                    block: Block::zero(n, n * PARAMETERS_PER_BODY),
                    share: 0.0,
                    information: alloc::vec![0.0; 2 * n],
                };
                AGAIN
            ],
            next: 0,
            estimator,
        })
    }

    /// Starts from the noise an earlier recording left ([`super::MapEstimate::noise_rad`],
    /// [`super::MapEstimate::motor_noise_nm`]) instead of finding it within the first ten seconds;
    /// values that are no noise are left out.
    pub fn expect_noise(&mut self, link_rad: &[f64], motor_nm: &[f64]) {
        for (noise, known) in self.noise.iter_mut().zip([link_rad, motor_nm]) {
            for (noise, known) in noise.iter_mut().zip(known) {
                if *known > 0.0 && known.is_finite() {
                    *noise = *known;
                }
            }
        }
    }

    /// Takes a block; returns its weight, 0 (left out as disturbed) to 1.
    ///
    /// # Errors
    /// [`StepError`] when the block is of another arm or not finite; the state is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn step(&mut self, block: &Block) -> Result<f64, StepError> {
        /// Data after which the weight has its final scale, blocks.
        const ANNEALED: f64 = 40.0;
        const WIDE: f64 = 40.0;
        if !self.young.first().is_some_and(|y| y.block.fits(block)) {
            return Err(StepError::Length);
        }
        let needed = [&block.y, &block.y_square, &block.y_cube, &block.phi];
        if needed.into_iter().flatten().any(|x| !x.is_finite()) {
            return Err(StepError::NotFinite);
        }
        self.weigh_again();
        let share = self.share_of_stand(block);
        self.linearise(block);
        let scale = (WIDE * libm::exp(-self.blocks / (0.25 * ANNEALED))).max(SCALE);
        self.blocks += 1.0;
        let mut chi = 0.0;
        for k in 0..self.equations.list.len() {
            let Some(e) = self.equations.list.get(k).copied() else {
                break;
            };
            let spread = self.spread(&e) + self.variance(&e);
            chi += e.residual * e.residual / spread;
            self.follow_noise(&e, spread);
        }
        self.weight = redescending(chi / self.equations.list.len().max(1) as f64, scale);
        self.trust += 0.05 * (self.weight - self.trust);
        self.keep(block, share);
        if share > 0.0 {
            for k in 0..self.equations.list.len() {
                let Some(e) = self.equations.list.get(k).copied() else {
                    break;
                };
                let information = self.weight * share / self.variance(&e);
                self.update(&e, information, k > 0);
                let young = self.young.get_mut(self.next);
                if let Some(slot) = young.and_then(|y| y.information.get_mut(k)) {
                    *slot = information;
                }
            }
        }
        self.next = (self.next + 1) % AGAIN;
        Ok(self.weight)
    }

    /// Equations of `block` around what is believed now.
    fn linearise(&mut self, block: &Block) {
        self.estimator.linearise(
            block,
            self.belief.temperature_c,
            &self.belief.mean,
            &mut self.equations,
        );
        self.origin.copy_from_slice(&self.belief.mean);
    }

    /// Puts a block where the oldest was.
    fn keep(&mut self, block: &Block, share: f64) {
        if let Some(young) = self.young.get_mut(self.next) {
            young.block.copy_from(block);
            young.share = share;
            young.information.fill(0.0);
        }
    }

    /// Weighs the oldest block again, with what is known by now.
    fn weigh_again(&mut self) {
        /// Changes of the information below this share are left.
        const SAME: f64 = 0.02;
        let Some(old) = self.young.get_mut(self.next) else {
            return;
        };
        let share = core::mem::take(&mut old.share);
        if !(share > 0.0 && self.trust > 0.5) {
            return;
        }
        self.estimator.linearise(
            &old.block,
            self.belief.temperature_c,
            &self.belief.mean,
            &mut self.equations,
        );
        self.origin.copy_from_slice(&self.belief.mean);
        let mut chi = 0.0;
        for e in &self.equations.list {
            chi += e.residual * e.residual / self.variance(e);
        }
        let weight = redescending(chi / self.equations.list.len().max(1) as f64, SCALE);
        let mut moved = false;
        for k in 0..self.equations.list.len() {
            let Some(e) = self.equations.list.get(k).copied() else {
                break;
            };
            let young = self.young.get(self.next);
            let Some(before) = young.and_then(|y| y.information.get(k)).copied() else {
                break;
            };
            let more = weight * share / self.variance(&e) - before;
            if more.abs() > SAME * before {
                self.update(&e, more, moved);
                moved = true;
            }
        }
    }

    /// How much of a block's information counts: the blocks of a stand share that of one.
    fn share_of_stand(&mut self, block: &Block) -> f64 {
        const STAND_RAD: f64 = 0.01;
        let moved = self
            .pose
            .iter()
            .zip(&block.q)
            .any(|(a, b)| !((a - b).abs() <= STAND_RAD));
        if moved {
            for (pose, q) in self.pose.iter_mut().zip(&block.q) {
                *pose = *q;
            }
            self.stood = 0.0;
        }
        self.stood += 1.0;
        let inflation = self.estimator.inflation();
        if self.stood <= inflation {
            1.0 / inflation
        } else {
            0.0
        }
    }

    fn variance(&self, e: &Equation) -> f64 {
        let [link, motor] = &self.noise;
        let noise = match e.side {
            Side::Link => link.get(e.joint),
            Side::Motor => motor.get(e.joint),
        };
        let noise = noise.copied().unwrap_or(1.0);
        noise * noise + e.unsure * e.unsure
    }

    /// `P hᵀ` into `gain`; returns `h P hᵀ`.
    fn spread(&mut self, e: &Equation) -> f64 {
        let d = self.belief.mean.len();
        self.gain.fill(0.0);
        let row = self.equations.rows.get(e.from..e.to).unwrap_or_default();
        for &(i, value) in row {
            let line = self.belief.covariance.get(i * d..(i + 1) * d);
            for (g, p) in self.gain.iter_mut().zip(line.unwrap_or_default()) {
                *g += value * p;
            }
        }
        row.iter()
            .map(|&(i, value)| value * self.gain.get(i).copied().unwrap_or_default())
            .sum()
    }

    /// The noise moves towards the median of the innovations that are mostly noise.
    fn follow_noise(&mut self, e: &Equation, spread: f64) {
        /// The step falls to a tenth of the first, so that the noise settles.
        const STEP: f64 = 0.03;
        const SETTLED: f64 = 0.003;
        let step = (STEP / (1.0 + 0.02 * self.blocks)).max(SETTLED);
        const MEDIAN: f64 = 0.6745;
        let variance = self.variance(e);
        if e.unsure > 0.0 || variance < 0.5 * spread {
            return;
        }
        let floor = match e.side {
            Side::Link => self.estimator.noise_floor_rad(),
            Side::Motor => self.estimator.motor_floor(e.joint),
        };
        let [link, motor] = &mut self.noise;
        let noise = match e.side {
            Side::Link => link.get_mut(e.joint),
            Side::Motor => motor.get_mut(e.joint),
        };
        if let Some(noise) = noise {
            let above = e.residual * e.residual > MEDIAN * MEDIAN * spread;
            let factor = if above { 1.0 + step } else { 1.0 - step };
            *noise = (*noise * factor).max(floor);
        }
    }

    /// One scalar measurement of so much information, which may be less than nothing; `again`: the
    /// state has moved since the residual was taken.
    fn update(&mut self, e: &Equation, information: f64, again: bool) {
        let d = self.belief.mean.len();
        let spread = self.spread(e);
        let mut residual = e.residual;
        if again {
            let row = self.equations.rows.get(e.from..e.to).unwrap_or_default();
            for &(i, value) in row {
                let now = self.belief.mean.get(i).copied().unwrap_or_default();
                let then = self.origin.get(i).copied().unwrap_or_default();
                residual -= value * (now - then);
            }
        }
        // Nothing can take back more than is known.
        const LEAST: f64 = 0.5;
        let left = 1.0 + information * spread;
        if !(left > LEAST && left.is_finite()) || information == 0.0 {
            return;
        }
        let total = left / information;
        for (x, g) in self.belief.mean.iter_mut().zip(&self.gain) {
            *x += g * residual / total;
        }
        for (line, g) in self.belief.covariance.chunks_exact_mut(d).zip(&self.gain) {
            let scaled = g / total;
            for (p, h) in line.iter_mut().zip(&self.gain) {
                *p -= scaled * h;
            }
        }
    }

    /// Offset of a joint and its standard deviation, rad; NaN for a joint there isn't.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn offset(&self, joint: usize) -> [f64; 2] {
        self.belief
            .entry(self.estimator.prior().place(joint, JointParameter::Offset))
    }

    /// What is believed now.
    pub fn belief(&self) -> &Belief {
        &self.belief
    }
}
