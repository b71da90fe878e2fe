//! The unknown parameters of a robot, with their prior before any recording.

use super::belief::{Belief, Payload, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD};
use super::block::Block;
use super::effects::bodies::Bodies;
use super::effects::payload::{HeldPayload, point_mass};
use super::effects::{
    FIXED, JOINT_PARAMETERS, JointParameter, Lifetime, PAYLOAD, Parameter, PriorInputs, about_zero,
};
use super::joint_prior::JointPrior;
use super::layout::Layout;
use super::state_entry::{self, StateEntry};
use crate::Gaussian;
use crate::arm::{Arm, BaseParameters, PARAMETERS_PER_BODY};
use crate::routings::Routings;
use crate::tolerances::Tolerances;
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// What the gripper may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PayloadRange {
    /// Least and largest mass, kg.
    pub mass_kg: [f64; 2],
    /// Largest moment about where it is expected, along every axis of the body that carries it, kg·m.
    pub moment_kg_m: f64,
}

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
    /// Routings of tendons that cross several joints.
    pub(crate) routes: Option<Routings>,
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
            routes: Routings::of(transmissions),
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
            arms: self
                .routes
                .as_ref()
                .map_or(0, |routes| routes.crossings().len()),
            is_coupled: self.routes.is_some(),
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

    /// The parameter that entry `k` of the state is.
    pub fn parameter(&self, k: usize) -> Option<&'static Parameter> {
        state_entry::parameter(self.layout(), k).map(|(_, parameter)| parameter)
    }

    /// What entry `k` of the state is.
    pub fn describe(&self, k: usize) -> Option<StateEntry> {
        let entry = StateEntry::of(self.layout(), k)?;
        let arm = k.checked_sub(self.layout().arm_start());
        let crossings = self.routes.as_ref().map_or(&[][..], Routings::crossings);
        Some(match arm.and_then(|arm| crossings.get(arm)) {
            Some((tendon, _)) => StateEntry {
                joint: Some(*tendon),
                ..entry
            },
            None => entry,
        })
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
            let Some(joint) = joint else { continue };
            let inputs = self.inputs(joint, offset_deviation_rad);
            for (k, parameter) in self.layout().own(i).zip(&JOINT_PARAMETERS) {
                if let Some(believed) = parameter.prior_of(&inputs) {
                    (mean[k], deviation[k]) = (believed.mean, believed.deviation);
                }
            }
        }
        for k in self.layout().arm_start()..self.body_start() {
            deviation[k] = self.tolerances.moment_arm.max(FIXED);
        }
        for b in 0..self.joints.len() {
            let at = self.body_start() + b * PARAMETERS_PER_BODY;
            let pi = self.inertial.get(b * PARAMETERS_PER_BODY..);
            if let Some(pi) = pi.and_then(|pi| pi.first_chunk()) {
                let of_body = Bodies::deviations(&self.tolerances, pi);
                deviation[at..at + PARAMETERS_PER_BODY].copy_from_slice(&of_body);
            }
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

    fn inputs<'a>(&'a self, joint: &'a JointPrior, offset_rad: f64) -> PriorInputs<'a> {
        PriorInputs {
            joint,
            tolerances: &self.tolerances,
            offset_rad,
        }
    }

    /// The payload's mass and moments before a recording.
    pub(crate) fn payload_belief(&self, payload: Payload) -> [Gaussian; PAYLOAD] {
        HeldPayload::prior(&self.tolerances, payload)
    }

    /// The encoders' zero is forgotten, as when the ropes are tensioned anew.
    pub fn open_zero(&self, belief: &mut Belief) {
        self.open_until(belief, Lifetime::Tensioning, f64::NAN);
    }

    /// Parameters of such a lifetime are forgotten.
    fn open_until(&self, belief: &mut Belief, lifetime: Lifetime, offset_rad: f64) {
        for (i, joint) in self.joints.iter().enumerate() {
            let Some(joint) = joint else { continue };
            let inputs = self.inputs(joint, offset_rad);
            let of_joint = self.layout().own(i).zip(&JOINT_PARAMETERS);
            for (k, parameter) in of_joint.filter(|(_, p)| p.lifetime == lifetime) {
                if let Some(believed) = parameter.prior_of(&inputs) {
                    belief.open(k, believed);
                }
            }
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
        self.open_until(belief, Lifetime::Recording, deviation_rad);
    }
}
