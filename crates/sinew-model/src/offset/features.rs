//! From samples to block features: an equation per joint that is linear in what is unknown.
//!
//! ```text
//! LP[x + η x³] = κ τ,   x = theta_measured − q − delta_e − encoder error(q) − noise
//! τ = Φ π + F_c LP[z] + F_v LP[dq] + μ LP[z |τ|],   Φ = K_I (P − LP[P]) − LP[A]
//! ```
//!
//! `Φ` is the momentum-filtered torque regressor: what the observer does to `p` and `α`, done to
//! the columns of their regressors, so no acceleration is needed and the lag of `Φ` is that of `y`.
//! Of its columns those of the base parameters are kept, which the others are made of. Everything
//! is averaged over blocks of a fifth of a second.
//!
//! Where the motor's torque `u` is recorded there is a second equation per joint,
//!
//! ```text
//! LP[u] = (1 + k)(τ + J LP[ddtheta] + F_m LP[z_m] + F_vm LP[dtheta] + μ_m LP[z_m |τ|]) + b
//! LP[ddtheta] = K_I (dtheta − LP[dtheta])
//! ```
//!
//! For a tendon that crosses several joints, `y` and `τ` are those of the tendon ([`Coupling::paired`](crate::tendons::Coupling::paired)).
//!
//! `z` and `z_m` are pre-sliding friction states in −1…1 driven by `q` and `theta`.

use super::block::{Block, STAND_RAD, copy};
use super::config::FeatureConfig;
use super::effects::ENCODER;
use super::joint_signals::{JointSignals, Lags, Spring};
use crate::StepError;
use crate::arm::{Arm, ArmWorkspace, MomentumRegressor, PARAMETERS_PER_BODY};
use crate::error::{is_input, is_time_step};
use crate::observer::{DoublePole, FirstOrder, StateVariableFilter};
use crate::routings::Routings;
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// Makes blocks from samples.
#[derive(Debug, Clone)]
pub struct FeatureObserver {
    arm: Arm,
    config: FeatureConfig,
    ws: ArmWorkspace,
    regressor: MomentumRegressor,
    /// Columns of the regressors that everything else follows from.
    base: Vec<usize>,
    /// These columns of `P` and `A` when they were last computed, `n × r`.
    before: Vec<[f64; 2]>,
    joints: Vec<JointSignals>,
    /// Of the last sample's filters, and its step, s.
    pole: DoublePole,
    dt_s: f64,
    lags: Lags,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    /// Where the arm stands, and for how long, s.
    stands_at: Vec<f64>,
    stood_s: f64,
    phi: Vec<f64>,
    /// Routings of tendons that cross several joints, and room for `Φ` of a block.
    routes: Option<(Routings, Vec<f64>)>,
    sum: Block,
    count: u32,
    since_start_s: f64,
    since_regressor_s: f64,
    block_start_s: f64,
    started: bool,
}

/// Whether steps differ by no more than rounding does: a filter's weights are worth an exponential.
fn is_same_step(a_s: f64, b_s: f64) -> bool {
    (a_s - b_s).abs() <= 1e-9 * b_s
}

impl FeatureObserver {
    /// Storage for `arm`. This is where memory is allocated, once.
    pub fn new(arm: &Arm, config: FeatureConfig) -> Self {
        Self::of_base(arm, config, arm.base_parameters().columns)
    }

    /// The same for columns of base parameters that are known already ([`Arm::base_parameters`]): finding them takes
    /// memory that a microcontroller hasn't got, `O(n³)` numbers.
    ///
    /// # Errors
    /// [`StepError::Length`] when they don't ascend, or the arm hasn't got as many.
    pub fn with_base_columns(
        arm: &Arm,
        config: FeatureConfig,
        columns: &[usize],
    ) -> Result<Self, StepError> {
        let there = columns
            .last()
            .is_none_or(|last| *last < arm.dof() * PARAMETERS_PER_BODY);
        match there && columns.is_sorted_by(|a, b| a < b) {
            true => Ok(Self::of_base(arm, config, columns.to_vec())),
            false => Err(StepError::Length),
        }
    }

