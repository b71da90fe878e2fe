//! Torque of what the gripper holds.

use super::prior::PAYLOAD;
use crate::arm::PARAMETERS_PER_BODY;

/// Torque of the payload: a point mass near where it is expected.
///
/// With `h = m e` its moments about that place `a`, its second moments about the link's origin are
/// `m a aᵀ + a hᵀ + h aᵀ + h hᵀ/m`.
///
/// Returns the torque and its change with mass and moments.
pub(super) fn payload_torque(
    body: &[f64; PARAMETERS_PER_BODY],
    a: [f64; 3],
    [m, h @ ..]: [f64; PAYLOAD],
) -> (f64, [f64; PAYLOAD]) {
    /// Nothing is held further from where it is expected, m.
    const FAR_M: f64 = 0.1;
    const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Torque of second moments `u vᵀ + v uᵀ`, halved.
    let second = |u: [f64; 3], v: [f64; 3]| {
        let [xx, yy, zz] = [u[0] * v[0], u[1] * v[1], u[2] * v[2]];
        let mixed = |i: usize, k: usize| 0.5 * (u[i] * v[k] + u[k] * v[i]);
        body[4] * (yy + zz) + body[7] * (xx + zz) + body[9] * (xx + yy)
            - body[5] * mixed(0, 1)
            - body[6] * mixed(0, 2)
            - body[8] * mixed(1, 2)
    };
    let first = body[1] * a[0] + body[2] * a[1] + body[3] * a[2];
    let mut slope = [body[0] + first + second(a, a), 0.0, 0.0, 0.0];
    let mut torque = slope[0] * m;
    let size = libm::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    let mass = m.max(size / FAR_M);
    for (k, axis) in AXES.into_iter().enumerate() {
        slope[k + 1] = body[k + 1] + 2.0 * second(a, axis);
        torque += slope[k + 1] * h[k];
        if mass > 0.0 {
            slope[k + 1] += 2.0 * second(h, axis) / mass;
        }
    }
    if mass > 0.0 {
        torque += second(h, h) / mass;
    }
    (torque, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inertial parameters of a point mass in the order of the regressor.
    fn point(m: f64, [x, y, z]: [f64; 3]) -> [f64; PARAMETERS_PER_BODY] {
        let moments = [m, m * x, m * y, m * z];
        let inertia = [
            y * y + z * z,
            -x * y,
            -x * z,
            x * x + z * z,
            -y * z,
            x * x + y * y,
        ];
        core::array::from_fn(|k| {
            moments
                .get(k)
                .copied()
                .unwrap_or_else(|| m * inertia[k - 4])
        })
    }

    #[test]
    fn a_payload_weighs_as_a_point_mass_where_it_is() {
        let body: [f64; PARAMETERS_PER_BODY] =
            core::array::from_fn(|k| libm::sin(1.0 + 2.3 * k as f64));
        let at = [0.02, -0.11, 0.04];
        for (m, e) in [
            (0.4, [0.01, -0.05, 0.03]),
            (0.02, [0.0, 0.05, 0.0]),
            (0.3, [0.0; 3]),
            (0.0, [0.0; 3]),
        ] {
            let state = [m, m * e[0], m * e[1], m * e[2]];
            let (torque, slope) = payload_torque(&body, at, state);
            let there = point(m, core::array::from_fn(|k| at[k] + e[k]));
            let expected: f64 = body.iter().zip(there).map(|(phi, pi)| phi * pi).sum();
            assert!((torque - expected).abs() < 1e-14, "{torque} {expected}");
            if m == 0.0 {
                continue;
            }
            // Moments: the slope is that of the torque at a constant mass. The mass's own leaves
            // out that the same moments sit nearer on a heavier body, which its size allows for.
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
        // 4 mm·kg at 10 cm at most: a mass of 40 g, and second moments of 0.4 g·m².
        let expected = -0.01 + 0.004 + 2.0 * 0.04 * 0.01;
        assert!((torque - expected).abs() < 1e-14, "{torque} {expected}");
        assert!(slope.iter().all(|s| s.is_finite()));
    }
}
