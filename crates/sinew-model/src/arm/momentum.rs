//! The O(n) momentum pass.

use super::{Arm, ArmJoint, ArmWorkspace, JointKind};
use crate::StepError;
use crate::sines::sin_cos;
use crate::vec3::{Mat3, Vec3, add, cross, rotate, rotate_back};

/// Results of one pass, borrowed from the workspace. All of length `n`.
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
    /// Returns [`StepError::Length`] if a slice or the workspace has the wrong length, and
    /// [`StepError::NotFinite`] if an input is NaN or infinite. The workspace's previous results are
    /// then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    ///
    /// # Source
    /// Kirchhoff, von Stryk, IROS 2018, eq. (7) for the terms of the observer; the subtree form
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
        // A sum is finite only if every term is; overflow of finite terms is rejected as well.
        let mut sum = 0.0;
        for (a, b) in q.iter().zip(dq) {
            sum += a.abs() + b.abs();
        }
        if !sum.is_finite() {
            return Err(StepError::NotFinite);
        }
        sin_cos(q, &mut ws.sin_q, &mut ws.cos_q);
        self.place_joints(&mut ws.moving, q, dq, (&ws.sin_q, &ws.cos_q));
        self.momentum_forward(&mut ws.moving);
        self.momentum_backward(&mut ws.moving, &mut ws.p, &mut ws.ct_dq, &mut ws.g);
        Ok(Momentum {
            p: &ws.p,
            ct_dq: &ws.ct_dq,
            g: &ws.g,
        })
    }

    /// Computes the motion of each joint independently of the others.
    #[inline]
    fn place_joints(
        &self,
        moving: &mut [Moving],
        q: &[f64],
        dq: &[f64],
        (sin_q, cos_q): (&[f64], &[f64]),
    ) {
        let Some((base, bodies)) = moving.split_first_mut() else {
            return;
        };
        base.set_motion(&Motion {
            omega: [0.0; 3],
            v: [0.0; 3],
            gamma: self.gravity,
        });
        let moved = q.iter().zip(dq).zip(sin_q.iter().zip(cos_q));
        for ((joint, body), ((q, dq), (sin_q, cos_q))) in self.joints.iter().zip(bodies).zip(moved)
        {
            body.set_frame(&Frame::new(joint, *q, *dq, (*sin_q, *cos_q)));
        }
    }

    /// Base to tip: velocities, gravity and own momentum of each body.
    #[inline]
    fn momentum_forward(&self, moving: &mut [Moving]) {
        for (i, joint) in self.joints.iter().enumerate() {
            // A joint's slot comes after its parent's, so the split always succeeds.
            let Some((before, after)) = moving.split_at_mut_checked(i + 1) else {
                return;
            };
            let (Some(parent), Some(body)) = (before.get(joint.parent_slot), after.first_mut())
            else {
                return;
            };
            let motion = parent.motion().carried_on(&body.frame());
            body.set_motion(&motion);
            body.set_carried(&SubtreeMomentum::of(joint, &motion));
        }
    }

    /// Tip to base: project, then hand momentum and first moment to the parent.
    #[inline]
    fn momentum_backward(
        &self,
        moving: &mut [Moving],
        p: &mut [f64],
        ct_dq: &mut [f64],
        g: &mut [f64],
    ) {
        let joints = self.joints.iter().enumerate();
        let outputs = p.iter_mut().zip(ct_dq.iter_mut()).zip(g.iter_mut());
        for ((i, joint), ((p, ct_dq), g)) in joints.zip(outputs).rev() {
            let Some((before, after)) = moving.split_at_mut_checked(i + 1) else {
                return;
            };
            let (Some(parent), Some(body)) = (before.get_mut(joint.parent_slot), after.first())
            else {
                return;
            };
            let carried = body.carried();
            (*p, *ct_dq, *g) = project(joint, &body.motion(), &carried);
            if joint.parent_slot != 0 {
                parent.add(&carried.seen_from_parent(joint, &body.frame()));
            }
        }
    }
}

/// Frame of a joint at its `q` and `dq`, independent of the other joints.
#[derive(Clone, Copy)]
struct Frame {
    /// Rotation matrix `parent_from_body`.
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
    fn new(joint: &ArmJoint, q: f64, dq: f64, turned: (f64, f64)) -> Self {
        let (rotation, translation) = joint.placed_by(q, turned);
        let (spin, slide) = match joint.kind {
            JointKind::Revolute => (dq, 0.0),
            JointKind::Prismatic => (0.0, dq),
        };
        Self {
            rotation,
            translation,
            spin,
            slide,
        }
    }
}

/// Motion that a body passes to its children; in body axes.
#[derive(Clone, Copy)]
struct Motion {
    /// Angular velocity of the body.
    omega: Vec3,
    /// Velocity of the body's origin.
    v: Vec3,
    /// Gravity in body axes.
    gamma: Vec3,
}

impl Motion {
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

/// Momentum that a body passes to its parent, about the origin of the frame it is expressed in.
#[derive(Clone, Copy, Default)]
struct SubtreeMomentum {
    /// Linear momentum of the subtree.
    force: Vec3,
    /// Angular momentum of the subtree.
    moment: Vec3,
    /// First mass moment.
    first: Vec3,
}

impl SubtreeMomentum {
    /// Momentum of one body without its children: `H = [I ω + h × v; m v + ω × h]`.
    #[inline(always)]
    fn of(joint: &ArmJoint, motion: &Motion) -> Self {
        let (w, v) = (motion.omega, motion.v);
        let (m, h, i) = (joint.mass, joint.first_moment, &joint.inertia);
        Self {
            force: [
                m * v[0] + (w[1] * h[2] - w[2] * h[1]),
                m * v[1] + (w[2] * h[0] - w[0] * h[2]),
                m * v[2] + (w[0] * h[1] - w[1] * h[0]),
            ],
            moment: [
                i[0][0] * w[0] + i[0][1] * w[1] + i[0][2] * w[2] + (h[1] * v[2] - h[2] * v[1]),
                i[0][1] * w[0] + i[1][1] * w[1] + i[1][2] * w[2] + (h[2] * v[0] - h[0] * v[2]),
                i[0][2] * w[0] + i[1][2] * w[1] + i[2][2] * w[2] + (h[0] * v[1] - h[1] * v[0]),
            ],
            first: h,
        }
    }

