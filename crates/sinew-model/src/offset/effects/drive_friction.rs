//! Friction between the motor and the spring.

use super::description::ASSUMED;
use super::joint_friction::STATED;
use super::{
    Description, Drive, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
};
use crate::Gaussian;

pub(crate) struct DriveFriction;

impl Effect for DriveFriction {
    const DESCRIPTION: Description = Description {
        title: "Drive friction",
        text: "The motor provides the friction of motor and gear in addition to the spring torque, with the same friction model as the joint. \
               The friction of a drive at rest is unknown. For the share of the block at rest, its full amount is used as a standard deviation.",
        equation: "drive torque   F_m LP[z_m] + F_vm LP[dtheta] + μ_m LP[z_m |τ|]",
        parameters: &[
            Parameter {
                place: P::MotorCoulomb as usize,
                name: "drive Coulomb friction",
                symbol: "F_m",
                unit: "N·m",
                prior_text: "specified value ± `friction_percent`; default 10 mrad × K ± the same",
                source: STATED,
                lifetime: Lifetime::Days,
                kind: Some(Kind::DriveFriction),
                term: Term::DriveTorque,
                prior: |inputs| {
                    let (own, off) = inputs.joint.drive_friction(inputs.tolerances.friction);
                    Some(Gaussian::new(own.coulomb_nm, off * own.coulomb_nm))
                },
            },
            Parameter {
                place: P::MotorViscous as usize,
                name: "drive viscous friction",
                symbol: "F_vm",
                unit: "N·m·s/rad",
                prior_text: "specified value ± `friction_percent` of it or of a tenth of `F_m` per rad/s; default 0.6 `F_m` per rad/s ± the same",
                source: STATED,
                lifetime: Lifetime::Days,
                kind: Some(Kind::DriveFriction),
                term: Term::DriveTorque,
                prior: |inputs| {
                    let (own, off) = inputs.joint.drive_friction(inputs.tolerances.friction);
                    let viscous = own.viscous_nm_s_per_rad;
                    let size = viscous.max(0.1 * own.coulomb_nm);
                    Some(Gaussian::new(viscous, off * size))
                },
            },
            Parameter {
                place: P::MotorLoadFriction as usize,
                name: "drive load-dependent friction",
                symbol: "μ_m",
                unit: "",
                prior_text: "`drive_load_friction_mean_percent` ± `drive_load_friction_percent`",
                source: ASSUMED,
                lifetime: Lifetime::Days,
                kind: Some(Kind::DriveFriction),
                term: Term::DriveTorque,
                prior: |inputs| Some(inputs.tolerances.drive_load_friction),
            },
        ],
    };

    #[inline]
    fn drive_torque(point: &Point<'_>, drive: &Drive, sum: &mut Sum<'_>) {
        sum.add(point, P::MotorCoulomb, drive.z);
        sum.add(point, P::MotorViscous, drive.velocity);
        sum.add(point, P::MotorLoadFriction, drive.z_load);
    }

    #[inline]
    fn unknown_drive_torque(point: &Point<'_>, drive: &Drive) -> f64 {
        let coulomb_nm = (point.at(P::MotorCoulomb).abs()).max(point.joint.drive_coulomb_nm());
        let load = point.at(P::MotorLoadFriction).abs() * point.joint.stiffness_nm_per_rad;
        (coulomb_nm + load * point.measured.pull_rad.abs()) * drive.stood
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn drive_friction_is_unknown_at_rest() {
        let mut example = Example::with(&[
            (P::MotorCoulomb, -0.5),
            (P::MotorViscous, 0.2),
            (P::MotorLoadFriction, 0.1),
        ]);
        let drive = Drive {
            torque: 0.0,
            inertial: 0.0,
            velocity: 2.0,
            z: 1.0,
            z_load: 4.0,
            stood: 0.25,
        };
        let torque = |point: &Point<'_>, sum: &mut Sum<'_>| {
            DriveFriction::drive_torque(point, &drive, sum);
        };
        example.check::<DriveFriction>(torque, -0.5 + 0.4 + 0.4);
        example.joint.motor_coulomb_nm = 0.3;
        example.joint.stiffness_nm_per_rad = 50.0;
        example.measured.pull_rad = -0.04;
        let unknown = DriveFriction::unknown_drive_torque(&example.point(), &drive);
        assert!((unknown - 0.25 * (0.5 + 0.2)).abs() < 1e-15);
        // A drive has at least the friction of its description.
        example.joint.motor_coulomb_nm = 0.8;
        let unknown = DriveFriction::unknown_drive_torque(&example.point(), &drive);
        assert!((unknown - 0.25 * (0.8 + 0.2)).abs() < 1e-15);
    }
}
