//! Sensor model: recorded values of the true state.

use super::sampled::Names;
use super::scenario::{Draw, PerJoint, Scenario, TensionChannel, TorqueChannel, normal};
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

/// Drawn parameters of a torque channel.
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

/// Drawn parameters of a tension channel.
#[derive(Debug, Clone)]
pub(crate) struct TensionSensor {
    scale: Vec<f64>,
    offset: Vec<f64>,
    noise: f64,
}

impl TensionSensor {
    fn new(spec: &TensionChannel, tendons: &[String], rng: &mut ChaCha8Rng) -> Self {
        let zero = vec![0.0; tendons.len()];
        Self {
            scale: spec.scale_error.sample(tendons, &zero, rng),
            offset: spec.offset_n.sample(tendons, &zero, rng),
            noise: spec.noise_n,
        }
    }

    /// Recorded tension of the tendon on an axis, N.
    pub(crate) fn read(&self, i: usize, tension_n: f64, rng: &mut ChaCha8Rng) -> f64 {
        let noise = if self.noise > 0.0 {
            self.noise * normal(rng)
        } else {
            0.0
        };
        (1.0 + self.scale[i]) * tension_n + self.offset[i] + noise
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
    /// Sensor of tensions, if recorded.
    pub tension: Option<TensionSensor>,
    pub rng: ChaCha8Rng,
}

impl Sensors {
    /// `truth` draws the values that are constant for a robot, and `rng` draws the noise.
    pub(crate) fn new(
        scenario: &Scenario,
        names: &Names,
        truth: &mut ChaCha8Rng,
        later: &mut ChaCha8Rng,
        rng: ChaCha8Rng,
    ) -> Self {
        let Names { joints, motors, .. } = names;
        let zero = vec![0.0; motors.len()];
        let e = &scenario.encoder;
        Self {
            joint_step: e.joint_bits.map(|bits| TAU / f64::from(bits).exp2()),
            once: e.once_per_turn_rad.sample(joints, &zero, truth),
            once_phase: phases(joints, truth),
            twice: e.twice_per_turn_rad.sample(joints, &zero, truth),
            twice_phase: phases(joints, truth),
            joint_noise: e.joint_noise_rad,
            motor_step: e.motor_resolution_rad,
            motor_noise: e.motor_noise_rad,
            motor_scale: e.motor_scale_error.sample(motors, &zero, later),
            velocity_noise: scenario.velocity_noise_rad_per_s,
            motor_torque: TorqueSensor::new(&scenario.motor_torque, motors, truth),
            torque_sensor: TorqueSensor::new(&scenario.torque_sensor, joints, truth),
            tension: None,
            rng,
        }
    }

    /// Adds the sensors of the tensions, which came to the language last.
    pub(crate) fn add_tension(
        &mut self,
        scenario: &Scenario,
        tendons: &[String],
        later: &mut ChaCha8Rng,
    ) {
        let sensor = TensionSensor::new(&scenario.tension_sensor, tendons, later);
        self.tension = scenario.record.tension.then_some(sensor);
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

    /// Adds the first and second harmonic of the encoder error at `q` to `seen`, rad.
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
