//! Transmissions of tendons that cross several joints, for a test and a benchmark.

use sinew_model::tendons::Routing;
use sinew_model::transmission::Transmission;

/// Tendons that run over the joint before their own.
pub(crate) fn routed(n: usize) -> Vec<Option<Transmission>> {
    let tendon = |i: usize| {
        // B = rho⁻ᵀ of rho = 1 + ½ on the diagonal below.
        let arm = |j: usize| match i.checked_sub(j) {
            Some(0) => 1.0,
            Some(1) => 0.5,
            _ => 0.0,
        };
        let share = |j: usize| j.checked_sub(i).map_or(0.0, |k| (-0.5_f64).powi(k as i32));
        Some(Transmission {
            routing: Some(Routing {
                tendon: i.to_string(),
                motor: i.to_string(),
                drive_ratio: 2.0,
                moment_arms: (0..n).map(arm).collect(),
                torque_shares: (0..n).map(share).collect(),
            }),
            ..Transmission::spring(40.0)
        })
    };
    (0..n).map(tendon).collect()
}
