//! The absolute offset, block by block: a small Kalman step five times a second.

use super::block::Block;
use super::filter::{Filter, Work};
use super::map::MapEstimator;
use super::prior::{Belief, JointParameter};
use super::since::Since;
use crate::StepError;
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
/// A block is weighed three times: when it comes, and a quarter and half of a minute later, with
/// what is known by then, `χ = mean e²/σ²`. What it then says more or less than it did goes in as a
/// measurement of the information `Δ = (w₂/σ₂² − w₁/σ₁²)/ι`, less than nothing where a contact is
/// left out:
///
/// ```text
/// x ← x + P hᵀ e/(s + 1/Δ),     P ← P − P hᵀ h P/(s + 1/Δ)
/// ```
///
/// What comes first is believed, because nothing speaks against it: an arm that is leant on while
/// the filter starts would have every later block left out. So a second filter goes over the first
/// 75 blocks seven times from the first belief, each time with weights from the time before and a
/// smaller `c`, as the batch form does; then takes what came since, and the first one's place where it
/// explains all blocks better. Until then, some 24 s, the filter [is in
/// doubt](RecursiveOffsets::is_in_doubt).
///
/// It is in doubt again when hardly a block counts for some six seconds, or a joint's link equations
/// are off by two standard deviations in the mean over 40 blocks that tell something new (each cut at
/// five; so a contact of a few seconds isn't enough). Where that lasts for another ten seconds, the
/// second filter goes over the last 75 blocks, and takes the first one's place once it is trusted and
/// explains them better by 60, half chi-square: a rope has slipped, a load changed. The doubt ends when
/// the blocks agree again.
///
/// Strands may have failed since the belief: it starts with every stiffness opened by a tenth
/// that was known better, and its offsets are averaged over which of them have changed, as [`MapEstimator::watch`] does.
///
/// # Realtime
/// [`RecursiveOffsets::step`]: no allocation, lock, panic or clock; `O(n d²)`, eleven times that while
/// the second filter catches up. Keeps 150 blocks, `1200 n (r + 30)` bytes of `r` base parameters, and
/// five covariances, `40 d²` bytes, beside vectors.
#[derive(Debug, Clone)]
pub struct RecursiveOffsets {
    estimator: MapEstimator,
    /// What was believed before the first block, every stiffness opened that was known, of all
    /// bodies' parameters.
    before: Belief,
    /// The same of the model's.
    start: Belief,
    /// Offsets averaged over which stiffness has changed.
    since: Since,
    /// Noise of link and motor equations that a filter starts from.
    start_noise: [Vec<f64>; 2],
    believed: Filter,
    rival: Filter,
    stage: Stage,
    work: Work,
    /// Pose the arm stands at, and for how many blocks.
    pose: Vec<f64>,
    stood: f64,
    /// The last [`KEPT`] blocks, a ring.
    kept: Vec<Kept>,
    /// Blocks taken.
    taken: usize,
    /// Whether the second filter has been over the first blocks.
    opened: bool,
    /// The block the second filter began with.
    from: usize,
}

/// A block, and the share of its information that counts; 0: none of it goes in.
#[derive(Debug, Clone)]
struct Kept {
    block: Block,
    share: f64,
}

/// What the second filter does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Rests,
    /// Waits for blocks from after what disturbed the first.
    Waits {
        until: usize,
    },
    /// Goes over its blocks up to `to` for the `pass`-th time, and takes those up to the present
    /// after the last.
    GoesOver {
        to: usize,
        pass: usize,
        at: usize,
    },
    /// Takes every block as it comes.
    Rivals,
}

/// The most blocks the second filter goes over.
const STRETCH: usize = 75;
/// Blocks kept: what the second filter goes over and what comes meanwhile.
const KEPT: usize = 2 * STRETCH;
/// Blocks after which one is weighed again.
const AGAIN: [usize; 2] = [STRETCH, KEPT - 1];
/// Scales of the weight, in standard deviations, with which the second filter goes over its
/// blocks.
const SCALES: [f64; 7] = [40.0, 20.0, 10.0, 6.0, 4.0, 3.0, 3.0];
/// Passes over every other block only.
const COARSE: usize = 5;
/// Passes after which the residuals show the noise.
const NOISE_SEEN: usize = 2;

