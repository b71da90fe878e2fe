//! Bytes into blocks, on the host.

use super::{WireError, checked, robot_id};
use crate::arm::Arm;
use crate::offset::{Block, FeatureConfig, FeatureObserver};
use alloc::vec::Vec;

/// Reads blocks from a line, byte by byte. It resynchronises after bytes that were lost, changed or added, and may
/// start at any byte.
///
/// Allocates memory for every block and is therefore intended for a host.
#[derive(Debug, Clone)]
pub struct BlockReceiver {
    robot: u32,
    joints: usize,
    columns: usize,
    frame: Vec<u8>,
    bytes_max: usize,
    /// The frame is longer than allowed: input is discarded until the next frame begins.
    too_long: bool,
    /// Sequence that the next block has if none is lost.
    expected: Option<u32>,
    counts: Counts,
}

/// Statistics of the received frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Number of blocks received.
    pub blocks: u64,
    /// Number of blocks that the chip completed and that were not received: lost on the line, or skipped because the
    /// line was too slow.
    pub lost: u64,
    /// Number of frames rejected for any reason, including the partial first frame of a running line.
    pub rejected: u64,
    /// Number of restarts of the chip.
    pub restarts: u64,
}

/// Received block with its number.
#[derive(Debug, Clone, PartialEq)]
pub struct Received {
    /// Number of the block since the start of the chip, from 0.
    pub sequence: u32,
    /// Number of blocks lost between the previous block and this one.
    pub lost_before: u32,
    /// Whether the chip restarted since the last block.
    pub restarted: bool,
    /// Block, bitwise identical to the one on the chip.
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

    /// Returns the statistics of the received frames.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Takes a byte; gives a block when it was the last of one.
    ///
    /// # Errors
    /// Returns a [`WireError`] with the last byte of a frame that is no block of this robot. The next byte begins a new one.
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
            Err(reason) => {
                self.counts.rejected += 1;
                Err(reason)
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
        // Blocks completed before the first received one are lost, too.
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
