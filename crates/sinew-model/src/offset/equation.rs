//! A block's equations, linearised: what is expected, and how it moves with the state.

use super::block::{Block, ENCODER};
use super::changes::{Change, What};
use super::payload::payload_torque;
use super::prior::{JointParameter as P, PAYLOAD, PER_JOINT, Prior};
use crate::arm::PARAMETERS_PER_BODY;
use alloc::vec::Vec;

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
    /// Its row is `rows[from..to]`.
    pub(super) from: usize,
    pub(super) to: usize,
    /// Measured less expected.
    pub(super) residual: f64,
    /// Standard deviation of what is unknown beside the noise: a standing drive's friction.
    pub(super) unsure: f64,
    /// Share of the time the drive stood.
    pub(super) stood: f64,
    /// How what is expected moves with the joint's torque. What masses and load do goes through
    /// that torque: link and motor row are the same there, but for this factor.
    pub(super) worth: f64,
}

/// Equations of one block, reused from block to block.
#[derive(Debug, Clone)]
pub(super) struct Equations {
    pub(super) rows: Vec<(usize, f64)>,
    pub(super) list: Vec<Equation>,
}

impl Equations {
    /// Room for the equations of a block while these changes are sought; allocates here only.
    pub(super) fn new(prior: &Prior, changes: &[Change]) -> Self {
        let n = prior.joints();
        let more: usize = changes.iter().map(|c| c.what.columns()).sum();
        let row = PER_JOINT + n * PARAMETERS_PER_BODY + PAYLOAD + more;
        Self {
            rows: Vec::with_capacity(2 * n * row),
            list: Vec::with_capacity(2 * n),
        }
    }

    /// Row of an equation: places in the state and their values.
    pub(super) fn row(&self, e: &Equation) -> &[(usize, f64)] {
        self.rows.get(e.from..e.to).unwrap_or_default()
    }

    /// The next entry of the row at work. Never allocates.
    fn push(&mut self, place: usize, value: f64) {
        debug_assert!(self.rows.len() < self.rows.capacity(), "rows are too short");
        if self.rows.len() < self.rows.capacity() {
            self.rows.push((place, value));
        }
    }

    /// The row at work is whole. Never allocates.
    fn close(&mut self, equation: Equation) {
        debug_assert!(self.list.len() < self.list.capacity(), "list is too short");
        if self.list.len() < self.list.capacity() {
            self.list.push(equation);
        }
    }
}

/// `values[place]`; NaN, which no estimate hides, where there is none.
fn entry(values: &[f64], place: usize) -> f64 {
    values.get(place).copied().unwrap_or(f64::NAN)
}

