//! A constant force from outside at the tool: a cable that drags, a hose, a spring balancer.
//!
//! It is known in the base's frame, so what it does to a joint turns with the arm, and an offset doesn't:
//!
//! ```text
//! τ_spring = τ − J(q)ᵀ f,    J(q)ᵀ f = Σ_k f_k (j_k + Σ_l a_l m_lk)
//! ```
//!
//! with `j_k` the torque per newton along axis `k` of the base at the place where a payload is expected, and `m_lk` what
//! that changes by for every metre that it acts elsewhere in the body. Like every torque of a block it has passed the
//! low-pass: `LP[J]`, from the positions at the ends of the blocks and a straight line between them.

use super::block::Block;
use super::effects::FORCE;
use super::effects::external_force::{AppliedForce, ForceTorque};
use super::mixture::{Occurrence, PriorOdds};
use crate::Gaussian;
use crate::arm::{Arm, ArmWorkspace};
use crate::vec3::{Vec3, add};
use alloc::vec::Vec;

/// Odds that a force acts which nobody stated: a starting guess.
const ODDS: f64 = 0.05;
/// An arm is in its place where every joint is within this of it, rad. Contacts for a tenth of the time move joints by up to
/// 0.5 rad, and further than this for 1 to 5 % of it.
pub(crate) const PLACE_RAD: f64 = 0.2;
/// One that is there for such a share of the time says nothing of a force.
const STANDS: f64 = 0.92;
/// One that is there for such a share says little: a force further from nothing than so many deviations of what is believed is
/// none. Contacts and friction made some of 9 to 14 N out of nothing, where 0 ± 2 N were believed.
const HARDLY_MOVES: f64 = 0.75;
const FAR: f64 = 4.0;

/// Whether an arm that is in its place for such a share of the time says little of what pulls at it.
pub(crate) fn hardly_moves(in_its_place: f64) -> bool {
    in_its_place >= HARDLY_MOVES
}

/// What is believed of a constant force from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExternalForce {
    /// Along the axes of the base, N.
    pub force_n: [Gaussian; 3],
    /// Whether somebody said that there is one: it is estimated then, whatever the recording says.
    pub is_stated: bool,
}

impl ExternalForce {
    /// A force that nobody stated, and that may be as large as this along every axis, N; `None` for 0.
    pub fn possible(deviation_n: f64) -> Option<Self> {
        (deviation_n > 0.0).then_some(Self {
            force_n: [Gaussian::new(0.0, deviation_n); 3],
            is_stated: false,
        })
    }
}

/// A force on an arm.
#[derive(Debug, Clone)]
pub(crate) struct ForceModel {
    pub(crate) believed: ExternalForce,
    arm: Arm,
    /// Body it acts on, and where in its frame it is expected, m.
    body: usize,
    at: Vec3,
    /// How far from there it may act, m.
    pub(crate) reach_m: f64,
}

impl ForceModel {
    pub(crate) fn new(
        believed: ExternalForce,
        arm: &Arm,
        (body, at): (usize, Vec3),
        reach_m: f64,
    ) -> Self {
        Self {
            believed,
            arm: arm.clone(),
            body,
            at,
            reach_m,
        }
    }

    /// The force of a state's entries, which count from what is believed.
    pub(crate) fn applied(&self, [x, y, z, away_m @ ..]: [f64; FORCE]) -> AppliedForce {
        let [a, b, c] = self.believed.force_n.map(|f| f.mean);
        AppliedForce {
            force_n: [a + x, b + y, c + z],
            away_m,
        }
    }

