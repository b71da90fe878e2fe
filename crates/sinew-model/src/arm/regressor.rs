//! How momentum and bias depend on the mass properties: the regressors of identification.

use super::momentum::Moving;
use super::{Arm, ArmWorkspace, JointKind};
use crate::StepError;
use crate::vec3::{Vec3, add, cross, rotate, scale};
use alloc::vec::Vec;

/// Inertial parameters per body, in this order: mass, first moment (x, y, z), inertia about the
/// joint origin (xx, xy, xz, yy, yz, zz), all in the body's re-based frame (axis along z).
pub const PARAMETERS_PER_BODY: usize = 10;

/// Storage for the regressors of an arm of `n` joints, sized at construction.
///
/// `p = P π` and `Cᵀdq − g = A π` with `π` the inertial parameters of all bodies in joint order.
#[derive(Debug, Clone)]
pub struct MomentumRegressor {
    n: usize,
    /// `P`, row-major `n × 10 n`, N·m·s per parameter unit.
    pub p: Vec<f64>,
    /// `A`, row-major `n × 10 n`, N·m per parameter unit.
    pub a: Vec<f64>,
}

impl MomentumRegressor {
    /// Storage for `arm`. This is where memory is allocated, once.
    pub fn new(arm: &Arm) -> Self {
        let n = arm.dof();
        Self {
            n,
            p: alloc::vec![0.0; n * n * PARAMETERS_PER_BODY],
            a: alloc::vec![0.0; n * n * PARAMETERS_PER_BODY],
        }
    }

    /// Number of columns, `10 n`.
    pub fn columns(&self) -> usize {
        self.n * PARAMETERS_PER_BODY
    }
}

impl Arm {
    /// Fills `out` with the regressors at `q`, `dq`.
    ///
    /// Each body's momentum for a unit of each of its ten parameters is carried to the base and
    /// projected on every joint on the way, as in [`Arm::momentum`].
    ///
    /// # Errors
    /// As [`Arm::momentum`]; [`StepError::Length`] when `out` was made for another arm.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n · depth).
    pub fn momentum_regressor(
        &self,
        ws: &mut ArmWorkspace,
        q: &[f64],
        dq: &[f64],
        out: &mut MomentumRegressor,
    ) -> Result<(), StepError> {
        let n = self.joints.len();
        if out.n != n {
            return Err(StepError::Length);
        }
        // Leaves velocities, gravity and joint placements in the workspace.
        self.momentum(ws, q, dq)?;
        out.p.fill(0.0);
        out.a.fill(0.0);
        let columns = n * PARAMETERS_PER_BODY;
        for b in 0..n {
            let Some((omega, v, _)) = ws.moving.get(b + 1).map(Moving::velocities) else {
                return Err(StepError::Length);
            };
            for k in 0..PARAMETERS_PER_BODY {
                let mut unit = Unit::of(k, omega, v);
                let mut i = b;
                loop {
                    let (Some(joint), Some(body)) = (self.joints.get(i), ws.moving.get(i + 1))
                    else {
                        return Err(StepError::Length);
                    };
                    let (w, v, g) = body.velocities();
                    let (m, f, s) = (unit.moment, unit.force, unit.first_moment);
                    let (p, a) = match joint.kind {
                        JointKind::Revolute => (
                            m[2],
                            w[1] * m[0] - w[0] * m[1] + v[1] * f[0]
                                - v[0] * f[1]
                                - (s[1] * g[0] - s[0] * g[1]),
                        ),
                        JointKind::Prismatic => {
                            (f[2], w[1] * f[0] - w[0] * f[1] + unit.mass * g[2])
                        }
                    };
                    let at = i * columns + b * PARAMETERS_PER_BODY + k;
                    if let (Some(to_p), Some(to_a)) = (out.p.get_mut(at), out.a.get_mut(at)) {
                        (*to_p, *to_a) = (p, a);
                    }
                    if joint.parent_slot == 0 {
                        break;
                    }
                    let (rotation, origin) = body.placement();
                    let force = rotate(&rotation, unit.force);
                    unit = Unit {
                        mass: unit.mass,
                        moment: add(rotate(&rotation, unit.moment), cross(origin, force)),
                        force,
                        first_moment: add(
                            rotate(&rotation, unit.first_moment),
                            scale(origin, unit.mass),
                        ),
                    };
                    i = joint.parent_slot - 1;
                }
            }
        }
        Ok(())
    }

    /// Inertial parameters `π` of all bodies, `10 n`, in the order of
    /// [`PARAMETERS_PER_BODY`].
    pub fn inertial_parameters(&self) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.dof() * PARAMETERS_PER_BODY);
        for joint in &self.joints {
            let (h, i) = (joint.first_moment, &joint.inertia);
            out.extend_from_slice(&[
                joint.mass, h[0], h[1], h[2], i[0][0], i[0][1], i[0][2], i[1][1], i[1][2], i[2][2],
            ]);
        }
        out
    }
}

/// Momentum of a body for a unit of one inertial parameter.
struct Unit {
    mass: f64,
    moment: Vec3,
    force: Vec3,
    first_moment: Vec3,
}

impl Unit {
    fn of(parameter: usize, w: Vec3, v: Vec3) -> Self {
        let axis = |k: usize| {
            let mut e = [0.0; 3];
            e[k] = 1.0;
            e
        };
        let nothing = Self {
            mass: 0.0,
            moment: [0.0; 3],
            force: [0.0; 3],
            first_moment: [0.0; 3],
        };
        // Entries of the inertia: which axes they couple.
        let couple = |i: usize, k: usize| {
            let mut moment = [0.0; 3];
            moment[i] += w[k];
            if i != k {
                moment[k] += w[i];
            }
            Self { moment, ..nothing }
        };
        match parameter {
            0 => Self {
                mass: 1.0,
                force: v,
                ..nothing
            },
            1..=3 => {
                let h = axis(parameter - 1);
                Self {
                    moment: cross(h, v),
                    force: cross(w, h),
                    first_moment: h,
                    ..nothing
                }
            }
            4 => couple(0, 0),
            5 => couple(0, 1),
            6 => couple(0, 2),
            7 => couple(1, 1),
            8 => couple(1, 2),
            _ => couple(2, 2),
        }
    }
}
