//! The absolute offset, block by block: a small Kalman step five times a second.
//!
//! Reading order: this file, `slices` (what is done with a block, in order), `disturbance` (what is done when blocks no longer
//! fit), `checkpoints` (what was known before), `task` (a filter's part of a block), `filter` (one filter over blocks),
//! `workspace` (what its step computes with), `ring` (the last blocks), `robust_noise`, `stiffness` (the average over lost
//! stiffness), `force` (whether a force from outside acts), `places` (whether the arm works or stands).

mod checkpoints;
mod disturbance;
mod filter;
mod force;
mod places;
mod ring;
mod robust_noise;
mod slices;
mod stiffness;
mod task;
mod workspace;

use super::batch::MapEstimator;
use super::belief::Belief;
use super::block::{Block, copy};
use super::equations::estimation_model::EstimationModel;
use super::error::MapError;
use super::estimate::ForceEstimate;
use super::external_force::{ForceModel, hardly_moves};
use super::misfit::misfit_rad;
use super::parameter::JointParameter;
use crate::{Gaussian, StepError};
use alloc::vec::Vec;
use checkpoints::Checkpoints;
use filter::Filter;
use force::{ForceAverage, ForceBelief};
use ring::{BlockRing, KEPT, SEGMENT};
use slices::Next;
use stiffness::StiffnessAverage;
use task::{Kind, Task};
use workspace::{Workspace, dimension};

