//! Motor set-points for a desired joint position.

use super::error::CorrectionError;
use super::transmission::{Correction, JointCorrection};
use crate::StepError;
use crate::arm::{Arm, ArmWorkspace};
use crate::error::is_input;
use crate::transmission::{Friction, Transmission};
use alloc::vec::Vec;

/// Motor set-points `theta_set = q_d + x(tau_d) + delta_e`, `x` the spring's deflection under the torque `tau_d` that
/// the desired motion requires.
///
/// ```text
/// at rest     tau_d = g(q_d) − tau_ext
/// in motion   tau_d = M(q_d) ddq_d + C dq_d + g(q_d) + tau_friction_joint(dq_d) − tau_ext
/// ```
///
/// A motor held at `theta_set` holds the joint at `q_d` exactly if the model is exact: the set-point is an equilibrium.
/// Remaining errors: `(1/K − 1/K_true) tau_d` for a wrong stiffness, `δg/K` for wrong masses, dry friction at the joint
/// over `K`. It is a feed-forward: errors of the motor position and oscillations of the arm are tasks of the
/// controller.
///
/// A payload is part of the arm passed to the constructor ([`Arm::with_payload`]).
///
/// A tendon with a [`Routing`](crate::tendons::Routing) carries `f = Σ_j B_ij tau_j`, and the set-point of its motor is
///
/// ```text
/// drive_ratio theta_set = Σ_j rho_ij q_d_j + x(f) + delta_e
/// ```
///
/// # Realtime
/// Everything is allocated at construction.
///
/// # Source
/// P. Tomei, IEEE TAC 36, 1991, for `q_d + g(q_d)/K`; the paper's eq. (4) for `delta_e`.
#[derive(Debug, Clone)]
pub struct SetPoint {
    arm: Arm,
    ws: ArmWorkspace,
    correction: Correction,
    friction: Vec<Friction>,
    rest: Vec<f64>,
    tau_el: Vec<f64>,
    /// Torques of the tendons, N·m; empty without routings.
    tendon_torque: Vec<f64>,
    theta_set: Vec<f64>,
}

impl SetPoint {
    /// Set-points for `arm`; one transmission and one correction per joint, `None` for rigid
    /// joints, whose set-point is `q_d`.
    ///
    /// # Errors
    /// Returns a [`CorrectionError`], naming the joint and the value.
    pub fn new(
        arm: &Arm,
        transmissions: &[Option<Transmission>],
        corrections: &[JointCorrection],
    ) -> Result<Self, CorrectionError> {
        let n = arm.dof();
        if transmissions.len() != n {
            return Err(CorrectionError::Length {
                expected: n,
                found: transmissions.len(),
            });
        }
        let friction =
            |t: &Option<Transmission>| t.as_ref().map_or(Friction::default(), |t| t.joint_friction);
        let correction = Correction::new(transmissions, corrections)?;
        let routed = correction.routes().map_or(0, |_| n);
        Ok(Self {
            ws: ArmWorkspace::new(arm),
            arm: arm.clone(),
            correction,
            tendon_torque: alloc::vec![0.0; routed],
            friction: transmissions.iter().map(friction).collect(),
            rest: alloc::vec![0.0; n],
            tau_el: alloc::vec![0.0; n],
            theta_set: alloc::vec![0.0; n],
        })
    }

    /// Changes the correction of one joint's transmission.
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

