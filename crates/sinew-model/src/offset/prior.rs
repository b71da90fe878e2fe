//! The unknown parameters of a robot, with their prior before any recording.

use super::belief::{Belief, Payload, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD};
use super::block::Block;
use super::layout::Layout;
use super::parameter::{ENCODER, JointParameter, PAYLOAD, PER_JOINT};
use super::payload::point_mass;
use super::state_entry::StateEntry;
use crate::Gaussian;
use crate::arm::{Arm, BaseParameters, PARAMETERS_PER_BODY};
use crate::tolerances::Tolerances;
use crate::transmission::{Friction, Transmission};
use alloc::vec::Vec;

/// Nominal values of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointPrior {
    /// Nominal stiffness, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Reflected motor inertia, kg·m²; `None`: the motor's torque is no witness.
    pub motor_inertia_kg_m2: Option<f64>,
    /// Nominal Coulomb friction, N·m; where it and the viscous one are 0, nobody stated any.
    pub coulomb_nm: f64,
    /// Nominal viscous friction, N·m·s/rad.
    pub viscous_nm_s_per_rad: f64,
    /// Nominal Coulomb friction of the drive, N·m; as above.
    pub motor_coulomb_nm: f64,
    /// Nominal viscous friction of the drive, N·m·s/rad.
    pub motor_viscous_nm_s_per_rad: f64,
    /// Whether two ropes pull against each other: one that stretched is a dead zone then.
    pub antagonistic: bool,
    /// Drift of the zero with temperature by rope, frame and routing, rad/K; `None`: 0 ± the tolerance.
    pub drift_rad_per_k: Option<Gaussian>,
}

impl JointPrior {
    /// Friction of the joint as far as it is known before any recording, and by what part of itself it may
    /// be off: a guess by all of it.
    fn friction(&self, tolerance: f64) -> (Friction, f64) {
        let stated = Friction {
            coulomb_nm: self.coulomb_nm,
            viscous_nm_s_per_rad: self.viscous_nm_s_per_rad,
        };
        self.known(stated, Friction::GUESSED_OF_JOINT_RAD, tolerance)
    }

    /// The same of the drive.
    fn drive_friction(&self, tolerance: f64) -> (Friction, f64) {
        let stated = Friction {
            coulomb_nm: self.motor_coulomb_nm,
            viscous_nm_s_per_rad: self.motor_viscous_nm_s_per_rad,
        };
        self.known(stated, Friction::GUESSED_OF_DRIVE_RAD, tolerance)
    }

    fn known(&self, stated: Friction, guess_rad: f64, tolerance: f64) -> (Friction, f64) {
        let off = if stated.is_stated() { tolerance } else { 1.0 };
        (stated.or_guessed(self.stiffness_nm_per_rad, guess_rad), off)
    }

    /// Coulomb friction of the drive, N·m, as far as it is known before any recording.
    pub(crate) fn drive_coulomb_nm(&self) -> f64 {
        self.drive_friction(0.0).0.coulomb_nm
    }
}

/// What the gripper may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PayloadRange {
    /// Least and largest mass, kg.
    pub mass_kg: [f64; 2],
    /// Largest moment about where it is expected, along every axis of the body that carries it, kg·m.
    pub moment_kg_m: f64,
}

/// What half a dead zone may be before anything is known, rad.
const UNKNOWN_SLACK_RAD: f64 = 0.01;
/// Standard deviation of where in −1…1 friction stands. A joint at rest came there by sliding, or
/// was pushed there by its rope: an end is more likely than the middle (evenly spread: 0.58).
pub(crate) const STUCK: f64 = 0.85;
/// Standard deviation of what is held fixed, in its own unit.
const FIXED: f64 = 1e-9;

/// The model whose parameters are estimated, with its priors.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    pub(crate) joints: Vec<Option<JointPrior>>,
    /// Nominal inertial parameters, `10 n`.
    pub(crate) inertial: Vec<f64>,
    /// Body the payload hangs on, and where in its frame it is expected, m.
    pub(crate) payload_body: usize,
    pub(crate) payload_at: [f64; 3],
    /// What of `inertial` motion depends on.
    pub(crate) base: BaseParameters,
    tolerances: Tolerances,
}

