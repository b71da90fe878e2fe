//! Loss of a transmission: a tendon that is torn or off its pulley, or whose motor side is detached.
//!
//! Such a tendon transmits no torque from its onset `t0` on, so the link moves as a free pendulum while motor and joint
//! move independently of each other. Three hypotheses are compared per joint on the blocks of a recording, in rad of the
//! spring deflection (torques divided by the stiffness `K`). `y` is `theta_measured − q`, `d = Φ z / K` the deflection
//! that the motion of the link requires, `u = τ_m − J LP[θ̈]` the torque of the drive less its inertia:
//!
//! ```text
//! intact      y ~ (1 − c) t(d, σ_y) + c N(0, (τ_max/2K)²)    u/K ~ t(y, σ_u)    d: as in the recording
//! loss        y ~ N(0, w²)                                    u/K ~ t(0, σ_u)    d ~ N(0, σ_d²)
//! sensing     y ~ N(0, w²)                                    u/K ~ t(0, √(σ_u² + d_g²))    d ~ N(0, σ_d² + d_g²)
//! ```
//!
//! * `τ_max`: effort limit of the joint. No contact deflects a spring by more than the torque of its drive; a share `c` of
//!   the time is in contact.
//! * `w`: half the range of the joint, in which motor and joint move independently of each other.
//! * `σ_d`: friction, mass tolerance and payload; `d_g`: root mean square of the gravity load over the poses of the joint.
//! * sensing: an encoder that is frozen, loose or mapped to another joint, or positions in another unit. Its `d` is that of
//!   a pose the arm is not in. A joint whose reading is constant while its motor moves is less probable for a free link.
//!
//! The posterior of the onset is a sum over all blocks. The noise of consecutive blocks is correlated, so each counts as
//! `(1 − ρ)/(1 + ρ)` observations, and a motor at rest for ten seconds at most.

use super::detector::{ln_normal, ln_student, ln_sum};
use super::frozen_encoder::MAX_CONSTANT_RAD;
use super::recorder::Recorded;
use super::result::{TendonChange, TendonChangeKind};
use crate::robot_check::loads;
use sinew_model::arm::JointKind;
use sinew_model::offset::{Block, MapEstimator, Payload, UNKNOWN_OFFSET_RAD};
use sinew_model::robot::Robot;
use sinew_model::transmission::Friction;
use sinew_model::{Interval95, Z95};

/// Mean time between losses of one transmission, s of motion: one in a thousand hours. Engineering estimate.
const LOSS_INTERVAL_S: f64 = 3.6e6;
/// Probability that a transmission was lost before the recording. Engineering estimate.
const LOST_BEFORE_PROBABILITY: f64 = 1e-3;
/// Probability that a sensor or its mapping is wrong from the start, the commonest fault of new recordings.
/// Engineering estimate.
const SENSING_FAULT_PROBABILITY: f64 = 1e-2;
/// Prior share of the time in contact.
const CONTACT_SHARE: f64 = 0.1;
/// Largest considered square of a standardised load: the free fall of a link is faster than the filters.
const MAX_SQUARE: f64 = 25.0;
/// Travel of a motor between two independent observations, rad.
const TRAVEL_RAD: f64 = 0.01;
/// Time of a motor at rest that counts, s.
const MAX_REST_S: f64 = 10.0;
/// Probability that a free link shows a constant reading while its motor moves: friction holds it, and no other joint
/// moves it by a step of its encoder. Engineering estimate.
const FREE_BUT_CONSTANT_PROBABILITY: f64 = 0.1;
/// Minimum probability of a loss to be reported.
const MIN_PROBABILITY: f64 = 0.5;

/// Loss of the transmission of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TransmissionLoss {
    /// Index of the joint.
    pub(super) joint: usize,
    /// Start of the first block without torque, s.
    pub(super) since_s: f64,
    /// 95 % interval of the onset, s; `None` for a loss before the recording.
    pub(super) interval_s: Option<Interval95>,
    /// Posterior probability, 0 to 1.
    pub(super) probability: f64,
}

impl TransmissionLoss {
    /// Excludes the joint from all blocks that may be without torque.
    pub(super) fn exclude(&self, recorded: &mut Recorded) {
        let from_s = self
            .interval_s
            .map_or(f64::NEG_INFINITY, |interval| interval.low);
        let lost = recorded
            .blocks
            .iter_mut()
            .filter(|block| block.time_s > from_s);
        lost.for_each(|block| block.exclude(self.joint));
    }

    /// The loss as a change of the tendon.
    pub(super) fn change(&self) -> TendonChange {
        TendonChange {
            kind: TendonChangeKind::TransmissionLost,
            time_s: self.since_s.max(0.0),
            interval_s: self.interval_s,
            probability: Some(self.probability),
            size_rad: None,
            stiffness_change_ratio: None,
            cause: None,
        }
    }
}

