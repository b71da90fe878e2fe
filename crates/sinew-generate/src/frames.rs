//! Frames and masses that minimise the number of operations.
//!
//! Rotating the frame of a joint about its axis, or shifting it along the axis, does not change the dynamics. Every
//! frame is therefore placed on the common normal with the axis of the next joint. The transform from the parent then
//! consists of a rotation about x, a translation along x and a translation along z, instead of a general rotation
//! (Denavit and Hartenberg; Khalil and Kleinfinger for
//! trees).
//!
//! Of a body on a revolute joint, mass, first moment along the axis, and one inertia across it, look the same at
//! every angle: they count to the parent, so that four of ten parameters are zero for every such joint (Gautier and
//! Khalil's base parameters). A body on a prismatic joint hands its inertia on.

use sinew_model::arm::{Arm, JointKind, PARAMETERS_PER_BODY, Pose};
use sinew_model::vec3::{Mat3, Vec3};

/// A turn as cosine and sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    pub(crate) cosine: f64,
    pub(crate) sine: f64,
}

impl Turn {
    pub(crate) const NONE: Self = Self {
        cosine: 1.0,
        sine: 0.0,
    };

    /// From two numbers that are one's cosine and sine but for rounding.
    fn new(cosine: f64, sine: f64) -> Self {
        let length = cosine.hypot(sine);
        Self {
            cosine: neat(cosine / length),
            sine: neat(sine / length),
        }
    }

    /// This turn, then another.
    fn then(self, other: Self) -> Self {
        Self::new(
            self.cosine * other.cosine - self.sine * other.sine,
            self.sine * other.cosine + self.cosine * other.sine,
        )
    }

    fn back(self) -> Self {
        Self {
            cosine: self.cosine,
            sine: -self.sine,
        }
    }

    /// Rotation matrix about z.
    fn about_z(self) -> Mat3 {
        let (c, s) = (self.cosine, self.sine);
        [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
    }

    /// Rotation matrix about x.
    fn about_x(self) -> Mat3 {
        let (c, s) = (self.cosine, self.sine);
        [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]
    }
}

/// Rounds values that differ from 0 or ±1 by rounding error only.
fn neat(value: f64) -> f64 {
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    let nearest = value.round();
    if (value - nearest).abs() < ROUNDING && nearest.abs() <= 1.0 {
        nearest
    } else {
        value
    }
}

/// Sets a length to 0 if it is rounding error of the lengths it was computed from.
fn length(value: f64, scale: f64) -> f64 {
    if value.abs() < 8.0 * f64::EPSILON * scale {
        0.0
    } else {
        value
    }
}

/// Transform of a joint relative to its parent, and the masses that it carries.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Link {
    pub(crate) kind: JointKind,
    /// `None`: the base.
    pub(crate) parent: Option<usize>,
    /// First rotation, about the z axis of the parent; needed only for a second joint on one body.
    pub(crate) branch: Turn,
    /// Along the parent's z, m.
    pub(crate) branch_m: f64,
    /// Angle about x.
    pub(crate) twist: Turn,
    /// Along x, m.
    pub(crate) normal_m: f64,
    /// Along y, m: zero but for axes that are nearly parallel.
    pub(crate) across_m: f64,
    /// About the joint's own z, at `q = 0`.
    pub(crate) angle: Turn,
    /// Along it, m.
    pub(crate) offset_m: f64,
    /// Mass, first moment and inertia that are left to the body, about the joint's origin.
    pub(crate) body: Body,
    /// Mass of the body and of its descendants after the redistribution, kg.
    pub(crate) subtree_kg: f64,
}

/// Mass properties about an origin: mass, first moment, inertia.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Body {
    pub(crate) mass: f64,
    pub(crate) first: Vec3,
    pub(crate) inertia: Mat3,
}

impl Body {
    fn of(pi: &[f64]) -> Self {
        let at = |i: usize| pi.get(i).copied().unwrap_or(0.0);
        Self {
            mass: at(0),
            first: [at(1), at(2), at(3)],
            inertia: [
                [at(4), at(5), at(6)],
                [at(5), at(7), at(8)],
                [at(6), at(8), at(9)],
            ],
        }
    }

    fn plus(self, other: Self) -> Self {
        let mut out = self;
        out.mass += other.mass;
        for i in 0..3 {
            out.first[i] += other.first[i];
            for j in 0..3 {
                out.inertia[i][j] += other.inertia[i][j];
            }
        }
        out
    }

