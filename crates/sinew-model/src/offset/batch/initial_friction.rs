//! Effect of stiction in rest phases on an estimate.

use super::problem::Problem;
use super::solution::Solution;
use crate::offset::block::Block;
use crate::offset::effects::JointParameter as P;
use crate::offset::effects::initial_friction::INITIAL_FRICTION_STD;
use crate::offset::equations::equation::Equations;
use crate::offset::equations::loaded::Content;
use crate::offset::estimate::MapEstimate;
use alloc::vec::Vec;

/// Standard deviation of entry `place` by the stiction of joints in long rest phases.
///
/// The friction in −1…1 is then unknown ([`Block::rests_long`]) but constant until the arm moves, so that it does not
/// average out over blocks. With the information `A`, the row `h` and the weighted information `w` of an equation, the
/// friction `F` and the torque gain `g` (derivative of the expected value with respect to a torque), over all long rest
/// phases `r` of all joints
///
/// ```text
/// σ² = 0.85² Σ_r (Σ_{b in r} (A⁻¹ h_b)_place w_b g_b F_b)²,    F = F_c + μ K |y|
/// ```
///
/// as for a considered, not estimated parameter (Schmidt 1966).
pub(super) fn deviation_of(problem: &Problem<'_>, solution: &Solution, place: usize) -> f64 {
    let at = &solution.estimate;
    let mut along = alloc::vec![0.0; at.state.len()];
    along[place] = 1.0;
    solution.factor.solve(&mut along);
    let mut rest = RestPhase::new(problem.layout().joints);
    let mut equations = Equations::new(problem.layout(), &at.changes);
    let mut variance = 0.0;
    for (b, block) in problem.blocks.iter().enumerate() {
        variance += rest.add_block(block);
        problem.equations(at, b, Content::Rows, &mut equations);
        let weight = at.weights.get(b).copied().unwrap_or_default();
        for e in &equations.list {
            let moved = equations.dot(e, &along) * weight * problem.information_of(e, at, b);
            let moved = moved * e.torque_gain;
            match &problem.model.reduced.routes {
                None => rest.moves[e.joint] += moved * friction_nm(problem, at, block, e.joint),
                Some(routes) if routes.pulled(e.joint).is_some() => {
                    rest.moves[e.joint] += moved * friction_nm(problem, at, block, e.joint);
                }
                Some(routes) => {
                    let shares = routes.torque_shares(e.joint).iter().enumerate();
                    for (j, share) in shares.filter(|(_, share)| **share != 0.0) {
                        rest.moves[j] += moved * share * friction_nm(problem, at, block, j);
                    }
                }
            }
        }
    }
    variance += rest.variance();
    INITIAL_FRICTION_STD * libm::sqrt(variance)
}

/// Largest friction of joint `i`, N·m.
fn friction_nm(problem: &Problem<'_>, at: &MapEstimate, block: &Block, i: usize) -> f64 {
    let model = &problem.model.reduced;
    let state = &at.state[problem.layout().own(i)];
    let pulled = model.routes.as_ref().and_then(|routes| routes.pulled(i));
    let stiffness = match pulled {
        Some(pulled) => pulled.stiffness_nm_per_rad,
        None => model.joints[i].map_or(0.0, |joint| joint.stiffness_nm_per_rad),
    };
    let load_rad = match &model.routes {
        None => block.y[i],
        Some(routes) => routes.joint_deflection(i, block.y.iter().copied()),
    };
    let load = state[P::LoadFriction as usize] * stiffness * load_rad;
    state[P::Coulomb as usize].abs() + load.abs()
}

/// Rest phase of the arm at one pose.
struct RestPhase {
    stood_s: f64,
    is_long: bool,
    /// Derivative of the entry with respect to the friction of every joint, at full friction.
    moves: Vec<f64>,
}

impl RestPhase {
    fn new(joints: usize) -> Self {
        Self {
            stood_s: 0.0,
            is_long: false,
            moves: alloc::vec![0.0; joints],
        }
    }

