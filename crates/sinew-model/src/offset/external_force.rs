//! A constant external force at the tool: a cable that drags, a hose, a spring balancer.
//!
//! The force is constant in the base frame, so its torque on a joint depends on the pose, whereas an offset does not:
//!
//! ```text
//! τ_spring = τ − J(q)ᵀ f,    J(q)ᵀ f = Σ_k f_k (j_k + Σ_l a_l m_lk)
//! ```
//!
//! with `j_k` the torque per newton along axis `k` of the base at the point where a payload is expected, and `m_lk` its
//! change per metre of distance from that point in the body. Like every torque of a block it is low-pass filtered:
//! `LP[J]`, from the positions at the ends of the blocks with linear interpolation between them.

use super::block::Block;
use super::effects::FORCE;
use super::effects::external_force::{AppliedForce, ForceTorque};
use super::mixture::{Occurrence, PriorOdds};
use crate::Gaussian;
use crate::arm::{Arm, ArmWorkspace};
use crate::vec3::{Vec3, add};
use alloc::vec::Vec;

/// Prior odds of an unspecified external force; an assumed value.
const PRIOR_ODDS: f64 = 0.05;
/// Maximum deviation of every joint from a pose in which the arm counts as resting, rad. Contacts during a tenth of
/// the time move joints by up to 0.5 rad, and beyond this bound for 1 to 5 % of the time.
pub(crate) const PLACE_RAD: f64 = 0.2;
/// Share of the time in one pose above which a recording is uninformative about a force.
const MAX_SHARE_IN_PLACE: f64 = 0.92;
/// Share of the time in one pose above which a recording is weakly informative about a force.
const WEAK_SHARE_IN_PLACE: f64 = 0.75;
/// Maximum distance of a force from its prior in such a recording, in prior standard deviations; a larger force is rejected.
/// Contacts and friction caused spurious forces of 9 to 14 N at a prior of 0 ± 2 N.
const MAX_FORCE_SIGMA: f64 = 4.0;

/// Whether an arm that stays in one pose for this share of the time is weakly informative about an external force.
pub(crate) fn hardly_moves(in_its_place: f64) -> bool {
    in_its_place >= WEAK_SHARE_IN_PLACE
}

/// Prior of a constant external force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExternalForce {
    /// Along the axes of the base, N.
    pub force_n: [Gaussian; 3],
    /// Whether the user specified the force; a specified force is always estimated.
    pub is_specified: bool,
}

impl ExternalForce {
    /// Returns the prior of an unspecified force with this standard deviation along every axis, N; `None` for 0.
    pub fn possible(std_n: f64) -> Option<Self> {
        (std_n > 0.0).then_some(Self {
            force_n: [Gaussian::new(0.0, std_n); 3],
            is_specified: false,
        })
    }
}

/// A force on an arm.
#[derive(Debug, Clone)]
pub(crate) struct ForceModel {
    pub(crate) prior: ExternalForce,
    arm: Arm,
    /// Body it acts on, and where in its frame it is expected, m.
    body: usize,
    at: Vec3,
    /// Standard deviation of the distance of the force's point of action, m.
    pub(crate) reach_m: f64,
}

impl ForceModel {
    pub(crate) fn new(
        prior: ExternalForce,
        arm: &Arm,
        (body, at): (usize, Vec3),
        reach_m: f64,
    ) -> Self {
        Self {
            prior,
            arm: arm.clone(),
            body,
            at,
            reach_m,
        }
    }

    /// Returns the force of a state's entries, which are differences from the prior.
    pub(crate) fn applied(&self, [x, y, z, away_m @ ..]: [f64; FORCE]) -> AppliedForce {
        let [a, b, c] = self.prior.force_n.map(|f| f.mean);
        AppliedForce {
            force_n: [a + x, b + y, c + z],
            away_m,
        }
    }

    /// Standard deviations of its entries before a recording.
    pub(crate) fn stds(&self) -> [f64; FORCE] {
        let [a, b, c] = self.prior.force_n.map(|f| f.std);
        [a, b, c, self.reach_m, self.reach_m, self.reach_m]
    }

