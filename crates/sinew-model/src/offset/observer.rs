//! Computation of the offset of every joint from one sample.

use super::block::copy;
use super::config::{Comparison, OffsetConfig, OffsetConfigError, TorqueSource, VelocityFilter};
use crate::StepError;
use crate::arm::{Arm, ArmWorkspace};
use crate::error::{is_input, is_time_step};
use crate::observer::{DoublePole, FirstOrder, MomentumObserver, StateVariableFilter};
use crate::routings::Routings;
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// One sample of a robot. Slices have one entry per joint.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sample<'a> {
    /// Joint position, rad.
    pub q: &'a [f64],
    /// Measured motor position reflected to the joint, rad. Not looked at for rigid joints.
    pub theta_measured: &'a [f64],
    /// Joint velocity, rad/s; needed with [`VelocityFilter::Recorded`].
    pub dq: Option<&'a [f64]>,
    /// Measured elastic torque, N·m; needed by [`TorqueSource::TorqueSensor`].
    pub tau_el: Option<&'a [f64]>,
    /// Motor torque reflected to the joint, N·m; needed by [`TorqueSource::Motor`].
    pub tau_m: Option<&'a [f64]>,
    /// Known external torque, N·m, positive when applied to the robot.
    pub tau_ext: Option<&'a [f64]>,
}

/// Maximum filter cut-off, above which a filter has no effect at any sampling rate.
const MAX_CUTOFF_RAD_PER_S: f64 = 1e6;

/// Filters of one joint.
#[derive(Debug, Clone, Copy, Default)]
struct JointFilters {
    q: StateVariableFilter,
    theta: StateVariableFilter,
    /// Known torque that enters the observer: external, or the motor's.
    torque: StateVariableFilter,
    /// `theta − q` with the lag of the observed torque.
    deflection: FirstOrder,
}

/// Estimates every joint's offset `delta_e` sample by sample.
///
/// ```text
/// delta_e = theta_measured − q − tau_el / K            eq. (5)–(6)
/// ```
///
/// with `tau_el` from the source chosen; of a tendon that crosses several joints the torque is `B_i· tau_el`
/// ([`Coupling::paired`](crate::tendons::Coupling::paired)). With [`Comparison::Matched`] positions pass through the
/// filters that make `tau_el` lag, so that a motion cancels; the estimate then is that of about
/// `2/ω + 1/K_I` ago.
///
/// Right in differences: a wrong stiffness or mass adds an error proportional to the torque.
///
/// # Realtime
/// Everything is allocated at construction.
#[derive(Debug, Clone)]
pub struct OffsetObserver {
    arm: Arm,
    transmissions: Vec<Option<Transmission>>,
    /// Routings of tendons that cross several joints.
    routes: Option<Routings>,
    config: OffsetConfig,
    ws: ArmWorkspace,
    observer: MomentumObserver,
    filters: Vec<JointFilters>,
    // One entry per joint each.
    q: Vec<f64>,
    dq: Vec<f64>,
    external_torque: Vec<f64>,
    momentum: Vec<f64>,
    alpha: Vec<f64>,
    deflection: Vec<f64>,
    tau_el: Vec<f64>,
    delta_e: Vec<f64>,
    since_start_s: f64,
    started: bool,
}

