//! A constant force at the tool.

use super::description::ASSUMED;
use super::{Description, Effect, Parameter};
use crate::vec3::Vec3;

/// Number of entries of an external force: along the axes of the base, and distance of its point of
/// action from the expected one.
pub(crate) const FORCE: usize = 6;

const fn along(name: &'static str, symbol: &'static str) -> Parameter {
    Parameter {
        name,
        symbol,
        unit: "N",
        prior_text: "0 ± `external_force_n`; or as specified on the command line",
        source: ASSUMED,
        ..Parameter::CARRIED
    }
}

const fn away(name: &'static str, symbol: &'static str) -> Parameter {
    Parameter {
        name,
        symbol,
        unit: "m",
        prior_text: "0 ± `payload_reach_mm`",
        source: ASSUMED,
        ..Parameter::CARRIED
    }
}

/// External force of a state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AppliedForce {
    pub(crate) force_n: [f64; 3],
    pub(crate) away_m: [f64; 3],
}

impl Effect for AppliedForce {
    const DESCRIPTION: Description = Description {
        title: "External force",
        text: "A cable, a hose or a spring balancer acts on the tool with a force that is constant in the base frame. \
               It is part of the estimate if the recording shows a force or the operator specifies one, see \
               [external force](absolute.md#external-force).",
        equation: "joint torque   −LP[J(q)]ᵀ f,      J(q)ᵀ f = Σ_k f_k (j_k + Σ_l a_l m_lk)",
        parameters: &[
            along("external force x", "f_x"),
            along("external force y", "f_y"),
            along("external force z", "f_z"),
            away("place of the force x", "a_x"),
            away("place of the force y", "a_y"),
            away("place of the force z", "a_z"),
        ],
    };
}

/// Torque of a force on a joint.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct ForceTorque {
    /// Torque per newton along each axis of the base, N·m.
    pub(crate) at: Vec3,
    /// Change per metre of distance along each axis of the body.
    pub(crate) away: [Vec3; 3],
}

impl ForceTorque {
    /// The torque, N·m, and its change with force and place.
    pub(crate) fn torque(&self, applied: &AppliedForce) -> (f64, [f64; FORCE]) {
        let mut per_newton = self.at;
        let mut slope = [0.0; FORCE];
        let (of_force, of_place) = slope.split_at_mut(3);
        for ((away, place), of_place) in self.away.iter().zip(applied.away_m).zip(of_place) {
            for ((to, x), force) in per_newton.iter_mut().zip(away).zip(applied.force_n) {
                *to += place * x;
                *of_place += force * x;
            }
        }
        of_force.copy_from_slice(&per_newton);
        let pairs = per_newton.iter().zip(applied.force_n);
        (pairs.map(|(x, force)| x * force).sum(), slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_torque_is_bilinear_in_force_and_place() {
        let of = ForceTorque {
            at: [0.5, -0.2, 0.1],
            away: [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, -3.0]],
        };
        let applied = AppliedForce {
            force_n: [2.0, 1.0, -1.0],
            away_m: [0.1, 0.2, 0.3],
        };
        let (torque, slope) = of.torque(&applied);
        // 2 (0.5 + 0.1) + (−0.2 + 0.4) − (0.1 − 0.9)
        assert!((torque - 2.2).abs() < 1e-15, "{torque}");
        let expected = [0.6, 0.2, -0.8, 2.0, 2.0, 3.0];
        for (found, expected) in slope.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{slope:?}");
        }
    }
}