/// Recursive form of [`MapEstimator::solve`]: the same equations, priors and block weights, one
/// block at a time, with a state that never grows.
///
/// ```text
/// e = residual,  s = h P hᵀ,  R = ι (σ² + (1 − w) s)/w,   w = (c²/(c² + χ))²,  χ = mean e²/(s + σ²)
/// x ← x + P hᵀ e/(s + R),     P ← P − P hᵀ h P/(s + R)
/// ```
///
/// So what surprises moves `x` by some `w` of what it says, however little was known. With `R = σ² ι/w` a contact at eight
/// deviations, `w = 0.02`, moved an arm that stands nine tenths of the way.
///
/// The scale `c` of the redescending weight falls from wide to 3 with the data, as the batch form's
/// does from iteration to iteration. `ι` is how many blocks say what one of independent errors does: noise
/// lasts for a second, and what the model gets wrong for 0.3 rad of the fastest joint's way. Of a stand the first ten seconds
/// count, as one block. Noise `σ` follows the median of the innovations.
///
/// **Reweighting.** A block is weighed three times: when it comes, and a quarter and half of a minute
/// later, with the posterior of then, `χ = mean e²/σ²`. The difference goes in as a measurement of the
/// information `Δ = (w₂/σ₂² − w₁/σ₁²)/ι`, which is negative where a contact is left out:
///
/// ```text
/// x ← x + P hᵀ e/(s + 1/Δ),     P ← P − P hᵀ h P/(s + 1/Δ)
/// ```
///
/// **Challenger.** The first blocks are weighed against the prior alone: an arm that is leant on while
/// the filter starts would have every later block left out. So a second filter, the challenger,
/// replays the first 75 blocks eight times from the prior, each time with weights from the time before
/// and a smaller `c`, as the batch form does. It then takes what came since, and replaces the first
/// filter, the incumbent, where it explains all blocks better. Until then, some 24 s, the offsets [are
/// provisional](RecursiveOffsets::is_provisional).
///
/// They are so again when the incumbent is inconsistent: the mean weight of its blocks stays below a
/// quarter for some six seconds, or the mean normalised innovation of a joint's link equations exceeds
/// two over 40 blocks that carry new information (each cut at five, so that a contact of a few seconds
/// isn't enough; over 15 while nothing goes in, so that it agrees soon after one). A filter that takes in what it
/// can't explain moves stiffness and rates instead: five deviations within some ten to twenty seconds count as well.
///
/// **Disturbance.** What went in of late may be wrong then. So the incumbent goes back to what it knew ten to twenty seconds ago, and
/// only weighs blocks, none of which goes in. If they agree again, it was a contact. If not within four seconds, the challenger
/// goes on from there over the blocks since the disturbance was seen, with offsets opened by 10 mrad, known stiffness by a tenth, and the
/// payload by as much as it was unknown before the first block. What else was learned stays. Every third attempt begins from the prior
/// instead, over the last 75 blocks. The challenger replaces the incumbent once it is consistent, has moved neither stiffness nor
/// rates by five deviations, and explains its blocks better by 60, half chi-square, or at all after 45 s: a rope has slipped, a strand
/// failed, a load changed. The offsets are provisional no longer once the blocks agree again. For a minute after that, and in the challenger,
/// a joint's mean normalised innovation by the blocks' weights, in which contacts hardly count, must stay below 0.8, too: a second slip
/// would go in as stiffness, which is open.
///
/// **Lost stiffness.** Strands may have failed since the prior was learned: the filter starts with every
/// stiffness opened by a tenth that was known better, and its offsets are averaged over which of them
/// have changed, as [`MapEstimator::search`] does. A slip fits few poses as well as lost stiffness. So where stiffness seems lost
/// since something was amiss, with a probability above 0.8, and not before, the offsets stay provisional for a minute after that was
/// settled, and for as long as the arm is in four poses for most of the time.
///
/// **Creep.** Ropes stretch while they are looked at. So an offset moves evenly, by a rate each that is 0 ± 1 mrad a minute
/// before the first block, and what is told is where it is now:
///
/// ```text
/// offset(t) = offset + rate (t − t_now)
/// ```
///
/// **Force.** A constant force from outside may act at the tool, where [`MapEstimator::with_external_force`] says so. It is in the
/// state, and what is told is averaged over whether it acts. While it isn't likely, blocks are weighed and linearised as if there were
/// none:
///
/// ```text
/// x | 0 = x − P_·f C⁻¹ f,     P | 0 = P − P_·f C⁻¹ P_f·,     C: covariance of the force f
/// ```
///
/// **Bounded work.** [`RecursiveOffsets::step`] does a block's work at once. A fast loop does it in slices:
/// [`RecursiveOffsets::begin`] takes a block, every [`RecursiveOffsets::advance`] after it does as many slices as it is told,
/// a slice `O(d²)`. The answers are the same to the last bit, and stay those of the block before until the last slice is
/// done. [`RecursiveOffsets::slices_per_block`] is the most a block takes.
///
/// # Realtime
/// [`RecursiveOffsets::step`]: no allocation, lock, panic or clock; `O(n d²)`, up to thirty times that while
/// the challenger replays. Keeps 150 blocks, `1200 n (r + 42)` bytes of `r` base parameters, and
/// eight covariances, `64 d²` bytes, beside vectors.
#[derive(Debug, Clone)]
pub struct RecursiveOffsets {
    model: EstimationModel,
    /// Prior before the first block, every known stiffness opened, of all bodies' parameters.
    before: Belief,
    /// The same of the reduced model's.
    start: Belief,
    /// What is known averaged over whether a force acts; `None`: none is looked for.
    force: Option<ForceAverage>,
    /// Offsets averaged over which stiffness has changed.
    stiffness: StiffnessAverage,
    /// Noise of link and motor equations that a filter starts from.
    start_noise: [Vec<f64>; 2],
    incumbent: Filter,
    challenger: Filter,
    /// What the incumbent knew before anything was amiss.
    checkpoints: Checkpoints,
    /// How often the challenger has begun since.
    attempts: usize,
    /// Blocks taken when it was seen; 0: nothing was amiss yet.
    seen: usize,
    /// Joints that seemed to have lost stiffness before anything was amiss.
    softer_before: Vec<bool>,
    /// Blocks until which what goes in is held against its mean.
    watched: usize,
    stage: Stage,
    work: Workspace,
    ring: BlockRing,
    /// Whether the challenger has been over the first blocks.
    opened: bool,
    /// The block the challenger began with.
    from: usize,
    /// What is unknown of every joint's offset and looks the same in every block, rad.
    added_rad: Vec<f64>,
    /// The same where no temperature is known.
    unknown_rad: Vec<f64>,
    /// Temperature that is stated, °C: it takes the place of the blocks'. NaN: none is.
    stated_c: f64,
    /// Whether the last block's temperature is known.
    temperature_known: bool,
    /// What is left to do with the last block.
    next: Next,
    /// Offsets and whether they are provisional, of the last block that is done with.
    told: Vec<Gaussian>,
    told_force: Option<ForceEstimate>,
    told_provisional: bool,
}

/// What the challenger does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Idle,
    /// Waits for blocks from after what disturbed the incumbent.
    Waiting {
        until: usize,
    },
    /// Goes over its blocks up to `to` for the `pass`-th time, and takes those up to the present
    /// after the last.
    Replaying {
        to: usize,
        pass: usize,
        at: usize,
    },
    /// Takes every block as it comes.
    Tracking,
}

