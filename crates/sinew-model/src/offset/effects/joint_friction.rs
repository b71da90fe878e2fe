//! Friction between the spring and the link.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
};
use crate::Gaussian;

pub(crate) struct JointFriction;

/// Source of a friction that `robot.toml` does not state.
pub(super) const STATED: &str = "data sheet; default: friction of the BioRob-like arm";

impl Effect for JointFriction {
    const DESCRIPTION: Description = Description {
        title: "Joint friction",
        text: "The spring carries the friction of the joint. Coulomb friction follows a friction state `z` in −1…1, a stop operator \
               over 1 mrad of travel. Viscous friction is proportional to speed, and load friction to the torque, as in bearings and guides.",
        equation: "joint torque   F_c LP[z] + F_v LP[dq] + μ LP[z |τ|]",
        parameters: &[
            Parameter {
                place: P::Coulomb as usize,
                name: "Coulomb friction",
                symbol: "F_c",
                unit: "N·m",
                prior_text: "specified value ± `friction_percent`; default 2 mrad × K ± the same",
                source: STATED,
                lifetime: Lifetime::Days,
                kind: Some(Kind::Friction),
                term: Term::JointTorque,
                prior: |inputs| {
                    let (own, off) = inputs.joint.friction(inputs.tolerances.friction);
                    Some(Gaussian::new(own.coulomb_nm, off * own.coulomb_nm))
                },
            },
            Parameter {
                place: P::Viscous as usize,
                name: "viscous friction",
                symbol: "F_v",
                unit: "N·m·s/rad",
                prior_text: "specified value ± `friction_percent`; default 0.6 of the Coulomb friction per rad/s ± the same",
                source: STATED,
                lifetime: Lifetime::Days,
                kind: Some(Kind::Friction),
                term: Term::JointTorque,
                prior: |inputs| {
                    let (own, off) = inputs.joint.friction(inputs.tolerances.friction);
                    let viscous = own.viscous_nm_s_per_rad;
                    Some(Gaussian::new(viscous, off * viscous))
                },
            },
            Parameter {
                place: P::LoadFriction as usize,
                name: "load-dependent friction",
                symbol: "μ",
                unit: "",
                prior_text: "`load_friction_mean_percent` ± `load_friction_percent`",
                source: ASSUMED,
                lifetime: Lifetime::Days,
                kind: Some(Kind::Friction),
                term: Term::JointTorque,
                prior: |inputs| Some(inputs.tolerances.load_friction),
            },
        ],
    };

    #[inline]
    fn joint_torque(point: &Point<'_>, sum: &mut Sum<'_>) {
        sum.add(point, P::Coulomb, point.measured.z);
        sum.add(point, P::Viscous, point.measured.dq);
        sum.add(point, P::LoadFriction, point.measured.z_load);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn joint_friction_opposes_motion_by_state_speed_and_load() {
        let mut example = Example::with(&[
            (P::Coulomb, 0.1),
            (P::Viscous, 0.05),
            (P::LoadFriction, 0.02),
        ]);
        (
            example.measured.z,
            example.measured.dq,
            example.measured.z_load,
        ) = (-1.0, -0.8, -3.0);
        let expected = -0.1 - 0.04 - 0.06;
        example.check::<JointFriction>(JointFriction::joint_torque, expected);
    }
}
