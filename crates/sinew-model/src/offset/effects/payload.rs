//! Payload in the gripper.

use super::description::ASSUMED;
use super::{Description, Effect, FIXED, Parameter, about_zero};
use crate::Gaussian;
use crate::arm::PARAMETERS_PER_BODY;
use crate::offset::state_estimate::Payload;
use crate::tolerances::Tolerances;

/// Number of entries of a payload: mass, and three first moments about its expected point.
pub(crate) const PAYLOAD: usize = 4;

/// Nothing is held further from where it is expected, m, a tool by its end, where it may be off by `reach_m`, a standard deviation
/// (`payload_reach_mm`).
pub(crate) fn furthest_m(reach_m: f64) -> f64 {
    const TOOL_M: f64 = 0.3;
    const TOOL_REACH_M: f64 = 0.05;
    TOOL_M * (reach_m / TOOL_REACH_M).max(1.0)
}

/// Inertial parameters of a kilogram at a point, in the order of the regressor.
pub(crate) fn point_mass([x, y, z]: [f64; 3]) -> [f64; PARAMETERS_PER_BODY] {
    let inertia = [
        y * y + z * z,
        -x * y,
        -x * z,
        x * x + z * z,
        -y * z,
        x * x + y * y,
    ];
    let [xx, xy, xz, yy, yz, zz] = inertia;
    [1.0, x, y, z, xx, xy, xz, yy, yz, zz]
}

/// Payload in the gripper: mass and first moments about its expected point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HeldPayload {
    mass_kg: f64,
    moments: [f64; 3],
    /// Mass the moments are those of, at least.
    least_mass_kg: f64,
}

const fn moment(name: &'static str, symbol: &'static str) -> Parameter {
    Parameter {
        name,
        symbol,
        unit: "kg·m",
        prior_text: "0 ± mass × `payload_reach_mm`",
        source: ASSUMED,
        ..Parameter::CARRIED
    }
}

impl Effect for HeldPayload {
    const DESCRIPTION: Description = Description {
        title: "Payload",
        text: "The gripper may hold a point mass near the expected point `a`. \
               Its second moments follow from its mass and first moments, so the torque is not linear in them. \
               A change found by the search, such as a load picked up, is added to the parameters from its time on.",
        equation: "joint torque   Φ_tool (m, m a + h, m a aᵀ + a hᵀ + h aᵀ + h hᵀ/m)",
        parameters: &[
            Parameter {
                name: "payload mass",
                symbol: "m",
                unit: "kg",
                prior_text: "as specified; or `payload_mean_kg` ± `payload_kg`; or 0 for an empty gripper",
                source: ASSUMED,
                ..Parameter::CARRIED
            },
            moment("payload moment x", "h_x"),
            moment("payload moment y", "h_y"),
            moment("payload moment z", "h_z"),
        ],
    };
}

impl HeldPayload {
    /// Prior of mass and moments.
    pub(crate) fn prior(tolerances: &Tolerances, payload: Payload) -> [Gaussian; PAYLOAD] {
        let mass = match payload {
            Payload::Empty => return [about_zero(FIXED); PAYLOAD],
            Payload::Unknown => tolerances.payload_kg,
            Payload::Specified { mass_kg } => Gaussian::new(mass_kg.mean, mass_kg.std.max(FIXED)),
        };
        let size = mass.mean.abs().max(mass.std);
        let moment = about_zero(size * tolerances.payload_reach_m);
        [mass, moment, moment, moment]
    }

    /// * `furthest_m`: [`furthest_m`] of the robot.
    pub(crate) fn new([mass_kg, moments @ ..]: [f64; PAYLOAD], furthest_m: f64) -> Self {
        let [x, y, z] = moments;
        let size = libm::sqrt(x * x + y * y + z * z);
        Self {
            mass_kg,
            moments,
            least_mass_kg: mass_kg.max(size / furthest_m),
        }
    }
}

/// Effect of a payload on the torque of a joint: a point mass near its expected point.
///
/// With `h = m e` its moments about that place `a`, its second moments about the link's origin are
/// `m a aᵀ + a hᵀ + h aᵀ + h hᵀ/m`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PayloadTorque {
    /// Torque of a mass at `a`, and of moments about it.
    slope: [f64; PAYLOAD],
    /// Torque of second moments.
    second: [[f64; 3]; 3],
}

impl PayloadTorque {
    /// * `body`: torque per inertial parameter of the body that carries it; `a`: where it is expected, m.
    pub(crate) fn new(body: &[f64; PARAMETERS_PER_BODY], a: [f64; 3]) -> Self {
        let [mass, x, y, z, xx, xy, xz, yy, yz, zz] = *body;
        // Moments of inertia are sums of second moments, products of inertia are their negatives.
        let second = [
            [yy + zz, -0.5 * xy, -0.5 * xz],
            [-0.5 * xy, xx + zz, -0.5 * yz],
            [-0.5 * xz, -0.5 * yz, xx + yy],
        ];
        let [sx, sy, sz] = second.map(|row| dot(row, a));
        let first = [x, y, z];
        Self {
            slope: [
                mass + dot(first, a) + dot([sx, sy, sz], a),
                x + 2.0 * sx,
                y + 2.0 * sy,
                z + 2.0 * sz,
            ],
            second,
        }
    }

