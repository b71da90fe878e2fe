//! Measured values of a block at a joint, prepared once for many linearisations.

use super::reduced_model::ReducedModel;
use crate::offset::block::Block;
use crate::offset::effects::payload::PayloadTorque;
use crate::offset::effects::{Drive, ENCODER, Measured};

impl Measured {
    /// Returns the measured values of joint `i` in `block`; `None` for a rigid one, and where its deflection is
    /// excluded ([`Block::exclude`]). Never allocates.
    pub(crate) fn of(model: &ReducedModel, block: &Block, i: usize) -> Option<Self> {
        let joint = model.joints.get(i)?.as_ref()?;
        if block.is_excluded(i) {
            return None;
        }
        let stiffness = joint.stiffness_nm_per_rad;
        // Lengths have been checked: none of these is ever missing. What is becomes NaN, which no
        // estimate hides.
        let of = |column: &[f64]| column.get(i).copied().unwrap_or(f64::NAN);
        let encoder = block.encoder.get(i * ENCODER..(i + 1) * ENCODER)?;
        let phi = model.phi(block, i)?;
        let mut encoder: [f64; ENCODER] = *encoder.first_chunk()?;
        let (mut turned, mut load_rad) = (of(&block.turned), of(&block.y));
        let (mut pull_rad, mut joint_stiffness) = (load_rad, stiffness);
        if let Some(routes) = &model.routes {
            turned += routes.moved_by_others(i, block.turned.iter().copied());
            load_rad = routes.joint_deflection(i, block.y.iter().copied());
            pull_rad = routes.pull_rad(i, pull_rad);
            if let Some(pulled) = routes.pulled(i) {
                joint_stiffness = pulled.stiffness_nm_per_rad;
            }
            let arm = routes.moment_arm(i, i);
            encoder.iter_mut().for_each(|wave| *wave *= arm);
        }
        let torque = of(&block.motor_torque);
        let inertia = joint.motor_inertia_kg_m2.filter(|_| torque.is_finite());
        Some(Self {
            y: of(&block.y),
            y_square: of(&block.y_square),
            y_cube: of(&block.y_cube),
            y_slow: of(&block.y_slow),
            turned,
            dq: of(&block.dq),
            encoder,
            pull_rad,
            load_rad,
            z: of(&block.z),
            z_unknown: of(&block.z_unknown),
            z_load: of(&block.z_load) * joint_stiffness,
            held: if block.rests_long() { 1.0 } else { 0.0 },
            tau: phi.iter().zip(&model.inertial).map(|(p, pi)| p * pi).sum(),
            load: PayloadTorque::new(&model.payload_phi(phi), model.payload_at),
            drive: inertia.map(|inertia| Drive {
                torque,
                inertial: inertia * of(&block.motor_acceleration),
                velocity: of(&block.motor_velocity),
                z: of(&block.motor_z),
                z_load: of(&block.motor_z_load) * stiffness,
                stood: of(&block.motor_stood),
            }),
            tension_nm: of(&block.tension_nm),
        })
    }
}
