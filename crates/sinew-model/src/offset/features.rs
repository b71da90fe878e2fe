//! From samples to block features: an equation per joint that is linear in what is unknown.
//!
//! ```text
//! y = LP[theta_measured − q] = delta_e + s(κ τ) + encoder error(q) + noise
//! τ = Φ π + F_c LP[z] + F_v LP[dq] + μ LP[z |τ|],   Φ = K_I (P − LP[P]) − LP[A]
//! ```
//!
//! `Φ` is the momentum-filtered torque regressor: what the observer does to `p` and `α`, done to
//! the columns of their regressors, so no acceleration is needed and the lag of `Φ` is that of
//! `y`. Everything is averaged over blocks of a fifth of a second.

use crate::StepError;
use crate::arm::{Arm, ArmWorkspace, MomentumRegressor};
use crate::error::{is_input, is_time_step};
use crate::observer::{ExactPole, FirstOrder, StateVariableFilter};
use alloc::vec::Vec;

/// How features are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureConfig {
    /// Pole of the matched low-pass, 1/s.
    pub gain_per_s: f64,
    /// Velocity filter, rad/s.
    pub cutoff_rad_per_s: f64,
    /// Regressors are computed at most this often, s: the filtered positions are smooth.
    pub regressor_step_s: f64,
    /// Length of a block, s.
    pub block_s: f64,
    /// Stroke over which joint friction builds up, rad (pre-sliding).
    pub presliding_rad: f64,
}

impl Default for FeatureConfig {
    fn default() -> Self {
        Self {
            gain_per_s: 3.0,
            cutoff_rad_per_s: 60.0,
            regressor_step_s: 4e-3,
            block_s: 0.2,
            presliding_rad: 1e-3,
        }
    }
}

/// Averages over one block.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Middle of the block, s since the first sample.
    pub time_s: f64,
    /// Filtered joint position at the end of the block, `n`, rad.
    pub q: Vec<f64>,
    /// Filtered `theta_measured − q`, `n`, rad.
    pub y: Vec<f64>,
    /// `Φ`, row-major `n × 10 n`, N·m per parameter unit.
    pub phi: Vec<f64>,
    /// Friction state, −1…1, `n`.
    pub z: Vec<f64>,
    /// Joint velocity, `n`, rad/s.
    pub dq: Vec<f64>,
    /// Friction state times the size of the spring's torque over its stiffness, `n`, rad.
    pub z_load: Vec<f64>,
    /// Sine and cosine of once and twice `q`, `n × 4`.
    pub encoder: Vec<f64>,
    /// Temperature, °C; NaN where not recorded.
    pub temperature_c: f64,
}

