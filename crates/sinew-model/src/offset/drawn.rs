//! Numbers for tests.

use super::equation::Side;
use super::prior::{JointParameter as P, PER_JOINT};

/// A joint's own entries of an equation: what only the other side knows is nothing, the zero is an
/// offset too.
pub(super) fn own(side: Side, seed: &mut u64) -> [f64; PER_JOINT] {
    let of_motor = P::MotorScale as usize..P::Slack as usize;
    let both = [P::Coulomb, P::Viscous, P::LoadFriction, P::Stuck].map(|p| p as usize);
    let mut own = core::array::from_fn(|k| {
        let is_there = both.contains(&k) || of_motor.contains(&k) == (side == Side::Motor);
        if is_there { random(seed) } else { 0.0 }
    });
    own[P::Zero as usize] = own[P::Offset as usize];
    own
}

/// Numbers without a pattern in −1..1, the same on every machine.
pub(crate) fn random(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