    /// Seen from another frame: `other_from_this`, about the other's origin.
    fn seen_from(&self, pose: &Pose) -> Self {
        let (r, t) = (&pose.rotation, pose.translation);
        let h = rotate(r, self.first);
        let turned = product(&product(r, &self.inertia), &transposed(r));
        let m = self.mass;
        let lift = 2.0 * dot(h, t) + m * dot(t, t);
        let mut inertia = turned;
        for i in 0..3 {
            inertia[i][i] += lift;
            for j in 0..3 {
                inertia[i][j] -= h[i] * t[j] + t[i] * h[j] + m * t[i] * t[j];
            }
        }
        Self {
            mass: m,
            first: [h[0] + m * t[0], h[1] + m * t[1], h[2] + m * t[2]],
            inertia,
        }
    }

    /// Removes and returns the parameters that do not depend on the joint position.
    fn take_invariant(&mut self, kind: JointKind) -> Self {
        match kind {
            JointKind::Revolute => {
                let across = self.inertia[1][1];
                let taken = Self {
                    mass: self.mass,
                    first: [0.0, 0.0, self.first[2]],
                    inertia: [[across, 0.0, 0.0], [0.0, across, 0.0], [0.0; 3]],
                };
                self.mass = 0.0;
                self.first[2] = 0.0;
                self.inertia[0][0] -= across;
                self.inertia[1][1] = 0.0;
                taken
            }
            JointKind::Prismatic => Self {
                inertia: std::mem::take(&mut self.inertia),
                ..Self::default()
            },
        }
    }
}

impl Link {
    /// `parent_from_joint` at `q = 0`.
    fn pose(&self) -> Pose {
        let step = |rotation: Mat3, translation: Vec3| Pose {
            rotation,
            translation,
        };
        step(self.branch.about_z(), [0.0, 0.0, self.branch_m])
            .then(&step(self.twist.about_x(), [self.normal_m, 0.0, 0.0]))
            .then(&step(
                self.angle.about_z(),
                [0.0, self.across_m, self.offset_m],
            ))
    }
}

/// `Rz(branch) Tz(branch_m) Rx(twist) Txy(normal_m, across_m) Rz(angle) Tz(offset_m)`
struct Normal {
    branch: Turn,
    branch_m: f64,
    twist: Turn,
    normal_m: f64,
    across_m: f64,
    angle: Turn,
    offset_m: f64,
}

impl Normal {
    /// Computes the common normal from a joint's pose on its parent.
    fn of(pose: &Pose) -> Self {
        /// Axes that differ by less, the sine of their angle, are parallel: rounding.
        const PARALLEL: f64 = 1e-15;
        /// Minimum sine of the angle between two axes for a common normal. Below it the common normal is far away, and
        /// shifting parameters to it and back loses all significant digits if the angles of an arm have nine digits.
        const NEARLY: f64 = 0.05;
        let (r, t) = (&pose.rotation, pose.translation);
        let axis = [r[0][2], r[1][2], r[2][2]];
        let x = [r[0][0], r[1][0], r[2][0]];
        let tilt = axis[0].hypot(axis[1]);
        let reach = dot(t, t).sqrt();
        let (normal, branch_m, offset_m, twist, across_m) = if tilt > NEARLY {
            let normal = [-axis[1] / tilt, axis[0] / tilt, 0.0];
            let (along, up) = (dot(t, axis), t[2]);
            let offset_m = (along - axis[2] * up) / (tilt * tilt);
            let branch_m = up - axis[2] * offset_m;
            (normal, branch_m, offset_m, Turn::new(axis[2], tilt), 0.0)
        } else if tilt > PARALLEL {
            let normal = [-axis[1] / tilt, axis[0] / tilt, 0.0];
            (
                normal,
                0.0,
                dot(t, axis),
                Turn::new(axis[2], tilt),
                dot(t, cross(axis, normal)),
            )
        } else {
            let across = t[0].hypot(t[1]);
            let normal = match across > PARALLEL * reach {
                true => [t[0] / across, t[1] / across, 0.0],
                false => [1.0, 0.0, 0.0],
            };
            let twist = Turn::new(axis[2].signum(), 0.0);
            (normal, 0.0, t[2] * axis[2].signum(), twist, 0.0)
        };
        Self {
            branch: Turn::new(normal[0], normal[1]),
            branch_m: length(branch_m, reach),
            twist,
            normal_m: length(dot(t, normal), reach),
            across_m: length(across_m, reach),
            angle: Turn::new(dot(normal, x), dot(axis, cross(normal, x))),
            offset_m: length(offset_m, reach),
        }
    }
}

