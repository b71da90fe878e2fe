//! A block's equations, linearised: what is expected, and how it moves with the state.

use super::block::{Block, ENCODER};
use super::changes::{Change, What};
use super::layout::Layout;
use super::model::Model;
use super::payload::payload_torque;
use super::prior::{JointParameter as P, PAYLOAD, PER_JOINT};
use crate::cholesky::dot;
use alloc::vec::Vec;
use core::ops::Range;

/// Where an equation comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// `theta_measured − q`, rad.
    Link,
    /// Motor torque, N·m.
    Motor,
}

/// One equation of a block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Equation {
    pub(super) joint: usize,
    pub(super) side: Side,
    /// How what is expected moves with the joint's own parameters.
    pub(super) own: [f64; PER_JOINT],
    /// How it moves with the joint's torque: what masses and load do goes through that, so over them
    /// the row is this times [`Equations::carried`].
    pub(super) worth: f64,
    /// Measured less expected.
    pub(super) residual: f64,
    /// Standard deviation of what is unknown beside the noise: a standing drive's friction.
    pub(super) unsure: f64,
    /// Share of the time the drive stood.
    pub(super) stood: f64,
}

/// Equations of one block, reused from block to block.
#[derive(Debug, Clone)]
pub(super) struct Equations {
    layout: Layout,
    pub(super) list: Vec<Equation>,
    /// How the torque of every joint moves with bodies and load, `n × (r + 4)`.
    carried: Vec<f64>,
    /// Changes that have happened by the block's time, with their first column.
    active: Vec<(usize, What)>,
    /// What the gripper holds.
    held: [f64; PAYLOAD],
}

impl Equations {
    /// Room for the equations of a block while these changes are sought; allocates here only.
    pub(super) fn new(layout: Layout, changes: &[Change]) -> Self {
        let n = layout.joints;
        Self {
            layout,
            list: Vec::with_capacity(2 * n),
            carried: alloc::vec![0.0; n * layout.carried().len()],
            active: Vec::with_capacity(changes.len()),
            held: [0.0; PAYLOAD],
        }
    }

    /// Of the state.
    pub(super) fn layout(&self) -> Layout {
        self.layout
    }

    /// How the torque of a joint moves with bodies and load.
    pub(super) fn carried(&self, joint: usize) -> &[f64] {
        let m = self.layout.carried().len();
        let row = self.carried.get(joint * m..(joint + 1) * m);
        row.unwrap_or_default()
    }

    /// Entry `k` of what changes, in the row of `e`.
    pub(super) fn entry(&self, e: &Equation, what: What, k: usize) -> f64 {
        match what {
            What::Offset(joint) if joint == e.joint => e.own[P::Offset as usize],
            What::Compliance(joint) if joint == e.joint => e.own[P::Compliance as usize],
            What::Payload => e.worth * entry(self.carried(e.joint), self.layout.bodies + k),
            _ => 0.0,
        }
    }

    /// Columns of the changes that have happened, with their values in the row of `e`.
    pub(super) fn changes<'a>(
        &'a self,
        e: &'a Equation,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let columns = move |&(first, what): &(usize, What)| {
            (0..what.columns()).map(move |k| (first + k, self.entry(e, what, k)))
        };
        self.active.iter().flat_map(columns)
    }

    /// The row of `e` times a column.
    pub(super) fn dot(&self, e: &Equation, column: &[f64]) -> f64 {
        let part = |range: Range<usize>| column.get(range).unwrap_or_default();
        let own = dot(&e.own, part(self.layout.own(e.joint)));
        let carried = dot(self.carried(e.joint), part(self.layout.carried()));
        let changes = self.changes(e).map(|(i, value)| value * entry(column, i));
        own + e.worth * carried + changes.sum::<f64>()
    }

    /// Adds the row of `e`, times a factor, to a column.
    pub(super) fn add_to(&self, e: &Equation, factor: f64, column: &mut [f64]) {
        let mut add = |range: Range<usize>, values: &[f64], factor: f64| {
            let to = column.get_mut(range).unwrap_or_default();
            for (to, value) in to.iter_mut().zip(values) {
                *to += factor * value;
            }
        };
        add(self.layout.own(e.joint), &e.own, factor);
        add(
            self.layout.carried(),
            self.carried(e.joint),
            factor * e.worth,
        );
        for (i, value) in self.changes(e) {
            add(i..i + 1, &[value], factor);
        }
    }

    /// How the torque of joint `i` moves with bodies and load. Never allocates.
    pub(super) fn carry(&mut self, i: usize, phi: &[f64], load: &[f64; PAYLOAD]) {
        let m = self.layout.carried().len();
        let row = self.carried.get_mut(i * m..(i + 1) * m);
        let values = phi.iter().chain(load);
        for (to, value) in row.unwrap_or_default().iter_mut().zip(values) {
            *to = *value;
        }
    }

    /// An equation more. Never allocates.
    pub(super) fn push(&mut self, equation: Equation) {
        debug_assert!(self.list.len() < self.list.capacity(), "list is too short");
        if self.list.len() < self.list.capacity() {
            self.list.push(equation);
        }
    }

    /// The changes that have happened by now. Never allocates.
    pub(super) fn activate(&mut self, changes: &[Change], time_s: f64) {
        self.active.clear();
        let mut column = self.layout.dimension();
        for change in changes {
            if time_s >= change.at_s && self.active.len() < self.active.capacity() {
                self.active.push((column, change.what));
            }
            column += change.what.columns();
        }
    }

    /// Entry `k` of what changes, with all that was added to it.
    fn sum(&self, x: &[f64], what: What, k: usize) -> f64 {
        let own = self.active.iter().filter(|(_, w)| *w == what);
        let added = own.map(|(first, _)| entry(x, first + k));
        entry(x, what.place(self.layout) + k) + added.sum::<f64>()
    }
}

