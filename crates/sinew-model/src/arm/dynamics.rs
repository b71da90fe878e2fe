//! Inverse and forward dynamics.

use super::mass_matrix::wrench_in_parent;
use super::{Arm, ArmJoint, ArmWorkspace, BodyState, JointKind};
use crate::StepError;
use crate::cholesky;
use crate::vec3::{Vec3, add, cross, rotate, rotate_back, scale};

impl Arm {
    /// Generalised force for a motion: `tau = M(q) ddq + C(q, dq) dq + g(q)`.
    ///
    /// Recursive Newton–Euler in body frames; gravity enters as an acceleration of the base.
    ///
    /// * `q`, `dq`, `ddq`: `n`. Returns `tau`, `n`, N·m (N for prismatic joints).
    ///
    /// # Errors
    /// Returns [`StepError::Length`], [`StepError::NotFinite`].
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    pub fn inverse_dynamics<'w>(
        &self,
        ws: &'w mut ArmWorkspace,
        q: &[f64],
        dq: &[f64],
        ddq: &[f64],
    ) -> Result<&'w [f64], StepError> {
        let n = self.joints.len();
        if q.len() != n || dq.len() != n || ddq.len() != n || !ws.fits(self) {
            return Err(StepError::Length);
        }
        let finite = |x: &[f64]| x.iter().all(|v| v.is_finite());
        if !(finite(q) && finite(dq) && finite(ddq)) {
            return Err(StepError::NotFinite);
        }
        self.place(ws, q);
        self.newton_euler(ws, dq, Some(ddq));
        Ok(&ws.tau)
    }

    /// Bias torque `C(q, dq) dq + g(q)`: the joint torque of a motion without acceleration.
    ///
    /// # Errors
    /// Returns [`StepError::Length`], [`StepError::NotFinite`].
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    pub fn bias_torque<'w>(
        &self,
        ws: &'w mut ArmWorkspace,
        q: &[f64],
        dq: &[f64],
    ) -> Result<&'w [f64], StepError> {
        if q.len() != self.joints.len() || dq.len() != q.len() || !ws.fits(self) {
            return Err(StepError::Length);
        }
        if q.iter().chain(dq).any(|v| !v.is_finite()) {
            return Err(StepError::NotFinite);
        }
        self.place(ws, q);
        self.newton_euler(ws, dq, None);
        Ok(&ws.tau)
    }

    /// Acceleration under a generalised force: `ddq = M(q)⁻¹ (tau − C dq − g)`.
    ///
    /// Uses a Cholesky factorisation of the mass matrix; no inverse is formed.
    ///
    /// * `tau`: `n`, sum of all torques on the joints (elastic torque, friction, contact).
    /// * `ddq`: `n`, written; rad/s² (m/s²).
    ///
    /// # Errors
    /// Returns [`StepError::Length`] or [`StepError::NotFinite`] for an invalid input, and
    /// [`StepError::NotPositiveDefinite`] if the masses are physically impossible (a joint without
    /// mass, or an indefinite identified inertia). `ddq` is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n³).
    pub fn forward_dynamics(
        &self,
        ws: &mut ArmWorkspace,
        q: &[f64],
        dq: &[f64],
        tau: &[f64],
        ddq: &mut [f64],
    ) -> Result<(), StepError> {
        let n = self.joints.len();
        if tau.len() != n || ddq.len() != n || dq.len() != n {
            return Err(StepError::Length);
        }
        if tau.iter().chain(dq).any(|x| !x.is_finite()) {
            return Err(StepError::NotFinite);
        }
        self.mass_matrix(ws, q)?;
        // The mass matrix has placed the bodies.
        self.newton_euler(ws, dq, None);
        cholesky::factorise(&ws.mass_matrix, &mut ws.factor, n)
            .map_err(|joint| StepError::NotPositiveDefinite { joint })?;
        for ((out, tau), bias) in ddq.iter_mut().zip(tau).zip(&ws.tau) {
            *out = tau - bias;
        }
        cholesky::solve(&ws.factor, n, ddq);
        Ok(())
    }

    /// Newton–Euler recursion over placed bodies to `ws.tau`. Lengths are checked by the caller.
    fn newton_euler(&self, ws: &mut ArmWorkspace, dq: &[f64], ddq: Option<&[f64]>) {
        if let Some(base) = ws.state.first_mut() {
            base.acceleration = scale(self.gravity, -1.0);
        }
        for (i, (joint, rate)) in self.joints.iter().zip(dq).enumerate() {
            let acc = ddq.and_then(|a| a.get(i)).copied().unwrap_or(0.0);
            // A joint's slot comes after its parent's, so the split always succeeds.
            let Some((before, after)) = ws.state.split_at_mut_checked(i + 1) else {
                return;
            };
            let (Some(parent), Some(body)) = (before.get(joint.parent_slot), after.first_mut())
            else {
                return;
            };
            body.accelerate(joint, parent, *rate, acc);
        }
        let joints = self.joints.iter().zip(&mut ws.tau).enumerate();
        for (i, (joint, tau)) in joints.rev() {
            let Some((before, after)) = ws.state.split_at_mut_checked(i + 1) else {
                return;
            };
            let (Some(parent), Some(body)) = (before.get_mut(joint.parent_slot), after.first())
            else {
                return;
            };
            *tau = match joint.kind {
                JointKind::Revolute => body.moment[2],
                JointKind::Prismatic => body.force[2],
            };
            let (moment, force) = wrench_in_parent(body, body.moment, body.force);
            parent.moment = add(parent.moment, moment);
            parent.force = add(parent.force, force);
        }
        // The wrench that reached the base is discarded: the next pass begins with zero.
        if let Some(base) = ws.state.first_mut() {
            base.moment = [0.0; 3];
            base.force = [0.0; 3];
        }
    }
}

impl BodyState {
    /// Motion of a body from its parent's, and the wrench that needs.
    #[inline(always)]
    fn accelerate(&mut self, joint: &ArmJoint, parent: &Self, rate: f64, acc: f64) {
        let (wp, dwp, r) = (parent.omega, parent.angular_acceleration, self.origin);
        let rotation = self.rotation;
        let down = |x: Vec3| rotate_back(&rotation, x);
        let a_origin = add(
            parent.acceleration,
            add(cross(dwp, r), cross(wp, cross(wp, r))),
        );
        let w = down(wp);
        self.omega = w;
        self.angular_acceleration = down(dwp);
        self.acceleration = down(a_origin);
        match joint.kind {
            JointKind::Revolute => {
                self.omega[2] += rate;
                // d/dt of (w + rate ẑ) seen from the turning body
                self.angular_acceleration[0] += w[1] * rate;
                self.angular_acceleration[1] -= w[0] * rate;
                self.angular_acceleration[2] += acc;
            }
            JointKind::Prismatic => {
                // Coriolis 2 ω × ẑ rate, and the acceleration along z
                self.acceleration[0] += 2.0 * w[1] * rate;
                self.acceleration[1] -= 2.0 * w[0] * rate;
                self.acceleration[2] += acc;
            }
        }
        let (w, dw, a) = (self.omega, self.angular_acceleration, self.acceleration);
        let (m, h) = (joint.mass, joint.first_moment);
        let spin = rotate(&joint.inertia, w);
        self.force = add(scale(a, m), add(cross(dw, h), cross(w, cross(w, h))));
        self.moment = add(add(rotate(&joint.inertia, dw), cross(w, spin)), cross(h, a));
    }
}