    /// Computes the set-point that holds `q_d` at rest; returns `theta_set`, `n`, rad, in the coordinate of the motor's
    /// encoder (offset included).
    ///
    /// * `q_d`: `n`, rad. `tau_ext`: `n`, N·m, external torque applied to the robot; `None`: none.
    ///
    /// # Errors
    /// Returns [`StepError::Length`] or [`StepError::NotFinite`] for an invalid input, and [`StepError::Spring`] if the
    /// torque exceeds the maximum of a softening spring. The previous set-point is kept.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    pub fn hold(&mut self, q_d: &[f64], tau_ext: Option<&[f64]>) -> Result<&[f64], StepError> {
        check(q_d, self.rest.len())?;
        let g = self.arm.momentum(&mut self.ws, q_d, &self.rest)?.g;
        let set = Set {
            correction: &self.correction,
            q_d,
            tau_ext,
        };
        set.solve(
            g,
            None,
            (&mut self.tau_el, &mut self.tendon_torque),
            &mut self.theta_set,
        )?;
        Ok(&self.theta_set)
    }

    /// Set-point that lets the joint follow `q_d`, `dq_d`, `ddq_d`; otherwise as
    /// [`SetPoint::hold`].
    ///
    /// With an exact model the joint follows `q_d` while the motor follows `theta_set`. A disturbance causes an
    /// oscillation about `q_d`, which the controller has to damp.
    ///
    /// * `dq_d`, `ddq_d`: `n`, rad/s, rad/s².
    ///
    /// # Errors
    /// Returns the errors of [`SetPoint::hold`].
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    pub fn follow(
        &mut self,
        q_d: &[f64],
        dq_d: &[f64],
        ddq_d: &[f64],
        tau_ext: Option<&[f64]>,
    ) -> Result<&[f64], StepError> {
        for x in [q_d, dq_d, ddq_d] {
            check(x, self.rest.len())?;
        }
        let tau = self.arm.inverse_dynamics(&mut self.ws, q_d, dq_d, ddq_d)?;
        let set = Set {
            correction: &self.correction,
            q_d,
            tau_ext,
        };
        let friction = Some((self.friction.as_slice(), dq_d));
        set.solve(
            tau,
            friction,
            (&mut self.tau_el, &mut self.tendon_torque),
            &mut self.theta_set,
        )?;
        Ok(&self.theta_set)
    }

    /// Elastic torque at the joints that the latest set-point counts on, `n`, N·m.
    pub fn tau_el(&self) -> &[f64] {
        &self.tau_el
    }

    /// Torque of the tendons for the latest set-point, `n`, N·m, which the motors have to provide.
    ///
    /// For a joint with a separate tendon the value is `tau_el`. With a routing it is the torque in the tendon's
    /// coordinate; the torque at the motor shaft is `drive_ratio` times as large.
    pub fn tendon_torque(&self) -> &[f64] {
        match self.correction.routes() {
            Some(_) => &self.tendon_torque,
            None => &self.tau_el,
        }
    }

    /// The latest set-point, `n`, rad; 0 before the first.
    pub fn theta_set(&self) -> &[f64] {
        &self.theta_set
    }
}

/// One set-point being solved.
struct Set<'a> {
    correction: &'a Correction,
    q_d: &'a [f64],
    tau_ext: Option<&'a [f64]>,
}

impl Set<'_> {
    /// Writes `tau_el` and `theta_set` for the model's torque `tau`; on an error neither.
    fn solve(
        &self,
        tau: &[f64],
        friction: Option<(&[Friction], &[f64])>,
        (tau_el, tendon_torque): (&mut [f64], &mut [f64]),
        theta_set: &mut [f64],
    ) -> Result<(), StepError> {
        if let Some(tau_ext) = self.tau_ext {
            check(tau_ext, tau.len())?;
        }
        let torque = |i: usize| {
            let at = |x: &[f64]| x.get(i).copied().unwrap_or(0.0);
            let friction = friction.map_or(0.0, |(friction, dq)| {
                friction.get(i).map_or(0.0, |f| f.torque(at(dq)))
            });
            at(tau) + friction - self.tau_ext.map_or(0.0, at)
        };
        if let Some(routes) = self.correction.routes() {
            let n = tau.len();
            let carried = |i: usize| routes.torque_of(i, (0..n).map(torque));
            let joints = self.correction.joints();
            // Errors are returned before any value is written.
            for (i, joint) in joints.iter().enumerate() {
                if let Some(joint) = joint
                    && joint.spring.deflection(carried(i)).is_none()
                {
                    return Err(StepError::Spring { joint: i });
                }
            }
            let rows = tau_el.iter_mut().zip(tendon_torque).zip(theta_set);
            for (i, (((tau_el, tendon), theta), joint)) in rows.zip(joints).enumerate() {
                *tau_el = torque(i);
                *tendon = carried(i);
                let position = routes.path(i, self.q_d);
                *theta = match joint {
                    Some(j) => {
                        let x = j.spring.deflection(*tendon).unwrap_or(0.0);
                        (position + x + j.delta_e) / routes.drive_ratio(i)
                    }
                    None => position,
                };
            }
            return Ok(());
        }
        // Errors are returned before any value is written.
        for (i, joint) in self.correction.joints().iter().enumerate() {
            if let Some(joint) = joint
                && joint.spring.deflection(torque(i)).is_none()
            {
                return Err(StepError::Spring { joint: i });
            }
        }
        let rows = tau_el.iter_mut().zip(theta_set).zip(self.q_d);
        for (i, (((tau_el, theta), q_d), joint)) in rows.zip(self.correction.joints()).enumerate() {
            *tau_el = torque(i);
            *theta = match joint {
                Some(j) => q_d + j.spring.deflection(*tau_el).unwrap_or(0.0) + j.delta_e,
                None => *q_d,
            };
        }
        Ok(())
    }
}

fn check(x: &[f64], n: usize) -> Result<(), StepError> {
    if x.len() != n {
        return Err(StepError::Length);
    }
    if !x.iter().all(|x| is_input(*x)) {
        return Err(StepError::NotFinite);
    }
    Ok(())
}
