//! The state and the measurement that the equations of a joint are evaluated at.

use super::payload::PayloadTorque;
use super::{ENCODER, JointParameter, PER_JOINT};
use crate::offset::joint_prior::JointPrior;

/// An entry for each of a joint's parameters.
pub(crate) type JointRow = [f64; PER_JOINT];

/// A joint in a block, at a state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point<'a> {
    /// Parameters of the joint, with the changes up to the block's time in them.
    pub(crate) x: &'a JointRow,
    pub(crate) joint: &'a JointPrior,
    pub(crate) measured: &'a Measured,
    /// Difference from the reference temperature of the offsets, K.
    pub(crate) temperature_difference_k: f64,
}

impl Point<'_> {
    /// Value of a parameter.
    #[inline]
    pub(crate) fn at(&self, parameter: JointParameter) -> f64 {
        self.x[parameter as usize]
    }
}

/// A sum of terms, with its derivatives.
#[derive(Debug)]
pub(crate) struct Sum<'a> {
    value: f64,
    derivatives: &'a mut JointRow,
}

impl Sum<'_> {
    /// A term in proportion to one parameter.
    #[inline]
    pub(crate) fn add(&mut self, point: &Point<'_>, parameter: JointParameter, factor: f64) {
        self.value += point.at(parameter) * factor;
        self.derivatives[parameter as usize] = factor;
    }

    /// A term in proportion to each of the parameters that follow each other from the first one on.
    #[inline]
    pub(crate) fn add_all(&mut self, point: &Point<'_>, first: JointParameter, factors: &[f64]) {
        let places = (point.x.iter()).zip(self.derivatives.iter_mut());
        for ((x, to), factor) in places.skip(first as usize).zip(factors) {
            self.value += x * factor;
            *to = *factor;
        }
    }
}

/// Computes a sum of terms and writes their derivatives to `derivatives`.
///
/// * `start`: the sum without effects.
#[inline]
pub(crate) fn total(
    start: f64,
    derivatives: &mut JointRow,
    terms: impl FnOnce(&mut Sum<'_>),
) -> f64 {
    let mut sum = Sum {
        value: start,
        derivatives,
    };
    terms(&mut sum);
    sum.value
}

/// Quantities of a block in a joint's equations, except `Φ`, that are independent of the state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured {
    /// `theta_measured − q`, its square and cube, and with a long memory.
    pub(crate) y: f64,
    pub(crate) y_square: f64,
    pub(crate) y_cube: f64,
    pub(crate) y_slow: f64,
    /// Torque of the tendon divided by its described stiffness, rad: `y` of a loop.
    pub(crate) pull_rad: f64,
    /// Torque of the springs at the joint divided by its stiffness, rad: `y` of a joint with a separate tendon.
    pub(crate) load_rad: f64,
    /// Joint position, or path of the tendon over all joints that it crosses, rad.
    pub(crate) turned: f64,
    /// Velocity of the joint, rad/s.
    pub(crate) dq: f64,
    /// Sine and cosine terms of the encoder error.
    pub(crate) encoder: [f64; ENCODER],
    /// Pre-sliding friction state.
    pub(crate) z: f64,
    /// Half-width of the unknown part of the friction state.
    pub(crate) z_unknown: f64,
    /// Friction state multiplied by the magnitude of the spring torque, N·m.
    pub(crate) z_load: f64,
    /// Share of the friction that is unknown after a long rest: 1 or 0.
    pub(crate) held: f64,
    /// Torque of the bodies according to the description, N·m.
    pub(crate) tau: f64,
    /// Torque of the payload on the joint.
    pub(crate) load: PayloadTorque,
    /// Drive values, if the motor torque is recorded.
    pub(crate) drive: Option<Drive>,
    /// Torque of a tendon whose tension is measured, N·m; NaN where it is not.
    pub(crate) tension_nm: f64,
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
