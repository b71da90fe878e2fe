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
    /// Temperature over that the offsets refer to, K.
    pub(crate) warmer_k: f64,
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

/// A sum of terms; their derivatives go to `derivatives`.
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

/// All that a joint's equations need of a block but `Φ`, whatever the state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured {
    /// `theta_measured − q`, its square and cube, and with a long memory.
    pub(crate) y: f64,
    pub(crate) y_square: f64,
    pub(crate) y_cube: f64,
    pub(crate) y_slow: f64,
    /// Torque of the springs at the joint over its stiffness, rad: `y` of a joint with a tendon of its own.
    pub(crate) load_rad: f64,
    /// Joint position, or path of the tendon by all joints it crosses, rad; velocity of the joint, and what goes with its encoder.
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
