//! External torque of contacts with the robot.

use super::error::CorrectionError;
use super::tolerances::ContactTolerances;
use super::transmission::{Correction, JointCorrection};
use crate::StepError;
use crate::arm::{Arm, ArmWorkspace};
use crate::error::{is_input, is_time_step};
use crate::observer::{DoublePole, FirstOrder, MomentumObserver, StateVariableFilter};
use crate::offset::VelocityFilter;
use crate::routings::Routings;
use crate::transmission::{Friction, Transmission};
use alloc::vec::Vec;

/// How the external torque is estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExternalTorqueConfig {
    /// Observer gain `K_I`, 1/s.
    pub gain_per_s: f64,
    /// Source of the joint velocities.
    pub velocity: VelocityFilter,
}

impl Default for ExternalTorqueConfig {
    /// `K_I` = 30 1/s, filter at 60 rad/s: a contact is detectable after `2/ω + 1/K_I` = 67 ms, and a
    /// 13-bit encoder makes a noise of a few hundredths of a newton metre at the shoulder of a
    /// light arm.
    fn default() -> Self {
        Self {
            gain_per_s: 30.0,
            velocity: VelocityFilter::StateVariable {
                cutoff_rad_per_s: 60.0,
            },
        }
    }
}

/// Filters of one joint.
#[derive(Debug, Clone, Copy, Default)]
struct JointFilters {
    q: StateVariableFilter,
    tau_el: StateVariableFilter,
    /// `tau_el` with the lag of the estimate.
    lagging: FirstOrder,
}

/// External joint torque from the momentum observer, driven by the corrected elastic torque.
///
/// ```text
/// r = K_I (p − p₀ − ∫ (tau_el + Cᵀdq − g − tau_friction_joint + r) dt),   ṙ = K_I (tau_ext − r)
/// ```
///
/// with `tau_el` of [`Correction::elastic_torque`] and the exact pole of [`MomentumObserver`]. Positions and `tau_el`
/// pass through the same filter, so that motion cancels. Contacts, an unknown payload and all model errors are part of
/// `r`; an offset of `delta_e` left uncorrected appears as `−K delta_e`. With linear springs
/// and filtered velocities `r = K (delta_e − delta_e_hat)`, `delta_e_hat` the estimate of
/// [`OffsetObserver`](crate::offset::OffsetObserver): both use the same residual, one for contacts, the other for the
/// offset. One sample cannot determine both.
///
/// # Realtime
/// Everything is allocated at construction.
///
/// # Source
/// Kirchhoff, von Stryk, IROS 2018, eq. (7), with the measured torque on the spring's side;
/// De Luca et al., IROS 2006.
#[derive(Debug, Clone)]
pub struct ExternalTorqueObserver {
    arm: Arm,
    correction: Correction,
    config: ExternalTorqueConfig,
    tolerances: ContactTolerances,
    friction: Vec<Friction>,
    ws: ArmWorkspace,
    observer: MomentumObserver,
    filters: Vec<JointFilters>,
    // One entry per joint each.
    raw: Vec<f64>,
    q: Vec<f64>,
    dq: Vec<f64>,
    tau_el: Vec<f64>,
    alpha: Vec<f64>,
    tau_ext: Vec<f64>,
    threshold: Vec<f64>,
    since_start_s: f64,
    started: bool,
}

impl ExternalTorqueObserver {
    /// Creates an observer of `arm` with one transmission, correction and noise per joint. The external torque of a
    /// rigid joint (`None`) is NaN, because its elastic torque is not measurable.
    ///
    /// # Errors
    /// Returns a [`CorrectionError`] that names the joint and the value.
    pub fn new(
        arm: &Arm,
        transmissions: &[Option<Transmission>],
        corrections: &[JointCorrection],
        config: ExternalTorqueConfig,
        tolerances: ContactTolerances,
    ) -> Result<Self, CorrectionError> {
        let n = arm.dof();
        if transmissions.len() != n {
            return Err(CorrectionError::Length {
                expected: n,
                found: transmissions.len(),
            });
        }
        tolerances.check(n)?;
        if let VelocityFilter::StateVariable { cutoff_rad_per_s } = config.velocity
            && !(cutoff_rad_per_s > 0.0 && cutoff_rad_per_s <= 1e6)
        {
            return Err(CorrectionError::VelocityFilter { cutoff_rad_per_s });
        }
        let zeros = || alloc::vec![0.0; n];
        let friction =
            |t: &Option<Transmission>| t.as_ref().map_or(Friction::default(), |t| t.joint_friction);
        Ok(Self {
            correction: Correction::new(transmissions, corrections)?,
            observer: MomentumObserver::new(&alloc::vec![config.gain_per_s; n])?,
            ws: ArmWorkspace::new(arm),
            arm: arm.clone(),
            config,
            tolerances,
            friction: transmissions.iter().map(friction).collect(),
            filters: alloc::vec![JointFilters::default(); n],
            raw: zeros(),
            q: zeros(),
            dq: zeros(),
            tau_el: zeros(),
            alpha: zeros(),
            tau_ext: alloc::vec![f64::NAN; n],
            threshold: alloc::vec![f64::NAN; n],
            since_start_s: 0.0,
            started: false,
        })
    }

