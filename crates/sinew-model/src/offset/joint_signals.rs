//! Filtered signals of one joint that form a block.

use super::effects::ENCODER;
use crate::observer::{ExactPole, FirstOrder, StateVariableFilter};

/// Memory of a viscoelastic rope within a session, s.
const CREEP_S: f64 = 30.0;
/// Travel after which the direction of friction is certain, rad: several times the apparent motion
/// of a joint at rest by quantisation.
const CERTAIN_STROKE_RAD: f64 = 10e-3;
/// JointSignals that are low-passed per joint.
const LAGS: usize = 13 + ENCODER;

/// Weights of the low-passes for a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lags {
    pub(crate) step_s: f64,
    pub(crate) pole: ExactPole,
    pub(crate) slow: ExactPole,
}

impl Lags {
    pub(crate) fn new(gain_per_s: f64, step_s: f64) -> Self {
        Self {
            step_s,
            pole: ExactPole::new(gain_per_s, step_s),
            slow: ExactPole::new(1.0 / CREEP_S, step_s),
        }
    }
}

/// Filtered signals of one joint.
#[derive(Debug, Clone, Default)]
pub(crate) struct JointSignals {
    pub(crate) q: StateVariableFilter,
    pub(crate) theta: StateVariableFilter,
    pub(crate) torque: StateVariableFilter,
    z: f64,
    /// Bounds of the friction state, which is unknown at the start of a recording.
    z_bounds: [f64; 2],
    q_at_z: f64,
    motor_z: f64,
    theta_at_z: f64,
    /// Velocity of the motor, rad/s.
    pub(crate) motor_rate: f64,
    /// Low-passed, in the order of [`JointSignals::lag_inputs`].
    pub(crate) lags: [FirstOrder; LAGS],
    /// The matched deflection once more, slowly.
    pub(crate) slow: FirstOrder,
}

/// Spring and motor parameters that the signals of a joint need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spring {
    /// Torque of the spring at the joint over its stiffness, rad.
    pub(crate) load_rad: f64,
    /// Pull of the tendon over its stiffness, by its description, rad.
    pub(crate) pull_rad: f64,
    /// Position of the motor, rad.
    pub(crate) motor_rad: f64,
    /// Velocity of the motor, rad/s.
    pub(crate) motor_rad_per_s: f64,
}

impl JointSignals {
    /// Spring of a joint with a tendon of its own.
    pub(crate) fn spring(&self) -> Spring {
        Spring {
            load_rad: self.deflection(),
            pull_rad: self.deflection(),
            motor_rad: self.theta.value(),
            motor_rad_per_s: self.theta.rate(),
        }
    }

    /// `theta_measured − q`, rad.
    pub(crate) fn deflection(&self) -> f64 {
        self.theta.value() - self.q.value()
    }

    /// Starts the filters of the positions and of the torque; [`settle`](Self::settle) follows.
    pub(crate) fn start(&mut self, q: f64, theta: f64, torque: f64) {
        *self = Self {
            q: StateVariableFilter::settled_at(q),
            theta: StateVariableFilter::settled_at(theta),
            torque: StateVariableFilter::settled_at(torque),
            z_bounds: [-1.0, 1.0],
            q_at_z: q,
            ..Self::default()
        };
    }

    /// Starts the low-passed signals, as if the joint had stood there.
    pub(crate) fn settle(&mut self, spring: Spring) {
        self.theta_at_z = spring.motor_rad;
        self.motor_rate = spring.motor_rad_per_s;
        let inputs = self.lag_inputs(spring);
        let [deflection, ..] = inputs;
        self.lags = inputs.map(FirstOrder::settled_at);
        self.slow = FirstOrder::settled_at(deflection);
    }

    /// Brings friction and the low-passed signals to now.
    pub(crate) fn follow(
        &mut self,
        spring: Spring,
        stroke_rad: f64,
        pole: &ExactPole,
        slow: &ExactPole,
    ) {
        let q = self.q.value();
        let moved = q - self.q_at_z;
        self.q_at_z = q;
        self.z = (self.z + moved / stroke_rad).clamp(-1.0, 1.0);
        for z in &mut self.z_bounds {
            *z = (*z + moved / CERTAIN_STROKE_RAD).clamp(-1.0, 1.0);
        }
        let turned = spring.motor_rad - self.theta_at_z;
        self.theta_at_z = spring.motor_rad;
        self.motor_rate = spring.motor_rad_per_s;
        self.motor_z = (self.motor_z + turned / stroke_rad).clamp(-1.0, 1.0);
        let inputs = self.lag_inputs(spring);
        for (lag, u) in self.lags.iter_mut().zip(inputs) {
            // Not a number is "not recorded"; it must not stay in the lag for ever.
            if lag.output().is_finite() {
                lag.step(pole, u);
            } else {
                *lag = FirstOrder::settled_at(u);
            }
        }
        let [deflection, ..] = &self.lags;
        self.slow.step(slow, deflection.output());
    }

    /// Returns the inputs of the low-pass filters.
    fn lag_inputs(&self, spring: Spring) -> [f64; LAGS] {
        /// Speed below which the direction of a drive's friction is unknown, rad/s.
        const REST_RAD_PER_S: f64 = 0.05;
        let q = &self.q;
        let deflection = self.deflection();
        let (s1, c1) = libm::sincos(q.value());
        let (s2, c2) = (2.0 * s1 * c1, c1 * c1 - s1 * s1);
        let [low, high] = self.z_bounds;
        let z_unknown = 0.5 * (high - low);
        let z = self.z * (1.0 - z_unknown);
        let is_at_rest = self.motor_rate.abs() < REST_RAD_PER_S;
        [
            deflection,
            deflection * deflection,
            deflection * deflection * deflection,
            q.value(),
            z,
            z_unknown,
            q.rate(),
            z * spring.load_rad.abs(),
            self.torque.value(),
            self.motor_rate,
            self.motor_z,
            self.motor_z * spring.pull_rad.abs(),
            if is_at_rest { 1.0 } else { 0.0 },
            s1,
            c1,
            s2,
            c2,
        ]
    }
}