impl OffsetObserver {
    /// Creates an estimator for `arm`, with one transmission per axis and `None` for a rigid joint. The offset of a
    /// rigid joint is NaN, as is that of a tendon whose group has one equation per joint.
    ///
    /// # Errors
    /// Returns an [`OffsetConfigError`], naming the joint and the value.
    pub fn new(
        arm: &Arm,
        transmissions: &[Option<Transmission>],
        config: OffsetConfig,
    ) -> Result<Self, OffsetConfigError> {
        let (n, dof) = (transmissions.len(), arm.dof());
        if n < dof {
            return Err(OffsetConfigError::Length {
                expected: dof,
                found: n,
            });
        }
        if let VelocityFilter::StateVariable { cutoff_rad_per_s } = config.velocity
            && !(cutoff_rad_per_s > 0.0 && cutoff_rad_per_s <= MAX_CUTOFF_RAD_PER_S)
        {
            return Err(OffsetConfigError::VelocityFilter { cutoff_rad_per_s });
        }
        for (joint, t) in transmissions.iter().enumerate() {
            let Some(t) = t else { continue };
            let k = t.stiffness_nm_per_rad;
            if !(k.is_finite() && k > 0.0) {
                return Err(OffsetConfigError::Stiffness {
                    joint,
                    stiffness_nm_per_rad: k,
                });
            }
            if config.source == TorqueSource::Motor && t.motor_inertia_kg_m2.is_none() {
                return Err(OffsetConfigError::MotorInertia { joint });
            }
        }
        if config.source == TorqueSource::Motor && config.velocity == VelocityFilter::Recorded {
            return Err(OffsetConfigError::MotorVelocity);
        }
        let observed = match config.source {
            TorqueSource::Motor => n,
            TorqueSource::Observer | TorqueSource::TorqueSensor => dof,
        };
        let gains = alloc::vec![config.gain_per_s; observed];
        let zeros = || alloc::vec![0.0; n];
        Ok(Self {
            arm: arm.clone(),
            transmissions: transmissions.to_vec(),
            routes: Routings::of(transmissions),
            config,
            ws: ArmWorkspace::new(arm),
            observer: MomentumObserver::new(&gains)?,
            filters: alloc::vec![JointFilters::default(); n],
            q: zeros(),
            dq: zeros(),
            external_torque: zeros(),
            momentum: zeros(),
            alpha: zeros(),
            deflection: zeros(),
            tau_el: zeros(),
            delta_e: alloc::vec![f64::NAN; n],
            since_start_s: 0.0,
            started: false,
        })
    }

    /// How it estimates.
    pub fn config(&self) -> &OffsetConfig {
        &self.config
    }