/// How fast an offset may move, rad/s, a standard deviation: a starting guess. Where nothing moves, recordings of a minute get
/// intervals wider by a third (S7) for it.
const CREEP_RAD_PER_S: f64 = 1e-3 / 60.0;
/// Blocks after which one is weighed again.
const AGAIN: [usize; 2] = [SEGMENT, KEPT - 1];
/// Scales of the weight, in standard deviations, with which the challenger goes over its
/// blocks.
const SCALES: [f64; 8] = [40.0, 20.0, 10.0, 6.0, 4.0, 3.0, 3.0, 3.0];
/// Passes over every other block only.
const COARSE: usize = 6;
/// Probability above which a joint's stiffness seems lost.
const SOFTER: f64 = 0.5;
/// Passes after which the residuals show the noise.
const NOISE_SEEN: usize = 2;

impl RecursiveOffsets {
    /// A filter that starts from `belief`; allocates here only.
    ///
    /// # Errors
    /// [`MapError::Dimension`] when the belief is of another robot, [`MapError::Prior`] when its
    /// covariance is none.
    pub fn new(estimator: MapEstimator, belief: Belief) -> Result<Self, MapError> {
        Self::of(estimator.into_model(), belief)
    }

    fn of(model: EstimationModel, belief: Belief) -> Result<Self, MapError> {
        /// Noise before any innovation, rad: what a good sensor leaves.
        const START_RAD: f64 = 0.5e-3;
        belief.check_dimension(model.prior.dimension())?;
        let mut before = belief;
        let (reduced, layout) = (&model.reduced, model.reduced.layout);
        let elastic = (0..layout.joints).filter(|&i| model.prior.is_elastic(i));
        let creeps: Vec<usize> = elastic.collect();
        let mut start = opened(&model, reduced.believed(&before), creeps.len());
        let mut stiffness = StiffnessAverage::open(reduced, &mut start, &mut before)?;
        stiffness.average(&start, &start);
        let n = layout.joints;
        let start_noise = [
            alloc::vec![START_RAD; n],
            (0..n).map(|i| 3.0 * model.motor_floor(i)).collect(),
        ];
        let place = |joint: &usize| layout.place(*joint, JointParameter::Offset);
        let offsets: Vec<usize> = creeps.iter().map(place).collect();
        let force = model.force.as_ref();
        let force = force.map(|force| ForceBelief::new(force, &start, layout.dimension()));
        let average = force.as_ref().map(|_| ForceAverage::new(&start));
        let filter = Filter::new((&start, &offsets), force, &start_noise, KEPT);
        let mut made = Self {
            force: average,
            challenger: filter.clone(),
            checkpoints: Checkpoints::new(&filter),
            attempts: 0,
            seen: 0,
            softer_before: alloc::vec![false; n],
            watched: 0,
            incumbent: filter,
            stage: Stage::Idle,
            start,
            before,
            stiffness,
            start_noise,
            work: Workspace::new(&model, creeps),
            ring: BlockRing::new(&model),
            opened: false,
            from: 0,
            added_rad: alloc::vec![0.0; n],
            unknown_rad: alloc::vec![0.0; n],
            stated_c: f64::NAN,
            temperature_known: true,
            next: Next::Rest,
            told: alloc::vec![Gaussian::new(f64::NAN, f64::NAN); n],
            told_force: None,
            told_provisional: true,
            model,
        };
        made.tell();
        Ok(made)
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
        self.incumbent.expect_noise(&self.start_noise);
        self.tell_at_rest();
    }

    /// How fast offsets may move, rad/s, a standard deviation: 0 of ropes that don't creep, such as steel. It is 1 mrad a minute
    /// unless this says otherwise, before the first block.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] where it is no deviation, [`StepError::Started`] after a block came; nothing has changed.
    pub fn expect_creep(&mut self, deviation_rad_per_s: f64) -> Result<(), StepError> {
        if !(deviation_rad_per_s >= 0.0 && deviation_rad_per_s.is_finite()) {
            return Err(StepError::NotFinite);
        }
        if self.ring.taken() > 0 {
            return Err(StepError::Started);
        }
        let first = dimension(&self.model, 0);
        let filters = [&mut self.incumbent, &mut self.challenger];
        let beliefs = filters.map(Filter::belief_mut);
        for belief in beliefs.into_iter().chain([&mut self.start]) {
            let d = belief.mean.len();
            for rate in first..d {
                if let Some(variance) = belief.covariance.get_mut(rate * (d + 1)) {
                    *variance = deviation_rad_per_s * deviation_rad_per_s;
                }
            }
        }
        Ok(())
    }

