//! A block's equations, linearised: what is expected, and how it moves with the state.

use super::block::{Block, ENCODER};
use super::changes::{Change, What};
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
        let mut expected = offset + linear + at(P::Viscoelastic) * slow + at(P::Gear) * turned
            - cubic * linear * linear * linear
            + at(P::Drift) * warmer;
        // A pair of slack ropes lets the joint through a dead zone, by the sign of the torque.
        const SMOOTH_RAD: f64 = 2e-3;
        let taut = if joint.antagonistic {
            libm::tanh(linear / SMOOTH_RAD)
        } else {
            0.0
        };
        expected += at(P::Slack) * taut;
        for (k, e) in encoder.iter().enumerate() {
            expected += x[self.place(i, P::Encoder) + k] * e;
        }
        let slope = 1.0 - 3.0 * cubic * linear * linear;
        let per_torque = slope * kappa * soft;
        let from = out.rows.len();
        active.push(&mut out.rows, self.place(i, P::Offset), 1.0);
        out.rows.push((self.place(i, P::Zero), 1.0));
        active.push(
            &mut out.rows,
            self.place(i, P::Compliance),
            slope * kappa * tau,
        );
        out.rows
            .push((self.place(i, P::Stiffening), -linear * linear * linear));
        if joint.antagonistic {
            out.rows.push((self.place(i, P::Slack), taut));
        }
        out.rows.push((self.place(i, P::Viscoelastic), slow));
        out.rows.push((self.place(i, P::Gear), turned));
        if warmer != 0.0 {
            out.rows.push((self.place(i, P::Drift), warmer));
            out.rows
                .push((self.place(i, P::Thermal), slope * kappa * tau * warmer));
        }
        for (k, e) in encoder.iter().enumerate() {
            out.rows.push((self.place(i, P::Encoder) + k, *e));
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
            residual: block.y[i] - expected,
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

/// Torque of the payload: a point mass near where it is expected.
///
/// With `h = m e` its moments about that place `a`, its second moments about the link's origin are
/// `m a aᵀ + a hᵀ + h aᵀ + h hᵀ/m`.
///
/// Returns the torque and its change with mass and moments.
fn payload_torque(body: &[f64], a: [f64; 3], [m, h @ ..]: [f64; PAYLOAD]) -> (f64, [f64; PAYLOAD]) {
    /// Nothing is held further from where it is expected, m.
    const FAR_M: f64 = 0.1;
    const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Torque of second moments `u vᵀ + v uᵀ`, halved.
    let second = |u: [f64; 3], v: [f64; 3]| {
        let [xx, yy, zz] = [u[0] * v[0], u[1] * v[1], u[2] * v[2]];
        let mixed = |i: usize, k: usize| 0.5 * (u[i] * v[k] + u[k] * v[i]);
        body[4] * (yy + zz) + body[7] * (xx + zz) + body[9] * (xx + yy)
            - body[5] * mixed(0, 1)
            - body[6] * mixed(0, 2)
            - body[8] * mixed(1, 2)
    };
    let first = body[1] * a[0] + body[2] * a[1] + body[3] * a[2];
    let mut slope = [body[0] + first + second(a, a), 0.0, 0.0, 0.0];
    let mut torque = slope[0] * m;
    let size = libm::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    let mass = m.max(size / FAR_M);
    for (k, axis) in AXES.into_iter().enumerate() {
        slope[k + 1] = body[k + 1] + 2.0 * second(a, axis);
        torque += slope[k + 1] * h[k];
        if mass > 0.0 {
            slope[k + 1] += 2.0 * second(h, axis) / mass;
        }
    }
    if mass > 0.0 {
        torque += second(h, h) / mass;
    }
    (torque, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inertial parameters of a point mass in the order of the regressor.
    fn point(m: f64, [x, y, z]: [f64; 3]) -> [f64; PARAMETERS_PER_BODY] {
        let moments = [m, m * x, m * y, m * z];
        let inertia = [
            y * y + z * z,
            -x * y,
            -x * z,
            x * x + z * z,
            -y * z,
            x * x + y * y,
        ];
        core::array::from_fn(|k| {
            moments
                .get(k)
                .copied()
                .unwrap_or_else(|| m * inertia[k - 4])
        })
    }

    #[test]
    fn a_payload_weighs_as_a_point_mass_where_it_is() {
        let body: [f64; PARAMETERS_PER_BODY] =
            core::array::from_fn(|k| libm::sin(1.0 + 2.3 * k as f64));
        let at = [0.02, -0.11, 0.04];
        for (m, e) in [
            (0.4, [0.01, -0.05, 0.03]),
            (0.02, [0.0, 0.05, 0.0]),
            (0.3, [0.0; 3]),
            (0.0, [0.0; 3]),
        ] {
            let state = [m, m * e[0], m * e[1], m * e[2]];
            let (torque, slope) = payload_torque(&body, at, state);
            let there = point(m, core::array::from_fn(|k| at[k] + e[k]));
            let expected: f64 = body.iter().zip(there).map(|(phi, pi)| phi * pi).sum();
            assert!((torque - expected).abs() < 1e-14, "{torque} {expected}");
            if m == 0.0 {
                continue;
            }
            // Moments: the slope is that of the torque at a constant mass. The mass's own leaves
            // out that the same moments sit nearer on a heavier body, which its size allows for.
            for k in 1..PAYLOAD {
                let mut ends = [state; 2];
                ends[0][k] -= 1e-6;
                ends[1][k] += 1e-6;
                let [low, high] = ends.map(|s| payload_torque(&body, at, s).0);
                let numeric = (high - low) / 2e-6;
                assert!(
                    (slope[k] - numeric).abs() < 1e-6,
                    "{k}: {} {numeric}",
                    slope[k]
                );
            }
        }
    }

    #[test]
    fn moments_without_a_mass_stay_within_reach() {
        let body = [1.0; PARAMETERS_PER_BODY];
        let (torque, slope) = payload_torque(&body, [0.0; 3], [-0.01, 0.004, 0.0, 0.0]);
        // 4 mm·kg at 10 cm at most: a mass of 40 g, and second moments of 0.4 g·m².
        let expected = -0.01 + 0.004 + 2.0 * 0.04 * 0.01;
        assert!((torque - expected).abs() < 1e-14, "{torque} {expected}");
        assert!(slope.iter().all(|s| s.is_finite()));
    }
}