    /// Returns the model of the arm.
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// Forgets the past: the next step is a start. For gaps, clock jumps, a new recording.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn reset(&mut self) {
        self.started = false;
        self.observer.reset();
        self.since_start_s = 0.0;
    }

    /// Steps by `dt_s` to `sample`. The first sample after construction or a reset only initialises the observer,
    /// assuming that the robot was at rest, and ignores `dt_s`.
    ///
    /// # Errors
    /// Returns [`StepError::Length`] (also if the source needs a quantity that the sample lacks),
    /// [`StepError::NotFinite`] or [`StepError::TimeStep`]; the state is then unchanged, so that the caller can skip a
    /// bad sample and pass the time since the last good one with the next step.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    pub fn step(&mut self, dt_s: f64, sample: &Sample<'_>) -> Result<(), StepError> {
        self.check(dt_s, sample)?;
        let external_torque = match self.config.source {
            TorqueSource::Observer => sample.tau_ext,
            TorqueSource::TorqueSensor => sample.tau_el,
            TorqueSource::Motor => sample.tau_m,
        };
        self.filter(dt_s, sample, external_torque);
        match self.config.source {
            TorqueSource::Observer => self.link_side(dt_s, external_torque.is_some())?,
            TorqueSource::Motor => self.motor_side(dt_s)?,
            TorqueSource::TorqueSensor => self.measured(sample),
        }
        self.compare(sample);
        if self.started {
            self.since_start_s += dt_s;
        }
        self.started = true;
        Ok(())
    }

    /// Checks the inputs before any state changes.
    fn check(&self, dt_s: f64, sample: &Sample<'_>) -> Result<(), StepError> {
        let n = self.transmissions.len();
        let fits = |x: Option<&[f64]>| x.is_none_or(|x| x.len() == n);
        if sample.q.len() != n
            || sample.theta_measured.len() != n
            || !(fits(sample.dq)
                && fits(sample.tau_el)
                && fits(sample.tau_m)
                && fits(sample.tau_ext))
        {
            return Err(StepError::Length);
        }
        if self.started && !is_time_step(dt_s) {
            return Err(StepError::TimeStep);
        }
        let finite = |x: &[f64]| x.iter().all(|v| is_input(*v));
        if !finite(sample.q) {
            return Err(StepError::NotFinite);
        }
        if self.config.velocity == VelocityFilter::Recorded {
            let dq = sample.dq.ok_or(StepError::Length)?;
            if !finite(dq) {
                return Err(StepError::NotFinite);
            }
        }
        let needed = match self.config.source {
            TorqueSource::Observer => sample.tau_ext,
            TorqueSource::TorqueSensor => Some(sample.tau_el.ok_or(StepError::Length)?),
            TorqueSource::Motor => Some(sample.tau_m.ok_or(StepError::Length)?),
        };
        // External torque acts on every joint; the torques of a rigid joint itself are ignored.
        let every_joint = self.config.source == TorqueSource::Observer;
        for (i, transmission) in self.transmissions.iter().enumerate() {
            let elastic = transmission.is_some();
            let at = |x: &[f64]| x.get(i).is_some_and(|v| is_input(*v));
            if (elastic && !at(sample.theta_measured))
                || ((elastic || every_joint) && needed.is_some_and(|x| !at(x)))
            {
                return Err(StepError::NotFinite);
            }
        }
        Ok(())
    }

    /// Updates `q`, `dq`, the external torque and the filters of `theta` with this sample.
    fn filter(&mut self, dt_s: f64, sample: &Sample<'_>, external_torque: Option<&[f64]>) {
        let VelocityFilter::StateVariable {
            cutoff_rad_per_s: w,
        } = self.config.velocity
        else {
            copy(&mut self.q, sample.q);
            if let Some(dq) = sample.dq {
                copy(&mut self.dq, dq);
            }
            for (i, slot) in self.external_torque.iter_mut().enumerate() {
                *slot = external_torque
                    .and_then(|k| k.get(i))
                    .copied()
                    .unwrap_or(0.0);
            }
            return;
        };
        let pole = DoublePole::new(w, dt_s);
        let rows = self.filters.iter_mut().zip(&self.transmissions).zip(
            self.q
                .iter_mut()
                .zip(&mut self.dq)
                .zip(&mut self.external_torque),
        );
        for (i, ((filter, transmission), ((q, dq), slot))) in rows.enumerate() {
            let at = |x: &[f64]| x.get(i).copied().unwrap_or(0.0);
            // A rigid joint's motor side may be missing (NaN): it must not get in.
            let elastic = transmission.is_some();
            let theta = if elastic {
                at(sample.theta_measured)
            } else {
                0.0
            };
            let torque = external_torque.map_or(0.0, at);
            let torque = if torque.is_finite() { torque } else { 0.0 };
            if self.started {
                filter.q.step(&pole, at(sample.q));
                filter.theta.step(&pole, theta);
                filter.torque.step(&pole, torque);
            } else {
                filter.q = StateVariableFilter::settled_at(at(sample.q));
                filter.theta = StateVariableFilter::settled_at(theta);
                filter.torque = StateVariableFilter::settled_at(torque);
            }
            *q = filter.q.value();
            *dq = filter.q.rate();
            *slot = filter.torque.value();
        }
    }

    /// Elastic torque as measured. Eq. (5) compares samples of one time, so that nothing is filtered; matched,
    /// torque and positions pass the same filter.
    fn measured(&mut self, sample: &Sample<'_>) {
        let unfiltered = match self.config.comparison {
            Comparison::Paper => sample.tau_el,
            Comparison::Matched => None,
        };
        for (i, (tau, filtered)) in self
            .tau_el
            .iter_mut()
            .zip(&self.external_torque)
            .enumerate()
        {
            // A rigid joint's may be missing (NaN).
            let raw = unfiltered.and_then(|x| x.get(i)).copied();
            *tau = raw.filter(|x| x.is_finite()).unwrap_or(*filtered);
        }
    }

    /// Elastic torque from the arm's momentum.
    fn link_side(&mut self, dt_s: f64, tau_ext: bool) -> Result<(), StepError> {
        let dof = self.arm.dof();
        let of_arm = self.q.get(..dof).zip(self.dq.get(..dof));
        let (q, dq) = of_arm.ok_or(StepError::Length)?;
        let terms = self.arm.momentum(&mut self.ws, q, dq)?;
        let rows = self.alpha.iter_mut().zip(&self.transmissions);
        let inputs = terms.ct_dq.iter().zip(terms.g).zip(&self.dq);
        for ((alpha, transmission), ((ct_dq, g), dq)) in rows.zip(inputs) {
            let friction = transmission
                .as_ref()
                .map_or(0.0, |t| t.joint_friction.torque(*dq));
            *alpha = ct_dq - g - friction;
        }
        let of_arm = self.alpha.get(..dof).zip(self.external_torque.get(..dof));
        let (alpha, external_torque) = of_arm.ok_or(StepError::Length)?;
        self.observer
            .step(dt_s, terms.p, alpha, tau_ext.then_some(external_torque))?;
        copy(&mut self.tau_el, self.observer.torque());
        Ok(())
    }

    /// Elastic torque from the motors' momentum: `I_m ddtheta = (tau_m − friction) − tau_el` is
    /// the observer's equation for `p = −I_m dtheta`, `α = −(tau_m − friction)`.
    fn motor_side(&mut self, dt_s: f64) -> Result<(), StepError> {
        let rows = self.momentum.iter_mut().zip(&mut self.alpha);
        let inputs = self
            .transmissions
            .iter()
            .zip(&self.filters)
            .zip(&self.external_torque);
        for (i, ((p, alpha), ((transmission, filter), tau_m))) in rows.zip(inputs).enumerate() {
            (*p, *alpha) = match transmission {
                None => (0.0, 0.0),
                Some(t) => {
                    let others = self
                        .routes
                        .as_ref()
                        .map(|routes| routes.moved_by_others(i, self.dq.iter().copied()));
                    let dtheta = others.map_or(filter.theta.rate(), |x| filter.theta.rate() + x);
                    (
                        -t.motor_inertia_kg_m2.unwrap_or(0.0) * dtheta,
                        t.motor_friction.torque(dtheta) - tau_m,
                    )
                }
            };
        }
        self.observer
            .step(dt_s, &self.momentum, &self.alpha, None)?;
        copy(&mut self.tau_el, self.observer.torque());
        Ok(())
    }

    /// Eq. (5)–(6), with or without the lag of the observed torque.
    fn compare(&mut self, sample: &Sample<'_>) {
        let filtered = self.config.velocity != VelocityFilter::Recorded;
        let matched = self.config.comparison == Comparison::Matched;
        let lagging = self.config.source != TorqueSource::TorqueSensor;
        let rows = self
            .delta_e
            .iter_mut()
            .zip(&mut self.deflection)
            .zip(&mut self.filters)
            .zip(&self.transmissions);
        let positions = sample.theta_measured.iter().zip(sample.q);
        // A motor's torque is that of its tendon already.
        let routes = (self.routes.as_ref()).filter(|_| self.config.source != TorqueSource::Motor);
        // Axes without a joint are in groups with an equation per joint.
        let inputs = self.tau_el.iter().zip(self.observer.pole());
        for (i, (((((delta_e, out), filter), transmission), (tau_el, pole)), (theta, q))) in
            rows.zip(inputs).zip(positions).enumerate()
        {
            let Some(transmission) = transmission else {
                continue;
            };
            let mut deflection = theta - q;
            if matched && filtered {
                deflection = filter.theta.value() - filter.q.value();
            }
            if matched && lagging {
                if self.started {
                    deflection = filter.deflection.step(pole, deflection);
                } else {
                    filter.deflection = FirstOrder::settled_at(deflection);
                }
            }
            let torque = match routes {
                None => *tau_el,
                Some(routes) => routes.torque_of(i, self.tau_el.iter().copied()),
            };
            *out = deflection;
            // A group with an equation per joint does not have the torque of one tendon.
            if self
                .routes
                .as_ref()
                .is_some_and(|routes| routes.pull(i).is_some())
            {
                continue;
            }
            *delta_e = deflection - torque / transmission.stiffness_nm_per_rad;
        }
    }

    /// Offset `delta_e`, `n`, rad; NaN for rigid joints and before the first sample.
    pub fn delta_e(&self) -> &[f64] {
        &self.delta_e
    }

    /// Elastic torque from the source chosen, `n`, N·m.
    pub fn tau_el(&self) -> &[f64] {
        &self.tau_el
    }

    /// Deflection `theta_measured − q` as used in the comparison (delayed if the lag is matched), `n`, rad.
    pub fn deflection(&self) -> &[f64] {
        &self.deflection
    }

    /// Joint velocity as used, `n`, rad/s.
    pub fn dq(&self) -> &[f64] {
        &self.dq
    }

    /// Time since the first sample, s.
    pub fn since_start_s(&self) -> f64 {
        self.since_start_s
    }

    /// Time after which the error of the initial state (a robot in motion, an observer that assumes rest) has
    /// decreased to a thousandth, s: `7/K_I + 9/ω`, since `e⁻⁷` and
    /// `(1 + 9) e⁻⁹` are about 1e-3.
    pub fn settling_time_s(&self) -> f64 {
        let filter = match self.config.velocity {
            VelocityFilter::StateVariable { cutoff_rad_per_s } => 9.0 / cutoff_rad_per_s,
            VelocityFilter::Recorded => 0.0,
        };
        match self.config.source {
            TorqueSource::TorqueSensor if self.config.comparison == Comparison::Paper => 0.0,
            TorqueSource::TorqueSensor => filter,
            _ => filter + 7.0 / self.config.gain_per_s,
        }
    }

    /// Whether the start has faded.
    pub fn is_settled(&self) -> bool {
        self.started && self.since_start_s >= self.settling_time_s()
    }
}
