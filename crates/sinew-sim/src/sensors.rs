//! What the recording shows of the true state.

use super::scenario::{Draw, PerJoint, Scenario, TorqueChannel, normal};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Motor position as recorded with the paper's artificial offset: `theta + delta_e` where
/// `theta` is larger than the offset, `theta` elsewhere, rad.
///
/// # Source
/// Kirchhoff, von Stryk, IROS 2018, section V (Fig. 6).
pub fn injected(theta: f64, delta_e: f64) -> f64 {
    if theta > delta_e {
        theta + delta_e
    } else {
        theta
    }
}

/// A torque channel, drawn.
#[derive(Debug, Clone)]
pub(crate) struct TorqueSensor {
    scale: Vec<f64>,
    offset: Vec<f64>,
    ripple: Vec<f64>,
    phase: Vec<f64>,
    per_rad: f64,
    noise: f64,
}

impl TorqueSensor {
    fn new(spec: &TorqueChannel, names: &[String], rng: &mut ChaCha8Rng) -> Self {
        let zero = vec![0.0; names.len()];
        Self {
            scale: spec.scale_error.sample(names, &zero, rng),
            offset: spec.offset_nm.sample(names, &zero, rng),
            ripple: spec.ripple_nm.sample(names, &zero, rng),
            phase: phases(names, rng),
            per_rad: spec.ripple_per_rad,
            noise: spec.noise_nm,
        }
    }

    pub(crate) fn read(&self, i: usize, tau: f64, theta: f64, rng: &mut ChaCha8Rng) -> f64 {
        let noise = if self.noise > 0.0 {
            self.noise * normal(rng)
        } else {
            0.0
        };
        let ripple = if self.ripple[i] == 0.0 {
            0.0
        } else {
            self.ripple[i] * libm::sin(self.per_rad * theta + self.phase[i])
        };
        (1.0 + self.scale[i]) * tau + self.offset[i] + ripple + noise
    }
}

fn phases(names: &[String], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let turn = PerJoint {
        all: Some(Draw::Uniform { min: 0.0, max: TAU }),
        by_joint: Vec::new(),
    };
    turn.sample(names, &vec![0.0; names.len()], rng)
}

/// All sensors of a robot.
#[derive(Debug, Clone)]
pub(crate) struct Sensors {
    joint_step: Option<f64>,
    once: Vec<f64>,
    once_phase: Vec<f64>,
    twice: Vec<f64>,
    twice_phase: Vec<f64>,
    joint_noise: f64,
    motor_step: f64,
    motor_noise: f64,
    motor_scale: Vec<f64>,
    velocity_noise: f64,
    pub motor_torque: TorqueSensor,
    pub torque_sensor: TorqueSensor,
    pub rng: ChaCha8Rng,
}

impl Sensors {
    /// `truth` draws what is fixed for a robot, `rng` the noise.
    pub(crate) fn new(
        scenario: &Scenario,
        names: &[String],
        truth: &mut ChaCha8Rng,
        later: &mut ChaCha8Rng,
        rng: ChaCha8Rng,
    ) -> Self {
        let zero = vec![0.0; names.len()];
        let e = &scenario.encoder;
        Self {
            joint_step: e.joint_bits.map(|bits| TAU / f64::from(bits).exp2()),
            once: e.once_per_turn_rad.sample(names, &zero, truth),
            once_phase: phases(names, truth),
            twice: e.twice_per_turn_rad.sample(names, &zero, truth),
            twice_phase: phases(names, truth),
            joint_noise: e.joint_noise_rad,
            motor_step: e.motor_resolution_rad,
            motor_noise: e.motor_noise_rad,
            motor_scale: e.motor_scale_error.sample(names, &zero, later),
            velocity_noise: scenario.velocity_noise_rad_per_s,
            motor_torque: TorqueSensor::new(&scenario.motor_torque, names, truth),
            torque_sensor: TorqueSensor::new(&scenario.torque_sensor, names, truth),
            rng,
        }
    }

    fn noise(&mut self, std: f64) -> f64 {
        if std > 0.0 {
            std * normal(&mut self.rng)
        } else {
            0.0
        }
    }

    /// Joint position, rad.
    pub(crate) fn joint(&mut self, i: usize, q: f64) -> f64 {
        let noise = self.noise(self.joint_noise);
        let seen = self.eccentric(i, q + noise, q);
        match self.joint_step {
            Some(step) => (seen / step).round() * step,
            None => seen,
        }
    }

    /// `seen` with the encoder's error of once and twice per turn at `q`, rad.
    pub(crate) fn eccentric(&self, i: usize, mut seen: f64, q: f64) -> f64 {
        if self.once[i] != 0.0 {
            seen += self.once[i] * libm::sin(q + self.once_phase[i]);
        }
        if self.twice[i] != 0.0 {
            seen += self.twice[i] * libm::sin(2.0 * q + self.twice_phase[i]);
        }
        seen
    }

    /// Motor position with an offset injected and a drift of its zero, rad; at the motor's shaft where a drive ratio is given.
    pub(crate) fn motor(
        &mut self,
        i: usize,
        theta: f64,
        offset: f64,
        drift: f64,
        drive_ratio: Option<f64>,
    ) -> f64 {
        let shown = injected(theta, offset) * (1.0 + self.motor_scale[i]);
        let position = drive_ratio.map_or(shown + drift, |ratio| (shown + drift) / ratio);
        let seen = position + self.noise(self.motor_noise);
        if self.motor_step > 0.0 {
            (seen / self.motor_step).round() * self.motor_step
        } else {
            seen
        }
    }

    /// Joint velocity, rad/s.
    pub(crate) fn velocity(&mut self, dq: f64) -> f64 {
        dq + self.noise(self.velocity_noise)
    }
}
