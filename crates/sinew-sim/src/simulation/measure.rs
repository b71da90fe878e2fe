//! Sensor values of the state, and their true values.

use super::*;
use crate::sensors::injected;

impl Simulation {
    /// Writes the frame and its true values.
    pub(super) fn measure(&mut self) -> Result<(), SimulateError> {
        let t = self.time_s();
        let state = &self.plant.state;
        // No joint turns a thousand radians in a recording made by a working controller.
        const MAX_POSITION_RAD: f64 = 1e3;
        let lost = |q: &f64| !q.is_finite() || q.abs() >= MAX_POSITION_RAD;
        if let Some(i) = state.q.iter().position(lost) {
            return Err(SimulateError::Diverged {
                time_s: t,
                reason: format!("joint '{}' is at {} rad", self.names[i], state.q[i]),
            });
        }
        self.set_inputs(t);
        let inputs = Inputs {
            tau_m: &self.tau_m,
            delta_e: &self.delta_e,
            stiffness_scale: &self.stiffness_scale,
            forces: &self.forces,
        };
        self.plant
            .elastic_torques(&inputs, &mut self.truth.tendon_torque, &mut self.tau_el);
        self.plant
            .external_torque(&self.forces, &mut self.tau_ext)
            .map_err(|e| diverged(t, e))?;
        self.truth.time_s = t;
        let temperature_c = self.temperature.at(t);
        let warmer = temperature_c - self.temperature.reference_c;
        let record = self.scenario.record;
        let rate = self.scenario.sample_rate_hz;
        self.delay_motor(rate);
        self.frame.time_ns =
            self.scenario.start_time_ns + (self.frames as f64 * (1e9 / rate)).round() as i64;
        for i in 0..self.axes() {
            let is_joint = i < self.names.len();
            if is_joint {
                let (q, dq) = (self.plant.state.q[i], self.plant.state.dq[i]);
                self.truth.q_d[i] = self.q_d[i];
                self.truth.dq_d[i] = self.dq_d[i];
                self.truth.q[i] = q;
                self.truth.dq[i] = dq;
                self.truth.tau_el[i] = self.tau_el[i];
                self.truth.tau_ext[i] = self.tau_ext[i];
                self.frame.q[i] = self.sensors.joint(i, q) - self.joint_encoder_error(i, t);
            } else {
                // Without a joint nothing moves.
                self.frame.q[i] = 0.0;
                if record.dq {
                    self.frame.dq[i] = 0.0;
                }
            }
            if self.has_tendon(i) {
                self.measure_motor(i, t, warmer);
            }
            let theta = self.plant.state.theta[i];
            if is_joint {
                if record.dq {
                    self.frame.dq[i] = self.sensors.velocity(self.truth.dq[i]);
                }
                if record.tau_el {
                    let (sensor, tau_el) = (&self.sensors.torque_sensor, self.truth.tau_el[i]);
                    self.frame.tau_el[i] = sensor.read(i, tau_el, theta, &mut self.sensors.rng);
                }
            }
            let motor = self.motor_axis(i);
            if record.tau_m && motor < i {
                self.frame.tau_m[i] = self.frame.tau_m[motor];
            } else if record.tau_m && self.has_tendon(i) {
                let sensor = &self.sensors.motor_torque;
                let (torque, at_motor) = match self.drive_ratio(i) {
                    Some(ratio) => (ratio * self.tau_m[i], theta / ratio),
                    None => (self.tau_m[i], theta),
                };
                let rng = &mut self.sensors.rng;
                self.frame.tau_m[i] = sensor.read(i, torque, at_motor, rng);
            }
            if record.tau_ext && is_joint {
                self.frame.tau_ext[i] = self.truth.tau_ext[i];
            }
            let tension_n = self.truth.tendon_torque[i] / self.metres_per_rad[i];
            self.truth.tension_n[i] = tension_n;
            if let (Some(sensor), true) = (&self.sensors.tension, tension_n.is_finite()) {
                self.frame.tension[i] = sensor.read(i, tension_n, &mut self.sensors.rng);
            }
        }
        if record.temperature {
            let error_k = if t >= self.temperature.reading_error_from_s {
                self.temperature.reading_error_k
            } else {
                0.0
            };
            self.frame.temperature_c = temperature_c + error_k;
        }
        Ok(())
    }

    /// Sets the encoder position of the motor on axis `i`, and the offset of the tendon.
    fn measure_motor(&mut self, i: usize, t: f64, warmer: f64) {
        let theta = self.plant.state.theta[i];
        let ratio = self.drive_ratio(i);
        let at_motor = |theta: f64| ratio.map_or(theta, |ratio| theta / ratio);
        let parts = self.offset_at(i, t);
        let injection = parts.injected;
        self.truth.theta[i] = at_motor(theta);
        self.truth.delta_e[i] =
            parts.physical + parts.motor_encoder + parts.joint_encoder + injected(theta, injection)
                - theta;
        let motor = self.motor_axis(i);
        if motor < i {
            // One encoder measures one position.
            self.frame.theta[i] = self.frame.theta[motor];
            return;
        }
        let drift = self.temperature.drift_rad_per_k[i] * warmer;
        let shown = self.shown_theta(i, self.scenario.sample_rate_hz);
        self.frame.theta[i] =
            self.sensors.motor(i, shown, injection, drift, ratio) + at_motor(parts.motor_encoder);
    }

    /// Positions of the joint and of the motor on axis `i` at the latest frame as the encoders would show them
    /// without noise and quantisation, rad; 0 for a joint that the axis does not have.
    pub fn shown_without_noise(&self, i: usize) -> (f64, f64) {
        let truth = &self.truth;
        let warmer = self.temperature.at(truth.time_s) - self.temperature.reference_c;
        let q = match i < self.names.len() {
            true => self.sensors.eccentric(i, truth.q[i], truth.q[i]),
            false => 0.0,
        };
        let motor = self.motor_axis(i);
        let parts = self.offset_at(motor, truth.time_s);
        let drift = self.temperature.drift_rad_per_k[motor] * warmer;
        let error = self.joint_encoder_error(i, truth.time_s);
        let shown = |theta| injected(theta, parts.injected) + parts.motor_encoder + drift;
        let theta = match self.drive_ratio(motor) {
            Some(ratio) => shown(ratio * truth.theta[motor]) / ratio,
            None => shown(truth.theta[motor]),
        };
        (q - error, theta)
    }

    /// Remembers motor positions as long as they are recorded late.
    fn delay_motor(&mut self, rate_hz: f64) {
        let delay = self.scenario.encoder.motor_delay_s * rate_hz;
        if delay > 0.0 {
            self.shown.push_back(self.plant.state.theta.clone());
            while self.shown.len() > delay.ceil() as usize + 1 {
                self.shown.pop_front();
            }
        }
    }

    /// Returns the delayed motor position for the recording, interpolated linearly between frames; the first position
    /// until the delay has passed.
    fn shown_theta(&self, i: usize, rate_hz: f64) -> f64 {
        let delay = self.scenario.encoder.motor_delay_s * rate_hz;
        let Some(newest) = self.shown.len().checked_sub(1) else {
            return self.plant.state.theta[i];
        };
        let at = |frames: usize| self.shown[newest.saturating_sub(frames)][i];
        let share = delay - delay.floor();
        let whole = delay.floor() as usize;
        at(whole) + share * (at(whole + 1) - at(whole))
    }
}