/// `values[place]`; NaN, which no estimate hides, where there is none.
fn entry(values: &[f64], place: usize) -> f64 {
    values.get(place).copied().unwrap_or(f64::NAN)
}

impl Model {
    /// Fills `out`, which has room for them, with the equations of `block` around the state `x` (`d`
    /// entries, then those of `changes`). `motor`: whether the motor's torque is used.
    pub(super) fn linearise(
        &self,
        block: &Block,
        reference_c: f64,
        changes: &[Change],
        motor: bool,
        x: &[f64],
        out: &mut Equations,
    ) {
        out.list.clear();
        out.activate(changes, block.time_s);
        out.held = core::array::from_fn(|k| out.sum(x, What::Payload, k));
        let warmer = if block.temperature_c.is_finite() && reference_c.is_finite() {
            block.temperature_c - reference_c
        } else {
            0.0
        };
        for i in 0..self.layout.joints {
            self.linearise_joint(i, block, warmer, motor, x, out);
        }
    }

    fn linearise_joint(
        &self,
        i: usize,
        block: &Block,
        warmer: f64,
        motor: bool,
        x: &[f64],
        out: &mut Equations,
    ) {
        let Some(Some(joint)) = self.joints.get(i) else {
            return;
        };
        let stiffness = joint.stiffness_nm_per_rad;
        let kappa = 1.0 / stiffness;
        let at = |p: P| entry(x, self.layout.place(i, p));
        let of = |column: &[f64]| entry(column, i);
        let encoder = block.encoder.get(i * ENCODER..(i + 1) * ENCODER);
        let encoder = encoder.and_then(|e| e.first_chunk::<ENCODER>());
        // Lengths have been checked: none of these is ever missing.
        let (Some(phi), Some(encoder)) = (self.phi(block, i), encoder) else {
            return;
        };
        let bodies = x.get(self.layout.carried()).unwrap_or_default();
        let mut tau = 0.0;
        for ((phi, pi), error) in phi.iter().zip(&self.inertial).zip(bodies) {
            tau += phi * (pi + error);
        }
        let (torque, load) = payload_torque(&self.payload_phi(phi), self.payload_at, out.held);
        tau += torque;
        out.carry(i, phi, &load);
        let z_load = of(&block.z_load) * stiffness;
        // A joint that has not slid since the recording began may be held either way.
        let stuck = (at(P::Coulomb) + at(P::LoadFriction) * stiffness * of(&block.y).abs())
            * of(&block.z_unknown);
        tau += at(P::Stuck) * stuck
            + at(P::Coulomb) * of(&block.z)
            + at(P::Viscous) * of(&block.dq)
            + at(P::LoadFriction) * z_load;

        // Link side.
        let compliance = out.sum(x, What::Compliance(i), 0);
        let soft = 1.0 + compliance + at(P::Thermal) * warmer;
        let linear = kappa * soft * tau;
        let cubic = at(P::Stiffening);
        let offset = out.sum(x, What::Offset(i), 0) + at(P::Zero);
        // The slow part of the deflection, and how far the joint has turned.
        let (slow, turned) = (of(&block.y_slow) - offset, of(&block.turned));
        // What `theta_measured − q` holds beside the spring's deflection.
        let mut beside =
            offset + at(P::Viscoelastic) * slow + at(P::Gear) * turned + at(P::Drift) * warmer;
        // A pair of slack ropes lets the joint through a dead zone, by the sign of the torque.
        const SMOOTH_RAD: f64 = 2e-3;
        let taut = if joint.antagonistic {
            libm::tanh(linear / SMOOTH_RAD)
        } else {
            0.0
        };
        beside += at(P::Slack) * taut;
        for (k, e) in encoder.iter().enumerate() {
            beside += entry(x, self.layout.place(i, P::Encoder) + k) * e;
        }
        // LP[x + η x³] = κ τ with x = theta_measured − q − beside: linear in stiffness, stiffening
        // and torque, however large the deflection.
        let (y, y2, y3) = (of(&block.y), of(&block.y_square), of(&block.y_cube));
        let square = y2 - beside * (2.0 * y - beside);
        let cube = y3 - beside * (3.0 * y2 - beside * (3.0 * y - beside));
        let expected = beside + linear - cubic * cube;
        // What a rad beside is worth, where the spring is stiffer.
        let worth = 1.0 + 3.0 * cubic * square;
        let per_torque = kappa * soft;
        let mut own = [0.0; PER_JOINT];
        own[P::Offset as usize] = worth;
        own[P::Zero as usize] = worth;
        own[P::Compliance as usize] = kappa * tau;
        own[P::Stiffening as usize] = -cube;
        own[P::Slack as usize] = worth * taut;
        own[P::Viscoelastic as usize] = worth * slow;
        own[P::Gear as usize] = worth * turned;
        own[P::Drift as usize] = worth * warmer;
        own[P::Thermal as usize] = kappa * tau * warmer;
        for (to, e) in own.iter_mut().skip(P::Encoder as usize).zip(encoder) {
            *to = worth * e;
        }
        let rubs = [
            (P::Coulomb, of(&block.z)),
            (P::Viscous, of(&block.dq)),
            (P::LoadFriction, z_load),
            (P::Stuck, stuck),
        ];
        for (p, value) in rubs {
            own[p as usize] = per_torque * value;
        }
        out.push(Equation {
            joint: i,
            side: Side::Link,
            own,
            worth: per_torque,
            residual: y - expected,
            unsure: 0.0,
            stood: 0.0,
        });

        // Motor side.
        let (Some(inertia), true) = (joint.motor_inertia_kg_m2, motor && per_torque > 0.0) else {
            return;
        };
        if !of(&block.motor_torque).is_finite() {
            return;
        }
        let scale = 1.0 + at(P::MotorScale);
        let z_load = of(&block.motor_z_load) * stiffness;
        let torque = tau
            + inertia * of(&block.motor_acceleration)
            + at(P::MotorCoulomb) * of(&block.motor_z)
            + at(P::MotorViscous) * of(&block.motor_velocity)
            + at(P::MotorLoadFriction) * z_load;
        let mut own = [0.0; PER_JOINT];
        own[P::MotorScale as usize] = torque;
        own[P::MotorBias as usize] = 1.0;
        own[P::MotorCoulomb as usize] = scale * of(&block.motor_z);
        own[P::MotorViscous as usize] = scale * of(&block.motor_velocity);
        own[P::MotorLoadFriction as usize] = scale * z_load;
        for (p, value) in rubs {
            own[p as usize] = scale * value;
        }
        let grip = at(P::MotorCoulomb).abs().max(joint.motor_coulomb_nm)
            + at(P::MotorLoadFriction).abs() * stiffness * of(&block.y).abs();
        out.push(Equation {
            joint: i,
            side: Side::Motor,
            own,
            worth: scale,
            residual: of(&block.motor_torque) - scale * torque - at(P::MotorBias),
            unsure: grip * of(&block.motor_stood),
            stood: of(&block.motor_stood),
        });
    }
}

impl What {
    /// Entries of the state it changes.
    pub(super) fn columns(self) -> usize {
        match self {
            Self::Offset(_) | Self::Compliance(_) => 1,
            Self::Payload => PAYLOAD,
        }
    }

    /// First entry of the state it changes.
    pub(super) fn place(self, layout: Layout) -> usize {
        match self {
            Self::Offset(joint) => layout.place(joint, P::Offset),
            Self::Compliance(joint) => layout.place(joint, P::Compliance),
            Self::Payload => layout.payload_place(),
        }
    }
}
