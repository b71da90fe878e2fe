//! Conversion of samples to block features, with one equation per joint that is linear in the unknown parameters.
//!
//! ```text
//! LP[x + η x³] = κ τ,   x = theta_measured − q − delta_e − encoder error(q) − noise
//! τ = Φ π + F_c LP[z] + F_v LP[dq] + μ LP[z |τ|],   Φ = K_I (P − LP[P]) − LP[A]
//! ```
//!
//! `Φ` is the momentum-filtered torque regressor: the filter that the observer applies to `p` and `α` is applied to
//! the columns of their regressors. No acceleration is needed, and the lag of `Φ` is that of `y`. Only the columns of
//! the base parameters are stored, because the others are linear combinations of them. All signals are averaged over
//! blocks of 0.2 s.
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

use super::block::{Block, REST_RAD, copy};
use super::config::FeatureConfig;
use super::effects::ENCODER;
use super::joint_signals::{JointSignals, Lags, Spring};
use crate::StepError;
use crate::arm::{Arm, ArmWorkspace, MomentumRegressor, PARAMETERS_PER_BODY};
use crate::error::{is_input, is_time_step};
use crate::observer::{DoublePole, ExactPole, FirstOrder, StateVariableFilter};
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
    /// Columns of the base parameters in the regressors.
    base: Vec<usize>,
    /// These columns of `P` and `A` when they were last computed, `n × r`.
    before: Vec<[f64; 2]>,
    joints: Vec<JointSignals>,
    /// Filter weights of the last sample, and its time step, s.
    pole: DoublePole,
    dt_s: f64,
    lags: Lags,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    /// Position at which the arm is at rest, and the duration of the rest, s.
    rest_position: Vec<f64>,
    stood_s: f64,
    phi: Vec<f64>,
    /// Routings of tendons that cross several joints, and room for `Φ` of a block.
    routes: Option<(Routings, Vec<f64>)>,
    /// Additional signals of groups with an equation per joint.
    pulls: PullSignals,
    sum: Block,
    count: u32,
    since_start_s: f64,
    since_regressor_s: f64,
    block_start_s: f64,
    started: bool,
}

/// Filtered signals of groups with an equation per joint; empty if there is none.
#[derive(Debug, Clone, Default)]
struct PullSignals {
    /// Torque by the tension sensor of every axis.
    tension_nm: Vec<StateVariableFilter>,
    lagged_nm: Vec<FirstOrder>,
    /// Moment arms that vary, and these times the deflection of their tendon.
    arms: Vec<[FirstOrder; 2]>,
}

/// Whether two time steps are equal up to rounding, so that the filter weights (an exponential) can be reused.
fn is_same_step(a_s: f64, b_s: f64) -> bool {
    (a_s - b_s).abs() <= 1e-9 * b_s
}

impl FeatureObserver {
    /// Storage for `arm`. This is where memory is allocated, once.
    pub fn new(arm: &Arm, config: FeatureConfig) -> Self {
        Self::of_base(arm, config, arm.base_parameters().columns)
    }

