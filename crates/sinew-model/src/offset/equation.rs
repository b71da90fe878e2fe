//! A block's equations, linearised: what is expected, and how it moves with the state.

use super::block::{Block, ENCODER};
use super::changes::{Change, What};
use super::payload::payload_torque;
use super::prior::{JointParameter as P, PAYLOAD, Prior};
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
}

/// Equations of one block, reused from block to block.
#[derive(Debug, Clone, Default)]
pub(super) struct Equations {
    pub(super) rows: Vec<(usize, f64)>,
    pub(super) list: Vec<Equation>,
}

impl Equations {
    /// Room for equations of so many entries in all.
    pub(super) fn with_capacity(entries: usize, equations: usize) -> Self {
        Self {
            rows: Vec::with_capacity(entries),
            list: Vec::with_capacity(equations),
        }
    }
}

impl Prior {
    /// Fills `out` with the equations of `block` around the state `x` (`d` entries, then those of
    /// `changes`). `motor`: whether the motor's torque is used.
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
        let Some(joint) = &self.joints[i] else { return };
        let stiffness = joint.stiffness_nm_per_rad;
        let kappa = 1.0 / stiffness;
        let n = self.joints();
        let columns = n * PARAMETERS_PER_BODY;
        let at = |p: P| x[self.place(i, p)];
        let phi = &block.phi[i * columns..(i + 1) * columns];
        let bodies = self.body_start();
        let mut tau = 0.0;
        for ((phi, pi), error) in phi.iter().zip(&self.inertial).zip(&x[bodies..]) {
            tau += phi * (pi + error);
        }
        let load = &phi[self.payload_body * PARAMETERS_PER_BODY..][..PARAMETERS_PER_BODY];
        let held = core::array::from_fn(|k| active.sum(x, self.payload_place() + k));
        let (torque, load) = payload_torque(load, self.payload_at, held);
        tau += torque;
        let z_load = block.z_load[i] * stiffness;
        // A joint that has not slid since the recording began may be held either way.
        let stuck = (at(P::Coulomb) + at(P::LoadFriction) * stiffness * block.y[i].abs())
            * block.z_unknown[i];
        tau += at(P::Stuck) * stuck
            + at(P::Coulomb) * block.z[i]
            + at(P::Viscous) * block.dq[i]
            + at(P::LoadFriction) * z_load;

        // Link side.
        let compliance = active.sum(x, self.place(i, P::Compliance));
        let soft = 1.0 + compliance + at(P::Thermal) * warmer;
        let linear = kappa * soft * tau;
        let cubic = at(P::Stiffening);
        let encoder = &block.encoder[i * ENCODER..(i + 1) * ENCODER];
        let offset = active.sum(x, self.place(i, P::Offset)) + at(P::Zero);
        // The slow part of the deflection, and how far the joint has turned.
        let (slow, turned) = (block.y_slow[i] - offset, block.turned[i]);
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
            beside += x[self.place(i, P::Encoder) + k] * e;
        }
        // LP[x + η x³] = κ τ with x = theta_measured − q − beside: linear in stiffness, stiffening
        // and torque, however large the deflection.
        let (y, y2, y3) = (block.y[i], block.y_square[i], block.y_cube[i]);
        let square = y2 - beside * (2.0 * y - beside);
        let cube = y3 - beside * (3.0 * y2 - beside * (3.0 * y - beside));
        let expected = beside + linear - cubic * cube;
        // What a rad beside is worth, where the spring is stiffer.
        let worth = 1.0 + 3.0 * cubic * square;
        let per_torque = kappa * soft;
        let from = out.rows.len();
        active.push(&mut out.rows, self.place(i, P::Offset), worth);
        out.rows.push((self.place(i, P::Zero), worth));
        active.push(&mut out.rows, self.place(i, P::Compliance), kappa * tau);
        out.rows.push((self.place(i, P::Stiffening), -cube));
        if joint.antagonistic {
            out.rows.push((self.place(i, P::Slack), worth * taut));
        }
        out.rows
            .push((self.place(i, P::Viscoelastic), worth * slow));
        out.rows.push((self.place(i, P::Gear), worth * turned));
        if warmer != 0.0 {
            out.rows.push((self.place(i, P::Drift), worth * warmer));
            out.rows
                .push((self.place(i, P::Thermal), kappa * tau * warmer));
        }
        for (k, e) in encoder.iter().enumerate() {
            out.rows.push((self.place(i, P::Encoder) + k, worth * e));
        }
        let torque_from = out.rows.len();
        out.rows
            .push((self.place(i, P::Coulomb), per_torque * block.z[i]));
        out.rows
            .push((self.place(i, P::Viscous), per_torque * block.dq[i]));
        out.rows
            .push((self.place(i, P::LoadFriction), per_torque * z_load));
        if stuck != 0.0 {
            out.rows.push((self.place(i, P::Stuck), per_torque * stuck));
        }
        for (k, phi) in phi.iter().enumerate() {
            if *phi != 0.0 {
                out.rows.push((bodies + k, per_torque * phi));
            }
        }
        for (k, c) in load.iter().enumerate() {
            active.push(&mut out.rows, self.payload_place() + k, per_torque * c);
        }
        let to = out.rows.len();
        out.list.push(Equation {
            joint: i,
            side: Side::Link,
            from,
            to,
            residual: y - expected,
            unsure: 0.0,
            stood: 0.0,
        });

        // Motor side.
        let (Some(inertia), true) = (joint.motor_inertia_kg_m2, motor && per_torque > 0.0) else {
            return;
        };
        if !block.motor_torque[i].is_finite() {
            return;
        }
        let from = out.rows.len();
        let scale = 1.0 + at(P::MotorScale);
        for r in torque_from..to {
            let (place, value) = out.rows[r];
            out.rows.push((place, scale * value / per_torque));
        }
        let z_load = block.motor_z_load[i] * stiffness;
        let torque = tau
            + inertia * block.motor_acceleration[i]
            + at(P::MotorCoulomb) * block.motor_z[i]
            + at(P::MotorViscous) * block.motor_velocity[i]
            + at(P::MotorLoadFriction) * z_load;
        for (p, value) in [
            (P::MotorScale, torque),
            (P::MotorBias, 1.0),
            (P::MotorCoulomb, scale * block.motor_z[i]),
            (P::MotorViscous, scale * block.motor_velocity[i]),
            (P::MotorLoadFriction, scale * z_load),
        ] {
            out.rows.push((self.place(i, p), value));
        }
        let grip = at(P::MotorCoulomb).abs().max(joint.motor_coulomb_nm)
            + at(P::MotorLoadFriction).abs() * stiffness * block.y[i].abs();
        out.list.push(Equation {
            joint: i,
            side: Side::Motor,
            from,
            to: out.rows.len(),
            residual: block.motor_torque[i] - scale * torque - at(P::MotorBias),
            unsure: grip * block.motor_stood[i],
            stood: block.motor_stood[i],
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
        x[place] + self.columns(place).map(|c| x[c]).sum::<f64>()
    }

    /// The entry's column, and that of every change to it.
    fn push(&self, rows: &mut Vec<(usize, f64)>, place: usize, value: f64) {
        rows.push((place, value));
        rows.extend(self.columns(place).map(|c| (c, value)));
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
