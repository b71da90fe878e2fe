//! What is unknown about a robot, with what is believed of it before a recording.

use super::block::ENCODER;
use super::layout::Layout;
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
    pub(super) fn drive_coulomb_nm(&self) -> f64 {
        self.drive_friction(0.0).0.coulomb_nm
    }
}

/// What a joint's parameters are, in their order in the state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum JointParameter {
    /// Offset `delta_e`, rad.
    Offset,
    /// Compliance over nominal, less one.
    Compliance,
    /// Cubic stiffening `η`, 1/rad².
    Stiffening,
    /// Coulomb friction of the joint, N·m.
    Coulomb,
    /// Viscous friction of the joint, N·m·s/rad.
    Viscous,
    /// Torque-proportional friction of the joint.
    LoadFriction,
    /// Drift of the zero with temperature, rad/K.
    Drift,
    /// Compliance change with temperature, 1/K.
    Thermal,
    /// First of the encoder's sine and cosine once and twice per turn, rad.
    Encoder,
    /// Scale error of the motor torque.
    MotorScale = Self::Encoder as usize + ENCODER,
    /// Offset of the motor torque, N·m.
    MotorBias,
    /// Coulomb friction of the drive, N·m.
    MotorCoulomb,
    /// Viscous friction of the drive, N·m·s/rad.
    MotorViscous,
    /// Torque-proportional friction of the drive.
    MotorLoadFriction,
    /// Half the dead zone of a slack antagonistic pair, rad.
    Slack,
    /// Where in −1…1 the friction of a joint stood when the recording began.
    Stuck,
    /// Share of the deflection that follows with a memory of half a minute.
    Viscoelastic,
    /// Error of the gear ratio, relative.
    Gear,
    /// What `theta_measured − q` shows of an unloaded spring right after tensioning, rad: where the
    /// encoders were zeroed.
    Zero,
}

/// Entries per joint.
pub(super) const PER_JOINT: usize = JointParameter::Zero as usize + 1;
/// Payload: mass, and three first moments beside where it is expected.
pub(super) const PAYLOAD: usize = 4;

/// What an offset may be before anything is known, rad.
pub const UNKNOWN_OFFSET_RAD: f64 = 0.03;
/// Offsets right after tensioning are zero by definition, up to this, rad.
pub const TENSIONED_OFFSET_RAD: f64 = 1e-5;
/// What half a dead zone may be before anything is known, rad.
const UNKNOWN_SLACK_RAD: f64 = 0.01;
/// Standard deviation of where in −1…1 friction stands. A joint at rest came there by sliding, or
/// was pushed there by its rope: an end is more likely than the middle (evenly spread: 0.58).
const STUCK: f64 = 0.85;
/// Standard deviation of what is held fixed, in its own unit.
const FIXED: f64 = 1e-9;

/// Mean and covariance of the state, and what the offsets refer to.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief {
    /// Means, `d`.
    pub mean: Vec<f64>,
    /// Covariance, row-major `d × d`.
    pub covariance: Vec<f64>,
    /// Temperature the offsets refer to, °C; NaN where unknown.
    pub temperature_c: f64,
}

impl Belief {
    /// Mean and standard deviation of entry `k`; NaN where there is none.
    pub fn entry(&self, k: usize) -> [f64; 2] {
        let d = self.mean.len();
        let at = |x: &[f64], k: usize| x.get(k).copied().unwrap_or(f64::NAN);
        [
            at(&self.mean, k),
            libm::sqrt(at(&self.covariance, k * d + k)),
        ]
    }

    /// Forgets entry `k`: believed to be `mean ± deviation`, unrelated to the rest.
    pub fn open(&mut self, k: usize, mean: f64, deviation: f64) {
        let d = self.mean.len();
        if k >= d || self.covariance.len() != d * d {
            return;
        }
        self.mean[k] = mean;
        for m in 0..d {
            self.covariance[k * d + m] = 0.0;
            self.covariance[m * d + k] = 0.0;
        }
        self.covariance[k * d + k] = deviation * deviation;
    }
}

/// What may be in the gripper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Payload {
    /// Nothing.
    Empty,
    /// Something unknown, as the tolerances say.
    Unknown,
    /// A mass known to a standard deviation, kg, near where it is expected.
    Known {
        /// Mass, kg.
        mass_kg: f64,
        /// Its standard deviation, kg.
        deviation_kg: f64,
    },
}

/// One entry of the state in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Joint or body it belongs to; `None` for the payload.
    pub joint: Option<usize>,
    /// What it is.
    pub name: &'static str,
    /// Its unit; empty for a ratio.
    pub unit: &'static str,
}