    /// The momentum of a joint's subtree about its parent's origin, in its parent's axes.
    #[inline(always)]
    fn seen_from_parent(&self, joint: &ArmJoint, frame: &Frame) -> Self {
        let (e, r, m) = (&frame.rotation, frame.translation, joint.subtree_mass);
        let force = rotate(e, self.force);
        let moment = rotate(e, self.moment);
        let first = rotate(e, self.first);
        Self {
            force,
            moment: add(moment, cross(r, force)),
            first: [
                first[0] + m * r[0],
                first[1] + m * r[1],
                first[2] + m * r[2],
            ],
        }
    }
}

/// Frame, motion and subtree momentum of one body, stored between the sweeps.
///
/// The layout is what makes the pass fast on x86-64, and is therefore unusual: no two results of the
/// same sweep are neighbours in memory. Where they are, the compiler packs them two by two into
/// vector registers, and the shuffles which that takes cost a seventh of the whole pass.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Moving([Component; 3]);

/// The x, y or z components of all results, with those of the first sweep between those of the second.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C)]
struct Component {
    rotation_0: f64,
    omega: f64,
    rotation_1: f64,
    v: f64,
    rotation_2: f64,
    gamma: f64,
    translation: f64,
    force: f64,
    spin: f64,
    moment: f64,
    slide: f64,
    first: f64,
}

impl Moving {
    /// Angular velocity, velocity and gravity in body axes, after a pass.
    pub(super) fn velocities(&self) -> (Vec3, Vec3, Vec3) {
        let motion = self.motion();
        (motion.omega, motion.v, motion.gamma)
    }

    /// `parent_from_joint`, after a pass: rotation and origin.
    pub(super) fn placement(&self) -> (Mat3, Vec3) {
        let frame = self.frame();
        (frame.rotation, frame.translation)
    }

    #[inline(always)]
    fn set_frame(&mut self, frame: &Frame) {
        for (k, slot) in self.0.iter_mut().enumerate() {
            [slot.rotation_0, slot.rotation_1, slot.rotation_2] = frame.rotation[k];
            slot.translation = frame.translation[k];
        }
        self.0[2].spin = frame.spin;
        self.0[2].slide = frame.slide;
    }

    #[inline(always)]
    fn frame(&self) -> Frame {
        let [x, y, z] = &self.0;
        Frame {
            rotation: [
                [x.rotation_0, x.rotation_1, x.rotation_2],
                [y.rotation_0, y.rotation_1, y.rotation_2],
                [z.rotation_0, z.rotation_1, z.rotation_2],
            ],
            translation: [x.translation, y.translation, z.translation],
            spin: z.spin,
            slide: z.slide,
        }
    }

    #[inline(always)]
    fn set_motion(&mut self, motion: &Motion) {
        for (k, slot) in self.0.iter_mut().enumerate() {
            slot.omega = motion.omega[k];
            slot.v = motion.v[k];
            slot.gamma = motion.gamma[k];
        }
    }

    #[inline(always)]
    fn motion(&self) -> Motion {
        let [x, y, z] = &self.0;
        Motion {
            omega: [x.omega, y.omega, z.omega],
            v: [x.v, y.v, z.v],
            gamma: [x.gamma, y.gamma, z.gamma],
        }
    }

    #[inline(always)]
    fn set_carried(&mut self, carried: &SubtreeMomentum) {
        for (k, slot) in self.0.iter_mut().enumerate() {
            slot.force = carried.force[k];
            slot.moment = carried.moment[k];
            slot.first = carried.first[k];
        }
    }

    #[inline(always)]
    fn add(&mut self, carried: &SubtreeMomentum) {
        for (k, slot) in self.0.iter_mut().enumerate() {
            slot.force += carried.force[k];
            slot.moment += carried.moment[k];
            slot.first += carried.first[k];
        }
    }

    #[inline(always)]
    fn carried(&self) -> SubtreeMomentum {
        let [x, y, z] = &self.0;
        SubtreeMomentum {
            force: [x.force, y.force, z.force],
            moment: [x.moment, y.moment, z.moment],
            first: [x.first, y.first, z.first],
        }
    }
}

/// Projects the motion of a body and the momentum of its subtree on its joint: `(p, Cᵀdq, g)`.
#[inline(always)]
fn project(joint: &ArmJoint, motion: &Motion, carried: &SubtreeMomentum) -> (f64, f64, f64) {
    let (w, v, gamma) = (motion.omega, motion.v, motion.gamma);
    let (f, n, s) = (carried.force, carried.moment, carried.first);
    match joint.kind {
        JointKind::Revolute => (
            n[2],
            (w[1] * n[0] - w[0] * n[1]) + (v[1] * f[0] - v[0] * f[1]),
            s[1] * gamma[0] - s[0] * gamma[1],
        ),
        JointKind::Prismatic => (
            f[2],
            w[1] * f[0] - w[0] * f[1],
            -joint.subtree_mass * gamma[2],
        ),
    }
}