    /// Creates an observer with precomputed columns of base parameters ([`Arm::base_parameters`]): computing them takes
    /// `O(n³)` numbers, more memory than a microcontroller has.
    ///
    /// # Errors
    /// Returns [`StepError::Length`] if they are not ascending, or if the arm has fewer.
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
            rest_position: alloc::vec![0.0; n],
            stood_s: 0.0,
            phi: alloc::vec![0.0; n * columns],
            routes: None,
            pulls: PullSignals::default(),
            sum: Block::zero(n, columns),
            count: 0,
            since_start_s: 0.0,
            since_regressor_s: 0.0,
            block_start_s: 0.0,
            started: false,
        }
    }

    /// Sets the routings of tendons that cross several joints, if there are any. Allocates.
    ///
    /// `theta_measured` of a step is then that of [`Feeder::theta`](crate::feeder::Feeder::theta), and a block's equation of joint `i` is that
    /// of the tendon paired with it: `y_i = theta_i − Σ_j rho_ij q_j` and `Φ_i = Σ_j B_ij Φ_j`. In a group with an equation per joint `Φ_j` is
    /// that of the joint. There are as many axes as transmissions, and slices of a step have one entry per axis.
    #[must_use]
    pub fn with_transmissions(mut self, transmissions: &[Option<Transmission>]) -> Self {
        let axes = transmissions.len().max(self.arm.dof());
        let columns = self.base.len();
        if axes > self.joints.len() {
            self.joints.resize(axes, JointSignals::default());
            for of_axes in [
                &mut self.positions,
                &mut self.velocities,
                &mut self.rest_position,
            ] {
                of_axes.resize(axes, 0.0);
            }
            self.phi.resize(axes * columns, 0.0);
            self.sum = Block::zero(axes, columns);
        }
        if let Some(routes) = Routings::of(transmissions) {
            if routes.has_pulls() {
                let arms = routes.varying().len();
                self.sum.tension_nm = alloc::vec![0.0; axes];
                self.sum.arm = alloc::vec![0.0; arms];
                self.sum.arm_y = alloc::vec![0.0; arms];
                self.pulls = PullSignals {
                    tension_nm: alloc::vec![StateVariableFilter::settled_at(f64::NAN); axes],
                    lagged_nm: alloc::vec![FirstOrder::settled_at(f64::NAN); axes],
                    arms: alloc::vec![[FirstOrder::default(); 2]; arms],
                };
            }
            self.routes = Some((routes, self.phi.clone()));
        }
        self
    }

    /// Re-initialises the filters with the next sample, as after a gap. The time continues.
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

    /// Adds a sample; returns whether a block is complete (see [`FeatureObserver::block`]).
    ///
    /// * `q`, `theta_measured`: `n`, rad; `temperature_c` may be NaN.
    /// * `motor_torque`: `n`, N·m, reflected to the joint; NaN if it is not recorded.
    ///
    /// # Errors
    /// Returns a [`StepError`] for an invalid input; the state is then unchanged.
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
        self.step_with_tension(
            dt_s,
            [q, theta_measured],
            [motor_torque, &[]],
            temperature_c,
        )
    }

    /// Adds a sample with tensions, as [`FeatureObserver::step`].
    ///
    /// * `tension_n`: `n` or empty, N; NaN if it is not recorded. Used in groups with an equation per joint.
    ///
    /// # Errors
    /// Returns a [`StepError`] for an invalid input; the state is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn step_with_tension(
        &mut self,
        dt_s: f64,
        [q, theta_measured]: [&[f64]; 2],
        [motor_torque, tension_n]: [&[f64]; 2],
        temperature_c: f64,
    ) -> Result<bool, StepError> {
        let n = self.joints.len();
        if q.len() != n || theta_measured.len() != n || motor_torque.len() != n {
            return Err(StepError::Length);
        }
        if !(tension_n.is_empty() || tension_n.len() == n) {
            return Err(StepError::Length);
        }
        if q.iter().chain(theta_measured).any(|x| !is_input(*x)) {
            return Err(StepError::NotFinite);
        }
        if !self.started {
            self.start(q, theta_measured, motor_torque)?;
            self.start_pulls(tension_n);
            return Ok(false);
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
            // A torque that returns after a gap re-initialises its filter.
            if joint.torque.value().is_finite() {
                joint.torque.step(&pole, *torque);
            } else {
                joint.torque = StateVariableFilter::settled_at(*torque);
            }
        }
        self.filter_tension(&pole, tension_n);
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
        let dof = self.arm.dof();
        let of_arm = (q.get(..dof)).zip(self.velocities.get(..dof));
        let (of_q, of_dq) = of_arm.ok_or(StepError::Length)?;
        self.arm
            .momentum_regressor(&mut self.ws, of_q, of_dq, &mut self.regressor)?;
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
        copy(&mut self.rest_position, q);
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
        let mut moved = self.positions.iter().zip(&self.rest_position);
        if moved.any(|(q, at)| (q - at).abs() > REST_RAD) {
            copy(&mut self.rest_position, &self.positions);
            self.stood_s = 0.0;
        }
        let dof = self.arm.dof();
        let of_arm = (self.positions.get(..dof)).zip(self.velocities.get(..dof));
        let (of_q, of_dq) = of_arm.ok_or(StepError::Length)?;
        self.arm
            .momentum_regressor(&mut self.ws, of_q, of_dq, &mut self.regressor)?;
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
        self.follow_pulls(&pole);
        Ok(())
    }

    /// Starts the filters of tensions and moment arms.
    fn start_pulls(&mut self, tension_n: &[f64]) {
        for i in 0..self.pulls.tension_nm.len() {
            let now = StateVariableFilter::settled_at(self.tension_nm(i, tension_n));
            if let Some(to) = self.pulls.tension_nm.get_mut(i) {
                *to = now;
            }
            if let Some(to) = self.pulls.lagged_nm.get_mut(i) {
                *to = FirstOrder::settled_at(now.value());
            }
        }
        for v in 0..self.pulls.arms.len() {
            let inputs = self.varying(v);
            if let Some(to) = self.pulls.arms.get_mut(v) {
                *to = inputs.map(FirstOrder::settled_at);
            }
        }
    }

    /// Brings the tensions to a sample.
    fn filter_tension(&mut self, pole: &DoublePole, tension_n: &[f64]) {
        for i in 0..self.pulls.tension_nm.len() {
            let now = self.tension_nm(i, tension_n);
            let Some(filter) = self.pulls.tension_nm.get_mut(i) else {
                return;
            };
            // A tension that returns after a gap re-initialises its filter.
            if filter.value().is_finite() {
                filter.step(pole, now);
            } else {
                *filter = StateVariableFilter::settled_at(now);
            }
        }
    }

    /// Brings the low-passed tensions and moment arms to now.
    fn follow_pulls(&mut self, pole: &ExactPole) {
        let tensions = self.pulls.lagged_nm.iter_mut().zip(&self.pulls.tension_nm);
        for (lag, tension) in tensions {
            if lag.output().is_finite() {
                lag.step(pole, tension.value());
            } else {
                *lag = FirstOrder::settled_at(tension.value());
            }
        }
        for v in 0..self.pulls.arms.len() {
            let inputs = self.varying(v);
            let lags = self.pulls.arms.get_mut(v).into_iter().flatten();
            for (lag, u) in lags.zip(inputs) {
                lag.step(pole, u);
            }
        }
    }

    /// Torque of the tendon on an axis by its tension, N·m; NaN where none is recorded.
    fn tension_nm(&self, i: usize, tension_n: &[f64]) -> f64 {
        let pull = self.routes.as_ref().and_then(|(routes, _)| routes.pull(i));
        let metres = pull.and_then(|pull| pull.metres_per_rad);
        match (metres, tension_n.get(i)) {
            (Some(metres), Some(tension)) => metres * tension,
            _ => f64::NAN,
        }
    }

    /// Moment arm number `v` of those that vary, and this times the deflection of its tendon.
    fn varying(&self, v: usize) -> [f64; 2] {
        let varying = self
            .routes
            .as_ref()
            .and_then(|(routes, _)| routes.varying().get(v));
        let Some((i, j, arm)) = varying else {
            return [0.0; 2];
        };
        let q = self.joints.get(*j).map_or(0.0, |joint| joint.q.value());
        let y = self.joints.get(*i).map_or(0.0, JointSignals::deflection);
        let [_, arm, _] = arm.evaluate(q);
        [arm, arm * y]
    }

    /// Spring and motor of joint `i` now.
    fn spring(&self, i: usize) -> Option<Spring> {
        let joint = self.joints.get(i)?;
        let own = joint.spring();
        let Some((routes, _)) = &self.routes else {
            return Some(own);
        };
        let of_all = |of: fn(&JointSignals) -> f64| self.joints.iter().map(of);
        let q = of_all(|j| j.q.value());
        Some(Spring {
            load_rad: routes.joint_deflection(i, of_all(JointSignals::deflection)),
            pull_rad: routes.pull_rad(i, own.pull_rad),
            motor_rad: own.motor_rad + routes.moved_by_others(i, q.clone()),
            motor_rad_per_s: own.motor_rad_per_s
                + routes.speed_by_others(i, q, of_all(|j| j.q.rate())),
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
        for (sum, lag) in s.tension_nm.iter_mut().zip(&self.pulls.lagged_nm) {
            *sum += lag.output();
        }
        let arms = s.arm.iter_mut().zip(&mut s.arm_y).zip(&self.pulls.arms);
        for ((arm, arm_y), [of_arm, of_arm_y]) in arms {
            *arm += of_arm.output();
            *arm_y += of_arm_y.output();
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
            let rows = s.phi.chunks_exact_mut(columns).enumerate();
            // An equation per joint has the torque of the joint.
            let own = |i: usize| routes.pull(i).is_none() && routes.pulled(i).is_none();
            for (i, row) in rows.filter(|(i, _)| own(*i)) {
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

    /// Arm, configuration of the blocks, and columns of the base parameters.
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

    /// At every rate from 10 Hz to 100 kHz: rounding does not change the step, clock jitter of 1 ppm does.
    #[test]
    fn time_step_changes_only_with_clock() {
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
