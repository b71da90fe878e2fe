//! Forces at a link and changed masses: contacts, payloads, perturbed models.

use super::build::{ArmError, BodyInertia, Pose, check_body};
use super::{Arm, ArmWorkspace, JointKind};
use crate::StepError;
use crate::vec3::{Vec3, add, cross, mul, rotate, rotate_back, scale};

impl Arm {
    /// Pose of link `link` in the base frame at `q`.
    ///
    /// # Errors
    /// Returns [`StepError::Length`], [`StepError::NotFinite`]; [`StepError::UnknownLink`].
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(depth).
    pub fn link_pose(
        &self,
        ws: &mut ArmWorkspace,
        q: &[f64],
        link: &str,
    ) -> Result<Pose, StepError> {
        let frame = self
            .links
            .iter()
            .find(|l| l.name == link)
            .ok_or(StepError::UnknownLink)?;
        let Some(joint) = frame.joint else {
            return Ok(frame.pose);
        };
        Ok(self.joint_pose(ws, q, joint)?.then(&frame.pose))
    }

    /// Adds the joint torques of a force at a point of a link: `tau += Jᵀ f`.
    ///
    /// * `point`: in the link frame, m. `force`: in the *base* frame, N.
    ///
    /// # Errors
    /// Returns [`StepError::Length`], [`StepError::NotFinite`]; [`StepError::UnknownLink`]. `tau` is
    /// then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(depth).
    pub fn add_point_force(
        &self,
        ws: &mut ArmWorkspace,
        q: &[f64],
        link: &str,
        point: Vec3,
        force: Vec3,
        tau: &mut [f64],
    ) -> Result<(), StepError> {
        if tau.len() != self.joints.len() {
            return Err(StepError::Length);
        }
        if point.iter().chain(&force).any(|x| !x.is_finite()) {
            return Err(StepError::NotFinite);
        }
        let frame = self
            .links
            .iter()
            .find(|l| l.name == link)
            .ok_or(StepError::UnknownLink)?;
        let Some(i) = frame.joint else {
            return Ok(());
        };
        let base_from_joint = self.joint_pose(ws, q, i)?;
        let force = rotate_back(&base_from_joint.rotation, force);
        let moment = cross(frame.pose.apply(point), force);
        self.each_carries(ws, i, (moment, force), |i, torque| tau[i] += torque);
        Ok(())
    }

    /// Writes the joint torques of a force of 1 N along each axis of the base on body `body`, N·m.
    ///
    /// * `points`: points of action in the body's re-based frame, m. `out`: `n` values per point, one point after the
    ///   other.
    ///
    /// # Errors
    /// Returns [`StepError::Length`] for a wrong length and [`StepError::NotFinite`] for NaN or infinite input.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(depth) for every point.
    pub(crate) fn torques_per_newton(
        &self,
        ws: &mut ArmWorkspace,
        q: &[f64],
        body: usize,
        points: &[Vec3],
        out: &mut [Vec3],
    ) -> Result<(), StepError> {
        let n = self.joints.len();
        if body >= n || out.len() != n * points.len() {
            return Err(StepError::Length);
        }
        let base_from_joint = self.joint_pose(ws, q, body)?;
        out.fill([0.0; 3]);
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (point, out) in points.iter().zip(out.chunks_exact_mut(n)) {
            for (axis, along) in axes.into_iter().enumerate() {
                let force = rotate_back(&base_from_joint.rotation, along);
                let moment = cross(*point, force);
                self.each_carries(ws, body, (moment, force), |i, torque| {
                    if let Some(to) = out.get_mut(i).and_then(|own| own.get_mut(axis)) {
                        *to = torque;
                    }
                });
            }
        }
        Ok(())
    }

    /// Torque at `joint` and every one before it of a wrench in the frame of `joint`; their poses are in the workspace.
    fn each_carries(
        &self,
        ws: &ArmWorkspace,
        mut joint: usize,
        (mut moment, mut force): (Vec3, Vec3),
        mut torque: impl FnMut(usize, f64),
    ) {
        while let Some(own) = self.joints.get(joint) {
            let along = match own.kind {
                JointKind::Revolute => moment[2],
                JointKind::Prismatic => force[2],
            };
            torque(joint, along);
            let (Some(parent), Some(state)) =
                (own.parent_slot.checked_sub(1), ws.state.get(joint + 1))
            else {
                return;
            };
            (moment, force) = super::mass_matrix::wrench_in_parent(state, moment, force);
            joint = parent;
        }
    }