/// Returns the links of an arm, with the masses shifted towards the base as far as possible.
pub(crate) fn links(arm: &Arm) -> Vec<Link> {
    let n = arm.dof();
    let parameters = arm.inertial_parameters();
    let bodies = parameters.chunks_exact(PARAMETERS_PER_BODY).map(Body::of);
    let normals: Vec<Normal> = (0..n)
        .map(|i| Normal::of(&arm.placement(i).unwrap_or(Pose::IDENTITY)))
        .collect();
    // A frame is laid on the normal to the first joint that its body carries.
    let mut own = vec![(Turn::NONE, 0.0); n];
    let mut laid = vec![false; n];
    for (i, normal) in normals.iter().enumerate() {
        if let Some(parent) = arm.parent(i).filter(|p| !laid[*p]) {
            laid[parent] = true;
            own[parent] = (normal.branch, normal.branch_m);
        }
    }
    // The last of a chain is laid so that its own angle and offset are zero.
    for (i, normal) in normals.iter().enumerate() {
        if !laid[i] {
            own[i] = (normal.angle.back(), -normal.offset_m);
        }
    }
    let mut links: Vec<Link> = (bodies.zip(&normals).enumerate())
        .map(|(i, (body, normal))| {
            let parent = arm.parent(i);
            let (before, before_m) = parent.map_or((Turn::NONE, 0.0), |p| own[p]);
            let (turn, shift_m) = own[i];
            let moved = Pose {
                rotation: turn.back().about_z(),
                translation: [0.0, 0.0, -shift_m],
            };
            let scale = normal.offset_m.abs() + shift_m.abs();
            let branch_scale = normal.branch_m.abs() + before_m.abs();
            Link {
                kind: arm.joint_kind(i).unwrap_or(JointKind::Revolute),
                parent,
                branch: before.back().then(normal.branch),
                branch_m: length(normal.branch_m - before_m, branch_scale),
                twist: normal.twist,
                normal_m: normal.normal_m,
                across_m: normal.across_m,
                angle: normal.angle.then(turn),
                offset_m: length(normal.offset_m + shift_m, scale),
                body: body.seen_from(&moved),
                subtree_kg: 0.0,
            }
        })
        .collect();
    for i in (0..n).rev() {
        let kind = links[i].kind;
        let taken = links[i].body.take_invariant(kind);
        let pose = links[i].pose();
        if let Some(parent) = links[i].parent {
            links[parent].body = links[parent].body.plus(taken.seen_from(&pose));
        }
    }
    for i in (0..n).rev() {
        links[i].subtree_kg += links[i].body.mass;
        let subtree_kg = links[i].subtree_kg;
        if let Some(parent) = links[i].parent {
            links[parent].subtree_kg += subtree_kg;
        }
    }
    links
}

/// Gravity in the frame that the base's joints sit on, m/s².
pub(crate) fn gravity(arm: &Arm) -> Vec3 {
    arm.gravity()
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn rotate(r: &Mat3, a: Vec3) -> Vec3 {
    r.map(|row| dot(row, a))
}

fn transposed(r: &Mat3) -> Mat3 {
    let column = |j: usize| [r[0][j], r[1][j], r[2][j]];
    [column(0), column(1), column(2)]
}

fn product(a: &Mat3, b: &Mat3) -> Mat3 {
    let columns = transposed(b);
    a.map(|row| columns.map(|column| dot(row, column)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_normal_reproduces_pose() {
        let poses = [
            Pose::from_xyz_rpy([0.1, -0.2, 0.3], [0.4, 0.5, -0.6]),
            Pose::from_xyz_rpy([0.0, 0.0, 0.3], [0.0, 0.0, 0.7]),
            // Nearly parallel: a right angle of nine digits, and less.
            Pose::from_xyz_rpy([0.2, 0.1, 0.3], [3.2e-9, 1e-9, 0.7]),
            Pose::from_xyz_rpy([0.2, 0.1, 0.3], [3e-14, 0.0, 0.7]),
            Pose::from_xyz_rpy([0.2, 0.1, 0.3], [0.04, 0.0, 0.7]),
            Pose::from_xyz_rpy([0.2, 0.1, 0.3], [std::f64::consts::PI + 1e-6, 0.0, 0.7]),
            Pose::from_xyz_rpy([0.2, 0.1, 0.3], [std::f64::consts::PI, 0.0, 0.7]),
            Pose::from_xyz_rpy([0.0, 0.0, 0.0], [std::f64::consts::FRAC_PI_2, 0.0, 0.0]),
            Pose::IDENTITY,
        ];
        for pose in poses {
            let n = Normal::of(&pose);
            let link = Link {
                kind: JointKind::Revolute,
                parent: None,
                branch: n.branch,
                branch_m: n.branch_m,
                twist: n.twist,
                normal_m: n.normal_m,
                across_m: n.across_m,
                angle: n.angle,
                offset_m: n.offset_m,
                body: Body::default(),
                subtree_kg: 0.0,
            };
            let again = link.pose();
            for i in 0..3 {
                assert!(
                    (again.translation[i] - pose.translation[i]).abs() < 1e-15,
                    "{pose:?}"
                );
                for j in 0..3 {
                    let apart = again.rotation[i][j] - pose.rotation[i][j];
                    assert!(apart.abs() < 1e-15, "{pose:?}");
                }
            }
        }
    }
}
