//! Inertial parameters of the links that differ from their description.

use super::description::ASSUMED;
use super::{Description, Effect, Kind, Lifetime, Parameter};
use crate::arm::PARAMETERS_PER_BODY;
use crate::tolerances::Tolerances;

pub(crate) struct Bodies;

const fn inertial(
    name: &'static str,
    symbol: &'static str,
    unit: &'static str,
    prior_text: &'static str,
) -> Parameter {
    Parameter {
        name,
        symbol,
        unit,
        prior_text,
        source: ASSUMED,
        lifetime: Lifetime::Months,
        kind: Some(Kind::Bodies),
        ..Parameter::CARRIED
    }
}

const MOMENT: &str = "0 ± `first_moment_percent` along itself, `first_moment_across_percent` of its size across, \
                      at least `mass_percent` of 1 cm";
const MOMENT_OF_INERTIA: &str = "0 ± `inertia_percent`, plus 1 % of `inertia_percent` of the trace";
const PRODUCT_OF_INERTIA: &str = "0 ± a fifth of `inertia_percent` of the trace";

impl Effect for Bodies {
    const DESCRIPTION: Description = Description {
        title: "Link inertia",
        text: "Gravity and motion of the links cause torques that are linear in ten inertial parameters of each body. \
               The parameters here are their errors relative to the URDF. \
               Motion depends on fewer combinations of them, the [base parameters](absolute.md#parameters).",
        equation: "joint torque   Φ (π₀ + δπ)",
        parameters: &[
            inertial("mass error", "δm", "kg", "0 ± `mass_percent`"),
            inertial("first moment error x", "δh_x", "kg·m", MOMENT),
            inertial("first moment error y", "δh_y", "kg·m", MOMENT),
            inertial("first moment error z", "δh_z", "kg·m", MOMENT),
            inertial("inertia error xx", "δI_xx", "kg·m²", MOMENT_OF_INERTIA),
            inertial("inertia error xy", "δI_xy", "kg·m²", PRODUCT_OF_INERTIA),
            inertial("inertia error xz", "δI_xz", "kg·m²", PRODUCT_OF_INERTIA),
            inertial("inertia error yy", "δI_yy", "kg·m²", MOMENT_OF_INERTIA),
            inertial("inertia error yz", "δI_yz", "kg·m²", PRODUCT_OF_INERTIA),
            inertial("inertia error zz", "δI_zz", "kg·m²", MOMENT_OF_INERTIA),
        ],
    };
}

impl Bodies {
    /// Standard deviations of the errors of a body with the nominal parameters `pi`.
    pub(crate) fn stds(
        t: &Tolerances,
        pi: &[f64; PARAMETERS_PER_BODY],
    ) -> [f64; PARAMETERS_PER_BODY] {
        let h = libm::sqrt(pi[1] * pi[1] + pi[2] * pi[2] + pi[3] * pi[3]);
        // A body whose centre sits on its joint still may sit 1 cm off.
        let across = (t.first_moment_across * h).max(0.01 * t.mass * pi[0]);
        let trace = pi[4] + pi[7] + pi[9];
        let std = |k: usize| match k {
            0 => t.mass * pi[0],
            1..4 => libm::hypot(t.first_moment * pi[k], across),
            4 | 7 | 9 => t.inertia * pi[k] + 0.01 * t.inertia * trace,
            _ => 0.2 * t.inertia * trace,
        };
        core::array::from_fn(|k| std(k).max(1e-12))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn body_tolerances_scale_with_the_nominal_parameters() {
        let t = Tolerances::default();
        let found = Bodies::stds(&t, &[2.0, 0.3, 0.0, 0.4, 0.1, 0.0, 0.0, 0.2, 0.0, 0.3]);
        let across = 0.03 * 0.5;
        let expected = [
            0.12,
            libm::hypot(0.065 * 0.3, across),
            across,
            libm::hypot(0.065 * 0.4, across),
            0.15 * 0.1 + 0.0015 * 0.6,
            0.03 * 0.6,
            0.03 * 0.6,
            0.15 * 0.2 + 0.0015 * 0.6,
            0.03 * 0.6,
            0.15 * 0.3 + 0.0015 * 0.6,
        ];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
    }
}
