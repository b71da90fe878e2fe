//! Joint in a given state, for tests of a single effect.

use super::payload::PayloadTorque;
use super::{Effect, JointParameter, JointRow, Measured, PER_JOINT, Point, Sum, total};
use crate::arm::PARAMETERS_PER_BODY;
use crate::offset::joint_prior::JointPrior;

/// Parameters, description and measurement of a joint.
pub(crate) struct Example {
    pub(crate) x: JointRow,
    pub(crate) joint: JointPrior,
    pub(crate) measured: Measured,
    pub(crate) temperature_difference_k: f64,
}

impl Example {
    /// A joint without signals whose parameters are zero but for these.
    pub(crate) fn with(parameters: &[(JointParameter, f64)]) -> Self {
        let mut x = [0.0; PER_JOINT];
        for (parameter, value) in parameters {
            x[*parameter as usize] = *value;
        }
        Self {
            x,
            joint: JointPrior {
                stiffness_nm_per_rad: 40.0,
                motor_inertia_kg_m2: None,
                coulomb_nm: 0.0,
                viscous_nm_s_per_rad: 0.0,
                motor_coulomb_nm: 0.0,
                motor_viscous_nm_s_per_rad: 0.0,
                antagonistic: false,
                drift_rad_per_k: None,
                has_joint: true,
                has_tendon: true,
                pretension_nm: 0.0,
            },
            measured: Measured {
                y: 0.0,
                y_square: 0.0,
                y_cube: 0.0,
                y_slow: 0.0,
                pull_rad: 0.0,
                load_rad: 0.0,
                turned: 0.0,
                dq: 0.0,
                encoder: [0.0; 4],
                z: 0.0,
                z_unknown: 0.0,
                z_load: 0.0,
                held: 0.0,
                tau: 0.0,
                load: PayloadTorque::new(&[0.0; PARAMETERS_PER_BODY], [0.0; 3]),
                drive: None,
                tension_nm: f64::NAN,
            },
            temperature_difference_k: 0.0,
        }
    }

    pub(crate) fn point(&self) -> Point<'_> {
        Point {
            x: &self.x,
            joint: &self.joint,
            measured: &self.measured,
            temperature_difference_k: self.temperature_difference_k,
        }
    }

    /// Checks the term of an effect against a closed form, and its derivatives against central differences: with respect to the
    /// effect's own parameters, and zero with respect to others.
    pub(crate) fn check<E: Effect>(&self, term: impl Fn(&Point<'_>, &mut Sum<'_>), expected: f64) {
        const STEP: f64 = 1e-3;
        // Of rounding, in values of order one.
        const EXACT: f64 = 1e-12;
        let at = |x: &JointRow| {
            let mut derivatives = [0.0; PER_JOINT];
            let point = Point { x, ..self.point() };
            let value = total(0.0, &mut derivatives, |sum| term(&point, sum));
            (value, derivatives)
        };
        let (value, derivatives) = at(&self.x);
        assert!((value - expected).abs() < EXACT, "{value}, not {expected}");
        for (k, derivative) in derivatives.into_iter().enumerate() {
            let belongs = E::DESCRIPTION.parameters.iter().any(|p| p.place == k);
            let moved = |by: f64| {
                let mut x = self.x;
                x[k] += by;
                at(&x).0
            };
            let slope = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
            let expected = if belongs { slope } else { 0.0 };
            assert!(
                (derivative - expected).abs() < EXACT * (1.0 + slope.abs()),
                "{k}: {derivative}, not {expected}"
            );
        }
    }
}
