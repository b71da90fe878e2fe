//! Energies, for identities and the simulator's balance.

use super::{Arm, ArmWorkspace};
use crate::StepError;
use crate::vec3::{add, dot, rotate, rotate_back, scale};

impl Arm {
    /// Kinetic energy `T = ½ dqᵀ p`, J.
    ///
    /// # Errors
    /// Returns the errors of [`Arm::momentum`].
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    pub fn kinetic_energy(
        &self,
        ws: &mut ArmWorkspace,
        q: &[f64],
        dq: &[f64],
    ) -> Result<f64, StepError> {
        let terms = self.momentum(ws, q, dq)?;
        Ok(0.5 * terms.p.iter().zip(dq).map(|(p, dq)| p * dq).sum::<f64>())
    }

    /// Potential energy `V = −Σ m γ·c`, zero where the centre of mass is level with the base
    /// origin, J. Links fixed to the base are excluded.
    ///
    /// # Errors
    /// Returns [`StepError::Length`] or [`StepError::NotFinite`] for an invalid input.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One O(n) pass.
    pub fn potential_energy(&self, ws: &mut ArmWorkspace, q: &[f64]) -> Result<f64, StepError> {
        let n = self.joints.len();
        if q.len() != n || !ws.fits(self) {
            return Err(StepError::Length);
        }
        if q.iter().any(|x| !x.is_finite()) {
            return Err(StepError::NotFinite);
        }
        let mut energy = 0.0;
        // `v` of a slot holds the position of its origin seen in its own axes: no orientation
        // has to be kept, because gravity is carried along in body axes too.
        ws.state[0].v = [0.0; 3];
        for i in 0..n {
            let joint = &self.joints[i];
            let (before, after) = ws.state.split_at_mut(i + 1);
            let (parent, body) = (&before[joint.parent_slot], &mut after[0]);
            let (rotation, origin) = joint.placed(q[i]);
            body.gamma = rotate_back(&rotation, parent.gamma);
            body.v = rotate_back(&rotation, add(parent.v, origin));
            let moment = add(scale(body.v, joint.mass), joint.first_moment);
            energy -= dot(body.gamma, moment);
        }
        ws.state[0].v = [0.0; 3];
        debug_assert_eq!(rotate(&crate::vec3::IDENTITY, ws.state[0].omega), [0.0; 3]);
        Ok(energy)
    }
}