    fn of_base(arm: &Arm, config: FeatureConfig, base: Vec<usize>) -> Self {
        let n = arm.dof();
        let regressor = MomentumRegressor::new(arm);
        let columns = base.len();
        Self {
            arm: arm.clone(),
            config,
            ws: ArmWorkspace::new(arm),
            regressor,
            base,
            before: alloc::vec![[0.0; 2]; n * columns],
            joints: alloc::vec![JointSignals::default(); n],
            pole: DoublePole::new(config.cutoff_rad_per_s, config.regressor_step_s),
            dt_s: config.regressor_step_s,
            lags: Lags::new(config.gain_per_s, config.regressor_step_s),
            positions: alloc::vec![0.0; n],
            velocities: alloc::vec![0.0; n],
            stands_at: alloc::vec![0.0; n],
            stood_s: 0.0,
            phi: alloc::vec![0.0; n * columns],
            routes: None,
            sum: Block::zero(n, columns),
            count: 0,
            since_start_s: 0.0,
            since_regressor_s: 0.0,
            block_start_s: 0.0,
            started: false,
        }
    }

    /// Takes the routings of tendons that cross several joints; without any nothing changes. Allocates.
    ///
    /// `theta_measured` of a step is then that of [`Feeder::theta`](crate::feeder::Feeder::theta), and a block's equation of joint `i` is that
    /// of the tendon paired with it: `y_i = theta_i − Σ_j rho_ij q_j` and `Φ_i = Σ_j B_ij Φ_j`.
    #[must_use]
    pub fn with_transmissions(mut self, transmissions: &[Option<Transmission>]) -> Self {
        let routes = Routings::of(transmissions);
        self.routes = routes.map(|routes| (routes, self.phi.clone()));
        self
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
        if !is_same_step(dt_s, self.dt_s) {
            self.dt_s = dt_s;
            self.pole = DoublePole::new(self.config.cutoff_rad_per_s, dt_s);
        }
        let pole = self.pole;
        let samples = q.iter().zip(theta_measured).zip(motor_torque);
        for (joint, ((q, theta), torque)) in self.joints.iter_mut().zip(samples) {
            joint.q.step(&pole, *q);
            joint.theta.step(&pole, *theta);
            // A torque that comes back after a gap starts its filter anew.
            if joint.torque.value().is_finite() {
                joint.torque.step(&pole, *torque);
            } else {
                joint.torque = StateVariableFilter::settled_at(*torque);
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
            .momentum_regressor(&mut self.ws, q, &self.velocities, &mut self.regressor)?;
        let samples = q.iter().zip(theta).zip(torque);
        for (joint, ((q, theta), torque)) in self.joints.iter_mut().zip(samples) {
            joint.start(*q, *theta, *torque);
        }
        for i in 0..self.joints.len() {
            let spring = self.spring(i);
            if let Some((joint, spring)) = self.joints.get_mut(i).zip(spring) {
                joint.settle(spring);
            }
        }
        self.follow_regressor(|phi, _, [_, a]| *phi = -a);
        copy(&mut self.stands_at, q);
        self.stood_s = 0.0;
        self.count = 0;
        self.clear_sums();
        self.since_regressor_s = 0.0;
        self.block_start_s = self.since_start_s;
        self.started = true;
        Ok(())
    }

    /// Brings `Φ` and the other low-passed signals to now.
    fn regress(&mut self, step_s: f64) -> Result<(), StepError> {
        let moving = self.positions.iter_mut().zip(&mut self.velocities);
        for (joint, (position, velocity)) in self.joints.iter().zip(moving) {
            (*position, *velocity) = (joint.q.value(), joint.q.rate());
        }
        self.stood_s += step_s;
        let mut moved = self.positions.iter().zip(&self.stands_at);
        if moved.any(|(q, at)| (q - at).abs() > STAND_RAD) {
            copy(&mut self.stands_at, &self.positions);
            self.stood_s = 0.0;
        }
        self.arm.momentum_regressor(
            &mut self.ws,
            &self.positions,
            &self.velocities,
            &mut self.regressor,
        )?;
        if !is_same_step(step_s, self.lags.step_s) {
            self.lags = Lags::new(self.config.gain_per_s, step_s);
        }
        let Lags { pole, slow, .. } = self.lags;
        let rate = (1.0 - pole.a) / step_s;
        self.follow_regressor(|phi, [p0, a0], [p1, a1]| {
            *phi = pole.a * *phi + rate * (p1 - p0) - pole.w0 * a0 - pole.w1 * a1;
        });
        for i in 0..self.joints.len() {
            let spring = self.spring(i);
            if let Some((joint, spring)) = self.joints.get_mut(i).zip(spring) {
                joint.follow(spring, self.config.presliding_rad, &pole, &slow);
            }
        }
        Ok(())
    }

    /// Spring and motor of joint `i` now.
    fn spring(&self, i: usize) -> Option<Spring> {
        let joint = self.joints.get(i)?;
        let own = joint.spring();
        let Some((routes, _)) = &self.routes else {
            return Some(own);
        };
        let of_all = |of: fn(&JointSignals) -> f64| self.joints.iter().map(of);
        Some(Spring {
            load_rad: routes.joint_deflection(i, of_all(JointSignals::deflection)),
            motor_rad: own.motor_rad + routes.moved_by_others(i, of_all(|j| j.q.value())),
            motor_rad_per_s: own.motor_rad_per_s
                + routes.moved_by_others(i, of_all(|j| j.q.rate())),
        })
    }

    /// Lets every entry of `Φ` see its entries of `P` and `A` before and now.
    fn follow_regressor(&mut self, step: impl Fn(&mut f64, [f64; 2], [f64; 2])) {
        let r = self.base.len().max(1);
        let joints = self
            .phi
            .chunks_exact_mut(r)
            .zip(self.before.chunks_exact_mut(r));
        for (joint, (phi, before)) in joints.enumerate() {
            let Some([p, a]) = self.regressor.rows(joint) else {
                return;
            };
            for ((phi, before), &column) in phi.iter_mut().zip(before).zip(&self.base) {
                if let (Some(p), Some(a)) = (p.get(column), a.get(column)) {
                    step(phi, *before, [*p, *a]);
                    *before = [*p, *a];
                }
            }
        }
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
        for (i, joint) in self.joints.iter().enumerate() {
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
            ] = joint.lags.each_ref().map(FirstOrder::output);
            let add = |column: &mut Vec<f64>, x: f64| {
                if let Some(sum) = column.get_mut(i) {
                    *sum += x;
                }
            };
            add(&mut s.y, y);
            add(&mut s.y_square, y_square);
            add(&mut s.y_cube, y_cube);
            add(&mut s.y_slow, joint.slow.output());
            add(&mut s.turned, turned);
            add(&mut s.z, z);
            add(&mut s.z_unknown, z_unknown);
            add(&mut s.dq, dq);
            add(&mut s.z_load, z_load);
            add(&mut s.motor_torque, torque);
            let acceleration = gain * (joint.motor_rate - velocity);
            add(&mut s.motor_acceleration, acceleration);
            add(&mut s.motor_velocity, velocity);
            add(&mut s.motor_z, motor_z);
            add(&mut s.motor_z_load, motor_z_load);
            add(&mut s.motor_stood, stood);
            let own = s.encoder.get_mut(i * ENCODER..).unwrap_or_default();
            for (sum, e) in own.iter_mut().zip(encoder) {
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
        if let Some((routes, of_joints)) = &mut self.routes {
            copy(of_joints, &s.phi);
            let columns = self.base.len().max(1);
            for (i, row) in s.phi.chunks_exact_mut(columns).enumerate() {
                for (k, to) in row.iter_mut().enumerate() {
                    let column = of_joints.iter().skip(k).step_by(columns);
                    *to = routes.torque_of(i, column.copied());
                }
            }
        }
        s.temperature_c *= scale;
        copy(&mut s.q, &self.positions);
        s.stood_s = self.stood_s;
        s.time_s = 0.5 * (s.time_s + self.since_start_s);
        self.count = 0;
    }

    /// The arm, how blocks are made of it, and the columns of its base parameters.
    #[cfg(feature = "wire")]
    pub(crate) fn made_for(&self) -> (&Arm, &FeatureConfig, &[usize]) {
        (&self.arm, &self.config, &self.base)
    }

    /// The block just completed.
    pub fn block(&self) -> &Block {
        &self.sum
    }
}

#[cfg(test)]
mod tests {
    use super::is_same_step;

    /// At every rate from 10 Hz to 100 kHz: what rounding does to a step is none, a clock that jitters by a millionth is.
    #[test]
    fn a_step_is_another_where_the_clock_says_so() {
        for step_s in [0.1, 4e-3, 1e-3, 1e-4, 1e-5] {
            // From times of a day: their last place is 1.5e-11 s, and whole nanoseconds are exact.
            let from_s = 86_400.0 * 1e9;
            let rounded_s = ((from_s + step_s * 1e9) - from_s) * 1e-9;
            assert!(is_same_step(rounded_s, step_s), "{step_s}");
            for share in [1e-6, 1e-3, 1.0] {
                assert!(!is_same_step(step_s * (1.0 + share), step_s), "{step_s}");
                assert!(!is_same_step(step_s / (1.0 + share), step_s), "{step_s}");
            }
        }
    }
}
