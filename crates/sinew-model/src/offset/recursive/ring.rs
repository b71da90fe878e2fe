//! The last blocks, by their number.

use super::places::Places;
use crate::StepError;
use crate::offset::block::{Block, STAND_RAD};
use crate::offset::equations::estimation_model::EstimationModel;
use crate::offset::external_force::{ForceCourse, ForceTorque};
use alloc::vec::Vec;

/// The most blocks the second filter goes over.
pub(super) const SEGMENT: usize = 75;
/// Blocks kept: what the second filter goes over and what comes meanwhile.
pub(super) const KEPT: usize = 2 * SEGMENT;

/// A block, and the share of its information that counts; 0: none of it goes in.
#[derive(Debug, Clone)]
pub(super) struct KeptBlock {
    pub(super) block: Block,
    /// What a force from outside does to every joint; empty where none is looked for.
    pub(super) forces: Vec<ForceTorque>,
    pub(super) share: f64,
}

/// The last [`KEPT`] blocks. Block `number` has the slot `number % KEPT`.
#[derive(Debug, Clone)]
pub(super) struct BlockRing {
    blocks: Vec<KeptBlock>,
    /// Blocks taken.
    taken: usize,
    /// Pose the arm stands at, and for how many blocks.
    pose: Vec<f64>,
    stood: f64,
    /// Where a force from outside is looked for.
    force: Option<ForceCourse>,
    /// Where the arm has been.
    places: Places,
}

impl BlockRing {
    /// Room for blocks of a model; allocates here only.
    pub(super) fn new(model: &EstimationModel) -> Self {
        let layout = model.reduced.layout;
        let forces = model.force.as_ref().map_or(0, |_| layout.joints);
        let course = |force| ForceCourse::new(force, model.gain_per_s, model.block_s);
        let empty = KeptBlock {
            block: Block::zero(layout.joints, layout.bodies),
            forces: alloc::vec![ForceTorque::default(); forces],
            share: 0.0,
        };
        Self {
            blocks: alloc::vec![empty; KEPT],
            taken: 0,
            pose: alloc::vec![f64::NAN; layout.joints],
            stood: 0.0,
            force: model.force.as_ref().map(course),
            places: Places::new(layout.joints),
        }
    }

    /// Blocks taken.
    pub(super) fn taken(&self) -> usize {
        self.taken
    }

    /// Slot of a block, and the block.
    pub(super) fn get(&self, number: usize) -> Option<(usize, &KeptBlock)> {
        let slot = number % KEPT;
        Some((slot, self.blocks.get(slot)?))
    }

    /// Takes a block; returns its number.
    pub(super) fn push(
        &mut self,
        model: &EstimationModel,
        block: &Block,
    ) -> Result<usize, StepError> {
        let number = self.taken;
        let slot = number % KEPT;
        if !self.blocks.get(slot).is_some_and(|k| k.block.fits(block)) {
            return Err(StepError::Length);
        }
        if !block.is_finite() {
            return Err(StepError::NotFinite);
        }
        let share = self.share_of(model, block);
        if let Some(kept) = self.blocks.get_mut(slot) {
            kept.block.copy_from(block);
            kept.share = share;
            if let (Some(course), Some(force)) = (&mut self.force, &model.force) {
                course.follow(force, block, &mut kept.forces);
            }
            self.places.note(&block.q);
        }
        self.taken += 1;
        Ok(number)
    }

    /// Share of the time in which the arm was in one pose, 0 to 1.
    pub(super) fn in_one_pose(&self) -> f64 {
        self.places.most_in_one()
    }

    /// The same of the four poses it was in most.
    pub(super) fn in_few_poses(&self) -> f64 {
        self.places.most_in_few()
    }

    /// A block's temperature is another one, °C.
    pub(super) fn state_temperature(&mut self, number: usize, temperature_c: f64) {
        if let Some(kept) = self.blocks.get_mut(number % KEPT) {
            kept.block.temperature_c = temperature_c;
        }
    }

    /// How much of a block's information counts: by how far the arm travels, and of a stand that of one block at most.
    fn share_of(&mut self, model: &EstimationModel, block: &Block) -> f64 {
        let moved = self
            .pose
            .iter()
            .zip(&block.q)
            .any(|(a, b)| !((a - b).abs() <= STAND_RAD));
        if moved {
            for (pose, q) in self.pose.iter_mut().zip(&block.q) {
                *pose = *q;
            }
            self.stood = 0.0;
        }
        self.stood += 1.0;
        if self.stood <= model.blocks_of_a_stand() {
            model.share(block)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::turntable;

    /// Of a stand, ten seconds count as one block does; then nothing, until it has moved.
    #[test]
    fn a_stand_counts_as_one_block() {
        let model = turntable();
        let mut ring = BlockRing::new(&model);
        let mut block = Block::zero(1, model.reduced.layout.bodies);
        block.motor_torque[0] = f64::NAN;
        let mut share = |q: f64| {
            block.q[0] = q;
            let number = ring.push(&model, &block).unwrap();
            ring.get(number).unwrap().1.share
        };
        let stand: Vec<f64> = (0..80).map(|_| share(0.3)).collect();
        assert!(stand[..50].iter().all(|share| (share - 0.02).abs() < 1e-12));
        assert!(stand[50..].iter().all(|share| *share == 0.0));
        assert!(share(0.32) > 0.0);
    }
}
