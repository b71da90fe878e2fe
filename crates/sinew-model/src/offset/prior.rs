//! The unknown parameters of a robot, with their prior before any recording.

use super::block::Block;
use super::effects::bodies::Bodies;
use super::effects::payload::{HeldPayload, point_mass};
use super::effects::{
    FIXED, JOINT_PARAMETERS, JointParameter, Lifetime, PAYLOAD, Parameter, PriorInputs, about_zero,
};
use super::joint_prior::JointPrior;
use super::layout::Layout;
use super::state_entry::{self, StateEntry};
use super::state_estimate::{Payload, StateEstimate, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD};
use crate::Gaussian;
use crate::arm::{Arm, BaseParameters, PARAMETERS_PER_BODY};
use crate::routings::Routings;
use crate::tolerances::Tolerances;
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// Range of the payload in the gripper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PayloadRange {
    /// Minimum and maximum mass, kg.
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
    /// Combinations of `inertial` that determine the motion.
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
        let routes = Routings::of(transmissions);
        Self {
            joints: transmissions
                .iter()
                .enumerate()
                .map(|(i, t)| {
                    let pulled = routes.as_ref().and_then(|routes| routes.pulled(i));
                    let pull = routes.as_ref().and_then(|routes| routes.pull(i));
                    let Some(t) = t else {
                        return pulled.map(JointPrior::of_joint);
                    };
                    Some(JointPrior {
                        stiffness_nm_per_rad: t.stiffness_nm_per_rad,
                        motor_inertia_kg_m2: t.motor_inertia_kg_m2,
                        coulomb_nm: t.joint_friction.coulomb_nm,
                        viscous_nm_s_per_rad: t.joint_friction.viscous_nm_s_per_rad,
                        motor_coulomb_nm: t.motor_friction.coulomb_nm,
                        motor_viscous_nm_s_per_rad: t.motor_friction.viscous_nm_s_per_rad,
                        antagonistic: t.tendon.as_ref().is_some_and(|t| t.antagonistic),
                        drift_rad_per_k: t.temperature_effect.map(|w| w.drift_rad_per_k),
                        has_joint: i < arm.dof() && (pull.is_none() || pulled.is_some()),
                        has_tendon: true,
                        pretension_nm: pull.map_or(0.0, |pull| pull.pretension_nm),
                    })
                })
                .collect(),
            inertial: arm.inertial_parameters(),
            payload_body: payload_body.min(arm.dof().saturating_sub(1)),
            payload_at,
            base: arm.base_parameters(),
            routes,
            tolerances,
        }
    }

    /// Axes: joints of the arm, and tendons beyond these.
    pub fn joints(&self) -> usize {
        self.joints.len()
    }

    /// Whether two ropes of joint `i` pull against each other.
    pub fn is_antagonistic(&self, i: usize) -> bool {
        let joint = self.joints.get(i).and_then(Option::as_ref);
        joint.is_some_and(|j| j.antagonistic)
    }

    /// Whether axis `i` has a tendon.
    pub fn is_elastic(&self, i: usize) -> bool {
        let joint = self.joints.get(i).and_then(Option::as_ref);
        joint.is_some_and(|joint| joint.has_tendon)
    }

    /// Routings of tendons that cross several joints; `None` where every joint has a tendon of its own.
    pub fn routings(&self) -> Option<&Routings> {
        self.routes.as_ref()
    }

    /// Length of the state.
    pub fn dimension(&self) -> usize {
        self.layout().dimension()
    }

    /// Returns the index of a joint's parameter in the state.
    pub fn place(&self, joint: usize, parameter: JointParameter) -> usize {
        self.layout().place(joint, parameter)
    }

    /// Returns the layout of the state in posteriors and estimates: every body with all its parameters.
    pub(crate) fn layout(&self) -> Layout {
        let of_routes = |count: &dyn Fn(&Routings) -> usize| self.routes.as_ref().map_or(0, count);
        Layout {
            joints: self.joints.len(),
            bodies: self.inertial.len(),
            arms: of_routes(&|routes| routes.crossings().len()),
            springs: of_routes(&|routes| routes.sprung().len()),
            sensors: of_routes(&|routes| {
                if routes.has_pulls() {
                    self.joints.len()
                } else {
                    0
                }
            }),
            is_coupled: self.routes.is_some(),
        }
    }

    /// Returns the standard deviation of the point of action of a payload or a force, m.
    pub(crate) fn reach_m(&self) -> f64 {
        self.tolerances.payload_reach_m
    }

    pub(crate) fn body_start(&self) -> usize {
        self.layout().body_start()
    }

    /// Returns the index of the payload mass in the state.
    pub fn payload_place(&self) -> usize {
        self.layout().payload_place()
    }

    /// The parameter that entry `k` of the state is.
    pub fn parameter(&self, k: usize) -> Option<&'static Parameter> {
        state_entry::parameter(self.layout(), k).map(|(_, parameter)| parameter)
    }

    /// Describes entry `k` of the state.
    pub fn describe(&self, k: usize) -> Option<StateEntry> {
        let layout = self.layout();
        let entry = StateEntry::of(layout, k)?;
        let routes = self.routes.as_ref();
        let crossing = |k: usize| Some(routes?.crossings().get(k)?.0);
        let sprung = |k: usize| routes?.sprung().get(k / 2).copied();
        let axis = if k >= layout.body_start() {
            entry.joint
        } else if let Some(k) = k.checked_sub(layout.sensor_start()) {
            Some(k / 2)
        } else if let Some(k) = k.checked_sub(layout.spring_start()) {
            sprung(k)
        } else if let Some(k) = k.checked_sub(layout.arm_start()) {
            crossing(k)
        } else {
            entry.joint
        };
        Some(StateEntry {
            joint: axis,
            ..entry
        })
    }

    /// Returns the deflection of elastic joint `i`'s spring that motion and gravity require, without friction and
    /// contact, one row per block, rad: `Φ_i z / K` with the described masses and stiffness and an empty gripper, then
    /// its change by a payload of 1 kg at the expected point, and by a first moment of 1 kg·m about that point along
    /// each axis of the body. Empty for a rigid joint, for a tendon, and for a joint of a group with one equation per
    /// joint. Allocates.
    pub fn described_deflections_rad(&self, blocks: &[Block], i: usize) -> Vec<[f64; 1 + PAYLOAD]> {
        let has_own = |routes: &Routings| routes.pull(i).is_none() && routes.pulled(i).is_none();
        let joint = self.joints.get(i).and_then(Option::as_ref);
        let Some(joint) = joint.filter(|_| self.routes.as_ref().is_none_or(has_own)) else {
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

    /// Returns the inertial parameters of all bodies, which are zero except for the payload.
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

    /// Returns the range of the payload: the prior mean, two standard deviations in mass and five in position, as of a
    /// tool held at its end. `None` for no payload.
    pub fn payload_range(&self, payload: Payload) -> Option<PayloadRange> {
        const MASS_SIGMA: f64 = 2.0;
        const POSITION_SIGMA: f64 = 5.0;
        let [mass, ..] = self.payload_prior(payload);
        let off_kg = MASS_SIGMA * mass.std;
        let least_kg = match payload {
            Payload::Empty => return None,
            Payload::Unknown => 0.0,
            Payload::Specified { .. } => (mass.mean - off_kg).max(0.0),
        };
        let most_kg = (mass.mean + off_kg).max(least_kg);
        Some(PayloadRange {
            mass_kg: [least_kg, most_kg],
            moment_kg_m: most_kg * POSITION_SIGMA * self.tolerances.payload_reach_m,
        })
    }

    /// Returns the prior before any recording; every offset is `0 ± offset_std_rad`.
    pub fn state_estimate(&self, payload: Payload, offset_std_rad: f64) -> StateEstimate {
        let d = self.dimension();
        let (mut mean, mut std) = (alloc::vec![0.0; d], alloc::vec![FIXED; d]);
        for (i, joint) in self.joints.iter().enumerate() {
            let Some(joint) = joint else { continue };
            let inputs = self.inputs(joint, offset_std_rad);
            for (k, parameter) in self.layout().own(i).zip(&JOINT_PARAMETERS) {
                if let Some(believed) = parameter.prior_of(&inputs) {
                    (mean[k], std[k]) = (believed.mean, believed.std);
                }
            }
        }
        let layout = self.layout();
        for k in layout.arm_start()..layout.spring_start() {
            std[k] = self.tolerances.moment_arm.max(FIXED);
        }
        for k in (layout.spring_start()..layout.sensor_start()).step_by(2) {
            std[k] = self.tolerances.spring.max(FIXED);
            std[k + 1] = self.tolerances.spring_rest_rad.max(FIXED);
        }
        for (i, k) in (layout.sensor_start()..layout.body_start())
            .step_by(2)
            .enumerate()
        {
            let joint = self.joints.get(i).and_then(Option::as_ref);
            let nm = joint.map_or(0.0, JointPrior::usual_torque_nm);
            std[k] = self.tolerances.tension_sensor.max(FIXED);
            std[k + 1] = (self.tolerances.tension_sensor * nm).max(FIXED);
        }
        for b in 0..self.inertial.len() / PARAMETERS_PER_BODY {
            let at = self.body_start() + b * PARAMETERS_PER_BODY;
            let pi = self.inertial.get(b * PARAMETERS_PER_BODY..);
            if let Some(pi) = pi.and_then(|pi| pi.first_chunk()) {
                let of_body = Bodies::stds(&self.tolerances, pi);
                std[at..at + PARAMETERS_PER_BODY].copy_from_slice(&of_body);
            }
        }
        let mut covariance = alloc::vec![0.0; d * d];
        for (k, s) in std.iter().enumerate() {
            covariance[k * d + k] = s * s;
        }
        let mut state_estimate = StateEstimate {
            mean,
            covariance,
            temperature_c: f64::NAN,
        };
        self.reset_payload(&mut state_estimate, payload);
        state_estimate
    }

    fn inputs<'a>(&'a self, joint: &'a JointPrior, offset_rad: f64) -> PriorInputs<'a> {
        PriorInputs {
            joint,
            tolerances: &self.tolerances,
            offset_rad,
        }
    }

    /// The payload's mass and moments before a recording.
    pub(crate) fn payload_prior(&self, payload: Payload) -> [Gaussian; PAYLOAD] {
        HeldPayload::prior(&self.tolerances, payload)
    }

    /// Resets the variance of the encoder zero offsets, as after re-tensioning of the ropes.
    pub fn reset_zero(&self, state_estimate: &mut StateEstimate) {
        self.reset_until(state_estimate, Lifetime::Tensioning, f64::NAN);
    }

    /// Parameters of such a lifetime are forgotten.
    fn reset_until(&self, state_estimate: &mut StateEstimate, lifetime: Lifetime, offset_rad: f64) {
        for (i, joint) in self.joints.iter().enumerate() {
            let Some(joint) = joint else { continue };
            let inputs = self.inputs(joint, offset_rad);
            let of_joint = self.layout().own(i).zip(&JOINT_PARAMETERS);
            for (k, parameter) in of_joint.filter(|(_, p)| p.lifetime == lifetime) {
                if let Some(believed) = parameter.prior_of(&inputs) {
                    state_estimate.reset(k, believed);
                }
            }
        }
    }

    /// Accounts for the tensioning of the rope of `joint` without zeroing its encoders: its offset is zero from now on
    /// by definition, for any encoder values.
    pub fn tension(&self, state_estimate: &mut StateEstimate, joint: usize) {
        let anywhere = self.tolerances.zero_rad.max(UNKNOWN_OFFSET_RAD);
        if self.is_elastic(joint) {
            let offset = self.place(joint, JointParameter::Offset);
            state_estimate.reset(offset, about_zero(TENSIONED_OFFSET_RAD));
            state_estimate.reset(
                self.place(joint, JointParameter::Zero),
                about_zero(anywhere),
            );
        }
    }

    /// Offsets are taken against the encoders' zero, wherever that is.
    pub fn hold_zero(&self, state_estimate: &mut StateEstimate) {
        for i in (0..self.joints.len()).filter(|&i| self.is_elastic(i)) {
            state_estimate.reset(self.place(i, JointParameter::Zero), about_zero(FIXED));
        }
    }

    /// Adds a delay of one side relative to the other of `0 ± std_s` to the posterior.
    ///
    /// A motor encoder delayed by `T` measures `theta(t − T) ≈ theta − T dtheta`: at every joint this is a viscous
    /// friction of `−K T`. An unknown `T` therefore correlates the viscous frictions of the joints.
    pub fn open_lag(&self, state_estimate: &mut StateEstimate, std_s: f64) {
        let d = self.dimension();
        let slope = |i: usize| {
            let joint = self.joints.get(i).and_then(Option::as_ref);
            joint.map_or(0.0, |j| std_s * j.stiffness_nm_per_rad)
        };
        for i in 0..self.joints.len() {
            let row = self.place(i, JointParameter::Viscous) * d;
            for k in 0..self.joints.len() {
                let column = self.place(k, JointParameter::Viscous);
                if let Some(cell) = state_estimate.covariance.get_mut(row + column) {
                    *cell += slope(i) * slope(k);
                }
            }
        }
    }

    /// Resets the payload to its prior.
    pub fn reset_payload(&self, state_estimate: &mut StateEstimate, payload: Payload) {
        for (k, believed) in self.payload_prior(payload).into_iter().enumerate() {
            state_estimate.reset(self.payload_place() + k, believed);
        }
    }

    /// Resets the offsets to `0 ± std_rad`, and the slack of antagonistic pairs and the initial friction to their
    /// priors.
    pub fn reset_offsets(&self, state_estimate: &mut StateEstimate, std_rad: f64) {
        self.reset_until(state_estimate, Lifetime::Recording, std_rad);
    }
}