/// Detects the losses of a recording; empty for tendons that share joints with others.
pub(super) fn detect(
    robot: &Robot,
    estimator: &MapEstimator,
    recorded: &Recorded,
    payload: Payload,
) -> Vec<TransmissionLoss> {
    if estimator.prior().routings().is_some() || recorded.blocks.is_empty() {
        return Vec::new();
    }
    let loads = loads::loads(&robot.arm, &robot.limits);
    let losses: Vec<TransmissionLoss> = (recorded.elastic.iter())
        .filter_map(|&joint| {
            Hypotheses::new(
                robot,
                estimator,
                recorded,
                payload,
                joint,
                loads[joint].gravity_nm,
            )?
            .loss(joint)
        })
        .collect();
    // Two independent losses are less probable than one wrong unit or mapping, which all joints have in common.
    match losses.len() > 1 && !has_motor_torque(recorded) {
        true => Vec::new(),
        false => losses,
    }
}

fn has_motor_torque(recorded: &Recorded) -> bool {
    let mut all = recorded.blocks.iter().flat_map(|b| &b.motor_torque);
    all.any(|torque| torque.is_finite())
}

/// Observations of one block, with their log likelihood ratios over the intact transmission.
#[derive(Debug, Clone, Copy)]
struct Observation {
    /// Start of the block, s.
    start_s: f64,
    /// Number of independent observations.
    weight: f64,
    /// Weighted log likelihood ratio of `y` and `u` for a loss and for a sensing fault.
    ln_ratio: [f64; 2],
    /// Square of the standardised load `d/σ_d`.
    load_square: f64,
}

/// Observations of a joint.
struct Hypotheses {
    observations: Vec<Observation>,
    /// Variance of the standardised load under a sensing fault.
    gravity_square: f64,
    block_s: f64,
}

impl Hypotheses {
    fn new(
        robot: &Robot,
        estimator: &MapEstimator,
        recorded: &Recorded,
        payload: Payload,
        joint: usize,
        gravity_nm: f64,
    ) -> Option<Self> {
        /// Root mean square of a sine, relative to its maximum.
        const RMS_RATIO: f64 = std::f64::consts::FRAC_1_SQRT_2;
        /// Standard deviation of the load on the drive by gear friction, relative to the load.
        const DRIVE_FRICTION_RATIO: f64 = 0.2;
        let transmission = robot.transmissions[joint].as_ref()?;
        let prior = estimator.prior();
        let loads = prior.described_deflections_rad(&recorded.blocks, joint);
        if loads.len() != recorded.blocks.len() {
            return None;
        }
        let stiffness = transmission.stiffness_nm_per_rad;
        let limits = robot.limits[joint];
        let range = match limits.upper - limits.lower {
            range if range.is_finite() && range > 0.0 => range,
            _ => match robot.arm.joint_kind(joint) {
                Some(JointKind::Prismatic) => return None,
                _ => std::f64::consts::TAU,
            },
        };
        let gravity_rad = RMS_RATIO * gravity_nm / stiffness;
        // Placeholders of effort limits bound nothing.
        let contact_rad = match 0.5 * limits.effort / stiffness {
            bound if bound > UNKNOWN_OFFSET_RAD => bound.min(0.5 * range),
            _ => 0.5 * range,
        };
        let friction = |friction: Friction, default_rad: f64| {
            let coulomb_nm = friction.or_default(stiffness, default_rad).coulomb_nm;
            // A drive without dry friction still has encoder errors.
            (coulomb_nm / stiffness).hypot(robot.tolerances.encoder_rad)
        };
        let joint_friction_rad = friction(transmission.joint_friction, Friction::DEFAULT_JOINT_RAD);
        let drive_friction_rad = friction(transmission.motor_friction, Friction::DEFAULT_DRIVE_RAD);
        let inertia = transmission.motor_inertia_kg_m2.unwrap_or(0.0);
        let mass_kg = prior
            .payload_range(payload)
            .map_or([0.0; 2], |held| held.mass_kg);
        let (held_kg, held_std_kg) = (
            0.5 * (mass_kg[0] + mass_kg[1]),
            0.5 * (mass_kg[1] - mass_kg[0]) / Z95,
        );
        let tolerance = robot.tolerances.mass;
        let width = 0.5 * range;
        let independent = independent_share(estimator);
        let block_s = estimator.block_s();
        let mut motion = MotorMotion::default();
        let observations = recorded.blocks.iter().zip(&loads).map(|(block, load)| {
            let y = block.y[joint];
            let d = load[0] + held_kg * load[1];
            let held_rad = held_std_kg * load[1];
            let load_variance = joint_friction_rad.powi(2)
                + (tolerance * gravity_rad).powi(2)
                + held_rad * held_rad;
            let intact_variance = UNKNOWN_OFFSET_RAD.powi(2)
                + load_variance
                + (robot.tolerances.stiffness * d).powi(2);
            let free = ln_normal(y, width * width);
            let intact = ln_sum(
                [
                    (1.0 - CONTACT_SHARE).ln() + ln_student(y - d, intact_variance),
                    CONTACT_SHARE.ln() + ln_normal(y, contact_rad * contact_rad),
                ]
                .into_iter(),
            );
            let mut ln_ratio = [free - intact; 2];
            let torque =
                (block.motor_torque[joint] - inertia * block.motor_acceleration[joint]) / stiffness;
            if torque.is_finite() {
                let variance = |load: f64| {
                    (2.0 * drive_friction_rad).powi(2) + (DRIVE_FRICTION_RATIO * load).powi(2)
                };
                let intact = ln_student(torque - y, variance(y));
                ln_ratio[0] += ln_student(torque, variance(0.0)) - intact;
                ln_ratio[1] +=
                    ln_student(torque, variance(0.0) + gravity_rad * gravity_rad) - intact;
            }
            let weight = independent * motion.share(block, joint, block_s);
            if motion.is_joint_constant(block, joint) {
                ln_ratio[0] += FREE_BUT_CONSTANT_PROBABILITY.ln();
            }
            Observation {
                start_s: block.time_s - 0.5 * block_s,
                weight,
                ln_ratio: ln_ratio.map(|ln| weight * ln),
                load_square: (d * d / load_variance).min(MAX_SQUARE),
            }
        });
        let own_variance = joint_friction_rad.powi(2) + (tolerance * gravity_rad).powi(2);
        Some(Self {
            observations: observations.collect(),
            gravity_square: 1.0 + gravity_rad * gravity_rad / own_variance,
            block_s,
        })
    }

