//! Mass and friction of links and joints, and warnings about implausible values.

use super::super::{ArmError, BodyInertia, Pose};
use super::{JointLimits, Reader, UrdfError, xml};
use crate::vec3::Mat3;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

/// Names of links and joints with implausible values, collected for one warning per kind.
#[derive(Default)]
pub(super) struct ImplausibleValues {
    inertia_without_mass: Vec<String>,
    not_definite: Vec<String>,
    triangle: Vec<String>,
    negative_friction: Vec<String>,
}

impl Reader<'_> {
    /// Mass properties of a link in its own frame.
    pub(super) fn link_body(&mut self, link: &xml::UrdfLink) -> Result<BodyInertia, UrdfError> {
        let [ixx, ixy, ixz, iyy, iyz, izz] = link.inertia;
        let body = BodyInertia {
            mass: link.mass_kg,
            com: [0.0; 3],
            inertia: [[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]],
        };
        let place = format!("link '{}'", link.name);
        super::super::build::check_body(&place, &body)?;
        let pose = urdf_pose(&link.origin);
        let placed = body.seen_from(&pose);
        super::super::build::check_body(&place, &placed)?;
        let implausible = &mut self.implausible;
        if body.mass == 0.0 && body.inertia != [[0.0; 3]; 3] {
            implausible.inertia_without_mass.push(link.name.clone());
        } else if !is_positive_semidefinite(&body.inertia) {
            implausible.not_definite.push(link.name.clone());
        } else if !obeys_triangle(&body.inertia) {
            implausible.triangle.push(link.name.clone());
        }
        Ok(placed)
    }

    pub(super) fn friction(
        &mut self,
        joint: &str,
        what: &'static str,
        value: f64,
        unit: &str,
    ) -> Result<f64, UrdfError> {
        if !value.is_finite() {
            return Err(ArmError::NotFinite {
                place: format!("joint '{joint}'"),
                what,
                value,
            }
            .into());
        }
        if value < 0.0 {
            self.implausible
                .negative_friction
                .push(format!("{joint} ({what} {value:.3} {unit})"));
        }
        Ok(value.max(0.0))
    }
}

impl ImplausibleValues {
    pub(super) fn sentences(&self) -> Vec<String> {
        [
            (
                &self.inertia_without_mass,
                "link with an inertia but no mass (0 kg), check its <mass>",
            ),
            (
                &self.not_definite,
                "link with an inertia that is not positive definite, impossible for a rigid body; used unchanged, a simulation may reject it",
            ),
            (
                &self.triangle,
                "link with principal inertias that break the triangle inequality, impossible for a rigid body (identified models contain such values); used unchanged",
            ),
            (
                &self.negative_friction,
                "joint with a negative friction in the URDF; 0 is used",
            ),
        ]
        .iter()
        .filter(|(names, _)| !names.is_empty())
        .map(|(names, text)| format!("{text}: {}", names.join(", ")))
        .collect()
    }
}

pub(super) fn joint_limits(joint: &xml::UrdfJoint) -> JointLimits {
    let [lower, upper, effort, velocity] = joint.limit;
    let endless = joint.joint_type == xml::JointType::Continuous;
    JointLimits {
        lower: if endless { f64::NEG_INFINITY } else { lower },
        upper: if endless { f64::INFINITY } else { upper },
        effort,
        velocity,
    }
}

pub(super) fn urdf_pose(origin: &xml::Origin) -> Pose {
    Pose::from_xyz_rpy(origin.xyz, origin.rpy)
}

/// Whether every principal minor is at least zero, up to rounding of the entries.
pub fn is_positive_semidefinite(a: &Mat3) -> bool {
    // Sixteen roundings per product of entries as large as the trace.
    let size = (a[0][0].abs() + a[1][1].abs() + a[2][2].abs()).max(f64::MIN_POSITIVE);
    let eps = 16.0 * f64::EPSILON;
    let minor = |i: usize, k: usize| a[i][i] * a[k][k] - a[i][k] * a[i][k];
    let det = a[0][0] * minor(1, 2) - a[0][1] * (a[0][1] * a[2][2] - a[1][2] * a[0][2])
        + a[0][2] * (a[0][1] * a[1][2] - a[1][1] * a[0][2]);
    (0..3).all(|i| a[i][i] >= -eps * size)
        && [(0, 1), (0, 2), (1, 2)]
            .iter()
            .all(|&(i, k)| minor(i, k) >= -eps * size * size)
        && det >= -eps * size * size * size
}

/// Whether the second mass moments `½ tr(I) 1 − I` are those of a body.
pub fn obeys_triangle(a: &Mat3) -> bool {
    let half_trace = 0.5 * (a[0][0] + a[1][1] + a[2][2]);
    let mut moments = a.map(|row| row.map(|x| -x));
    for (i, row) in moments.iter_mut().enumerate() {
        row[i] += half_trace;
    }
    // Values in files are rounded to a few digits; a thin rod sits on the border.
    let slack = 1e-3 * half_trace;
    for (i, row) in moments.iter_mut().enumerate() {
        row[i] += slack;
    }
    is_positive_semidefinite(&moments)
}
