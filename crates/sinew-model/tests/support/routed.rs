//! Transmissions of tendons that cross several joints, for a test and a benchmark.

use sinew_model::tendons::{MomentArm, Pull, PulledJoint, Routing, ShorteningTable, TendonKind};
use sinew_model::transmission::{Friction, Transmission};

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
                joint: i,
                motor: i.to_string(),
                drive_ratio: 2.0,
                moment_arms: (0..n).map(arm).collect(),
                torque_shares: (0..n).map(share).collect(),
                pull: None,
            }),
            ..Transmission::spring(40.0)
        })
    };
    (0..n).map(tendon).collect()
}

/// Two strands that pull every joint against each other; the moment arm of the second one varies. As many axes again as joints.
#[allow(dead_code, reason = "the benchmark has no use for them")]
pub(crate) fn antagonists(n: usize) -> Vec<Option<Transmission>> {
    let q = [-1.0, -0.3, 0.4, 1.0];
    let varying = ShorteningTable::new(&q, &q.map(|q: f64| -q + 0.1 * q * q)).unwrap();
    let strand = |axis: usize| {
        let joint = axis % n;
        let arm = match axis < n {
            true => MomentArm::Constant(1.0),
            false => MomentArm::Table(varying.clone()),
        };
        let nominal = if axis < n { 1.0 } else { -1.0 };
        let at_joint = |j: usize| if j == joint { nominal } else { 0.0 };
        Some(Transmission {
            routing: Some(Routing {
                tendon: axis.to_string(),
                joint,
                motor: axis.to_string(),
                drive_ratio: 0.5,
                moment_arms: (0..n).map(at_joint).collect(),
                torque_shares: Vec::new(),
                pull: Some(Pull {
                    kind: TendonKind::Strand,
                    pretension_nm: 10.0,
                    metres_per_rad: Some(0.02),
                    joints: vec![PulledJoint {
                        joint,
                        arm,
                        friction: Friction::default(),
                        spring: None,
                    }],
                }),
            }),
            ..Transmission::spring(40.0)
        })
    };
    (0..2 * n).map(strand).collect()
}
