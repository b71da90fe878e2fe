//! Blocks into bytes, on the chip.

use super::{CRC, CRC_BYTES, VERSION, robot_id};
use crate::StepError;
use crate::offset::{Block, FeatureObserver};
use alloc::vec::Vec;

/// Maximum number of bytes before a block: version, robot, sequence.
const HEAD_BYTES: usize = 1 + 5 + 5;

/// Writes blocks as frames, and stores the bytes that the line has not accepted yet.
///
/// ```text
/// if features.step(…)? { sender.put(features.block())?; }
/// while line.takes_a_byte() { … sender.pending() … sender.sent(1) }
/// ```
#[derive(Debug, Clone)]
pub struct BlockSender {
    robot: u32,
    columns: usize,
    joints: usize,
    sequence: u32,
    skipped: u32,
    content: Vec<u8>,
    frame: Vec<u8>,
    /// Start of the part of the frame that is not sent yet.
    from: usize,
    to: usize,
}

impl BlockSender {
    /// A sender of the blocks that `features` makes. All memory is allocated here.
    pub fn new(features: &FeatureObserver) -> Self {
        let (arm, _, base) = features.made_for();
        let (joints, columns) = (arm.dof(), base.len());
        let sizes = postcard::ser_flavors::Size::default();
        let block = postcard::serialize_with_flavor(&Block::zero(joints, columns), sizes);
        let content = HEAD_BYTES + block.unwrap_or_default() + CRC_BYTES;
        Self {
            robot: robot_id(features),
            columns,
            joints,
            sequence: 0,
            skipped: 0,
            content: alloc::vec![0; content],
            frame: alloc::vec![0; cobs::max_encoding_length(content) + 1],
            from: 0,
            to: 0,
        }
    }

    /// Accepts a block for sending. Returns `false` if the previous one is not sent yet; this block is then
    /// skipped and counted.
    ///
    /// # Errors
    /// Returns [`StepError::Length`] if the block belongs to another arm; nothing has changed.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock; `O(n r)` of `r` base parameters.
    pub fn put(&mut self, block: &Block) -> Result<bool, StepError> {
        if !block.is_of(self.joints, self.columns) {
            return Err(StepError::Length);
        }
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        if !self.pending().is_empty() {
            self.skipped = self.skipped.saturating_add(1);
            return Ok(false);
        }
        let message = (VERSION, self.robot, sequence, block);
        let written = postcard::to_slice_crc32(&message, &mut self.content, CRC.digest());
        let content = written.map_err(|_| StepError::Length)?;
        let framed = cobs::try_encode(content, &mut self.frame).map_err(|_| StepError::Length)?;
        let end = self.frame.get_mut(framed).ok_or(StepError::Length)?;
        *end = 0;
        (self.from, self.to) = (0, framed + 1);
        Ok(true)
    }

    /// Returns the bytes to be sent, in order.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn pending(&self) -> &[u8] {
        self.frame.get(self.from..self.to).unwrap_or_default()
    }

    /// Removes the first `count` [pending](BlockSender::pending) bytes, which the line has accepted.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn sent(&mut self, count: usize) {
        self.from = self.from.saturating_add(count).min(self.to);
    }

    /// Maximum number of bytes of a frame, which the line transmits five times per second.
    pub fn frame_bytes_max(&self) -> usize {
        self.frame.len()
    }

    /// Number of blocks skipped because the line was too slow.
    pub fn skipped(&self) -> u32 {
        self.skipped
    }
}