impl Prior {
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
        out.rows.clear();
        out.list.clear();
        let warmer = if block.temperature_c.is_finite() && reference_c.is_finite() {
            block.temperature_c - reference_c
        } else {
            0.0
        };
        let active = Active::new(self, changes, block.time_s);
        for i in 0..self.joints() {
            if self.is_elastic(i) {
                self.linearise_joint(i, block, warmer, &active, motor, x, out);
            }
        }
    }

    #[expect(clippy::too_many_arguments, reason = "one pass over a joint's data")]
    fn linearise_joint(
        &self,
        i: usize,
        block: &Block,
        warmer: f64,
        active: &Active<'_>,
        motor: bool,
        x: &[f64],
        out: &mut Equations,
    ) {
        let Some(Some(joint)) = self.joints.get(i) else {
            return;
        };
        let stiffness = joint.stiffness_nm_per_rad;
        let kappa = 1.0 / stiffness;
        let n = self.joints();
        let columns = n * PARAMETERS_PER_BODY;
        let at = |p: P| entry(x, self.place(i, p));
        let of = |column: &[f64]| entry(column, i);
        let phi = block.phi.get(i * columns..(i + 1) * columns);
        let encoder = block.encoder.get(i * ENCODER..(i + 1) * ENCODER);
        // Lengths have been checked: none of these is ever missing.
        let (Some(phi), Some(encoder)) = (phi, encoder) else {
            return;
        };
        let held = phi.get(self.payload_body * PARAMETERS_PER_BODY..);
        let Some(load) = held.and_then(|phi| phi.first_chunk()) else {
            return;
        };
        let bodies = self.body_start();
        let mut tau = 0.0;
        for ((phi, pi), error) in phi
            .iter()
            .zip(&self.inertial)
            .zip(x.get(bodies..).unwrap_or_default())
        {
            tau += phi * (pi + error);
        }
        let held = core::array::from_fn(|k| active.sum(x, self.payload_place() + k));
        let (torque, load) = payload_torque(load, self.payload_at, held);
        tau += torque;
        let z_load = of(&block.z_load) * stiffness;
        // A joint that has not slid since the recording began may be held either way.
        let stuck = (at(P::Coulomb) + at(P::LoadFriction) * stiffness * of(&block.y).abs())
            * of(&block.z_unknown);
        tau += at(P::Stuck) * stuck
            + at(P::Coulomb) * of(&block.z)
            + at(P::Viscous) * of(&block.dq)
            + at(P::LoadFriction) * z_load;

        // Link side.
        let compliance = active.sum(x, self.place(i, P::Compliance));
        let soft = 1.0 + compliance + at(P::Thermal) * warmer;
        let linear = kappa * soft * tau;
        let cubic = at(P::Stiffening);
        let offset = active.sum(x, self.place(i, P::Offset)) + at(P::Zero);
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
            beside += entry(x, self.place(i, P::Encoder) + k) * e;
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
        let from = out.rows.len();
        active.push(out, self.place(i, P::Offset), worth);
        out.push(self.place(i, P::Zero), worth);
        active.push(out, self.place(i, P::Compliance), kappa * tau);
        out.push(self.place(i, P::Stiffening), -cube);
        if joint.antagonistic {
            out.push(self.place(i, P::Slack), worth * taut);
        }
        out.push(self.place(i, P::Viscoelastic), worth * slow);
        out.push(self.place(i, P::Gear), worth * turned);
        if warmer != 0.0 {
            out.push(self.place(i, P::Drift), worth * warmer);
            out.push(self.place(i, P::Thermal), kappa * tau * warmer);
        }
        for (k, e) in encoder.iter().enumerate() {
            out.push(self.place(i, P::Encoder) + k, worth * e);
        }
        let torque_from = out.rows.len();
        out.push(self.place(i, P::Coulomb), per_torque * of(&block.z));
        out.push(self.place(i, P::Viscous), per_torque * of(&block.dq));
        out.push(self.place(i, P::LoadFriction), per_torque * z_load);
        if stuck != 0.0 {
            out.push(self.place(i, P::Stuck), per_torque * stuck);
        }
        for (k, phi) in phi.iter().enumerate() {
            if *phi != 0.0 {
                out.push(bodies + k, per_torque * phi);
            }
        }
        for (k, c) in load.iter().enumerate() {
            active.push(out, self.payload_place() + k, per_torque * c);
        }
        let to = out.rows.len();
        out.close(Equation {
            joint: i,
            side: Side::Link,
            from,
            to,
            residual: y - expected,
            unsure: 0.0,
            stood: 0.0,
            worth: per_torque,
        });

        // Motor side.
        let (Some(inertia), true) = (joint.motor_inertia_kg_m2, motor && per_torque > 0.0) else {
            return;
        };
        if !of(&block.motor_torque).is_finite() {
            return;
        }
        let from = out.rows.len();
        let scale = 1.0 + at(P::MotorScale);
        for r in torque_from..to {
            if let Some(&(place, value)) = out.rows.get(r) {
                out.push(place, scale * value / per_torque);
            }
        }
        let z_load = of(&block.motor_z_load) * stiffness;
        let torque = tau
            + inertia * of(&block.motor_acceleration)
            + at(P::MotorCoulomb) * of(&block.motor_z)
            + at(P::MotorViscous) * of(&block.motor_velocity)
            + at(P::MotorLoadFriction) * z_load;
        for (p, value) in [
            (P::MotorScale, torque),
            (P::MotorBias, 1.0),
            (P::MotorCoulomb, scale * of(&block.motor_z)),
            (P::MotorViscous, scale * of(&block.motor_velocity)),
            (P::MotorLoadFriction, scale * z_load),
        ] {
            out.push(self.place(i, p), value);
        }
        let grip = at(P::MotorCoulomb).abs().max(joint.motor_coulomb_nm)
            + at(P::MotorLoadFriction).abs() * stiffness * of(&block.y).abs();
        out.close(Equation {
            joint: i,
            side: Side::Motor,
            from,
            to: out.rows.len(),
            residual: of(&block.motor_torque) - scale * torque - at(P::MotorBias),
            unsure: grip * of(&block.motor_stood),
            stood: of(&block.motor_stood),
            worth: scale,
        });
    }
}

/// Changes that have happened by a block's time.
struct Active<'a> {
    prior: &'a Prior,
    changes: &'a [Change],
    time_s: f64,
}

impl<'a> Active<'a> {
    fn new(prior: &'a Prior, changes: &'a [Change], time_s: f64) -> Self {
        Self {
            prior,
            changes,
            time_s,
        }
    }

    /// Columns of changes to the entry at `place` of the state.
    fn columns(&self, place: usize) -> impl Iterator<Item = usize> + '_ {
        let mut column = self.prior.dimension();
        self.changes.iter().filter_map(move |change| {
            let first = column;
            column += change.what.columns();
            if self.time_s < change.at_s {
                return None;
            }
            let base = change.what.place(self.prior);
            (base..base + change.what.columns())
                .contains(&place)
                .then(|| first + place - base)
        })
    }

    /// The entry at `place` with all that was added to it.
    fn sum(&self, x: &[f64], place: usize) -> f64 {
        entry(x, place) + self.columns(place).map(|c| entry(x, c)).sum::<f64>()
    }

    /// The entry's column, and that of every change to it.
    fn push(&self, out: &mut Equations, place: usize, value: f64) {
        out.push(place, value);
        for column in self.columns(place) {
            out.push(column, value);
        }
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
    pub(super) fn place(self, prior: &Prior) -> usize {
        match self {
            Self::Offset(joint) => prior.place(joint, P::Offset),
            Self::Compliance(joint) => prior.place(joint, P::Compliance),
            Self::Payload => prior.payload_place(),
        }
    }
}