    /// Adds a block; returns the variance contribution of the rest phase that ended with it.
    fn add_block(&mut self, block: &Block) -> f64 {
        let mut ended = 0.0;
        if block.stood_s <= self.stood_s {
            ended = self.variance();
            self.is_long = false;
            self.moves.fill(0.0);
        }
        self.stood_s = block.stood_s;
        self.is_long |= block.rests_long();
        ended
    }

    fn variance(&self) -> f64 {
        if self.is_long {
            self.moves.iter().map(|x| x * x).sum()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::batch::search::searched;
    use crate::offset::change::{ChangeKind, ChangePoint};
    use crate::offset::equations::estimation_model::EstimationModel;
    use crate::offset::fixtures::{random, turntables};
    use crate::offset::state_estimate::TENSIONED_OFFSET_RAD;

    const COULOMB_NM: f64 = 0.1;
    const JOINTS: usize = 8;
    const MOVING_BLOCKS: usize = 120;
    const RESTING_BLOCKS: usize = 120;

    /// Returns a recording of joints that move to and fro, then rest, the first `inconsistency_rad` from its expected
    /// friction; its rope slips by `slip_rad` at block `at`.
    fn recording(
        model: &EstimationModel,
        inconsistency_rad: f64,
        (at, slip_rad): (usize, f64),
    ) -> Vec<Block> {
        let columns = model.reduced.layout.bodies;
        let mut seed = 7;
        (0..MOVING_BLOCKS + RESTING_BLOCKS)
            .map(|b| {
                let mut block = Block::zero(JOINTS, columns);
                block.time_s = 0.1 + 0.2 * b as f64;
                block.motor_torque.fill(f64::NAN);
                block.stood_s = 0.2 * b.saturating_sub(MOVING_BLOCKS) as f64;
                let moves = b < MOVING_BLOCKS;
                let slipped = if b >= at { slip_rad } else { 0.0 };
                let off = if moves { 0.0 } else { inconsistency_rad };
                for i in 0..JOINTS {
                    block.q[i] = if moves { random(&mut seed) } else { 0.3 };
                    block.z[i] = if !moves || (b / 5) % 2 == 0 {
                        1.0
                    } else {
                        -1.0
                    };
                    block.dq[i] = if moves { block.z[i] } else { 0.0 };
                    let own = if i == 0 { slipped + off } else { 0.0 };
                    let friction = COULOMB_NM / 40.0 * block.z[i];
                    let y = friction + own + 0.2e-3 * random(&mut seed);
                    (block.y[i], block.y_square[i], block.y_cube[i]) = (y, y * y, y * y * y);
                }
                block
            })
            .collect()
    }

    fn changes(inconsistency_rad: f64, slip: (usize, f64)) -> Vec<ChangePoint> {
        let model = turntables(JOINTS, COULOMB_NM);
        let blocks = recording(&model, inconsistency_rad, slip);
        searched(&model, TENSIONED_OFFSET_RAD, &blocks).changes
    }

    /// Coulomb friction over stiffness is 2.5 mrad.
    #[test]
    fn stiction_in_rest_phase_is_no_slip() {
        for inconsistency_rad in [-5e-3, -3e-3, 3e-3] {
            let found = changes(inconsistency_rad, (usize::MAX, 0.0));
            assert_eq!(found, [], "{inconsistency_rad}");
        }
    }

    #[test]
    fn slip_in_motion_is_found_with_rest_phase() {
        let found = changes(2e-3, (MOVING_BLOCKS / 2, 3e-3));
        let [slip] = found[..] else {
            panic!("{found:?}");
        };
        assert_eq!(slip.kind, ChangeKind::Offset(0));
        assert!(
            (slip.at_s - 0.2 * (MOVING_BLOCKS / 2) as f64).abs() < 0.5,
            "{slip:?}"
        );
    }

    #[test]
    fn offset_beyond_stiction_is_slip() {
        let found = changes(0.0, (MOVING_BLOCKS, 25e-3));
        assert_eq!(found.len(), 1, "{found:?}");
    }
}