    /// Torques per newton at a pose.
    fn per_newton(&self, ws: &mut ArmWorkspace, q: &[f64], out: &mut [Vec3]) {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let [x, y, z] = axes.map(|axis| add(self.at, axis));
        let points: [Vec3; POINTS] = [self.at, x, y, z];
        if (self.arm.torques_per_newton(ws, q, self.body, &points, out)).is_err() {
            // Blocks have been checked; what is none is hidden by no estimate.
            out.fill([f64::NAN; 3]);
        }
    }

    /// Returns the prior odds of an unspecified force.
    pub(crate) fn odds(&self) -> PriorOdds {
        let [std, ..] = self.stds();
        PriorOdds {
            std,
            odds: PRIOR_ODDS,
            occurrence: Occurrence::AsOne,
        }
    }

    /// Whether a force is identifiable for an arm that stays in one pose for this share of the time. An arm at rest
    /// provides no information: a force is then equivalent to offsets, masses and payload, and friction and contacts
    /// would be misinterpreted as a force. A specified force is always identifiable.
    pub(crate) fn is_identifiable(&self, in_its_place: f64) -> bool {
        self.prior.is_specified || in_its_place < MAX_SHARE_IN_PLACE
    }

    /// Whether an estimated force is plausible for an arm that stays in one pose for this share of the time.
    ///
    /// * `force_n`: difference from the prior mean.
    pub(crate) fn is_credible(&self, force_n: Vec3, in_its_place: f64) -> bool {
        let far_n = MAX_FORCE_SIGMA * self.odds().std;
        let is_far = force_n.iter().any(|x| x.abs() > far_n);
        self.is_identifiable(in_its_place) && !(is_far && hardly_moves(in_its_place))
    }

    /// Returns the torques of the force on every joint in consecutive blocks, `n` per block.
    ///
    /// * `gain_per_s`: pole of the blocks' low-pass; `block_s`: their length.
    pub(crate) fn torques(
        &self,
        blocks: &[Block],
        gain_per_s: f64,
        block_s: f64,
    ) -> Vec<ForceTorque> {
        let n = self.arm.dof();
        let mut filter = ForceFilter::new(self, gain_per_s, block_s);
        let mut out = alloc::vec![ForceTorque::default(); n * blocks.len()];
        for (block, out) in blocks.iter().zip(out.chunks_exact_mut(n.max(1))) {
            filter.follow(self, block, out);
        }
        out
    }
}

/// Number of points of action: the reference point of the body, and one metre along each of its axes.
const POINTS: usize = 4;

/// Torque of the force on the joints, from block to block.
#[derive(Debug, Clone)]
pub(crate) struct ForceFilter {
    gain_per_s: f64,
    block_s: f64,
    ws: ArmWorkspace,
    /// Torques per newton at the end of the block before and of this one, `n` for each of [`POINTS`].
    before: Vec<Vec3>,
    now: Vec<Vec3>,
    /// Torques per newton after the low-pass filter, at the end of the block and as its mean.
    passed: Vec<Vec3>,
    mean: Vec<Vec3>,
    last_s: f64,
}

impl ForceFilter {
    /// Before the first block; allocates here only.
    ///
    /// * `gain_per_s`: pole of the blocks' low-pass; `block_s`: their length.
    pub(crate) fn new(model: &ForceModel, gain_per_s: f64, block_s: f64) -> Self {
        let zero = alloc::vec![[0.0; 3]; POINTS * model.arm.dof()];
        Self {
            gain_per_s,
            block_s,
            ws: ArmWorkspace::new(&model.arm),
            before: zero.clone(),
            now: zero.clone(),
            passed: zero.clone(),
            mean: zero,
            last_s: f64::NEG_INFINITY,
        }
    }

