//! The generalised-momentum observer.

use super::pole::ExactPole;
use crate::StepError;
use crate::error::is_time_step;
use alloc::vec::Vec;

/// Observer gain outside the permitted range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("observer gain of joint {joint} is {gain_per_s} 1/s; it must be finite and above 0")]
pub struct GainError {
    /// Index of the joint.
    pub joint: usize,
    /// Gain given, 1/s.
    pub gain_per_s: f64,
}

/// Momentum observer: estimates the elastic joint torque without accelerations.
///
/// `ṗ = tau_el + tau_ext + α`, `α = Cᵀdq − g − tau_friction_joint`; `r` follows `tau_el` with
/// `ṙ = K_I (tau_el − r)`. In one step, with the pole solved exactly (`a = exp(−K_I Δt)`) and
/// `α + tau_ext` linear between samples ([`ExactPole`]):
///
/// ```text
/// r₁ = a r₀ + (1 − a) (p₁ − p₀)/Δt − w₀ (α₀ + tau_ext₀) − w₁ (α₁ + tau_ext₁)
/// ```
///
/// Stable for every `K_I > 0` and `Δt > 0`. Only the last `p` and `α + tau_ext` are kept, so a
/// varying step, a gap (re-initialisation) and a change of gain (no discontinuity: `r` is the
/// torque itself) need no special treatment. Valid if `tau_ext` is measured or specified: an
/// unmodelled contact appears in `r` in full.
///
/// # Source
/// Kirchhoff, von Stryk, IROS 2018, eq. (7); De Luca et al., IROS 2006, for the momentum form.
#[derive(Debug, Clone, PartialEq)]
pub struct MomentumObserver {
    gain: Vec<f64>,
    pole: Vec<ExactPole>,
    pole_dt: f64,
    r: Vec<f64>,
    p: Vec<f64>,
    /// `α + tau_ext` at the last sample.
    drive: Vec<f64>,
    started: bool,
}

impl MomentumObserver {
    /// An observer of `gain_per_s.len()` joints; `K_I` in 1/s, one per joint. Allocates here only.
    ///
    /// # Errors
    /// Returns a [`GainError`] when a gain is not finite and above 0.
    pub fn new(gain_per_s: &[f64]) -> Result<Self, GainError> {
        for (joint, &gain_per_s) in gain_per_s.iter().enumerate() {
            check_gain(joint, gain_per_s)?;
        }
        let n = gain_per_s.len();
        Ok(Self {
            gain: gain_per_s.to_vec(),
            pole: alloc::vec![ExactPole { a: 1.0, w0: 0.0, w1: 0.0 }; n],
            pole_dt: 0.0,
            r: alloc::vec![0.0; n],
            p: alloc::vec![0.0; n],
            drive: alloc::vec![0.0; n],
            started: false,
        })
    }

    /// Changes the gain of one joint; `r` does not jump. A joint past the last is ignored.
    ///
    /// # Errors
    /// Returns a [`GainError`]; the gain is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn set_gain(&mut self, joint: usize, gain_per_s: f64) -> Result<(), GainError> {
        check_gain(joint, gain_per_s)?;
        if let Some(slot) = self.gain.get_mut(joint) {
            *slot = gain_per_s;
            self.pole_dt = 0.0;
        }
        Ok(())
    }

    /// Resets the state; the next sample re-initialises the observer.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn reset(&mut self) {
        self.started = false;
    }

    /// One step of `dt_s` to the sample `p`, `alpha`, `tau_ext` (`None`: no external torque).
    ///
    /// The first step after construction or a reset only takes the sample: `r` starts at
    /// `−(α + tau_ext)`, the elastic torque at rest (`g(q)`), and `dt_s` is not looked at.
    /// Subtracting `p(0)` is implied: only differences of `p` enter.
    ///
    /// * `p`, `alpha`, `tau_ext`: `n`; N·m·s, N·m, N·m.
    ///
    /// # Errors
    /// Returns [`StepError::Length`], [`StepError::NotFinite`], [`StepError::TimeStep`]; the state is
    /// then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n).
    pub fn step(
        &mut self,
        dt_s: f64,
        p: &[f64],
        alpha: &[f64],
        tau_ext: Option<&[f64]>,
    ) -> Result<(), StepError> {
        let n = self.r.len();
        if p.len() != n || alpha.len() != n || tau_ext.is_some_and(|t| t.len() != n) {
            return Err(StepError::Length);
        }
        let mut sum = 0.0;
        for (p, alpha) in p.iter().zip(alpha) {
            sum += p.abs() + alpha.abs();
        }
        for t in tau_ext.unwrap_or(&[]) {
            sum += t.abs();
        }
        // Far below overflow of `(p₁ − p₀)/Δt` at the shortest step.
        if sum.is_nan() || sum >= 1e200 {
            return Err(StepError::NotFinite);
        }
        if self.started {
            if !is_time_step(dt_s) {
                return Err(StepError::TimeStep);
            }
            self.set_step(dt_s);
        }
        let per_s = 1.0 / dt_s;
        let state = self
            .r
            .iter_mut()
            .zip(&mut self.p)
            .zip(&mut self.drive)
            .zip(&self.pole);
        for (i, ((((r, p0), drive0), pole), (p, alpha))) in
            state.zip(p.iter().zip(alpha)).enumerate()
        {
            let drive = alpha + tau_ext.and_then(|t| t.get(i)).unwrap_or(&0.0);
            *r = if self.started {
                pole.a * *r + (1.0 - pole.a) * (p - *p0) * per_s
                    - pole.w0 * *drive0
                    - pole.w1 * drive
            } else {
                -drive
            };
            *p0 = *p;
            *drive0 = drive;
        }
        self.started = true;
        Ok(())
    }

    /// Estimated elastic torque `r`, `n`, N·m. Zero before the first sample.
    pub fn torque(&self) -> &[f64] {
        &self.r
    }

    /// Weights of the last step, one per joint: other signals compared with `r` use the same weights.
    pub fn pole(&self) -> &[ExactPole] {
        &self.pole
    }

    /// Recomputes the weights when the step has changed.
    #[inline]
    fn set_step(&mut self, dt_s: f64) {
        if dt_s == self.pole_dt {
            return;
        }
        let mut last: Option<(f64, ExactPole)> = None;
        for (pole, &gain) in self.pole.iter_mut().zip(&self.gain) {
            // Usually one gain for all joints: one exponential for all.
            *pole = match last {
                Some((g, p)) if g == gain => p,
                _ => ExactPole::new(gain, dt_s),
            };
            last = Some((gain, *pole));
        }
        self.pole_dt = dt_s;
    }
}

fn check_gain(joint: usize, gain_per_s: f64) -> Result<(), GainError> {
    if gain_per_s.is_finite() && gain_per_s > 0.0 {
        Ok(())
    } else {
        Err(GainError { joint, gain_per_s })
    }
}
