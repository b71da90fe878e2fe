//! From samples to block features: an equation per joint that is linear in what is unknown.
//!
//! ```text
//! LP[x + η x³] = κ τ,   x = theta_measured − q − delta_e − encoder error(q) − noise
//! τ = Φ π + F_c LP[z] + F_v LP[dq] + μ LP[z |τ|],   Φ = K_I (P − LP[P]) − LP[A]
//! ```
//!
//! `Φ` is the momentum-filtered torque regressor: what the observer does to `p` and `α`, done to
//! the columns of their regressors, so no acceleration is needed and the lag of `Φ` is that of
//! `y`. Everything is averaged over blocks of a fifth of a second.
//!
//! Where the motor's torque `u` is recorded there is a second equation per joint,
//!
//! ```text
//! LP[u] = (1 + k)(τ + J LP[ddtheta] + F_m LP[z_m] + F_vm LP[dtheta] + μ_m LP[z_m |τ|]) + b
//! LP[ddtheta] = K_I (dtheta − LP[dtheta])
//! ```
//!
//! `z` and `z_m` are pre-sliding friction states in −1…1 driven by `q` and `theta`.

use super::block::{Block, ENCODER};
use super::config::FeatureConfig;
use crate::StepError;
use crate::arm::{Arm, ArmWorkspace, MomentumRegressor};
use crate::error::{is_input, is_time_step};
use crate::observer::{ExactPole, FirstOrder, StateVariableFilter};
use alloc::vec::Vec;

/// Memory of a viscoelastic rope within a session, s.
const CREEP_S: f64 = 30.0;
/// Travel after which friction surely points against it, rad: several times what quantisation makes
/// a standing joint seem to move.
const SURE_STROKE_RAD: f64 = 10e-3;
/// Signals that are low-passed per joint.
const LAGS: usize = 13 + ENCODER;

/// Makes blocks from samples.
#[derive(Debug, Clone)]
pub struct FeatureObserver {
    arm: Arm,
    config: FeatureConfig,
    ws: ArmWorkspace,
    now: MomentumRegressor,
    before: MomentumRegressor,
    q: Vec<StateVariableFilter>,
    theta: Vec<StateVariableFilter>,
    z: Vec<f64>,
    /// Bounds of the friction state: it may be anything when a recording begins.
    z_bounds: Vec<[f64; 2]>,
    q_at_z: Vec<f64>,
    torque: Vec<StateVariableFilter>,
    motor_z: Vec<f64>,
    theta_at_z: Vec<f64>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    /// Low-passed, in the order of [`FeatureObserver::lag_inputs`], one set per joint.
    lags: Vec<[FirstOrder; LAGS]>,
    phi: Vec<f64>,
    /// The matched deflection once more, slowly.
    slow: Vec<FirstOrder>,
    sum: Block,
    count: u32,
    since_start_s: f64,
    since_regressor_s: f64,
    block_start_s: f64,
    started: bool,
}

impl FeatureObserver {
    /// Storage for `arm`. This is where memory is allocated, once.
    pub fn new(arm: &Arm, config: FeatureConfig) -> Self {
        let n = arm.dof();
        let regressor = MomentumRegressor::new(arm);
        let columns = regressor.columns();
        Self {
            arm: arm.clone(),
            config,
            ws: ArmWorkspace::new(arm),
            now: regressor.clone(),
            before: regressor,
            q: alloc::vec![StateVariableFilter::default(); n],
            theta: alloc::vec![StateVariableFilter::default(); n],
            z: alloc::vec![0.0; n],
            z_bounds: alloc::vec![[-1.0, 1.0]; n],
            q_at_z: alloc::vec![0.0; n],
            torque: alloc::vec![StateVariableFilter::default(); n],
            motor_z: alloc::vec![0.0; n],
            theta_at_z: alloc::vec![0.0; n],
            positions: alloc::vec![0.0; n],
            velocities: alloc::vec![0.0; n],
            lags: alloc::vec![[FirstOrder::default(); LAGS]; n],
            phi: alloc::vec![0.0; n * columns],
            slow: alloc::vec![FirstOrder::default(); n],
            sum: Block::zero(n, columns),
            count: 0,
            since_start_s: 0.0,
            since_regressor_s: 0.0,
            block_start_s: 0.0,
            started: false,
        }
    }

