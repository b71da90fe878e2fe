//! The O(n) momentum pass.

use super::{Arm, ArmWorkspace, BodyState, Joint, JointKind};
use crate::StepError;
use crate::vec3::{Mat3, Vec3, rotate, rotate_back};

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
        self.place_joints(&mut ws.frames, q, dq);
        self.momentum_forward(&ws.frames, &mut ws.state);
        self.momentum_backward(
            &ws.frames,
            &mut ws.state,
            &mut ws.p,
            &mut ws.ct_dq,
            &mut ws.g,
        );
        Ok(Momentum {
            p: &ws.p,
            ct_dq: &ws.ct_dq,
            g: &ws.g,
        })
    }

    /// What each joint does by itself: nothing here waits for another joint, so that sines of all
    /// joints are computed side by side.
    #[inline]
    fn place_joints(&self, frames: &mut [Frame], q: &[f64], dq: &[f64]) {
        for (((joint, frame), q), dq) in self.joints.iter().zip(frames).zip(q).zip(dq) {
            *frame = Frame::new(joint, *q, *dq);
        }
    }

    /// Base to tip: velocities, gravity and own momentum of each body.
    #[inline]
    fn momentum_forward(&self, frames: &[Frame], state: &mut [BodyState]) {
        // Most joints hang on the one before: its velocity then is still in registers.
        let Some((base, _)) = state.split_first() else {
            return;
        };
        let mut last = Motion::of(base);
        for (i, (joint, frame)) in self.joints.iter().zip(frames).enumerate() {
            if joint.parent_slot != i {
                let Some(parent) = state.get(joint.parent_slot) else {
                    return;
                };
                last = Motion::of(parent);
            }
            last = last.carried_on(frame);
            let Some(body) = state.get_mut(i + 1) else {
                return;
            };
            body.omega = last.omega;
            body.v = last.v;
            body.gamma = last.gamma;
            own_momentum(joint, body);
        }
    }

    /// Tip to base: project, then hand momentum and first moment to the parent.
    #[inline]
    fn momentum_backward(
        &self,
        frames: &[Frame],
        state: &mut [BodyState],
        p: &mut [f64],
        ct_dq: &mut [f64],
        g: &mut [f64],
    ) {
        let joints = self.joints.iter().zip(frames).enumerate();
        let outputs = p.iter_mut().zip(ct_dq.iter_mut()).zip(g.iter_mut());
        for ((i, (joint, frame)), ((p, ct_dq), g)) in joints.zip(outputs).rev() {
            // A joint's slot comes after its parent's, so the split always succeeds.
            let Some((before, after)) = state.split_at_mut_checked(i + 1) else {
                return;
            };
            let (Some(parent), Some(body)) = (before.get_mut(joint.parent_slot), after.first())
            else {
                return;
            };
            (*p, *ct_dq, *g) = project(joint, body);
            if joint.parent_slot != 0 {
                hand_to_parent(joint, frame, body, parent);
            }
        }
    }
}

/// A joint at its `q` and `dq`, before anything is known of the others.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Frame {
    /// `parent_from_joint`: the fixed rotation and the joint's own in one matrix, so that the
    /// chain of joints waits for one product per joint, not two.
    rotation: Mat3,
    /// Origin in the parent's frame, travel of a prismatic joint included, m.
    translation: Vec3,
    /// Own angular velocity about z.
    spin: f64,
    /// Own velocity along z.
    slide: f64,
}

impl Frame {
    #[inline(always)]
    fn new(joint: &Joint, q: f64, dq: f64) -> Self {
        let (e, r) = (&joint.rotation, joint.translation);
        match joint.kind {
            JointKind::Revolute => {
                let (s, c) = libm::sincos(q);
                Self {
                    // E Rz(q)
                    rotation: [
                        [
                            c * e[0][0] + s * e[0][1],
                            c * e[0][1] - s * e[0][0],
                            e[0][2],
                        ],
                        [
                            c * e[1][0] + s * e[1][1],
                            c * e[1][1] - s * e[1][0],
                            e[1][2],
                        ],
                        [
                            c * e[2][0] + s * e[2][1],
                            c * e[2][1] - s * e[2][0],
                            e[2][2],
                        ],
                    ],
                    translation: r,
                    spin: dq,
                    slide: 0.0,
                }
            }
            JointKind::Prismatic => Self {
                rotation: *e,
                translation: [r[0] + q * e[0][2], r[1] + q * e[1][2], r[2] + q * e[2][2]],
                spin: 0.0,
                slide: dq,
            },
        }
    }
}

/// What a body hands to those it carries.
#[derive(Clone, Copy)]
struct Motion {
    omega: Vec3,
    v: Vec3,
    gamma: Vec3,
}

impl Motion {
    #[inline(always)]
    fn of(body: &BodyState) -> Self {
        Self {
            omega: body.omega,
            v: body.v,
            gamma: body.gamma,
        }
    }

    /// Motion of the body a joint carries from that of the body it sits on.
    #[inline(always)]
    fn carried_on(&self, frame: &Frame) -> Self {
        let (e, r, w) = (&frame.rotation, frame.translation, self.omega);
        let at_joint = [
            self.v[0] + (w[1] * r[2] - w[2] * r[1]),
            self.v[1] + (w[2] * r[0] - w[0] * r[2]),
            self.v[2] + (w[0] * r[1] - w[1] * r[0]),
        ];
        let mut omega = rotate_back(e, w);
        let mut v = rotate_back(e, at_joint);
        omega[2] += frame.spin;
        v[2] += frame.slide;
        Self {
            omega,
            v,
            gamma: rotate_back(e, self.gamma),
        }
    }
}

/// `H = [I ω + h × v; m v + ω × h]` of one body alone.
#[inline(always)]
fn own_momentum(joint: &Joint, body: &mut BodyState) {
    let (w, v) = (body.omega, body.v);
    let (m, h, i) = (joint.mass, joint.first_moment, &joint.inertia);
    body.moment = [
        i[0][0] * w[0] + i[0][1] * w[1] + i[0][2] * w[2] + (h[1] * v[2] - h[2] * v[1]),
        i[0][1] * w[0] + i[1][1] * w[1] + i[1][2] * w[2] + (h[2] * v[0] - h[0] * v[2]),
        i[0][2] * w[0] + i[1][2] * w[1] + i[2][2] * w[2] + (h[0] * v[1] - h[1] * v[0]),
    ];
    body.force = [
        m * v[0] + (w[1] * h[2] - w[2] * h[1]),
        m * v[1] + (w[2] * h[0] - w[0] * h[2]),
        m * v[2] + (w[0] * h[1] - w[1] * h[0]),
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
fn hand_to_parent(joint: &Joint, frame: &Frame, body: &BodyState, parent: &mut BodyState) {
    let (e, r, m) = (&frame.rotation, frame.translation, joint.subtree_mass);
    let f = rotate(e, body.force);
    let n = rotate(e, body.moment);
    let h = rotate(e, body.first_moment);
    for k in 0..3 {
        parent.force[k] += f[k];
        parent.first_moment[k] += h[k] + m * r[k];
    }
    parent.moment[0] += n[0] + (r[1] * f[2] - r[2] * f[1]);
    parent.moment[1] += n[1] + (r[2] * f[0] - r[0] * f[2]);
    parent.moment[2] += n[2] + (r[0] * f[1] - r[1] * f[0]);
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
