//! Friction of a joint that has not slid yet, or that has stood for long.

use super::{
    Description, Effect, JointParameter as P, Lifetime, Parameter, Point, Sum, Term, about_zero,
};

pub(crate) struct InitialFriction;

/// Prior standard deviation of the initial friction in −1…1. A joint at rest arrived there by
/// sliding, or was moved there by its rope: a value near ±1 is more probable than one near 0
/// (uniform distribution: 0.58).
pub(crate) const INITIAL_FRICTION_STD: f64 = 0.85;

impl Effect for InitialFriction {
    const DESCRIPTION: Description = Description {
        title: "Stiction",
        text: "A joint that has not moved since the start of the recording may be held by its friction in either direction. \
               The unknown share `z_u` of its friction state decays over the first 20 mrad of travel in one direction. \
               For a joint at rest for three seconds, the same standard deviation is added to its equation instead.",
        equation: "joint torque   z₀ z_u (F_c + μ K |y|),      y = LP[theta_measured − q]",
        parameters: &[Parameter {
            place: P::InitialFriction as usize,
            name: "friction at the start, −1…1",
            symbol: "z₀",
            unit: "",
            prior_text: "0 ± 0.85",
            source: "between a uniform distribution (0.58) and always at ±1 (1); engineering judgement",
            lifetime: Lifetime::Recording,
            kind: None,
            term: Term::JointTorque,
            prior: |_| Some(about_zero(INITIAL_FRICTION_STD)),
        }],
    };

    #[inline]
    fn joint_torque(point: &Point<'_>, sum: &mut Sum<'_>) {
        let friction_nm =
            point.at(P::Coulomb) + load_friction(point) * point.measured.load_rad.abs();
        sum.add(
            point,
            P::InitialFriction,
            friction_nm * point.measured.z_unknown,
        );
    }

    #[inline]
    fn unknown_torque(point: &Point<'_>) -> f64 {
        let held = INITIAL_FRICTION_STD * point.measured.held * (1.0 - point.measured.z_unknown);
        held * (point.at(P::Coulomb).abs()
            + load_friction(point).abs() * point.measured.load_rad.abs())
    }
}

/// Friction per deflection, N·m/rad.
#[inline]
fn load_friction(point: &Point<'_>) -> f64 {
    point.at(P::LoadFriction) * point.joint.stiffness_nm_per_rad
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn initial_friction_is_a_part_of_what_friction_can_hold() {
        let mut example = Example::with(&[
            (P::InitialFriction, -0.5),
            (P::Coulomb, 0.1),
            (P::LoadFriction, 0.02),
        ]);
        example.joint.stiffness_nm_per_rad = 50.0;
        (
            example.measured.load_rad,
            example.measured.z_unknown,
            example.measured.held,
        ) = (-0.06, 0.4, 1.0);
        // 0.1 N·m and a fiftieth of 3 N·m.
        let friction_nm = 0.16;
        example.check::<InitialFriction>(InitialFriction::joint_torque, -0.5 * 0.4 * friction_nm);
        let unknown_nm = InitialFriction::unknown_torque(&example.point());
        assert!((unknown_nm - 0.85 * 0.6 * friction_nm).abs() < 1e-15);
    }
}