    /// Changes the correction of one joint's transmission; the estimate follows with its lag.
    ///
    /// # Errors
    /// Returns a [`CorrectionError`] for an invalid value; nothing is then changed.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn set(
        &mut self,
        joint: usize,
        correction: &JointCorrection,
    ) -> Result<(), CorrectionError> {
        self.correction.set(joint, correction)
    }

    /// Returns the corrections of the transmissions.
    pub fn correction(&self) -> &Correction {
        &self.correction
    }

    /// Forgets the past: the next step is a start.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn reset(&mut self) {
        self.started = false;
        self.observer.reset();
        self.since_start_s = 0.0;
    }

    /// Steps by `dt_s` to a sample. The first sample after construction or a reset only initialises the observer,
    /// assuming that the robot was at rest, and ignores `dt_s`.
    ///
    /// * `q`, `theta_measured`: `n`, rad. `dq`: `n`, rad/s, needed and used only with [`VelocityFilter::Recorded`].
    ///
    /// # Errors
    /// Returns [`StepError::Length`], [`StepError::NotFinite`] or [`StepError::TimeStep`] for an invalid input; the
    /// state is then unchanged, so that the caller can skip a bad sample.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    pub fn step(
        &mut self,
        dt_s: f64,
        q: &[f64],
        theta_measured: &[f64],
        dq: Option<&[f64]>,
    ) -> Result<(), StepError> {
        self.check(dt_s, q, dq)?;
        self.correction
            .elastic_torque(theta_measured, q, &mut self.raw)?;
        let overflows = |(joint, tau): (&Option<_>, &f64)| joint.is_some() && !is_input(*tau);
        if self
            .correction
            .joints()
            .iter()
            .zip(&self.raw)
            .any(overflows)
        {
            return Err(StepError::NotFinite);
        }
        self.filter(dt_s, q, dq);
        let terms = self.arm.momentum(&mut self.ws, &self.q, &self.dq)?;
        let inputs = terms
            .ct_dq
            .iter()
            .zip(terms.g)
            .zip(&self.dq)
            .zip(&self.friction);
        for (alpha, (((ct_dq, g), dq), friction)) in self.alpha.iter_mut().zip(inputs) {
            *alpha = ct_dq - g - friction.torque(*dq);
        }
        self.observer
            .step(dt_s, terms.p, &self.alpha, Some(&self.tau_el))?;
        self.update_outputs();
        if self.started {
            self.since_start_s += dt_s;
        }
        self.started = true;
        Ok(())
    }

    /// Checks the inputs before any state changes.
    fn check(&self, dt_s: f64, q: &[f64], dq: Option<&[f64]>) -> Result<(), StepError> {
        let n = self.raw.len();
        if q.len() != n {
            return Err(StepError::Length);
        }
        if self.started && !is_time_step(dt_s) {
            return Err(StepError::TimeStep);
        }
        let finite = |x: &[f64]| x.iter().all(|v| is_input(*v));
        if !finite(q) {
            return Err(StepError::NotFinite);
        }
        if self.config.velocity == VelocityFilter::Recorded {
            match dq {
                Some(dq) if dq.len() == n && finite(dq) => {}
                Some(dq) if dq.len() == n => return Err(StepError::NotFinite),
                _ => return Err(StepError::Length),
            }
        }
        Ok(())
    }

    /// Brings `q`, `dq` and `tau_el` to this sample.
    fn filter(&mut self, dt_s: f64, q_now: &[f64], dq_now: Option<&[f64]>) {
        let rows = self.q.iter_mut().zip(&mut self.dq).zip(&mut self.tau_el);
        let inputs = q_now.iter().zip(&self.raw).zip(self.correction.joints());
        let VelocityFilter::StateVariable {
            cutoff_rad_per_s: w,
        } = self.config.velocity
        else {
            let dq_now = dq_now.unwrap_or(&[]);
            for (i, (((q, dq), tau), ((q_now, raw), joint))) in rows.zip(inputs).enumerate() {
                *q = *q_now;
                *dq = dq_now.get(i).copied().unwrap_or(0.0);
                *tau = if joint.is_some() { *raw } else { 0.0 };
            }
            return;
        };
        let pole = DoublePole::new(w, dt_s);
        for ((((q, dq), tau), ((q_now, raw), joint)), filter) in
            rows.zip(inputs).zip(&mut self.filters)
        {
            // A rigid joint's NaN must not get in.
            let raw = if joint.is_some() { *raw } else { 0.0 };
            if self.started {
                filter.q.step(&pole, *q_now);
                filter.tau_el.step(&pole, raw);
            } else {
                filter.q = StateVariableFilter::settled_at(*q_now);
                filter.tau_el = StateVariableFilter::settled_at(raw);
            }
            *q = filter.q.value();
            *dq = filter.q.rate();
            *tau = filter.tau_el.value();
        }
    }

    /// Estimate and threshold of every joint.
    fn update_outputs(&mut self) {
        let t = &self.tolerances;
        if let Some(routes) = self.correction.routes() {
            for ((filter, pole), tau_el) in (self.filters.iter_mut())
                .zip(self.observer.pole())
                .zip(&self.tau_el)
            {
                if self.started {
                    filter.lagging.step(pole, *tau_el);
                } else {
                    filter.lagging = FirstOrder::settled_at(*tau_el);
                }
            }
            let rows = self.tau_ext.iter_mut().zip(&mut self.threshold);
            let parameters = self.friction.iter().zip(&t.noise_nm).zip(&self.filters);
            let joints = rows.zip(parameters).zip(self.observer.torque()).enumerate();
            for (j, (((tau_ext, threshold), ((friction, noise), filter)), r)) in joints {
                if self.correction.joints().get(j).is_none_or(Option::is_none) {
                    continue;
                }
                let model = (filter.lagging.output() + r) * t.mass_std;
                let carried = self.filters.iter().map(|f| f.lagging.output());
                let variance = spring_variance(&self.correction, routes, j, carried)
                    + model * model
                    + noise * noise;
                *tau_ext = *r;
                *threshold =
                    t.sigmas * libm::sqrt(variance) + t.friction_share * friction.coulomb_nm;
            }
            return;
        }
        let outputs = self.tau_ext.iter_mut().zip(&mut self.threshold);
        let observed = self.observer.torque().iter().zip(self.observer.pole());
        let parameters = self.tau_el.iter().zip(&self.friction).zip(&t.noise_nm);
        let rows = outputs.zip(observed).zip(parameters).zip(&mut self.filters);
        for (((((tau_ext, threshold), (r, pole)), ((tau_el, friction), noise)), filter), joint) in
            rows.zip(self.correction.joints())
        {
            let Some(joint) = joint else { continue };
            if self.started {
                filter.lagging.step(pole, *tau_el);
            } else {
                filter.lagging = FirstOrder::settled_at(*tau_el);
            }
            let carried = filter.lagging.output();
            let spring = &joint.spring;
            let slope = spring.slope(spring.deflection(carried).unwrap_or(0.0));
            let parts = [
                slope * joint.delta_e_std,
                carried * joint.stiffness_std,
                (carried + r) * t.mass_std,
                *noise,
            ];
            let variance: f64 = parts.iter().map(|p| p * p).sum();
            *tau_ext = *r;
            *threshold = t.sigmas * libm::sqrt(variance) + t.friction_share * friction.coulomb_nm;
        }
    }

    /// Estimated external torque, `n`, N·m, positive when applied to the robot; NaN for rigid
    /// joints and before the first sample.
    pub fn tau_ext(&self) -> &[f64] {
        &self.tau_ext
    }

    /// Threshold above which [`ExternalTorqueObserver::tau_ext`] exceeds the uncertainty of the model, `n`, N·m; NaN as
    /// there.
    pub fn threshold(&self) -> &[f64] {
        &self.threshold
    }

    /// Time after which a start in motion has faded to a thousandth, s: `7/K_I + 9/ω`.
    pub fn settling_time_s(&self) -> f64 {
        let filter = match self.config.velocity {
            VelocityFilter::StateVariable { cutoff_rad_per_s } => 9.0 / cutoff_rad_per_s,
            VelocityFilter::Recorded => 0.0,
        };
        filter + 7.0 / self.config.gain_per_s
    }

    /// Whether the start has faded.
    pub fn is_settled(&self) -> bool {
        self.started && self.since_start_s >= self.settling_time_s()
    }
}

/// Returns the variance of the elastic torque of joint `j` by the uncertainty of offsets and stiffnesses, (N·m)², over
/// all tendons that cross it.
fn spring_variance(
    correction: &Correction,
    routes: &Routings,
    j: usize,
    tau_el: impl Iterator<Item = f64> + Clone,
) -> f64 {
    let tendons = correction.joints().iter().enumerate();
    tendons.fold(0.0, |sum, (i, tendon)| {
        let Some(tendon) = tendon else { return sum };
        let carried = routes.torque_of(i, tau_el.clone());
        let spring = &tendon.spring;
        let slope = spring.slope(spring.deflection(carried).unwrap_or(0.0));
        let arm = routes.moment_arm(i, j);
        let by_offset = arm * slope * tendon.delta_e_std;
        let by_stiffness = arm * carried * tendon.stiffness_std;
        sum + by_offset * by_offset + by_stiffness * by_stiffness
    })
}