    /// `base_from_joint`, leaving the pose of every ancestor in the workspace.
    fn joint_pose(
        &self,
        ws: &mut ArmWorkspace,
        q: &[f64],
        joint: usize,
    ) -> Result<Pose, StepError> {
        if q.len() != self.joints.len() || !ws.fits(self) {
            return Err(StepError::Length);
        }
        if q.iter().any(|x| !x.is_finite()) {
            return Err(StepError::NotFinite);
        }
        let mut pose = Pose::IDENTITY;
        let mut slot = joint + 1;
        while let Some(i) = slot.checked_sub(1) {
            let (Some(j), Some(q), Some(state)) =
                (self.joints.get(i), q.get(i), ws.state.get_mut(slot))
            else {
                break;
            };
            (state.rotation, state.origin) = j.placed(*q);
            pose = Pose {
                rotation: mul(&state.rotation, &pose.rotation),
                translation: add(rotate(&state.rotation, pose.translation), state.origin),
            };
            slot = j.parent_slot;
        }
        Ok(pose)
    }

    /// Returns a copy of the arm with `body` fixed to `link`, where `body` is given in the link frame. A negative mass
    /// is an error; a body on a link that is fixed to the base has no effect.
    ///
    /// # Errors
    /// Returns `Ok(None)` if the link does not exist, and an [`ArmError`] if `body` is physically impossible.
    pub fn with_payload(&self, link: &str, body: BodyInertia) -> Result<Option<Self>, ArmError> {
        check_body(link, &body)?;
        let Some(frame) = self.links.iter().find(|l| l.name == link) else {
            return Ok(None);
        };
        let mut arm = self.clone();
        if let Some(joint) = frame.joint {
            let (first_moment, inertia) = body.seen_from(&frame.pose).at_origin();
            let j = &mut arm.joints[joint];
            j.mass += body.mass;
            j.first_moment = add(j.first_moment, first_moment);
            j.inertia = crate::vec3::add_scaled(&j.inertia, &inertia, 1.0);
            arm.sum_subtree_masses();
        }
        Ok(Some(arm))
    }

    /// Body of joint `i` in its re-based frame (axis along z), or `None` past the last.
    pub fn body(&self, i: usize) -> Option<BodyInertia> {
        let j = self.joints.get(i)?;
        let com = if j.mass > 0.0 {
            scale(j.first_moment, 1.0 / j.mass)
        } else {
            [0.0; 3]
        };
        Some(BodyInertia {
            mass: j.mass,
            com,
            inertia: crate::vec3::add_scaled(
                &j.inertia,
                &crate::vec3::point_inertia(j.mass, com),
                -1.0,
            ),
        })
    }

    /// The same arm with the body of joint `i` replaced; `body` in the re-based frame that
    /// [`Arm::body`] speaks. `i` past the last changes nothing.
    ///
    /// # Errors
    /// Returns an [`ArmError`] when `body` is impossible.
    pub fn with_body(&self, i: usize, body: BodyInertia) -> Result<Self, ArmError> {
        let mut arm = self.clone();
        if let (Some(joint), Some(name)) = (arm.joints.get_mut(i), self.names.get(i)) {
            check_body(name, &body)?;
            let (first_moment, inertia) = body.at_origin();
            joint.mass = body.mass;
            joint.first_moment = first_moment;
            joint.inertia = inertia;
            arm.sum_subtree_masses();
        }
        Ok(arm)
    }

    /// The same arm with every mass and inertia multiplied by `factor`, which multiplies `M`, `C` and `g` by it: the
    /// paper's model error "M, C, g each −10 %" is `0.9`.
    ///
    /// # Errors
    /// Returns an [`ArmError`] when `factor` is negative or not finite.
    pub fn with_scaled_masses(&self, factor: f64) -> Result<Self, ArmError> {
        check_body("mass factor", &BodyInertia::point(factor, [0.0; 3]))?;
        let mut arm = self.clone();
        for j in &mut arm.joints {
            j.mass *= factor;
            j.first_moment = scale(j.first_moment, factor);
            for row in &mut j.inertia {
                *row = scale(*row, factor);
            }
        }
        arm.sum_subtree_masses();
        Ok(arm)
    }
}
