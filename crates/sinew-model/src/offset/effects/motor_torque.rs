//! Errors of the recorded motor torque.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Kind, Lifetime, Parameter, Point, Sum, Term,
    about_zero,
};

pub(crate) struct MotorTorque;

impl Effect for MotorTorque {
    const DESCRIPTION: Description = Description {
        title: "Motor torque error",
        text: "A recorded motor torque is a second measurement of the joint torque, with errors of scale and zero. \
               A recorded current has the error of its torque constant, so its scale has the prior `motor_current_percent`.",
        equation: "motor scale   k\nmotor bias    b",
        parameters: &[
            Parameter {
                place: P::MotorScale as usize,
                name: "motor torque scale",
                symbol: "k",
                unit: "",
                prior_text: "0 ± `motor_torque_percent`, of a current 0 ± `motor_current_percent`",
                source: ASSUMED,
                lifetime: Lifetime::Months,
                kind: Some(Kind::MotorTorque),
                term: Term::MotorScale,
                prior: |inputs| Some(about_zero(inputs.tolerances.motor_torque)),
            },
            Parameter {
                place: P::MotorBias as usize,
                name: "motor torque zero",
                symbol: "b",
                unit: "N·m",
                prior_text: "0 ± a tenth of the drive's Coulomb friction, at least `motor_torque_percent` of the pretension of a strand and of 20 mrad × K",
                source: "engineering judgement: the zero error of a torque is a small part of the drive friction",
                lifetime: Lifetime::Days,
                kind: Some(Kind::MotorTorque),
                term: Term::MotorBias,
                prior: |inputs| {
                    let drive_nm = inputs.joint.drive_coulomb_nm();
                    let scale = inputs.tolerances.motor_torque;
                    let least_nm = (scale * 0.02 * inputs.joint.stiffness_nm_per_rad)
                        .max(scale * inputs.joint.pretension_nm);
                    Some(about_zero((0.1 * drive_nm).max(least_nm)))
                },
            },
        ],
    };

    #[inline]
    fn motor_scale(point: &Point<'_>, sum: &mut Sum<'_>) {
        sum.add(point, P::MotorScale, 1.0);
    }

    #[inline]
    fn motor_bias(point: &Point<'_>, sum: &mut Sum<'_>) {
        sum.add(point, P::MotorBias, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn motor_torque_has_errors_of_scale_and_zero() {
        let example = Example::with(&[(P::MotorScale, -0.04), (P::MotorBias, 0.3)]);
        example.check::<MotorTorque>(MotorTorque::motor_scale, -0.04);
        example.check::<MotorTorque>(MotorTorque::motor_bias, 0.3);
    }
}