    /// Adds to the deviation of every joint's offset, rad, what looks the same in every block
    /// ([`super::beliefs::unknown_temperature`]).
    pub fn add_deviation(&mut self, added_rad: &[f64]) {
        copy(&mut self.added_rad, added_rad);
        self.tell_at_rest();
    }

    /// What is known of the temperature: `stated_c`, °C, takes the place of the blocks' (NaN: none is stated); while neither
    /// is known, `unknown_rad` is added to every joint's deviation instead of what
    /// [`RecursiveOffsets::add_deviation`] says.
    pub fn expect_temperature(&mut self, stated_c: f64, unknown_rad: &[f64]) {
        self.stated_c = stated_c;
        copy(&mut self.unknown_rad, unknown_rad);
        self.tell_at_rest();
    }

    /// Noise of every joint's link (rad) and motor (N·m) equations, as the next filter may
    /// [expect](RecursiveOffsets::expect_noise) it.
    pub fn noise(&self) -> [&[f64]; 2] {
        self.incumbent.noise()
    }

    /// Takes a block and does all its work, and what is left of the one before; returns its weight, 0 (left out as
    /// disturbed) to 1.
    ///
    /// # Errors
    /// [`StepError`] when the block is of another arm or not finite; what is known is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn step(&mut self, block: &Block) -> Result<f64, StepError> {
        self.finish();
        self.begin(block)?;
        self.finish();
        Ok(self.incumbent.weight())
    }

    /// Offset of a joint, rad, averaged over which joints' stiffness has changed since the belief the
    /// filter started from; NaN for a joint there isn't. Its deviation holds what
    /// [fits nothing](super::misfit).
    ///
    /// While it is [provisional](RecursiveOffsets::is_provisional), the deviation is that from before
    /// the first block; once the challenger has found what explains the blocks of late, mean and
    /// deviation are those of both, one as likely as the other.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn offset(&self, joint: usize) -> Gaussian {
        let none = Gaussian::new(f64::NAN, f64::NAN);
        self.told.get(joint).copied().unwrap_or(none)
    }

    /// What [`RecursiveOffsets::offset`] says once all of a block's work is done.
    fn offset_now(&self, joint: usize) -> Gaussian {
        let layout = self.model.reduced.layout;
        if joint >= layout.joints {
            return Gaussian::new(f64::NAN, f64::NAN);
        }
        let place = layout.place(joint, JointParameter::Offset);
        let own = self.stiffness.offset(joint);
        let mut own = own.unwrap_or_else(|| self.averaged_force().entry(place));
        let misfit = misfit_rad(self.incumbent.unexplained_rad(joint));
        let added = self.added_rad(joint);
        own.deviation = libm::hypot(own.deviation, libm::hypot(misfit, added));
        if !self.is_provisional_now() {
            return own;
        }
        if self.stage == Stage::Tracking {
            let other = self.challenger.entry(place);
            let apart = 0.5 * (own.mean - other.mean);
            let variance = 0.5
                * (own.deviation * own.deviation + other.deviation * other.deviation)
                + apart * apart;
            return Gaussian::new(own.mean - apart, libm::sqrt(variance));
        }
        let before = self.start.entry(place).deviation;
        Gaussian::new(own.mean, own.deviation.max(before))
    }

    /// What a temperature that isn't known adds to the deviation of a joint's offset, rad: that of the last block, of the belief the
    /// filter started from, or both. 0 where both are known, where nobody said what it adds
    /// ([`RecursiveOffsets::expect_temperature`]), and for a joint there isn't. The interval holds it.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn unknown_temperature_rad(&self, joint: usize) -> f64 {
        let both_are_known = self.temperature_known && self.start.temperature_c.is_finite();
        match both_are_known {
            true => 0.0,
            false => self.added_rad(joint),
        }
    }

    /// What is unknown of a joint's offset and looks the same in every block, rad.
    fn added_rad(&self, joint: usize) -> f64 {
        let added = match self.temperature_known {
            true => &self.added_rad,
            false => &self.unknown_rad,
        };
        added.get(joint).copied().unwrap_or_default()
    }

    /// The incumbent's posterior, averaged over whether a force acts.
    fn averaged_force(&self) -> &Belief {
        let now = self.incumbent.belief();
        self.force.as_ref().map_or(now, ForceAverage::averaged)
    }

    /// Whether the offsets may be wrong by more than the data says: in the first 24 s, because an arm
    /// that is leant on from the start looks like another arm, and when hardly a block has fitted for
    /// some six seconds: a slip, a load, or a contact that lasts.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn is_provisional(&self) -> bool {
        self.told_provisional
    }

    fn is_provisional_now(&self) -> bool {
        let disturbed = self.stage != Stage::Idle || self.is_disturbed();
        let force = self.incumbent.force();
        let begins = force.is_some_and(ForceBelief::is_in_doubt);
        let softens = self.stands_and_softens() || self.softens_for_a_slip();
        !self.opened || disturbed || begins || softens
    }

    /// Whether an arm that hardly leaves one place seems to have lost stiffness. There one can't tell that from what leans on it.
    fn stands_and_softens(&self) -> bool {
        let mut joints = 0..self.softer_before.len();
        hardly_moves(self.ring.in_one_pose()) && joints.any(|i| self.stiffness_changed(i) > SOFTER)
    }

    /// Whether a joint seems to have lost stiffness since something was amiss, and little says that it was no slip: something was settled
    /// less than a minute ago, or the arm is in few poses most of the time.
    fn softens_for_a_slip(&self) -> bool {
        /// Share of the time in four poses. Arms that go from one to the next have 0.69 to 0.91 (S9), those that move all the time 0.3.
        const FEW: f64 = 0.6;
        /// Of 77 recordings in four poses none came to more than 0.7; three whose elbow was 31 to 53 mrad off came to 1.00.
        const SURELY: f64 = 0.8;
        let mut joints = self.softer_before.iter().enumerate();
        let softens = |(i, before): (usize, &bool)| !before && self.stiffness_changed(i) > SURELY;
        let says_little = self.is_watched() || self.ring.in_few_poses() > FEW;
        self.seen > 0 && says_little && joints.any(softens)
    }

    /// Probability that the stiffness of a joint has changed since the belief the filter started
    /// from; 0 for one that wasn't known then.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn stiffness_changed(&self, joint: usize) -> f64 {
        self.stiffness.probability(joint).unwrap_or_default()
    }

    /// A constant force from outside, as far as the blocks tell; `None`: none is looked for
    /// ([`MapEstimator::with_external_force`]).
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn external_force(&self) -> Option<ForceEstimate> {
        self.told_force
    }

    /// The posterior, averaged over which stiffness has changed, with all work done that is [left](RecursiveOffsets::advance).
    /// Allocates: no step.
    ///
    /// While the offsets are [provisional](RecursiveOffsets::is_provisional) this may be wrong by more than it says.
    ///
    /// # Errors
    /// [`MapError::Prior`] when the prior's covariance has no inverse.
    pub fn belief(&self) -> Result<Belief, MapError> {
        if self.is_busy() {
            let mut done = self.clone();
            done.finish();
            return done.belief();
        }
        let now = &self.stiffness.averaged(self.averaged_force())?;
        let (mut mean, covariance) =
            self.model
                .reduced
                .completed(&self.before, &now.mean, &now.covariance)?;
        // How fast ropes creep, and what pulls, is this recording's alone.
        let d = self.before.mean.len();
        let rows = covariance.chunks_exact(mean.len().max(1)).take(d);
        let covariance = rows.flat_map(|row| row.iter().take(d).copied()).collect();
        mean.truncate(d);
        Ok(Belief {
            mean,
            covariance,
            temperature_c: now.temperature_c,
        })
    }
}

/// A belief with a force after it, where one is looked for, and the rates of so many offsets.
fn opened(model: &EstimationModel, known: Belief, creeps: usize) -> Belief {
    let (d, total) = (known.mean.len(), dimension(model, creeps));
    let mut covariance = alloc::vec![0.0; total * total];
    for (to, from) in (covariance.chunks_exact_mut(total)).zip(known.covariance.chunks_exact(d)) {
        to[..d].copy_from_slice(from);
    }
    let force = model.force.as_ref();
    let force = force.map(ForceModel::filter_deviations);
    let rates = (0..creeps).map(|_| CREEP_RAD_PER_S);
    let deviations = force.into_iter().flatten().chain(rates);
    for (k, deviation) in (d..total).zip(deviations) {
        covariance[k * (total + 1)] = deviation * deviation;
    }
    let mut mean = known.mean;
    mean.resize(total, 0.0);
    Belief {
        mean,
        covariance,
        temperature_c: known.temperature_c,
    }
}