impl Prior {
    /// Priors for a robot; `payload_at` in the re-based frame of body `payload_body`.
    pub fn new(
        arm: &Arm,
        transmissions: &[Option<Transmission>],
        payload_body: usize,
        payload_at: [f64; 3],
        tolerances: Tolerances,
    ) -> Self {
        Self {
            joints: transmissions
                .iter()
                .map(|t| {
                    t.as_ref().map(|t| JointPrior {
                        stiffness_nm_per_rad: t.stiffness_nm_per_rad,
                        motor_inertia_kg_m2: t.motor_inertia_kg_m2,
                        coulomb_nm: t.joint_friction.coulomb_nm,
                        viscous_nm_s_per_rad: t.joint_friction.viscous_nm_s_per_rad,
                        motor_coulomb_nm: t.motor_friction.coulomb_nm,
                        motor_viscous_nm_s_per_rad: t.motor_friction.viscous_nm_s_per_rad,
                        antagonistic: t.tendon.as_ref().is_some_and(|t| t.antagonistic),
                        drift_rad_per_k: t.warmth.map(|w| w.drift_rad_per_k),
                    })
                })
                .collect(),
            inertial: arm.inertial_parameters(),
            payload_body: payload_body.min(arm.dof().saturating_sub(1)),
            payload_at,
            base: arm.base_parameters(),
            tolerances,
        }
    }

    /// Joints of the arm.
    pub fn joints(&self) -> usize {
        self.joints.len()
    }

    /// Whether two ropes of joint `i` pull against each other.
    pub fn is_antagonistic(&self, i: usize) -> bool {
        let joint = self.joints.get(i).and_then(Option::as_ref);
        joint.is_some_and(|j| j.antagonistic)
    }

    /// Whether joint `i` is elastic.
    pub fn is_elastic(&self, i: usize) -> bool {
        self.joints.get(i).is_some_and(Option::is_some)
    }

    /// Length of the state.
    pub fn dimension(&self) -> usize {
        self.layout().dimension()
    }

    /// Place of a joint's parameter in the state.
    pub fn place(&self, joint: usize, parameter: JointParameter) -> usize {
        self.layout().place(joint, parameter)
    }

    /// Of the state as beliefs and estimates have it: every body with all its parameters.
    pub(crate) fn layout(&self) -> Layout {
        Layout {
            joints: self.joints.len(),
            bodies: self.joints.len() * PARAMETERS_PER_BODY,
        }
    }

    /// How far from where it is expected a payload, or a force, may be, m.
    pub(crate) fn reach_m(&self) -> f64 {
        self.tolerances.payload_reach_m
    }

    pub(crate) fn body_start(&self) -> usize {
        self.layout().body_start()
    }

    /// Place of the payload's mass in the state.
    pub fn payload_place(&self) -> usize {
        self.layout().payload_place()
    }

    /// What entry `k` of the state is.
    pub fn describe(&self, k: usize) -> Option<StateEntry> {
        StateEntry::of(self.layout(), k)
    }

    /// Deflection of elastic joint `i`'s spring that motion and gravity ask for, friction and contact aside, one row per block, rad:
    /// `Φ_i z / K` with the described masses and stiffness and an empty gripper, then what a kilogram where a payload is expected adds to
    /// it, and a moment of 1 kg·m beside that place along each axis of the body. Empty for a rigid joint. Allocates.
    pub fn described_deflections_rad(&self, blocks: &[Block], i: usize) -> Vec<[f64; 1 + PAYLOAD]> {
        let Some(joint) = self.joints.get(i).and_then(Option::as_ref) else {
            return Vec::new();
        };
        let moved = |axis: usize, by_m: f64| {
            let mut at = self.payload_at;
            at[axis] += by_m;
            point_mass(at)
        };
        let moments = [0, 1, 2].map(|axis| {
            let ends = [1.0, -1.0].map(|by_m| self.on_payload_body(moved(axis, by_m)));
            let [further, nearer] = ends.map(|inertial| self.base.of(&inertial));
            let pairs = further.iter().zip(&nearer);
            pairs.map(|(a, b)| 0.5 * (a - b)).collect::<Vec<f64>>()
        });
        let described = self.base.of(&self.inertial);
        let mass = self
            .base
            .of(&self.on_payload_body(point_mass(self.payload_at)));
        let [x, y, z] = moments;
        let columns = [described, mass, x, y, z];
        let of_block = |block: &Block| {
            columns.each_ref().map(|column| {
                let row = block.phi.get(i * column.len()..(i + 1) * column.len());
                let torque = row.map_or(f64::NAN, |phi| crate::cholesky::dot(phi, column));
                torque / joint.stiffness_nm_per_rad
            })
        };
        blocks.iter().map(of_block).collect()
    }

    /// Inertial parameters of all bodies of which only the payload's has any.
    fn on_payload_body(&self, own: [f64; PARAMETERS_PER_BODY]) -> Vec<f64> {
        let mut inertial = alloc::vec![0.0; self.inertial.len()];
        let body = inertial
            .iter_mut()
            .skip(self.payload_body * PARAMETERS_PER_BODY);
        for (to, from) in body.zip(own) {
            *to = from;
        }
        inertial
    }

