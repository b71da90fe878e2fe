//! Bytes into blocks, on the host.

use super::{WireError, checked, robot_id};
use crate::arm::Arm;
use crate::offset::{Block, FeatureConfig, FeatureObserver};
use alloc::vec::Vec;

/// Reads blocks from a line, byte by byte. It finds its way again after bytes that were lost, changed or added, and starts
/// anywhere.
///
/// Allocates for every block: for a host.
#[derive(Debug, Clone)]
pub struct BlockReceiver {
    robot: u32,
    joints: usize,
    columns: usize,
    frame: Vec<u8>,
    bytes_max: usize,
    /// More came than a frame has: nothing is kept until the next begins.
    too_long: bool,
    /// Sequence that the next block has if none is lost.
    expected: Option<u32>,
    counts: Counts,
}

/// What came so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Blocks taken.
    pub blocks: u64,
    /// Blocks that the chip completed and that didn't come: lost on the line, or left out because it was too slow.
    pub lost: u64,
    /// Frames refused, for whatever reason; the first bytes of a line that was open already are one.
    pub refused: u64,
    /// How often the chip began anew.
    pub restarts: u64,
}

/// A block that came.
#[derive(Debug, Clone, PartialEq)]
pub struct Received {
    /// Its number since the chip began, from 0.
    pub sequence: u32,
    /// Blocks between the last one and this that didn't come.
    pub lost_before: u32,
    /// The chip began anew since the last block.
    pub restarted: bool,
    /// The block, with the bits it had on the chip.
    pub block: Block,
}

impl BlockReceiver {
    /// A receiver of blocks of this arm, made with this configuration.
    pub fn new(arm: &Arm, config: &FeatureConfig) -> Self {
        let features = FeatureObserver::new(arm, *config);
        let sender = super::BlockSender::new(&features);
        Self {
            robot: robot_id(&features),
            joints: arm.dof(),
            columns: features.made_for().2.len(),
            bytes_max: sender.frame_bytes_max(),
            frame: Vec::with_capacity(sender.frame_bytes_max()),
            too_long: false,
            expected: None,
            counts: Counts::default(),
        }
    }

    /// What came so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Takes a byte; gives a block when it was the last of one.
    ///
    /// # Errors
    /// [`WireError`] with the last byte of a frame that is no block of this robot. The next byte begins a new one.
    pub fn push(&mut self, byte: u8) -> Result<Option<Received>, WireError> {
        if byte != 0 {
            self.too_long |= self.frame.len() >= self.bytes_max;
            if !self.too_long {
                self.frame.push(byte);
            }
            return Ok(None);
        }
        if self.frame.is_empty() {
            return Ok(None);
        }
        let received = match self.too_long {
            true => Err(WireError::Damaged),
            false => self.decode(),
        };
        self.too_long = false;
        self.frame.clear();
        match received {
            Ok((sequence, block)) => Ok(Some(self.count(sequence, block))),
            Err(why) => {
                self.counts.refused += 1;
                Err(why)
            }
        }
    }

    fn decode(&mut self) -> Result<(u32, Block), WireError> {
        let bytes = cobs::decode_in_place(&mut self.frame).map_err(|_| WireError::Damaged)?;
        let content = checked(self.frame.get(..bytes).unwrap_or_default())?;
        let head: Result<(u32, &[u8]), _> = postcard::take_from_bytes(content);
        let (robot, rest) = head.map_err(|_| WireError::Content)?;
        if robot != self.robot {
            return Err(WireError::Robot {
                found: robot,
                expected: self.robot,
            });
        }
        let (sequence, block): (u32, Block) =
            postcard::from_bytes(rest).map_err(|_| WireError::Content)?;
        match block.is_of(self.joints, self.columns) && block.is_finite() {
            true => Ok((sequence, block)),
            false => Err(WireError::Content),
        }
    }

    fn count(&mut self, sequence: u32, block: Block) -> Received {
        let expected = self.expected.unwrap_or(sequence);
        let restarted = sequence < expected;
        // What a chip completed before its first block that came is lost, too.
        let lost_before = if restarted {
            sequence
        } else {
            sequence - expected
        };
        self.expected = Some(sequence.wrapping_add(1));
        self.counts.blocks += 1;
        self.counts.lost += u64::from(lost_before);
        self.counts.restarts += u64::from(restarted);
        Received {
            sequence,
            lost_before,
            restarted,
            block,
        }
    }
}
