//! What a block measures at a joint, prepared once for many linearisations.

use super::reduced_model::ReducedModel;
use crate::offset::block::Block;
use crate::offset::parameter::ENCODER;
use crate::offset::payload::PayloadTorque;

/// All that a joint's equations need of a block but `Φ`, whatever the state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured {
    /// `theta_measured − q`, its square and cube, and with a long memory.
    pub(crate) y: f64,
    pub(crate) y_square: f64,
    pub(crate) y_cube: f64,
    pub(crate) y_slow: f64,
    /// Joint position, rad, velocity, and what goes with its encoder.
    pub(crate) turned: f64,
    pub(crate) dq: f64,
    pub(crate) encoder: [f64; ENCODER],
    /// Friction state, what is unknown of it, and times the size of the spring's torque, N·m.
    pub(crate) z: f64,
    pub(crate) z_unknown: f64,
    pub(crate) z_load: f64,
    /// Share of its friction that is unknown as the arm has stood for long: 1 or 0.
    pub(crate) held: f64,
    /// Torque of the bodies as they are described, N·m.
    pub(crate) tau: f64,
    /// Of what the gripper holds.
    pub(crate) load: PayloadTorque,
    /// Where the motor's torque is recorded.
    pub(crate) drive: Option<Drive>,
}

/// The motor's side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drive {
    /// Recorded torque, N·m.
    pub(crate) torque: f64,
    /// `J ddtheta`, N·m.
    pub(crate) inertial: f64,
    pub(crate) velocity: f64,
    /// Friction state, and times the size of the spring's torque, N·m.
    pub(crate) z: f64,
    pub(crate) z_load: f64,
    /// Share of the time it stood.
    pub(crate) stood: f64,
}

impl Measured {
    /// What `block` says of joint `i`; nothing of a rigid one. Never allocates.
    pub(crate) fn of(model: &ReducedModel, block: &Block, i: usize) -> Option<Self> {
        let joint = model.joints.get(i)?.as_ref()?;
        let stiffness = joint.stiffness_nm_per_rad;
        // Lengths have been checked: none of these is ever missing. What is becomes NaN, which no
        // estimate hides.
        let of = |column: &[f64]| column.get(i).copied().unwrap_or(f64::NAN);
        let encoder = block.encoder.get(i * ENCODER..(i + 1) * ENCODER)?;
        let phi = model.phi(block, i)?;
        let torque = of(&block.motor_torque);
        let inertia = joint.motor_inertia_kg_m2.filter(|_| torque.is_finite());
        Some(Self {
            y: of(&block.y),
            y_square: of(&block.y_square),
            y_cube: of(&block.y_cube),
            y_slow: of(&block.y_slow),
            turned: of(&block.turned),
            dq: of(&block.dq),
            encoder: *encoder.first_chunk()?,
            z: of(&block.z),
            z_unknown: of(&block.z_unknown),
            z_load: of(&block.z_load) * stiffness,
            held: if block.stands_long() { 1.0 } else { 0.0 },
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
        })
    }
}