    /// Writes the torque of the force on every joint in the next block to `out`.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n).
    pub(crate) fn follow(&mut self, model: &ForceModel, block: &Block, out: &mut [ForceTorque]) {
        model.per_newton(&mut self.ws, &block.q, &mut self.now);
        let long_s = block.time_s - self.last_s;
        if long_s < 1.5 * self.block_s {
            let step = Straight::new(self.gain_per_s, long_s);
            let pairs = (self.before.as_flattened().iter()).zip(self.now.as_flattened());
            let to = self.passed.as_flattened_mut().iter_mut();
            for ((x, mean), (u0, u1)) in to.zip(self.mean.as_flattened_mut()).zip(pairs) {
                (*x, *mean) = step.of(*x, *u0, *u1);
            }
        } else {
            // The earlier motion is unknown; its mean is used.
            model.per_newton(&mut self.ws, &block.turned, &mut self.mean);
            for (to, mean) in self.passed.iter_mut().zip(&self.mean) {
                *to = *mean;
            }
        }
        let n = model.arm.dof();
        for (i, to) in out.iter_mut().enumerate() {
            let own = |point: usize| {
                self.mean
                    .get(point * n + i)
                    .copied()
                    .unwrap_or([f64::NAN; 3])
            };
            let less = |[a, b, c]: Vec3, [x, y, z]: Vec3| [a - x, b - y, c - z];
            *to = ForceTorque {
                at: own(0).map(|x| -x),
                away: [1, 2, 3].map(|point| less(own(0), own(point))),
            };
        }
        core::mem::swap(&mut self.before, &mut self.now);
        self.last_s = block.time_s;
    }
}

/// A first-order low-pass over a time in which its input changes linearly from one value to another.
struct Straight {
    long_s: f64,
    lag_s: f64,
    /// Decay of the initial value over a block: at its end, and in the mean.
    decay: f64,
    decay_mean: f64,
}

impl Straight {
    fn new(gain_per_s: f64, long_s: f64) -> Self {
        let decay = libm::exp(-gain_per_s * long_s);
        Self {
            long_s,
            lag_s: 1.0 / gain_per_s,
            decay,
            decay_mean: (1.0 - decay) / (gain_per_s * long_s),
        }
    }

