//! What is filtered of one joint on the way to a block.

use super::effects::ENCODER;
use crate::observer::{ExactPole, FirstOrder, StateVariableFilter};

/// Memory of a viscoelastic rope within a session, s.
const CREEP_S: f64 = 30.0;
/// Travel after which friction surely points against it, rad: several times what quantisation makes
/// a standing joint seem to move.
const SURE_STROKE_RAD: f64 = 10e-3;
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

/// What is filtered of one joint.
#[derive(Debug, Clone, Default)]
pub(crate) struct JointSignals {
    pub(crate) q: StateVariableFilter,
    pub(crate) theta: StateVariableFilter,
    pub(crate) torque: StateVariableFilter,
    z: f64,
    /// Bounds of the friction state: it may be anything when a recording begins.
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

/// What the signals of a joint have of its spring and its motor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spring {
    /// Torque of the spring at the joint over its stiffness, rad.
    pub(crate) load_rad: f64,
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
        let inputs = self.lag_inputs(spring.load_rad);
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
            *z = (*z + moved / SURE_STROKE_RAD).clamp(-1.0, 1.0);
        }
        let turned = spring.motor_rad - self.theta_at_z;
        self.theta_at_z = spring.motor_rad;
        self.motor_rate = spring.motor_rad_per_s;
        self.motor_z = (self.motor_z + turned / stroke_rad).clamp(-1.0, 1.0);
        let inputs = self.lag_inputs(spring.load_rad);
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

    /// What is low-passed.
    fn lag_inputs(&self, load_rad: f64) -> [f64; LAGS] {
        /// Below this speed a drive's friction may point either way, rad/s.
        const STANDS_RAD_PER_S: f64 = 0.05;
        let q = &self.q;
        let deflection = self.deflection();
        let (s1, c1) = libm::sincos(q.value());
        let (s2, c2) = (2.0 * s1 * c1, c1 * c1 - s1 * s1);
        let [low, high] = self.z_bounds;
        let z_unknown = 0.5 * (high - low);
        let z = self.z * (1.0 - z_unknown);
        let stands = self.motor_rate.abs() < STANDS_RAD_PER_S;
        [
            deflection,
            deflection * deflection,
            deflection * deflection * deflection,
            q.value(),
            z,
            z_unknown,
            q.rate(),
            z * load_rad.abs(),
            self.torque.value(),
            self.motor_rate,
            self.motor_z,
            self.motor_z * deflection.abs(),
            if stands { 1.0 } else { 0.0 },
            s1,
            c1,
            s2,
            c2,
        ]
    }
}