    /// The torque, N·m, and its change with mass and moments.
    pub(crate) fn torque(&self, payload: &HeldPayload) -> (f64, [f64; PAYLOAD]) {
        let h = payload.moments;
        let [mass, moments @ ..] = self.slope;
        let mut torque = mass * payload.mass_kg + dot(moments, h);
        let [mut x, mut y, mut z] = moments;
        if payload.least_mass_kg > 0.0 {
            let per_mass = 1.0 / payload.least_mass_kg;
            let [sx, sy, sz] = self.second.map(|row| per_mass * dot(row, h));
            torque += dot([sx, sy, sz], h);
            x += 2.0 * sx;
            y += 2.0 * sy;
            z += 2.0 * sz;
        }
        (torque, [mass, x, y, z])
    }
}

fn dot([a0, a1, a2]: [f64; 3], [b0, b1, b2]: [f64; 3]) -> f64 {
    a0 * b0 + a1 * b1 + a2 * b2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn payload_torque(
        body: &[f64; PARAMETERS_PER_BODY],
        a: [f64; 3],
        held: [f64; PAYLOAD],
    ) -> (f64, [f64; PAYLOAD]) {
        PayloadTorque::new(body, a).torque(&HeldPayload::new(held, furthest_m(0.05)))
    }

    #[test]
    fn payload_torque_equals_point_mass_torque() {
        let body: [f64; PARAMETERS_PER_BODY] =
            core::array::from_fn(|k| libm::sin(1.0 + 2.3 * k as f64));
        let at = [0.02, -0.11, 0.04];
        for (m, e) in [
            (0.4, [0.01, -0.05, 0.03]),
            (0.02, [0.0, 0.05, 0.0]),
            (0.3, [0.0; 3]),
            (0.25, [0.05, 0.0, 0.25]),
            (0.0, [0.0; 3]),
        ] {
            let state = [m, m * e[0], m * e[1], m * e[2]];
            let (torque, slope) = payload_torque(&body, at, state);
            let there = point_mass(core::array::from_fn(|k| at[k] + e[k]));
            let expected: f64 = body.iter().zip(there).map(|(phi, pi)| phi * m * pi).sum();
            assert!((torque - expected).abs() < 1e-14, "{torque} {expected}");
            if m == 0.0 {
                continue;
            }
            // Moments: the slope is that of the torque at a constant mass. The slope of the mass neglects that the same
            // moments correspond to a shorter distance on a heavier body, which its standard deviation covers.
            for k in 1..PAYLOAD {
                let mut ends = [state; 2];
                ends[0][k] -= 1e-6;
                ends[1][k] += 1e-6;
                let [low, high] = ends.map(|s| payload_torque(&body, at, s).0);
                let numeric = (high - low) / 2e-6;
                assert!(
                    (slope[k] - numeric).abs() < 1e-6,
                    "{k}: {} {numeric}",
                    slope[k]
                );
            }
        }
    }

    #[test]
    fn moments_without_a_mass_stay_within_reach() {
        let body = [1.0; PARAMETERS_PER_BODY];
        let (torque, slope) = payload_torque(&body, [0.0; 3], [-0.01, 0.004, 0.0, 0.0]);
        // 4 mm·kg at 30 cm at most: a mass of 13 g, and second moments of 1.2 g·m².
        let expected = -0.01 + 0.004 + 2.0 * (0.004 / 0.3) * 0.09;
        assert!((torque - expected).abs() < 1e-14, "{torque} {expected}");
        assert!(slope.iter().all(|s| s.is_finite()));
    }

    /// A payload of 0.2 kg at the end of a tool of 0.5 m, with `payload_reach_mm` 100.
    #[test]
    fn longer_reach_permits_distant_load() {
        let body = [1.0; PARAMETERS_PER_BODY];
        let held = [0.2, 0.0, 0.0, 0.1];
        let torque = |reach_m| {
            let held = HeldPayload::new(held, furthest_m(reach_m));
            PayloadTorque::new(&body, [0.0; 3]).torque(&held).0
        };
        let expected = 0.2 + 0.1 + 2.0 * 0.2 * 0.25;
        assert!((torque(0.1) - expected).abs() < 1e-14);
        let at_30_cm = 0.2 + 0.1 + 2.0 * 0.1 * 0.3;
        for short in [0.0, 0.05] {
            assert!((torque(short) - at_30_cm).abs() < 1e-14);
        }
    }
}
