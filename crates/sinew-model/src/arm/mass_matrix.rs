//! Mass matrix and its Cholesky factor.

use super::momentum::turn;
use super::{Arm, ArmWorkspace, Composite, Joint, JointKind};
use crate::StepError;
use crate::vec3::{
    Mat3, Vec3, add, add_scaled, cross, dot, mul, point_inertia, rotate, scale, transpose,
};

impl Arm {
    /// Mass matrix `M(q)`, row-major `n × n`, symmetric, by the composite-rigid-body algorithm.
    ///
    /// The simulator and tests use it; the observer never does.
    ///
    /// * `q`: `n`, rad (m for prismatic joints). Entries in kg·m² (kg, kg·m).
    ///
    /// # Errors
    /// [`StepError::Length`], [`StepError::NotFinite`].
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n·depth).
    ///
    /// # Source
    /// Featherstone, *Rigid Body Dynamics Algorithms*, 2008, section 6.2.
    pub fn mass_matrix<'w>(
        &self,
        ws: &'w mut ArmWorkspace,
        q: &[f64],
    ) -> Result<&'w [f64], StepError> {
        let n = self.joints.len();
        if q.len() != n || !ws.fits(self) {
            return Err(StepError::Length);
        }
        if q.iter().any(|x| !x.is_finite()) {
            return Err(StepError::NotFinite);
        }
        for (joint, slot) in self.joints.iter().zip(ws.composite.iter_mut().skip(1)) {
            *slot = Composite {
                mass: joint.mass,
                first_moment: joint.first_moment,
                inertia: joint.inertia,
            };
        }
        for (joint, (state, q)) in self
            .joints
            .iter()
            .zip(ws.state.iter_mut().skip(1).zip(q.iter()))
        {
            (state.cos, state.sin, state.travel) = match joint.kind {
                JointKind::Revolute => {
                    let (s, c) = libm::sincos(*q);
                    (c, s, 0.0)
                }
                JointKind::Prismatic => (1.0, 0.0, *q),
            };
        }
        for i in (0..n).rev() {
            let joint = &self.joints[i];
            let body = ws.composite[i + 1];
            if joint.parent_slot > 0 {
                let seen = seen_from_parent(joint, &ws.state[i + 1], &body);
                let parent = &mut ws.composite[joint.parent_slot];
                parent.mass += seen.mass;
                parent.first_moment = add(parent.first_moment, seen.first_moment);
                parent.inertia = add_scaled(&parent.inertia, &seen.inertia, 1.0);
            }
            // Momentum of the rigid subtree for a unit velocity of joint i, carried to the base.
            let h = body.first_moment;
            let (mut moment, mut force) = match joint.kind {
                JointKind::Revolute => (
                    [body.inertia[0][2], body.inertia[1][2], body.inertia[2][2]],
                    [-h[1], h[0], 0.0],
                ),
                JointKind::Prismatic => ([h[1], -h[0], 0.0], [0.0, 0.0, body.mass]),
            };
            let mut k = i;
            loop {
                let value = match self.joints[k].kind {
                    JointKind::Revolute => moment[2],
                    JointKind::Prismatic => force[2],
                };
                ws.mass_matrix[i * n + k] = value;
                ws.mass_matrix[k * n + i] = value;
                let parent_slot = self.joints[k].parent_slot;
                if parent_slot == 0 {
                    break;
                }
                (moment, force) =
                    wrench_in_parent(&self.joints[k], &ws.state[k + 1], moment, force);
                k = parent_slot - 1;
            }
        }
        // Joints on different branches don't touch each other.
        for i in 0..n {
            for k in 0..i {
                if !self.is_ancestor(k, i) {
                    ws.mass_matrix[i * n + k] = 0.0;
                    ws.mass_matrix[k * n + i] = 0.0;
                }
            }
        }
        Ok(&ws.mass_matrix)
    }

    /// Whether joint `a` carries joint `i` (or is it).
    fn is_ancestor(&self, a: usize, i: usize) -> bool {
        let mut slot = i + 1;
        while slot > a + 1 {
            slot = self.joints[slot - 1].parent_slot;
        }
        slot == a + 1
    }
}

/// Moment and force about the joint origin, seen from the parent's origin.
pub(super) fn wrench_in_parent(
    joint: &Joint,
    state: &super::BodyState,
    moment: Vec3,
    force: Vec3,
) -> (Vec3, Vec3) {
    let e = &joint.rotation;
    let f = turn(state.cos, state.sin, force);
    let mut n = turn(state.cos, state.sin, moment);
    n[0] -= state.travel * f[1];
    n[1] += state.travel * f[0];
    let (f, n) = (rotate(e, f), rotate(e, n));
    (add(n, cross(joint.translation, f)), f)
}

/// `parent_from_child` of a joint at the state's `q`.
pub(super) fn pose_in_parent(joint: &Joint, state: &super::BodyState) -> (Mat3, Vec3) {
    let (c, s) = (state.cos, state.sin);
    let rz = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
    let slide = rotate(&joint.rotation, [0.0, 0.0, state.travel]);
    (mul(&joint.rotation, &rz), add(joint.translation, slide))
}

fn seen_from_parent(joint: &Joint, state: &super::BodyState, body: &Composite) -> Composite {
    let (rot, r) = pose_in_parent(joint, state);
    let h = rotate(&rot, body.first_moment);
    let turned = mul(&mul(&rot, &body.inertia), &transpose(&rot));
    // ∫ (x·x 1 − x xᵀ) dm with x = r + y
    let mut inertia = add_scaled(&turned, &point_inertia(body.mass, r), 1.0);
    let cross_term = 2.0 * dot(r, h);
    for i in 0..3 {
        for k in 0..3 {
            inertia[i][k] -= r[i] * h[k] + h[i] * r[k];
        }
        inertia[i][i] += cross_term;
    }
    Composite {
        mass: body.mass,
        first_moment: add(h, scale(r, body.mass)),
        inertia,
    }
}