    /// What the gripper may hold: what is believed, two deviations off in mass and five in place, as of a tool held by its end. `None`:
    /// nothing.
    pub fn payload_range(&self, payload: Payload) -> Option<PayloadRange> {
        const FAR: f64 = 2.0;
        const FAR_OUT: f64 = 5.0;
        let [mass, ..] = self.payload_belief(payload);
        let off_kg = FAR * mass.deviation;
        let least_kg = match payload {
            Payload::Empty => return None,
            Payload::Unknown => 0.0,
            Payload::Known { .. } => (mass.mean - off_kg).max(0.0),
        };
        let most_kg = (mass.mean + off_kg).max(least_kg);
        Some(PayloadRange {
            mass_kg: [least_kg, most_kg],
            moment_kg_m: most_kg * FAR_OUT * self.tolerances.payload_reach_m,
        })
    }

    /// What is believed before any recording; every offset `0 ± offset_deviation_rad`.
    pub fn belief(&self, payload: Payload, offset_deviation_rad: f64) -> Belief {
        let d = self.dimension();
        let (mut mean, mut deviation) = (alloc::vec![0.0; d], alloc::vec![FIXED; d]);
        for (i, joint) in self.joints.iter().enumerate() {
            if let Some(joint) = joint {
                let at = i * PER_JOINT..(i + 1) * PER_JOINT;
                self.joint_belief(joint, &mut mean[at.clone()], &mut deviation[at]);
                deviation[self.place(i, JointParameter::Offset)] = offset_deviation_rad;
                let slack = &mut deviation[self.place(i, JointParameter::Slack)];
                *slack = slack.min(offset_deviation_rad);
            }
        }
        for b in 0..self.joints.len() {
            let at = self.body_start() + b * PARAMETERS_PER_BODY;
            let pi = &self.inertial[b * PARAMETERS_PER_BODY..(b + 1) * PARAMETERS_PER_BODY];
            self.body_belief(pi, &mut deviation[at..at + PARAMETERS_PER_BODY]);
        }
        let mut covariance = alloc::vec![0.0; d * d];
        for (k, s) in deviation.iter().enumerate() {
            covariance[k * d + k] = s * s;
        }
        let mut belief = Belief {
            mean,
            covariance,
            temperature_c: f64::NAN,
        };
        self.open_payload(&mut belief, payload);
        belief
    }

    fn joint_belief(&self, joint: &JointPrior, mean: &mut [f64], deviation: &mut [f64]) {
        use JointParameter as P;
        let t = &self.tolerances;
        let mut set = |p: P, believed: Gaussian| {
            mean[p as usize] = believed.mean;
            deviation[p as usize] = believed.deviation.max(FIXED);
        };
        set(P::Compliance, about_zero(t.stiffness));
        set(P::Stiffening, t.stiffening_per_rad2);
        let (own, off) = joint.friction(t.friction);
        set(
            P::Coulomb,
            Gaussian::new(own.coulomb_nm, off * own.coulomb_nm),
        );
        let viscous = own.viscous_nm_s_per_rad;
        set(P::Viscous, Gaussian::new(viscous, off * viscous));
        set(P::LoadFriction, t.load_friction);
        let drift = joint.drift_rad_per_k;
        set(P::Drift, drift.unwrap_or(about_zero(t.drift_rad_per_k())));
        set(P::Thermal, t.stiffness_per_k);
        set(P::Stuck, about_zero(STUCK));
        set(P::Viscoelastic, about_zero(t.viscoelastic));
        set(P::Gear, about_zero(t.gear));
        set(P::Zero, about_zero(t.zero_rad));
        set(P::MotorScale, about_zero(t.motor_torque));
        let (friction, off) = joint.drive_friction(t.friction);
        let drive = friction.coulomb_nm;
        // A torque's zero is good to a small part of what the drive's friction is.
        let bias = (0.1 * drive).max(t.motor_torque * 0.02 * joint.stiffness_nm_per_rad);
        set(P::MotorBias, about_zero(bias));
        set(P::MotorCoulomb, Gaussian::new(drive, off * drive));
        let viscous = friction.viscous_nm_s_per_rad;
        set(
            P::MotorViscous,
            Gaussian::new(viscous, off * viscous.max(0.1 * drive)),
        );
        set(P::MotorLoadFriction, t.drive_load_friction);
        if joint.antagonistic {
            deviation[P::Slack as usize] = UNKNOWN_SLACK_RAD;
        }
        for k in 0..ENCODER {
            deviation[P::Encoder as usize + k] = t.encoder_rad.max(FIXED);
        }
    }

