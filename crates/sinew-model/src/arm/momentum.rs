//! The O(n) momentum pass.

use super::{Arm, ArmWorkspace, BodyState, Joint, JointKind};
use crate::StepError;
use crate::vec3::{Vec3, rotate, rotate_back};

/// What one pass yields, borrowed from the workspace. All of length `n`.
#[derive(Debug, Clone, Copy)]
pub struct Momentum<'a> {
    /// Generalised momentum `p = M(q) dq`, N·m·s (N·s for a prismatic joint).
    pub p: &'a [f64],
    /// `C(q, dq)ᵀ dq = ∂T/∂q`, N·m (N).
    pub ct_dq: &'a [f64],
    /// Gravity torque `g(q)`, N·m (N).
    pub g: &'a [f64],
}

impl Arm {
    /// Generalised momentum, `Cᵀdq` and gravity torque in one pass from base to tip and back.
    ///
    /// With `v_i = [ω; v]` the body velocity, `[N; F]` the momentum of the whole subtree of `i`
    /// at joint `i`, `γ` gravity in the body frame, `s` the subtree's first mass moment, `m` its
    /// mass, and the joint axis along local z:
    ///
    /// ```text
    /// revolute    p = N_z    Cᵀdq = ω_y N_x − ω_x N_y + v_y F_x − v_x F_y    g = s_y γ_x − s_x γ_y
    /// prismatic   p = F_z    Cᵀdq = ω_y F_x − ω_x F_y                        g = −m γ_z
    /// ```
    ///
    /// `Cᵀdq = ∂T/∂q` holds for any `C` with `Ṁ = C + Cᵀ`; no Coriolis matrix is formed.
    ///
    /// * `q`, `dq`: `n`; rad and rad/s (m and m/s for prismatic joints).
    ///
    /// # Errors
    /// [`StepError::Length`] when a slice or the workspace doesn't fit the arm;
    /// [`StepError::NotFinite`] when an input is NaN or infinite. The workspace's previous
    /// results are then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    ///
    /// # Source
    /// Kirchhoff, von Stryk, IROS 2018, eq. (7) for what the observer needs; the subtree form
    /// follows from `T = ½ Σ vᵀ I v` and `∂v/∂q`.
    pub fn momentum<'w>(
        &self,
        ws: &'w mut ArmWorkspace,
        q: &[f64],
        dq: &[f64],
    ) -> Result<Momentum<'w>, StepError> {
        let n = self.joints.len();
        if q.len() != n || dq.len() != n || !ws.fits(self) {
            return Err(StepError::Length);
        }
        // A sum is finite only if every term is; overflow of finite terms is refused as well.
        let mut sum = 0.0;
        for (a, b) in q.iter().zip(dq) {
            sum += a.abs() + b.abs();
        }
        if !sum.is_finite() {
            return Err(StepError::NotFinite);
        }
        self.momentum_forward(&mut ws.state, q, dq);
        self.momentum_backward(&mut ws.state, &mut ws.p, &mut ws.ct_dq, &mut ws.g);
        Ok(Momentum {
            p: &ws.p,
            ct_dq: &ws.ct_dq,
            g: &ws.g,
        })
    }

    /// Base to tip: velocities, gravity and own momentum of each body.
    #[inline]
    fn momentum_forward(&self, state: &mut [BodyState], q: &[f64], dq: &[f64]) {
        for (i, ((joint, q), dq)) in self.joints.iter().zip(q).zip(dq).enumerate() {
            // A joint's slot comes after its parent's, so the split always succeeds.
            let Some((before, after)) = state.split_at_mut_checked(i + 1) else {
                return;
            };
            let (Some(parent), Some(body)) = (before.get(joint.parent_slot), after.first_mut())
            else {
                return;
            };
            body_forward(joint, parent, body, *q, *dq);
        }
    }

    /// Tip to base: project, then hand momentum and first moment to the parent.
    #[inline]
    fn momentum_backward(
        &self,
        state: &mut [BodyState],
        p: &mut [f64],
        ct_dq: &mut [f64],
        g: &mut [f64],
    ) {
        let joints = self.joints.iter().enumerate();
        let outputs = p.iter_mut().zip(ct_dq.iter_mut()).zip(g.iter_mut());
        for ((i, joint), ((p, ct_dq), g)) in joints.zip(outputs).rev() {
            let Some((before, after)) = state.split_at_mut_checked(i + 1) else {
                return;
            };
            let (Some(parent), Some(body)) = (before.get_mut(joint.parent_slot), after.first())
            else {
                return;
            };
            (*p, *ct_dq, *g) = project(joint, body);
            if joint.parent_slot != 0 {
                hand_to_parent(joint, body, parent);
            }
        }
    }
}

