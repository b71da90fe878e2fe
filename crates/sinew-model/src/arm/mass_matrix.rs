//! Mass matrix and its Cholesky factor.

use super::{Arm, ArmWorkspace, BodyState, Composite, JointKind};
use crate::StepError;
use crate::vec3::{Vec3, add, add_scaled, cross, dot, rotate, scale};

impl Arm {
    /// Mass matrix `M(q)`, row-major `n × n`, symmetric, by the composite-rigid-body algorithm.
    ///
    /// The simulator and tests use it; the observer never does.
    ///
    /// * `q`: `n`, rad (m for prismatic joints). Entries in kg·m² (kg, kg·m).
    ///
    /// # Errors
    /// Returns [`StepError::Length`], [`StepError::NotFinite`].
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
        self.place(ws, q);
        self.composite_bodies(ws);
        Ok(&ws.mass_matrix)
    }

    /// Poses of all bodies in their parents' frames, to `ws.state`. Lengths are the caller's care.
    pub(super) fn place(&self, ws: &mut ArmWorkspace, q: &[f64]) {
        for ((joint, body), q) in self.joints.iter().zip(ws.state.iter_mut().skip(1)).zip(q) {
            (body.rotation, body.origin) = joint.placed(*q);
        }
    }

    /// Mass matrix of the placed bodies, to `ws.mass_matrix`.
    fn composite_bodies(&self, ws: &mut ArmWorkspace) {
        let n = self.joints.len();
        for (joint, slot) in self.joints.iter().zip(ws.composite.iter_mut().skip(1)) {
            *slot = Composite {
                mass: joint.mass,
                first_moment: joint.first_moment,
                inertia: joint.inertia,
            };
        }
        for i in (0..n).rev() {
            let joint = &self.joints[i];
            let body = ws.composite[i + 1];
            if joint.parent_slot > 0 {
                let seen = seen_from_parent(&ws.state[i + 1], &body);
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
                (moment, force) = wrench_in_parent(&ws.state[k + 1], moment, force);
                k = parent_slot - 1;
            }
        }
        // Joints on different branches are independent.
        for i in 0..n {
            for k in 0..i {
                if !self.is_ancestor(k, i) {
                    ws.mass_matrix[i * n + k] = 0.0;
                    ws.mass_matrix[k * n + i] = 0.0;
                }
            }
        }
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
#[inline(always)]
pub(super) fn wrench_in_parent(body: &BodyState, moment: Vec3, force: Vec3) -> (Vec3, Vec3) {
    let (f, n) = (
        rotate(&body.rotation, force),
        rotate(&body.rotation, moment),
    );
    (add(n, cross(body.origin, f)), f)
}

#[inline(always)]
fn seen_from_parent(state: &BodyState, body: &Composite) -> Composite {
    let (rot, r, m) = (&state.rotation, state.origin, body.mass);
    let h = rotate(rot, body.first_moment);
    // R I Rᵀ, whose upper half is its lower half.
    let half = [
        rotate(&body.inertia, rot[0]),
        rotate(&body.inertia, rot[1]),
        rotate(&body.inertia, rot[2]),
    ];
    // ∫ (x·x 1 − x xᵀ) dm with x = r + y
    let diagonal = m * dot(r, r) + 2.0 * dot(r, h);
    let mut inertia = [[0.0; 3]; 3];
    for i in 0..3 {
        for k in 0..=i {
            let moment = m * r[i] * r[k] + r[i] * h[k] + h[i] * r[k];
            let value = dot(rot[i], half[k]) - moment;
            inertia[i][k] = value;
            inertia[k][i] = value;
        }
        inertia[i][i] += diagonal;
    }
    Composite {
        mass: m,
        first_moment: add(h, scale(r, m)),
        inertia,
    }
}
