//! How momentum and bias depend on the mass properties: the regressors of identification.

use super::{Arm, ArmWorkspace, JointKind};
use crate::StepError;
use crate::vec3::{Mat3, Vec3, add, cross, dot, rotate_back};
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
    /// View of the current joint on each body; `None` if it does not carry the body.
    carried: Vec<Option<Carried>>,
}

impl MomentumRegressor {
    /// Storage for `arm`. This is where memory is allocated, once.
    pub fn new(arm: &Arm) -> Self {
        let n = arm.dof();
        Self {
            n,
            p: alloc::vec![0.0; n * n * PARAMETERS_PER_BODY],
            a: alloc::vec![0.0; n * n * PARAMETERS_PER_BODY],
            carried: alloc::vec![None; n],
        }
    }

    /// Number of columns, `10 n`.
    pub fn columns(&self) -> usize {
        self.n * PARAMETERS_PER_BODY
    }

    /// Rows of `P` and `A` of a joint.
    pub(crate) fn rows(&self, joint: usize) -> Option<[&[f64]; 2]> {
        let columns = self.columns();
        let row = joint * columns..(joint + 1) * columns;
        Some([self.p.get(row.clone())?, self.a.get(row)?])
    }
}

impl Arm {
    /// Fills `out` with the regressors at `q`, `dq`.
    ///
    /// A body's momentum `H = [I ω + h × v; m v + ω × h]` is linear in its parameters, and joint `i`
    /// sees of it `p = Z·H` and `∂T/∂qᵢ = ξ·H`, with the twist `Z` of a unit of `dqᵢ` and
    /// `ξ = [ωᵢ × z; vᵢ × z]` (prismatic: `[0; ωᵢ × z]`), both carried from the joint out to the body.
    ///
    /// # Errors
    /// Returns the errors of [`Arm::momentum`]; [`StepError::Length`] when `out` was made for another arm.
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
        let MomentumRegressor { p, a, carried, .. } = out;
        let columns = (n * PARAMETERS_PER_BODY).max(1);
        let lines = p.chunks_exact_mut(columns).zip(a.chunks_exact_mut(columns));
        for ((i, joint), (p, a)) in self.joints.iter().enumerate().zip(lines) {
            let bodies = self.joints.iter().zip(ws.moving.iter().skip(1)).enumerate();
            let entries = p
                .chunks_exact_mut(PARAMETERS_PER_BODY)
                .zip(a.chunks_exact_mut(PARAMETERS_PER_BODY));
            for ((b, (own, body)), (p, a)) in bodies.zip(entries).skip(i) {
                let (omega, v, gravity) = body.velocities();
                let here = if b == i {
                    Some(Carried::start(joint.kind, omega, v, gravity))
                } else {
                    // A body that the joint does not carry keeps the zeros of construction.
                    let parent = own.parent_slot.checked_sub(1).filter(|p| *p >= i);
                    let parent = parent.and_then(|p| carried.get(p).copied().flatten());
                    parent.map(|parent| parent.carried_on(&body.placement()))
                };
                if let Some(slot) = carried.get_mut(b) {
                    *slot = here;
                }
                if let (Some(c), Some(p), Some(a)) =
                    (here, p.first_chunk_mut(), a.first_chunk_mut())
                {
                    *p = against(c.unit, omega, v);
                    *a = against(c.turned, omega, v);
                    let [mass, x, y, z, ..] = a;
                    *mass += c.lift;
                    *x += c.gravity[0];
                    *y += c.gravity[1];
                    *z += c.gravity[2];
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

/// Motion of a body relative to a joint that carries it, in the body's axes at its origin.
#[derive(Debug, Clone, Copy)]
struct Carried {
    /// Twist of a unit of the joint's velocity.
    unit: Twist,
    /// Twist whose product with the momentum is `∂T/∂q`.
    turned: Twist,
    /// Gravity's torque per first moment …
    gravity: Vec3,
    /// … and per mass.
    lift: f64,
}

#[derive(Debug, Clone, Copy)]
struct Twist {
    angular: Vec3,
    linear: Vec3,
}

impl Twist {
    fn carried_on(self, rotation: &Mat3, origin: Vec3) -> Self {
        Self {
            angular: rotate_back(rotation, self.angular),
            linear: rotate_back(rotation, add(self.linear, cross(self.angular, origin))),
        }
    }
}

impl Carried {
    /// Creates the view on the body that the joint itself moves.
    fn start(kind: JointKind, omega: Vec3, v: Vec3, gravity: Vec3) -> Self {
        const ZERO: Vec3 = [0.0; 3];
        const AXIS: Vec3 = [0.0, 0.0, 1.0];
        // `x × z`.
        let across = |x: Vec3| [x[1], -x[0], 0.0];
        let twist = |angular, linear| Twist { angular, linear };
        match kind {
            JointKind::Revolute => Self {
                unit: twist(AXIS, ZERO),
                turned: twist(across(omega), across(v)),
                gravity: across(gravity),
                lift: 0.0,
            },
            JointKind::Prismatic => Self {
                unit: twist(ZERO, AXIS),
                turned: twist(ZERO, across(omega)),
                gravity: ZERO,
                lift: gravity[2],
            },
        }
    }

    /// Transforms the view to the next body at this pose.
    fn carried_on(self, (rotation, origin): &(Mat3, Vec3)) -> Self {
        Self {
            unit: self.unit.carried_on(rotation, *origin),
            turned: self.turned.carried_on(rotation, *origin),
            gravity: rotate_back(rotation, self.gravity),
            lift: self.lift + dot(self.gravity, *origin),
        }
    }
}

/// A twist's product with the momentum of a body, for a unit of each of its parameters.
fn against(twist: Twist, w: Vec3, v: Vec3) -> [f64; PARAMETERS_PER_BODY] {
    let (t, l) = (twist.angular, twist.linear);
    let h = add(cross(v, t), cross(l, w));
    [
        dot(l, v),
        h[0],
        h[1],
        h[2],
        t[0] * w[0],
        t[0] * w[1] + t[1] * w[0],
        t[0] * w[2] + t[2] * w[0],
        t[1] * w[1],
        t[1] * w[2] + t[2] * w[1],
        t[2] * w[2],
    ]
}