impl RecursiveOffsets {
    /// A filter that starts from `belief`; allocates here only.
    ///
    /// # Errors
    /// [`super::MapError::Dimension`] when the belief is of another robot, [`super::MapError::Prior`] when its
    /// covariance is none.
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
        let mut before = belief;
        let (model, layout) = (estimator.model(), estimator.model().layout);
        let mut start = model.believed(&before);
        let mut since = Since::open(model, &mut start, &mut before)?;
        since.average(&start, &start);
        let n = layout.joints;
        let start_noise = [
            alloc::vec![START_RAD; n],
            (0..n).map(|i| 3.0 * estimator.motor_floor(i)).collect(),
        ];
        let filter = Filter::new(&start, &start_noise, KEPT);
        let empty = Kept {
            block: Block::zero(n, layout.bodies),
            share: 0.0,
        };
        Ok(Self {
            rival: filter.clone(),
            believed: filter,
            stage: Stage::Rests,
            start,
            before,
            since,
            start_noise,
            work: Work::new(layout),
            pose: alloc::vec![f64::NAN; n],
            stood: 0.0,
            kept: alloc::vec![empty; KEPT],
            taken: 0,
            opened: false,
            from: 0,
            estimator,
        })
    }

    /// Starts from the noise an earlier recording left ([`super::MapEstimate::noise_rad`],
    /// [`super::MapEstimate::motor_noise_nm`]) instead of finding it within the first ten seconds;
    /// values that are no noise are left out.
    pub fn expect_noise(&mut self, link_rad: &[f64], motor_nm: &[f64]) {
        for (noise, known) in self.start_noise.iter_mut().zip([link_rad, motor_nm]) {
            for (noise, known) in noise.iter_mut().zip(known) {
                if *known > 0.0 && known.is_finite() {
                    *noise = *known;
                }
            }
        }
        self.believed.expect_noise(&self.start_noise);
    }

    /// Noise of every joint's link (rad) and motor (N·m) equations, as the next filter may
    /// [expect](RecursiveOffsets::expect_noise) it.
    pub fn noise(&self) -> [&[f64]; 2] {
        self.believed.noise()
    }

    /// Takes a block; returns its weight, 0 (left out as disturbed) to 1.
    ///
    /// # Errors
    /// [`StepError`] when the block is of another arm or not finite; the state is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn step(&mut self, block: &Block) -> Result<f64, StepError> {
        let slot = self.taken % KEPT;
        if !self.kept.get(slot).is_some_and(|k| k.block.fits(block)) {
            return Err(StepError::Length);
        }
        if !block.is_finite() {
            return Err(StepError::NotFinite);
        }
        let share = self.share_of_stand(block);
        if let Some(kept) = self.kept.get_mut(slot) {
            kept.block.copy_from(block);
            kept.share = share;
        }
        let number = self.taken;
        self.taken += 1;
        take(
            &mut self.believed,
            &self.estimator,
            &mut self.work,
            &self.kept,
            number,
        );
        self.second();
        self.since.average(&self.start, self.believed.belief());
        Ok(self.believed.weight())
    }

    /// What the second filter does while a block comes.
    fn second(&mut self) {
        /// Blocks the second filter goes over while one comes.
        const AT_ONCE: usize = 10;
        match self.stage {
            Stage::Rests => {
                if self.taken == STRETCH {
                    self.begin();
                } else if self.taken > STRETCH && self.believed.is_doubted() {
                    self.wait();
                }
            }
            // What disturbed it is over.
            Stage::Waits { .. } | Stage::GoesOver { .. }
                if self.opened && self.believed.is_trusted() =>
            {
                self.stage = Stage::Rests;
            }
            Stage::Waits { until } => {
                if self.taken >= until {
                    self.begin();
                }
            }
            Stage::GoesOver { .. } => {
                for _ in 0..AT_ONCE {
                    self.go_over();
                }
            }
            Stage::Rivals => {
                let number = self.taken - 1;
                take(
                    &mut self.rival,
                    &self.estimator,
                    &mut self.work,
                    &self.kept,
                    number,
                );
                if self.taken.saturating_sub(self.from).is_multiple_of(AT_ONCE) {
                    self.decide();
                }
                // It began with blocks from before what it should explain.
                if self.stage == Stage::Rivals && self.rival.is_doubted() {
                    self.wait();
                }
            }
        }
    }

    /// The second filter will begin when most of the last blocks are from after the disturbance.
    fn wait(&mut self) {
        /// Blocks from after it.
        const AFTER: usize = 50;
        self.stage = Stage::Waits {
            until: self.taken + AFTER,
        };
    }

    /// The second filter begins with the last blocks.
    fn begin(&mut self) {
        self.rival.restart(&self.start, &self.start_noise);
        self.from = self.taken.saturating_sub(STRETCH);
        self.stage = Stage::GoesOver {
            pass: 0,
            to: self.taken,
            at: self.from,
        };
    }

    /// One block for the second filter.
    fn go_over(&mut self) {
        let Stage::GoesOver { to, pass, at } = self.stage else {
            return;
        };
        let Some(kept) = self.kept.get(at % KEPT) else {
            return;
        };
        let (mut pass, mut at) = (pass, at);
        if let Some(&scale) = SCALES.get(pass) {
            let slot = at % KEPT;
            self.rival.repeat(
                &self.estimator,
                &mut self.work,
                (&kept.block, kept.share),
                slot,
                scale,
            );
            at += if pass < COARSE { 2 } else { 1 };
            if at >= to {
                pass += 1;
                if pass > NOISE_SEEN {
                    self.rival.find_noise(&self.estimator);
                }
                if pass < SCALES.len() {
                    at = self.from;
                    self.rival.begin_pass(&self.start);
                }
            }
        } else {
            take(
                &mut self.rival,
                &self.estimator,
                &mut self.work,
                &self.kept,
                at,
            );
            at += 1;
        }
        self.stage = Stage::GoesOver { to, pass, at };
        if pass == SCALES.len() && at >= self.taken {
            self.stage = Stage::Rivals;
            self.decide();
        }
    }

    /// Whether the second filter takes the first one's place, or rests.
    fn decide(&mut self) {
        /// By how much it must explain its blocks better, half chi-square: it has every entry to
        /// itself. A slip of a millirad is worth more in 15 s.
        const BETTER: f64 = 60.0;
        /// From so many blocks that told something new: two or three stands say little of an arm.
        const ENOUGH: f64 = 15.0;
        let opening = self.from == 0;
        let seen = self.taken.saturating_sub(KEPT).max(self.from)..self.taken;
        let blocks = seen.filter_map(|number| self.kept.get(number % KEPT));
        let blocks = blocks.map(|k| (&k.block, k.share));
        let told: f64 = blocks.clone().map(|(_, share)| share).sum();
        let fit = told * self.estimator.inflation() > ENOUGH && self.rival.is_trusted();
        let margin = if opening { 0.0 } else { BETTER };
        let (estimator, work) = (&self.estimator, &mut self.work);
        let better = (opening || fit)
            && self.rival.cost(estimator, work, blocks.clone()) + margin
                < self.believed.cost(estimator, work, blocks);
        if better {
            core::mem::swap(&mut self.rival, &mut self.believed);
        }
        self.opened |= opening;
        if better || opening || self.believed.is_trusted() {
            self.stage = Stage::Rests;
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

    /// Offset of a joint and its standard deviation, rad, averaged over which joints' stiffness has
    /// changed since the belief the filter started from; NaN for a joint there isn't.
    ///
    /// While the filter [doubts](RecursiveOffsets::is_in_doubt), the deviation is that from before the first
    /// block; once the second filter has found what explains the blocks of late, mean and deviation
    /// are those of both, one as likely as the other.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn offset(&self, joint: usize) -> [f64; 2] {
        let layout = self.estimator.model().layout;
        if joint >= layout.joints {
            return [f64::NAN; 2];
        }
        let place = layout.place(joint, JointParameter::Offset);
        let own = self.since.offset(joint);
        let [mean, deviation] = own.unwrap_or_else(|| self.believed.belief().entry(place));
        if !self.is_in_doubt() {
            return [mean, deviation];
        }
        if self.stage == Stage::Rivals {
            let [other, unsure] = self.rival.belief().entry(place);
            let apart = 0.5 * (mean - other);
            let variance = 0.5 * (deviation * deviation + unsure * unsure) + apart * apart;
            return [mean - apart, libm::sqrt(variance)];
        }
        [mean, deviation.max(self.start.entry(place)[1])]
    }

    /// Whether the offsets may be wrong by more than the data says: in the first 24 s, because an arm
    /// that is leant on from the start looks like another arm, and when hardly a block has fitted for
    /// some six seconds: a slip, a load, or a contact that lasts.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn is_in_doubt(&self) -> bool {
        let disturbed = self.stage != Stage::Rests || self.believed.is_doubted();
        !self.opened || disturbed
    }

    /// Probability that the stiffness of a joint has changed since the belief the filter started
    /// from; 0 for one that wasn't known then.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn stiffness_changed(&self, joint: usize) -> f64 {
        self.since.probability(joint).unwrap_or_default()
    }

    /// What is believed now, averaged over which stiffness has changed. Allocates: no step.
    ///
    /// While the filter [doubts](RecursiveOffsets::is_in_doubt) this may be wrong by more than it says.
    ///
    /// # Errors
    /// [`super::MapError::Prior`] when what was believed before has no inverse.
    pub fn belief(&self) -> Result<Belief, super::MapError> {
        let now = &self.since.averaged(self.believed.belief())?;
        let model = self.estimator.model();
        let (mean, covariance) = model.completed(&self.before, &now.mean, &now.covariance)?;
        Ok(Belief {
            mean,
            covariance,
            temperature_c: now.temperature_c,
        })
    }
}

/// The filter takes block `number`, and weighs again those that came [`AGAIN`] blocks before.
fn take(
    filter: &mut Filter,
    estimator: &MapEstimator,
    work: &mut Work,
    kept: &[Kept],
    number: usize,
) {
    for age in AGAIN {
        if let Some(before) = number.checked_sub(age) {
            let slot = before % KEPT;
            if let Some(old) = kept.get(slot) {
                filter.again(estimator, work, &old.block, slot);
            }
        }
    }
    let slot = number % KEPT;
    if let Some(new) = kept.get(slot) {
        filter.take(estimator, work, (&new.block, new.share), slot);
    }
}
