//! The dead zone of two slack ropes that pull against each other.

use super::description::ASSUMED;
use super::{
    Description, Effect, JointParameter as P, Lifetime, Parameter, Point, Sum, Term, about_zero,
};

pub(crate) struct Slack;

/// Prior standard deviation of half the dead zone, rad.
const UNKNOWN_SLACK_RAD: f64 = 0.01;
/// Spring deflection over which the joint crosses its dead zone, rad.
const SMOOTH_RAD: f64 = 2e-3;

impl Effect for Slack {
    const DESCRIPTION: Description = Description {
        title: "Slack",
        text: "Two elongated ropes of an antagonistic pair leave a dead zone at the joint; its side depends on the sign of the torque. \
               The sign is a hyperbolic tangent with a scale of 2 mrad of deflection. \
               Its derivative with respect to the torque is neglected.",
        equation: "deflection   s tanh(d / 2 mrad),      d = (1 + Σ compliance) τ/K",
        parameters: &[Parameter {
            place: P::Slack as usize,
            name: "slack, half the dead zone",
            symbol: "s",
            unit: "rad",
            prior_text: "of an antagonistic pair 0 ± 10 mrad, at most that of the offset; else 0",
            source: ASSUMED,
            lifetime: Lifetime::Recording,
            kind: None,
            term: Term::Deflection,
            prior: |inputs| {
                let half_rad = UNKNOWN_SLACK_RAD.min(inputs.offset_rad);
                inputs.joint.antagonistic.then_some(about_zero(half_rad))
            },
        }],
    };

    #[inline]
    fn deflection(point: &Point<'_>, linear_rad: f64, sum: &mut Sum<'_>) {
        let taut = if point.joint.antagonistic {
            libm::tanh(linear_rad / SMOOTH_RAD)
        } else {
            0.0
        };
        sum.add(point, P::Slack, taut);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::effects::example::Example;

    #[test]
    fn slack_takes_the_sign_of_the_torque() {
        let mut example = Example::with(&[(P::Slack, 0.006)]);
        for (antagonistic, linear_rad, expected) in [
            (true, 0.05, 0.006),
            (true, -0.05, -0.006),
            // tanh(ln 2) = 3/5.
            (true, 2e-3 * core::f64::consts::LN_2, 0.0036),
            (false, 0.05, 0.0),
        ] {
            example.joint.antagonistic = antagonistic;
            let deflection = |point: &Point<'_>, sum: &mut Sum<'_>| {
                Slack::deflection(point, linear_rad, sum);
            };
            example.check::<Slack>(deflection, expected);
        }
    }
}