    fn body_belief(&self, pi: &[f64], deviation: &mut [f64]) {
        let t = &self.tolerances;
        let h = libm::sqrt(pi[1] * pi[1] + pi[2] * pi[2] + pi[3] * pi[3]);
        // A body whose centre sits on its joint still may sit 1 cm off.
        let across = (t.first_moment_across * h).max(0.01 * t.mass * pi[0]);
        let trace = pi[4] + pi[7] + pi[9];
        deviation[0] = t.mass * pi[0];
        for k in 1..4 {
            deviation[k] = libm::hypot(t.first_moment * pi[k], across);
        }
        for k in 4..PARAMETERS_PER_BODY {
            let diagonal = matches!(k, 4 | 7 | 9);
            deviation[k] = if diagonal {
                t.inertia * pi[k] + 0.01 * t.inertia * trace
            } else {
                0.2 * t.inertia * trace
            };
        }
        for x in deviation {
            *x = x.max(1e-12);
        }
    }

    /// The payload's mass and moments before a recording.
    pub(crate) fn payload_belief(&self, payload: Payload) -> [Gaussian; PAYLOAD] {
        let mass = match payload {
            Payload::Empty => return [about_zero(FIXED); PAYLOAD],
            Payload::Unknown => self.tolerances.payload_kg,
            Payload::Known { mass_kg } => Gaussian::new(mass_kg.mean, mass_kg.deviation.max(FIXED)),
        };
        let size = mass.mean.abs().max(mass.deviation);
        let moment = about_zero(size * self.tolerances.payload_reach_m);
        [mass, moment, moment, moment]
    }

    /// The encoders' zero is forgotten, as when the ropes are tensioned anew.
    pub fn open_zero(&self, belief: &mut Belief) {
        let deviation = self.tolerances.zero_rad.max(FIXED);
        for i in (0..self.joints.len()).filter(|&i| self.is_elastic(i)) {
            belief.open(self.place(i, JointParameter::Zero), about_zero(deviation));
        }
    }

    /// The rope of `joint` was tensioned, and nobody zeroed its encoders: its offset is zero from now on by
    /// definition, wherever the encoders say that it is.
    pub fn tension(&self, belief: &mut Belief, joint: usize) {
        let anywhere = self.tolerances.zero_rad.max(UNKNOWN_OFFSET_RAD);
        if self.is_elastic(joint) {
            let offset = self.place(joint, JointParameter::Offset);
            belief.open(offset, about_zero(TENSIONED_OFFSET_RAD));
            belief.open(
                self.place(joint, JointParameter::Zero),
                about_zero(anywhere),
            );
        }
    }

    /// Offsets are taken against the encoders' zero, wherever that is.
    pub fn hold_zero(&self, belief: &mut Belief) {
        for i in (0..self.joints.len()).filter(|&i| self.is_elastic(i)) {
            belief.open(self.place(i, JointParameter::Zero), about_zero(FIXED));
        }
    }

    /// How late one side is stamped against the other is `0 ± deviation_s` on top of what is believed.
    ///
    /// A motor side stamped `T` late shows `theta(t − T) ≈ theta − T dtheta`: on every joint that is `−K T` of
    /// viscous friction. So an unknown `T` makes the joints' viscous frictions go together.
    pub fn open_lag(&self, belief: &mut Belief, deviation_s: f64) {
        let d = self.dimension();
        let slope = |i: usize| {
            let joint = self.joints.get(i).and_then(Option::as_ref);
            joint.map_or(0.0, |j| deviation_s * j.stiffness_nm_per_rad)
        };
        for i in 0..self.joints.len() {
            let row = self.place(i, JointParameter::Viscous) * d;
            for k in 0..self.joints.len() {
                let column = self.place(k, JointParameter::Viscous);
                if let Some(cell) = belief.covariance.get_mut(row + column) {
                    *cell += slope(i) * slope(k);
                }
            }
        }
    }

    /// Whatever the gripper held is forgotten.
    pub fn open_payload(&self, belief: &mut Belief, payload: Payload) {
        for (k, believed) in self.payload_belief(payload).into_iter().enumerate() {
            belief.open(self.payload_place() + k, believed);
        }
    }

    /// Offsets are forgotten: each `0 ± deviation_rad`; so are the slack of antagonistic pairs and
    /// where friction stood.
    pub fn open_offsets(&self, belief: &mut Belief, deviation_rad: f64) {
        for i in (0..self.joints.len()).filter(|&i| self.is_elastic(i)) {
            belief.open(
                self.place(i, JointParameter::Offset),
                about_zero(deviation_rad),
            );
            belief.open(self.place(i, JointParameter::Stuck), about_zero(STUCK));
            if self.is_antagonistic(i) {
                let slack = deviation_rad.min(UNKNOWN_SLACK_RAD);
                belief.open(self.place(i, JointParameter::Slack), about_zero(slack));
            }
        }
    }
}

/// What is as likely below zero as above.
fn about_zero(deviation: f64) -> Gaussian {
    Gaussian::new(0.0, deviation)
}
