//! Numbers for tests.

use super::block::Block;
use super::change::{Appearance, SearchScope};
use super::config::FeatureConfig;
use super::effects::{JOINT_PARAMETERS, JointParameter as P, PER_JOINT};
use super::equations::equation::{Equations, Side};
use super::equations::estimation_model::EstimationModel;
use super::external_force::{ExternalForce, ForceModel};
use super::joint_prior::JointPrior;
use super::prior::Prior;
use crate::arm::{Arm, ArmBuilder, BodyInertia, BodySpec, JointKind, Pose};
use crate::tolerances::Tolerances;
use alloc::vec::Vec;

/// A joint's own entries of an equation: parameters of the other side alone are zero, the encoder zero is an
/// offset too.
pub(crate) fn own(side: Side, seed: &mut u64) -> [f64; PER_JOINT] {
    let mut own = core::array::from_fn(|k| {
        let term = JOINT_PARAMETERS[k].term;
        let is_there = match side {
            Side::Link => term.is_of_link(),
            Side::Motor => term.is_of_motor(),
            Side::Tension => false,
        };
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

/// Slopes of all equations by entry `place` of the state `x`, by differences, each with the entry of its row in `at`.
pub(crate) fn slopes(
    at: &Equations,
    x: &[f64],
    place: usize,
    linearised: impl Fn(&[f64]) -> Equations,
) -> Vec<[f64; 2]> {
    const STEP: f64 = 1e-5;
    let [less, more] = [-STEP, STEP].map(|by| {
        let mut x = x.to_vec();
        x[place] += by;
        linearised(&x)
    });
    let mut unit = alloc::vec![0.0; x.len()];
    unit[place] = 1.0;
    let sides = less.list.iter().zip(&more.list).zip(&at.list);
    sides
        .map(|((less, more), e)| {
            [
                (less.residual - more.residual) / (2.0 * STEP),
                at.dot(e, &unit),
            ]
        })
        .collect()
}

/// Search for slips and creep with an unchanged payload.
pub(crate) const SCOPE: SearchScope = SearchScope {
    offsets: true,
    payload: false,
    creep: true,
    continues: false,
    onset: None,
};

/// Blocks of a recording.
pub(crate) const BLOCKS: usize = 80;
/// The block its joint slips with.
pub(crate) const SLIPS_AT: usize = 40;

const STIFFNESS_NM_PER_RAD: f64 = 40.0;

/// A joint about the vertical.
pub(crate) fn turntable() -> EstimationModel {
    turntables(1, 0.0)
}

/// Joints about the vertical one on the other.
pub(crate) fn tables(count: usize) -> Arm {
    let mut arm = ArmBuilder::new();
    for k in 0..count {
        arm = arm.body(BodySpec {
            name: alloc::format!("table {k}"),
            parent: k.checked_sub(1),
            kind: JointKind::Revolute,
            axis: [0.0, 0.0, 1.0],
            placement: Pose::from_xyz_rpy([0.0; 3], [0.0; 3]),
            body: BodyInertia::point(1.0, [0.1, 0.0, 0.0]),
        });
    }
    arm.build().unwrap()
}

/// The same with springs and friction.
pub(crate) fn turntables(count: usize, coulomb_nm: f64) -> EstimationModel {
    let arm = tables(count);
    let none = alloc::vec![None; count];
    let mut prior = Prior::new(&arm, &none, 0, [0.0; 3], Tolerances::default());
    for joint in &mut prior.joints {
        *joint = Some(JointPrior {
            stiffness_nm_per_rad: STIFFNESS_NM_PER_RAD,
            motor_inertia_kg_m2: None,
            coulomb_nm,
            viscous_nm_s_per_rad: 0.0,
            motor_coulomb_nm: 0.0,
            motor_viscous_nm_s_per_rad: 0.0,
            antagonistic: false,
            drift_rad_per_k: None,
            has_joint: true,
            has_tendon: true,
            pretension_nm: 0.0,
        });
    }
    let mut model = EstimationModel::new(prior, &FeatureConfig::default());
    // Blocks made here have passed no low-pass.
    model.reduced.appears = Appearance::AT_ONCE;
    model
}

/// Speed at which a block is passed through, to and fro, rad/s: each counts whole.
pub(crate) fn passing(b: usize) -> f64 {
    if b.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Poses without a load, of a joint that slips by `slip_rad`.
pub(crate) fn slipping(model: &EstimationModel, slip_rad: f64, mut seed: u64) -> Vec<Block> {
    let columns = model.reduced.layout.bodies;
    (0..BLOCKS)
        .map(|b| {
            let mut block = Block::zero(1, columns);
            block.time_s = 0.1 + 0.2 * b as f64;
            block.q[0] = random(&mut seed);
            block.dq[0] = passing(b);
            let slipped = if b >= SLIPS_AT { slip_rad } else { 0.0 };
            let y = 1e-3 + slipped + 0.2e-3 * random(&mut seed);
            (block.y[0], block.y_square[0], block.y_cube[0]) = (y, y * y, y * y * y);
            block.motor_torque[0] = f64::NAN;
            block
        })
        .collect()
}

/// Distance of the force's point of action from the axis, m.
const LEVER_M: f64 = 0.4;

/// Two joints about one vertical axis; a force may act on the second one.
pub(crate) fn pushable(believed: ExternalForce) -> EstimationModel {
    let mut model = turntables(2, 0.0);
    let place = (1, [LEVER_M, 0.0, 0.0]);
    model.force = Some(ForceModel::new(believed, &tables(2), place, 0.05));
    model
}

/// Poses, a second apart, of these joints with offsets of 1 and 2 mrad while a force acts: its moment about the axis is
/// `r (f_y cos − f_x sin)`, and the spring torques decrease by it.
pub(crate) fn pushed(model: &EstimationModel, [x, y, _]: [f64; 3], mut seed: u64) -> Vec<Block> {
    let columns = model.reduced.layout.bodies;
    (0..BLOCKS)
        .map(|b| {
            let mut block = Block::zero(2, columns);
            block.time_s = 0.1 + b as f64;
            let q = [0, 1].map(|_| 1.5 * random(&mut seed));
            let turned = q[0] + q[1];
            let moment_nm = LEVER_M * (y * libm::cos(turned) - x * libm::sin(turned));
            for (i, offset_rad) in [1e-3, 2e-3].into_iter().enumerate() {
                let noise_rad = 0.1e-3 * random(&mut seed);
                let y = offset_rad - moment_nm / STIFFNESS_NM_PER_RAD + noise_rad;
                (block.y[i], block.y_square[i], block.y_cube[i]) = (y, y * y, y * y * y);
            }
            block.q.copy_from_slice(&q);
            block.dq.fill(passing(b));
            block.turned.copy_from_slice(&q);
            block.motor_torque.fill(f64::NAN);
            block
        })
        .collect()
}