    /// Posterior of a loss; `None` if it is less probable than not.
    fn loss(&self, joint: usize) -> Option<TransmissionLoss> {
        let n = self.observations.len();
        let mut ln = vec![[f64::NEG_INFINITY; 2]; n];
        let (mut ratio, mut weight, mut square) = ([0.0; 2], 0.0, 0.0);
        for (k, observation) in self.observations.iter().enumerate().rev() {
            for (sum, own) in ratio.iter_mut().zip(observation.ln_ratio) {
                *sum += own;
            }
            weight += observation.weight;
            square += observation.weight * observation.load_square;
            // The load of an intact arm depends on its task: its variance is that of the recording.
            let ln_load = |variance: f64| -0.5 * (square / variance + weight * variance.ln());
            let task = ln_load((square / weight.max(f64::MIN_POSITIVE)).max(1.0));
            let hazard = (self.block_s / LOSS_INTERVAL_S).ln();
            let onset = match k {
                0 => [LOST_BEFORE_PROBABILITY.ln(), SENSING_FAULT_PROBABILITY.ln()],
                _ => [hazard; 2],
            };
            ln[k] = [
                onset[0] + ratio[0] + ln_load(1.0) - task,
                onset[1] + ratio[1] + ln_load(self.gravity_square) - task,
            ];
        }
        let all = ln_sum(ln.iter().flatten().copied().chain([0.0]));
        let probability = ln_sum(ln.iter().map(|ln| ln[0])) - all;
        let probability = probability.exp();
        if !(probability >= MIN_PROBABILITY) {
            return None;
        }
        let most = (0..n).max_by(|&a, &b| ln[a][0].total_cmp(&ln[b][0]))?;
        let shares: Vec<f64> = ln
            .iter()
            .map(|ln| (ln[0] - all).exp() / probability)
            .collect();
        let quantile = |p: f64| {
            let mut sum = 0.0;
            shares.iter().position(|share| {
                sum += share;
                sum >= p
            })
        };
        let at = |k: usize| self.observations[k].start_s;
        let interval_s = (most > 0).then(|| Interval95 {
            low: at(quantile(0.025).unwrap_or(most)),
            high: at(quantile(0.975).unwrap_or(most)) + self.block_s,
        });
        Some(TransmissionLoss {
            joint,
            since_s: at(most),
            interval_s,
            probability,
        })
    }
}

/// Share of a block that is an observation of its own: noise of consecutive blocks has the autocorrelation `ρ`.
fn independent_share(estimator: &MapEstimator) -> f64 {
    let rho = estimator.noise_autocorrelation();
    (1.0 - rho) / (1.0 + rho)
}

/// Motion of a motor from block to block.
#[derive(Debug, Clone, Copy, Default)]
struct MotorMotion {
    last_rad: Option<f64>,
    rest_s: f64,
    joint_rad: Option<f64>,
}

impl MotorMotion {
    /// Returns 1 for a block with motion or within the first seconds of a rest phase, else 0.
    fn share(&mut self, block: &Block, joint: usize, block_s: f64) -> f64 {
        let position = block.turned[joint] + block.y[joint];
        if self
            .last_rad
            .is_none_or(|last| (position - last).abs() > TRAVEL_RAD)
        {
            (self.last_rad, self.rest_s) = (Some(position), 0.0);
        } else {
            self.rest_s += block_s;
        }
        if self.rest_s <= MAX_REST_S { 1.0 } else { 0.0 }
    }

    /// Whether the joint position is that of the previous block, which a moving or quantised joint never shows exactly.
    fn is_joint_constant(&mut self, block: &Block, joint: usize) -> bool {
        let position = block.turned[joint];
        let last = self.joint_rad.replace(position);
        last.is_some_and(|last| (position - last).abs() <= MAX_CONSTANT_RAD)
    }
}