    /// Standard deviations of its entries before a recording.
    pub(crate) fn deviations(&self) -> [f64; FORCE] {
        let [a, b, c] = self.believed.force_n.map(|f| f.deviation);
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

    /// What is believed of one that nobody stated.
    pub(crate) fn odds(&self) -> PriorOdds {
        let [deviation, ..] = self.deviations();
        PriorOdds {
            deviation,
            odds: ODDS,
            occurrence: Occurrence::AsOne,
        }
    }

    /// Whether poses can say anything of a force, of an arm that is in its place for such a share of the time. An arm that stands
    /// in one place says nothing of one: there it is like offsets, masses and what is held. What friction and contacts do to
    /// it would speak for one. A stated force acts without that.
    pub(crate) fn is_asked_for(&self, in_its_place: f64) -> bool {
        self.believed.is_stated || in_its_place < STANDS
    }

    /// Whether a force that was found may be one, of an arm that is in its place for such a share of the time.
    ///
    /// * `force_n`: from what is believed.
    pub(crate) fn is_credible(&self, force_n: Vec3, in_its_place: f64) -> bool {
        let far_n = FAR * self.odds().deviation;
        let is_far = force_n.iter().any(|x| x.abs() > far_n);
        self.is_asked_for(in_its_place) && !(is_far && hardly_moves(in_its_place))
    }

    /// What it does to every joint in blocks that follow each other, `n` a block.
    ///
    /// * `gain_per_s`: pole of the blocks' low-pass; `block_s`: their length.
    pub(crate) fn torques(
        &self,
        blocks: &[Block],
        gain_per_s: f64,
        block_s: f64,
    ) -> Vec<ForceTorque> {
        let n = self.arm.dof();
        let mut course = ForceCourse::new(self, gain_per_s, block_s);
        let mut out = alloc::vec![ForceTorque::default(); n * blocks.len()];
        for (block, out) in blocks.iter().zip(out.chunks_exact_mut(n.max(1))) {
            course.follow(self, block, out);
        }
        out
    }
}

/// Where the force acts in the body, and a metre further along each of its axes.
const POINTS: usize = 4;

/// What a force does to the joints, from block to block.
#[derive(Debug, Clone)]
pub(crate) struct ForceCourse {
    gain_per_s: f64,
    block_s: f64,
    ws: ArmWorkspace,
    /// Torques per newton at the end of the block before and of this one, `n` for each of [`POINTS`].
    before: Vec<Vec3>,
    now: Vec<Vec3>,
    /// The same after the low-pass: at the end of the block and in its mean.
    passed: Vec<Vec3>,
    mean: Vec<Vec3>,
    last_s: f64,
}

impl ForceCourse {
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

    /// What the force does to every joint in the block that follows, to `out`.
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
            // What came before isn't known; its mean is.
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

/// A first-order low-pass over a time in which its input goes straight from one value to another.
struct Straight {
    long_s: f64,
    lag_s: f64,
    /// What is left of the start at the end, and in the mean.
    left: f64,
    left_mean: f64,
}

impl Straight {
    fn new(gain_per_s: f64, long_s: f64) -> Self {
        let left = libm::exp(-gain_per_s * long_s);
        Self {
            long_s,
            lag_s: 1.0 / gain_per_s,
            left,
            left_mean: (1.0 - left) / (gain_per_s * long_s),
        }
    }

    /// Its output at the end and in the mean, from `x` at the start and the input's `u0` and `u1`.
    fn of(&self, x: f64, u0: f64, u1: f64) -> (f64, f64) {
        let late = self.lag_s * (u1 - u0) / self.long_s;
        let start = x - u0 + late;
        let end = u1 - late + start * self.left;
        let mean = 0.5 * (u0 + u1) - late + start * self.left_mean;
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
        let believed = ExternalForce::possible(2.0).unwrap();
        ForceModel::new(believed, &arm(), (1, AT), 0.05)
    }

    fn block(time_s: f64, q: [f64; 2], turned: [f64; 2]) -> Block {
        let mut block = Block::zero(2, 1);
        block.time_s = time_s;
        block.q.copy_from_slice(&q);
        block.turned.copy_from_slice(&turned);
        block
    }

    #[test]
    fn the_spring_carries_less_by_what_the_force_does_where_it_acts() {
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
                // Linear in each entry by itself.
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
    fn a_stated_force_acts_before_anything_is_found() {
        let believed = ExternalForce {
            force_n: [1.0, -2.0, 0.5].map(|mean| Gaussian::new(mean, 0.1)),
            is_stated: true,
        };
        let stated = ForceModel::new(believed, &arm(), (1, AT), 0.05);
        let q = [0.3, 0.9];
        let torques = stated.torques(&[block(0.1, q, q)], GAIN_PER_S, BLOCK_S);
        let free = model().applied([1.0, -2.0, 0.5, 0.0, 0.0, 0.0]);
        for torque in torques {
            let (found, _) = torque.torque(&stated.applied([0.0; FORCE]));
            assert_eq!(found, torque.torque(&free).0);
            assert!(found.abs() > 1e-3, "{found}");
        }
    }

    /// The second joint sweeps: the low-pass in steps of a millisecond against that of whole blocks.
    #[test]
    fn a_torque_of_motion_lags_as_the_blocks_do() {
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