    /// Returns the output at the end and in the mean, from `x` at the start and the input's `u0` and `u1`.
    fn of(&self, x: f64, u0: f64, u1: f64) -> (f64, f64) {
        let late = self.lag_s * (u1 - u0) / self.long_s;
        let start = x - u0 + late;
        let end = u1 - late + start * self.decay;
        let mean = 0.5 * (u0 + u1) - late + start * self.decay_mean;
        (end, mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{ArmBuilder, BodyInertia, BodySpec, JointKind, Pose};
    use alloc::string::String;

    const AT: Vec3 = [0.3, 0.05, -0.1];
    const GAIN_PER_S: f64 = 3.0;
    const BLOCK_S: f64 = 0.2;

    fn arm() -> Arm {
        let body = |parent: Option<usize>, x: f64, roll: f64| BodySpec {
            name: String::from(if parent.is_none() { "one" } else { "two" }),
            parent,
            kind: JointKind::Revolute,
            axis: [0.0, 0.0, 1.0],
            placement: Pose::from_xyz_rpy([x, 0.02, 0.1], [roll, 0.3, 0.0]),
            body: BodyInertia::point(1.2, [0.1, 0.05, 0.02]),
        };
        ArmBuilder::new()
            .body(body(None, 0.0, 0.4))
            .body(body(Some(0), 0.3, 1.5))
            .link(String::from("tool"), Some(1), Pose::IDENTITY)
            .build()
            .unwrap()
    }

    fn model() -> ForceModel {
        let prior = ExternalForce::possible(2.0).unwrap();
        ForceModel::new(prior, &arm(), (1, AT), 0.05)
    }

    fn block(time_s: f64, q: [f64; 2], turned: [f64; 2]) -> Block {
        let mut block = Block::zero(2, 1);
        block.time_s = time_s;
        block.q.copy_from_slice(&q);
        block.turned.copy_from_slice(&turned);
        block
    }

    #[test]
    fn spring_torque_reduced_by_external_force() {
        let (arm, model) = (arm(), model());
        let mut ws = ArmWorkspace::new(&arm);
        let entries = [0.7, -1.1, 0.4, 0.02, -0.01, 0.03];
        for q in [[0.0, 0.0], [0.8, -1.3], [-2.1, 0.6]] {
            let stands = [block(0.1, q, q), block(0.3, q, q)];
            let torques = model.torques(&stands, GAIN_PER_S, BLOCK_S);
            let place: Vec3 = core::array::from_fn(|k| AT[k] + entries[3 + k]);
            let force = [entries[0], entries[1], entries[2]];
            let mut expected = [0.0; 2];
            arm.add_point_force(&mut ws, &q, "tool", place, force, &mut expected)
                .unwrap();
            let applied = model.applied(entries);
            for (k, torque) in torques.iter().enumerate() {
                let (found, slope) = torque.torque(&applied);
                assert!((found + expected[k % 2]).abs() < 1e-12, "{found}");
                // The torque is linear in each entry.
                for (i, slope) in slope.into_iter().enumerate() {
                    let mut more = entries;
                    more[i] += 0.5;
                    let (more, _) = torque.torque(&model.applied(more));
                    assert!((more - found - 0.5 * slope).abs() < 1e-12, "{i}: {slope}");
                }
            }
        }
    }

    #[test]
    fn specified_force_acts_from_start() {
        let prior = ExternalForce {
            force_n: [1.0, -2.0, 0.5].map(|mean| Gaussian::new(mean, 0.1)),
            is_specified: true,
        };
        let stated = ForceModel::new(prior, &arm(), (1, AT), 0.05);
        let q = [0.3, 0.9];
        let torques = stated.torques(&[block(0.1, q, q)], GAIN_PER_S, BLOCK_S);
        let free = model().applied([1.0, -2.0, 0.5, 0.0, 0.0, 0.0]);
        for torque in torques {
            let (found, _) = torque.torque(&stated.applied([0.0; FORCE]));
            assert_eq!(found, torque.torque(&free).0);
            assert!(found.abs() > 1e-3, "{found}");
        }
    }

    /// The second joint sweeps: the low-pass in steps of a millisecond is compared with that of whole blocks.
    #[test]
    fn moving_torque_is_filtered_like_blocks() {
        let (arm, model) = (arm(), model());
        let mut ws = ArmWorkspace::new(&arm);
        let angle = |t: f64| [0.2, libm::sin(1.5 * t)];
        let mut per_newton = |q: [f64; 2]| {
            let mut out = [[0.0; 3]; 2];
            arm.torques_per_newton(&mut ws, &q, 1, &[AT], &mut out)
                .unwrap();
            out
        };
        const STEP_S: f64 = 1e-3;
        let mut passed = per_newton(angle(0.0));
        let (mut blocks, mut means) = (Vec::new(), Vec::new());
        let mut sum = [[0.0; 3]; 2];
        for k in 1..=4000 {
            let t = f64::from(k) * STEP_S;
            let now = per_newton(angle(t - 0.5 * STEP_S));
            for i in 0..2 {
                for axis in 0..3 {
                    let before = passed[i][axis];
                    let step = (now[i][axis] - before) * (1.0 - libm::exp(-GAIN_PER_S * STEP_S));
                    passed[i][axis] += step;
                    sum[i][axis] += 0.5 * (before + passed[i][axis]) * STEP_S / BLOCK_S;
                }
            }
            if k % 200 == 0 {
                blocks.push(block(t - 0.5 * BLOCK_S, angle(t), angle(t)));
                means.push(core::mem::take(&mut sum));
            }
        }
        let found = model.torques(&blocks, GAIN_PER_S, BLOCK_S);
        let (mut most, mut largest) = (0.0_f64, 0.0_f64);
        // Two seconds until the start is forgotten.
        for (mean, found) in means.iter().zip(found.chunks_exact(2)).skip(12) {
            for (mean, found) in mean.iter().zip(found) {
                for (mean, found) in mean.iter().zip(found.at) {
                    most = most.max((mean + found).abs());
                    largest = largest.max(mean.abs());
                }
            }
        }
        assert!(most < 4e-3 * largest, "{most} of {largest}");
    }
}