/// The model whose parameters are estimated, with its priors.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    pub(super) joints: Vec<Option<JointPrior>>,
    /// Nominal inertial parameters, `10 n`.
    pub(super) inertial: Vec<f64>,
    /// Body the payload hangs on, and where in its frame it is expected, m.
    pub(super) payload_body: usize,
    pub(super) payload_at: [f64; 3],
    /// What of `inertial` motion depends on.
    pub(super) base: BaseParameters,
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
    pub(super) fn layout(&self) -> Layout {
        Layout {
            joints: self.joints.len(),
            bodies: self.joints.len() * PARAMETERS_PER_BODY,
        }
    }

    pub(super) fn body_start(&self) -> usize {
        self.layout().body_start()
    }

    /// Place of the payload's mass in the state.
    pub fn payload_place(&self) -> usize {
        self.layout().payload_place()
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
        let mut set = |p: P, m: f64, s: f64| {
            mean[p as usize] = m;
            deviation[p as usize] = s.max(FIXED);
        };
        set(P::Compliance, 0.0, t.stiffness);
        set(
            P::Stiffening,
            t.stiffening_per_rad2[0],
            t.stiffening_per_rad2[1],
        );
        let (own, off) = joint.friction(t.friction);
        set(P::Coulomb, own.coulomb_nm, off * own.coulomb_nm);
        let viscous = own.viscous_nm_s_per_rad;
        set(P::Viscous, viscous, off * viscous);
        set(P::LoadFriction, t.load_friction[0], t.load_friction[1]);
        set(P::Drift, 0.0, t.drift_rad_per_k);
        set(P::Thermal, t.stiffness_per_k[0], t.stiffness_per_k[1]);
        set(P::Stuck, 0.0, STUCK);
        set(P::Viscoelastic, 0.0, t.viscoelastic);
        set(P::Gear, 0.0, t.gear);
        set(P::Zero, 0.0, t.zero_rad);
        set(P::MotorScale, 0.0, t.motor_torque);
        let (friction, off) = joint.drive_friction(t.friction);
        let drive = friction.coulomb_nm;
        set(
            P::MotorBias,
            0.0,
            // A torque's zero is good to a small part of what the drive's friction is.
            (0.1 * drive).max(t.motor_torque * 0.02 * joint.stiffness_nm_per_rad),
        );
        set(P::MotorCoulomb, drive, off * drive);
        let viscous = friction.viscous_nm_s_per_rad;
        set(P::MotorViscous, viscous, off * viscous.max(0.1 * drive));
        set(
            P::MotorLoadFriction,
            t.drive_load_friction[0],
            t.drive_load_friction[1],
        );
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

    /// The payload's mass and moments before a recording: `(mean, deviation)` of each.
    pub(super) fn payload_belief(&self, payload: Payload) -> [(f64, f64); PAYLOAD] {
        let [mean, deviation] = match payload {
            Payload::Empty => return [(0.0, FIXED); PAYLOAD],
            Payload::Unknown => self.tolerances.payload_kg,
            Payload::Known {
                mass_kg,
                deviation_kg,
            } => [mass_kg, deviation_kg.max(FIXED)],
        };
        let moment = mean.abs().max(deviation) * self.tolerances.payload_reach_m;
        [
            (mean, deviation),
            (0.0, moment),
            (0.0, moment),
            (0.0, moment),
        ]
    }

    /// The encoders' zero is forgotten, as when the ropes are tensioned anew.
    pub fn open_zero(&self, belief: &mut Belief) {
        let deviation = self.tolerances.zero_rad.max(FIXED);
        for i in (0..self.joints.len()).filter(|&i| self.is_elastic(i)) {
            belief.open(self.place(i, JointParameter::Zero), 0.0, deviation);
        }
    }

    /// Offsets are taken against the encoders' zero, wherever that is.
    pub fn hold_zero(&self, belief: &mut Belief) {
        for i in (0..self.joints.len()).filter(|&i| self.is_elastic(i)) {
            belief.open(self.place(i, JointParameter::Zero), 0.0, FIXED);
        }
    }

    /// Whatever the gripper held is forgotten.
    pub fn open_payload(&self, belief: &mut Belief, payload: Payload) {
        for (k, (mean, deviation)) in self.payload_belief(payload).into_iter().enumerate() {
            belief.open(self.payload_place() + k, mean, deviation);
        }
    }

    /// Offsets are forgotten: each `0 ± deviation_rad`; so are the slack of antagonistic pairs and
    /// where friction stood.
    pub fn open_offsets(&self, belief: &mut Belief, deviation_rad: f64) {
        for i in (0..self.joints.len()).filter(|&i| self.is_elastic(i)) {
            belief.open(self.place(i, JointParameter::Offset), 0.0, deviation_rad);
            belief.open(self.place(i, JointParameter::Stuck), 0.0, STUCK);
            if self.is_antagonistic(i) {
                let slack = deviation_rad.min(UNKNOWN_SLACK_RAD);
                belief.open(self.place(i, JointParameter::Slack), 0.0, slack);
            }
        }
    }
}