/// Number of encoder columns per joint.
pub(super) const ENCODER: usize = 4;

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
    q_at_z: Vec<f64>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    /// Low-passed: y, z, dq, z_load, encoder columns, one set per joint.
    lags: Vec<[FirstOrder; 4 + ENCODER]>,
    phi: Vec<f64>,
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
            q_at_z: alloc::vec![0.0; n],
            positions: alloc::vec![0.0; n],
            velocities: alloc::vec![0.0; n],
            lags: alloc::vec![[FirstOrder::default(); 4 + ENCODER]; n],
            phi: alloc::vec![0.0; n * columns],
            sum: Block {
                time_s: 0.0,
                q: alloc::vec![0.0; n],
                y: alloc::vec![0.0; n],
                phi: alloc::vec![0.0; n * columns],
                z: alloc::vec![0.0; n],
                dq: alloc::vec![0.0; n],
                z_load: alloc::vec![0.0; n],
                encoder: alloc::vec![0.0; n * ENCODER],
                temperature_c: 0.0,
            },
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
        temperature_c: f64,
    ) -> Result<bool, StepError> {
        let n = self.arm.dof();
        if q.len() != n || theta_measured.len() != n {
            return Err(StepError::Length);
        }
        if q.iter().chain(theta_measured).any(|x| !is_input(*x)) {
            return Err(StepError::NotFinite);
        }
        if !self.started {
            return self.start(q, theta_measured).map(|()| false);
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

    fn start(&mut self, q: &[f64], theta: &[f64]) -> Result<(), StepError> {
        self.velocities.fill(0.0);
        self.arm
            .momentum_regressor(&mut self.ws, q, &self.velocities, &mut self.now)?;
        for (filter, x) in self.q.iter_mut().zip(q) {
            *filter = StateVariableFilter::settled_at(*x);
        }
        for (filter, x) in self.theta.iter_mut().zip(theta) {
            *filter = StateVariableFilter::settled_at(*x);
        }
        self.z.fill(0.0);
        self.q_at_z.copy_from_slice(q);
        for (phi, a) in self.phi.iter_mut().zip(&self.now.a) {
            *phi = -a;
        }
        core::mem::swap(&mut self.now, &mut self.before);
        for (i, lags) in self.lags.iter_mut().enumerate() {
            let inputs = lag_inputs(&self.q[i], &self.theta[i], 0.0);
            for (lag, u) in lags.iter_mut().zip(inputs) {
                *lag = FirstOrder::settled_at(u);
            }
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
        let rate = (1.0 - pole.a) / step_s;
        let now = self.now.p.iter().zip(&self.now.a);
        let before = self.before.p.iter().zip(&self.before.a);
        for ((phi, (p1, a1)), (p0, a0)) in self.phi.iter_mut().zip(now).zip(before) {
            *phi = pole.a * *phi + rate * (p1 - p0) - pole.w0 * a0 - pole.w1 * a1;
        }
        core::mem::swap(&mut self.now, &mut self.before);
        for (i, lags) in self.lags.iter_mut().enumerate() {
            let moved = self.positions[i] - self.q_at_z[i];
            self.q_at_z[i] = self.positions[i];
            self.z[i] = (self.z[i] + moved / self.config.presliding_rad).clamp(-1.0, 1.0);
            let inputs = lag_inputs(&self.q[i], &self.theta[i], self.z[i]);
            for (lag, u) in lags.iter_mut().zip(inputs) {
                lag.step(&pole, u);
            }
        }
        Ok(())
    }

    fn clear_sums(&mut self) {
        let s = &mut self.sum;
        s.time_s = self.since_start_s;
        for column in [
            &mut s.y,
            &mut s.phi,
            &mut s.z,
            &mut s.dq,
            &mut s.z_load,
            &mut s.encoder,
        ] {
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
        for (i, lags) in self.lags.iter().enumerate() {
            let at = |k: usize| lags.get(k).map_or(0.0, FirstOrder::output);
            s.y[i] += at(0);
            s.z[i] += at(1);
            s.dq[i] += at(2);
            s.z_load[i] += at(3);
            for k in 0..ENCODER {
                s.encoder[i * ENCODER + k] += at(4 + k);
            }
        }
        s.temperature_c += temperature_c;
        self.count += 1;
    }

    fn average(&mut self) {
        let scale = 1.0 / f64::from(self.count.max(1));
        let s = &mut self.sum;
        for column in [
            &mut s.y,
            &mut s.phi,
            &mut s.z,
            &mut s.dq,
            &mut s.z_load,
            &mut s.encoder,
        ] {
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
}

/// What is low-passed for one joint, in the order of the lags.
fn lag_inputs(q: &StateVariableFilter, theta: &StateVariableFilter, z: f64) -> [f64; 4 + ENCODER] {
    let deflection = theta.value() - q.value();
    let (s1, c1) = libm::sincos(q.value());
    let (s2, c2) = (2.0 * s1 * c1, c1 * c1 - s1 * s1);
    [
        deflection,
        z,
        q.rate(),
        z * deflection.abs(),
        s1,
        c1,
        s2,
        c2,
    ]
}
