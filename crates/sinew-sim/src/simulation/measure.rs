//! What the sensors show of the state, and the truth behind it.

use super::*;
use crate::sensors::injected;

impl Simulation {
    /// Fills the frame and the truth behind it.
    pub(super) fn measure(&mut self) -> Result<(), SimulateError> {
        let t = self.time_s();
        let state = &self.plant.state;
        // No joint turns a thousand radians in a recording made by a working controller.
        const FAR_RAD: f64 = 1e3;
        let lost = |q: &f64| !q.is_finite() || q.abs() >= FAR_RAD;
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
        self.plant.elastic_torque(&inputs, &mut self.truth.tau_el);
        self.plant
            .external_torque(&self.forces, &mut self.truth.tau_ext)
            .map_err(|e| diverged(t, e))?;
        self.truth.time_s = t;
        let temperature_c = self.temperature.at(t);
        let warmer = temperature_c - self.temperature.reference_c;
        let record = self.scenario.record;
        let rate = self.scenario.sample_rate_hz;
        self.delay_motor(rate);
        self.frame.time_ns =
            self.scenario.start_time_ns + (self.frames as f64 * (1e9 / rate)).round() as i64;
        for i in 0..self.names.len() {
            let (q, dq) = (self.plant.state.q[i], self.plant.state.dq[i]);
            let theta = self.plant.state.theta[i];
            let ratio = self.drive_ratio(i);
            let at_motor = |theta: f64| ratio.map_or(theta, |ratio| theta / ratio);
            let parts = self.offset_at(i, t);
            let injection = parts.injected;
            let tau_el = self.truth.tau_el[i];
            self.truth.q_d[i] = self.q_d[i];
            self.truth.dq_d[i] = self.dq_d[i];
            self.truth.q[i] = q;
            self.truth.dq[i] = dq;
            self.truth.theta[i] = at_motor(theta);
            self.truth.delta_e[i] = parts.physical
                + parts.motor_encoder
                + parts.joint_encoder
                + injected(theta, injection)
                - theta;
            let drift = self.temperature.drift_rad_per_k[i] * warmer;
            self.frame.q[i] = self.sensors.joint(i, q) - self.joint_encoder_error(i, t);
            let shown = self.shown_theta(i, rate);
            self.frame.theta[i] = self.sensors.motor(i, shown, injection, drift, ratio)
                + at_motor(parts.motor_encoder);
            if record.dq {
                self.frame.dq[i] = self.sensors.velocity(dq);
            }
            if record.tau_el {
                let sensor = &self.sensors.torque_sensor;
                self.frame.tau_el[i] = sensor.read(i, tau_el, theta, &mut self.sensors.rng);
            }
            if record.tau_m {
                let sensor = &self.sensors.motor_torque;
                let torque = ratio.map_or(self.tau_m[i], |ratio| ratio * self.tau_m[i]);
                let rng = &mut self.sensors.rng;
                self.frame.tau_m[i] = sensor.read(i, torque, at_motor(theta), rng);
            }
            if record.tau_ext {
                self.frame.tau_ext[i] = self.truth.tau_ext[i];
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

    /// Joint position of joint `i` and position of its motor at the latest frame as the encoders would show them
    /// without noise and quantisation, rad.
    pub fn shown_without_noise(&self, i: usize) -> (f64, f64) {
        let truth = &self.truth;
        let warmer = self.temperature.at(truth.time_s) - self.temperature.reference_c;
        let parts = self.offset_at(i, truth.time_s);
        let drift = self.temperature.drift_rad_per_k[i] * warmer;
        let q = self.sensors.eccentric(i, truth.q[i], truth.q[i]);
        let error = self.joint_encoder_error(i, truth.time_s);
        let shown = |theta| injected(theta, parts.injected) + parts.motor_encoder + drift;
        let theta = match self.drive_ratio(i) {
            Some(ratio) => shown(ratio * truth.theta[i]) / ratio,
            None => shown(truth.theta[i]),
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

    /// The motor position that reaches the recording now, between frames along a straight line;
    /// the first one until there are enough.
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