/// Velocity, gravity and own momentum of one body from its parent's.
#[inline(always)]
fn body_forward(joint: &Joint, parent: &BodyState, body: &mut BodyState, q: f64, dq: f64) {
    let e = &joint.rotation;
    let r = joint.translation;
    let (wp, vp) = (parent.omega, parent.v);
    let at_joint = [
        vp[0] + wp[1] * r[2] - wp[2] * r[1],
        vp[1] + wp[2] * r[0] - wp[0] * r[2],
        vp[2] + wp[0] * r[1] - wp[1] * r[0],
    ];
    let w = rotate_back(e, wp);
    let v = rotate_back(e, at_joint);
    let gamma = rotate_back(e, parent.gamma);
    match joint.kind {
        JointKind::Revolute => {
            let (sin, cos) = libm::sincos(q);
            body.sin = sin;
            body.cos = cos;
            body.travel = 0.0;
            body.omega = turn_back(cos, sin, w);
            body.omega[2] += dq;
            body.v = turn_back(cos, sin, v);
            body.gamma = turn_back(cos, sin, gamma);
        }
        JointKind::Prismatic => {
            body.sin = 0.0;
            body.cos = 1.0;
            body.travel = q;
            body.omega = w;
            body.v = [v[0] + q * w[1], v[1] - q * w[0], v[2] + dq];
            body.gamma = gamma;
        }
    }
    let (w, v) = (body.omega, body.v);
    let (m, h, i) = (joint.mass, joint.first_moment, &joint.inertia);
    // H = [I ω + h × v; m v + ω × h]
    body.moment = [
        i[0][0] * w[0] + i[0][1] * w[1] + i[0][2] * w[2] + h[1] * v[2] - h[2] * v[1],
        i[0][1] * w[0] + i[1][1] * w[1] + i[1][2] * w[2] + h[2] * v[0] - h[0] * v[2],
        i[0][2] * w[0] + i[1][2] * w[1] + i[2][2] * w[2] + h[0] * v[1] - h[1] * v[0],
    ];
    body.force = [
        m * v[0] + w[1] * h[2] - w[2] * h[1],
        m * v[1] + w[2] * h[0] - w[0] * h[2],
        m * v[2] + w[0] * h[1] - w[1] * h[0],
    ];
    body.first_moment = h;
}

/// `(p, Cᵀdq, g)` of one joint.
#[inline(always)]
fn project(joint: &Joint, body: &BodyState) -> (f64, f64, f64) {
    let (w, v, n, f) = (body.omega, body.v, body.moment, body.force);
    let (s, gamma) = (body.first_moment, body.gamma);
    match joint.kind {
        JointKind::Revolute => (
            n[2],
            w[1] * n[0] - w[0] * n[1] + v[1] * f[0] - v[0] * f[1],
            s[1] * gamma[0] - s[0] * gamma[1],
        ),
        JointKind::Prismatic => (
            f[2],
            w[1] * f[0] - w[0] * f[1],
            -joint.subtree_mass * gamma[2],
        ),
    }
}

/// Adds the subtree's momentum and first moment, seen from the parent, to the parent's.
#[inline(always)]
fn hand_to_parent(joint: &Joint, body: &BodyState, parent: &mut BodyState) {
    let e = &joint.rotation;
    let r = joint.translation;
    let (c, s, d) = (body.cos, body.sin, body.travel);
    let f = turn(c, s, body.force);
    let mut n = turn(c, s, body.moment);
    n[0] -= d * f[1];
    n[1] += d * f[0];
    let mut h = turn(c, s, body.first_moment);
    h[2] += joint.subtree_mass * d;
    let (f, n, h) = (rotate(e, f), rotate(e, n), rotate(e, h));
    for k in 0..3 {
        parent.force[k] += f[k];
        parent.first_moment[k] += h[k] + joint.subtree_mass * r[k];
    }
    parent.moment[0] += n[0] + r[1] * f[2] - r[2] * f[1];
    parent.moment[1] += n[1] + r[2] * f[0] - r[0] * f[2];
    parent.moment[2] += n[2] + r[0] * f[1] - r[1] * f[0];
}

/// `Rz(q) a`.
#[inline(always)]
pub(super) fn turn(cos: f64, sin: f64, a: Vec3) -> Vec3 {
    [cos * a[0] - sin * a[1], sin * a[0] + cos * a[1], a[2]]
}

/// `Rz(q)ᵀ a`.
#[inline(always)]
pub(super) fn turn_back(cos: f64, sin: f64, a: Vec3) -> Vec3 {
    [cos * a[0] + sin * a[1], cos * a[1] - sin * a[0], a[2]]
}