    /// The next sample starts anew, as after a gap. Time goes on.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn reset(&mut self) {
        self.started = false;
    }

    /// Time since the first sample, s, gaps not counted.
    pub fn since_start_s(&self) -> f64 {
        self.since_start_s
    }

    /// Takes a sample; returns whether a block is complete (see [`FeatureObserver::block`]).
    ///
    /// * `q`, `theta_measured`: `n`, rad; `temperature_c` may be NaN.
    /// * `motor_torque`: `n`, N·m, reflected to the joint; NaN where it isn't recorded.
    ///
    /// # Errors
    /// [`StepError`]; the state is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn step(
        &mut self,
        dt_s: f64,
        q: &[f64],
        theta_measured: &[f64],
        motor_torque: &[f64],
        temperature_c: f64,
    ) -> Result<bool, StepError> {
        let n = self.arm.dof();
        if q.len() != n || theta_measured.len() != n || motor_torque.len() != n {
            return Err(StepError::Length);
        }
        if q.iter().chain(theta_measured).any(|x| !is_input(*x)) {
            return Err(StepError::NotFinite);
        }
        if !self.started {
            return self.start(q, theta_measured, motor_torque).map(|()| false);
        }
        if !is_time_step(dt_s) {
            return Err(StepError::TimeStep);
        }
        let w = self.config.cutoff_rad_per_s;
        let decay = StateVariableFilter::decay(w, dt_s);
        for (filter, x) in self.q.iter_mut().zip(q) {
            filter.step(w, dt_s, decay, *x);
        }
        for (filter, x) in self.theta.iter_mut().zip(theta_measured) {
            filter.step(w, dt_s, decay, *x);
        }
        for (filter, x) in self.torque.iter_mut().zip(motor_torque) {
            // A torque that comes back after a gap starts its filter anew.
            if filter.value().is_finite() {
                filter.step(w, dt_s, decay, *x);
            } else {
                *filter = StateVariableFilter::settled_at(*x);
            }
        }
        self.since_start_s += dt_s;
        self.since_regressor_s += dt_s;
        if self.since_regressor_s + 0.5 * dt_s < self.config.regressor_step_s {
            return Ok(false);
        }
        let step_s = self.since_regressor_s;
        self.since_regressor_s = 0.0;
        self.regress(step_s)?;
        if self.since_start_s - self.block_start_s < self.settling_s() && self.count == 0 {
            return Ok(false);
        }
        self.accumulate(temperature_c);
        let blocks = self.since_start_s - self.sum.time_s;
        if blocks < self.config.block_s {
            return Ok(false);
        }
        self.average();
        Ok(true)
    }

    /// Time the filters need to forget a start, s.
    fn settling_s(&self) -> f64 {
        7.0 / self.config.gain_per_s + 9.0 / self.config.cutoff_rad_per_s
    }

    fn start(&mut self, q: &[f64], theta: &[f64], torque: &[f64]) -> Result<(), StepError> {
        self.velocities.fill(0.0);
        self.arm
            .momentum_regressor(&mut self.ws, q, &self.velocities, &mut self.now)?;
        for (filter, x) in self.q.iter_mut().zip(q) {
            *filter = StateVariableFilter::settled_at(*x);
        }
        for (filter, x) in self.theta.iter_mut().zip(theta) {
            *filter = StateVariableFilter::settled_at(*x);
        }
        for (filter, x) in self.torque.iter_mut().zip(torque) {
            *filter = StateVariableFilter::settled_at(*x);
        }
        self.z.fill(0.0);
        self.z_bounds.fill([-1.0, 1.0]);
        self.q_at_z.copy_from_slice(q);
        self.motor_z.fill(0.0);
        self.theta_at_z.copy_from_slice(theta);
        for (phi, a) in self.phi.iter_mut().zip(&self.now.a) {
            *phi = -a;
        }
        core::mem::swap(&mut self.now, &mut self.before);
        for i in 0..self.lags.len() {
            let inputs = self.lag_inputs(i);
            for (lag, u) in self.lags[i].iter_mut().zip(inputs) {
                *lag = FirstOrder::settled_at(u);
            }
            let [deflection, ..] = inputs;
            self.slow[i] = FirstOrder::settled_at(deflection);
        }
        self.count = 0;
        self.clear_sums();
        self.since_regressor_s = 0.0;
        self.block_start_s = self.since_start_s;
        self.started = true;
        Ok(())
    }

    /// Brings `Φ` and the other low-passed signals to now.
    fn regress(&mut self, step_s: f64) -> Result<(), StepError> {
        for (i, filter) in self.q.iter().enumerate() {
            self.positions[i] = filter.value();
            self.velocities[i] = filter.rate();
        }
        self.arm.momentum_regressor(
            &mut self.ws,
            &self.positions,
            &self.velocities,
            &mut self.now,
        )?;
        let pole = ExactPole::new(self.config.gain_per_s, step_s);
        let slow = ExactPole::new(1.0 / CREEP_S, step_s);
        let rate = (1.0 - pole.a) / step_s;
        let now = self.now.p.iter().zip(&self.now.a);
        let before = self.before.p.iter().zip(&self.before.a);
        for ((phi, (p1, a1)), (p0, a0)) in self.phi.iter_mut().zip(now).zip(before) {
            *phi = pole.a * *phi + rate * (p1 - p0) - pole.w0 * a0 - pole.w1 * a1;
        }
        core::mem::swap(&mut self.now, &mut self.before);
        let stroke = self.config.presliding_rad;
        for i in 0..self.lags.len() {
            let moved = self.positions[i] - self.q_at_z[i];
            self.q_at_z[i] = self.positions[i];
            self.z[i] = (self.z[i] + moved / stroke).clamp(-1.0, 1.0);
            for z in &mut self.z_bounds[i] {
                *z = (*z + moved / SURE_STROKE_RAD).clamp(-1.0, 1.0);
            }
            let theta = self.theta[i].value();
            let turned = theta - self.theta_at_z[i];
            self.theta_at_z[i] = theta;
            self.motor_z[i] = (self.motor_z[i] + turned / stroke).clamp(-1.0, 1.0);
            let inputs = self.lag_inputs(i);
            for (lag, u) in self.lags[i].iter_mut().zip(inputs) {
                // Not a number is "not recorded"; it must not stay in the lag for ever.
                if lag.output().is_finite() {
                    lag.step(&pole, u);
                } else {
                    *lag = FirstOrder::settled_at(u);
                }
            }
            let deflection = self.lags[i].first().map_or(0.0, FirstOrder::output);
            self.slow[i].step(&slow, deflection);
        }
        Ok(())
    }

    fn clear_sums(&mut self) {
        let s = &mut self.sum;
        s.time_s = self.since_start_s;
        for column in s.sums() {
            column.fill(0.0);
        }
        s.temperature_c = 0.0;
        self.count = 0;
    }

    fn accumulate(&mut self, temperature_c: f64) {
        if self.count == 0 {
            self.clear_sums();
        }
        let s = &mut self.sum;
        for (sum, phi) in s.phi.iter_mut().zip(&self.phi) {
            *sum += phi;
        }
        let gain = self.config.gain_per_s;
        for (i, lags) in self.lags.iter().enumerate() {
            let [
                y,
                y_square,
                y_cube,
                turned,
                z,
                z_unknown,
                dq,
                z_load,
                torque,
                velocity,
                motor_z,
                motor_z_load,
                stood,
                encoder @ ..,
            ] = lags.each_ref().map(FirstOrder::output);
            s.y[i] += y;
            s.y_square[i] += y_square;
            s.y_cube[i] += y_cube;
            s.y_slow[i] += self.slow[i].output();
            s.turned[i] += turned;
            s.z[i] += z;
            s.z_unknown[i] += z_unknown;
            s.dq[i] += dq;
            s.z_load[i] += z_load;
            s.motor_torque[i] += torque;
            s.motor_acceleration[i] += gain * (self.theta[i].rate() - velocity);
            s.motor_velocity[i] += velocity;
            s.motor_z[i] += motor_z;
            s.motor_z_load[i] += motor_z_load;
            s.motor_stood[i] += stood;
            for (sum, e) in s.encoder[i * ENCODER..].iter_mut().zip(encoder) {
                *sum += e;
            }
        }
        s.temperature_c += temperature_c;
        self.count += 1;
    }

    fn average(&mut self) {
        let scale = 1.0 / f64::from(self.count.max(1));
        let s = &mut self.sum;
        for column in s.sums() {
            for x in column.iter_mut() {
                *x *= scale;
            }
        }
        s.temperature_c *= scale;
        s.q.copy_from_slice(&self.positions);
        s.time_s = 0.5 * (s.time_s + self.since_start_s);
        self.count = 0;
    }

    /// The block just completed.
    pub fn block(&self) -> &Block {
        &self.sum
    }

    /// What is low-passed for joint `i`.
    fn lag_inputs(&self, i: usize) -> [f64; LAGS] {
        /// Below this speed a drive's friction may point either way, rad/s.
        const STANDS_RAD_PER_S: f64 = 0.05;
        let (q, theta) = (&self.q[i], &self.theta[i]);
        let deflection = theta.value() - q.value();
        let (s1, c1) = libm::sincos(q.value());
        let (s2, c2) = (2.0 * s1 * c1, c1 * c1 - s1 * s1);
        let [low, high] = self.z_bounds[i];
        let z_unknown = 0.5 * (high - low);
        let z = self.z[i] * (1.0 - z_unknown);
        let stands = theta.rate().abs() < STANDS_RAD_PER_S;
        [
            deflection,
            deflection * deflection,
            deflection * deflection * deflection,
            q.value(),
            z,
            z_unknown,
            q.rate(),
            z * deflection.abs(),
            self.torque[i].value(),
            theta.rate(),
            self.motor_z[i],
            self.motor_z[i] * deflection.abs(),
            if stands { 1.0 } else { 0.0 },
            s1,
            c1,
            s2,
            c2,
        ]
    }
}
