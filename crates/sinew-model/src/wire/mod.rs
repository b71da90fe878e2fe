//! What a microcontroller and its host tell each other, as bytes: the robot (host to chip, once) and blocks (chip to host,
//! five a second).
//!
//! ```text
//! frame   = COBS(content) 0                       a zero byte is nowhere else, so a reader finds the next frame
//! content = version robot sequence block crc      fields as postcard writes them, CRC-32 (IEEE 802.3), little endian
//! image   = version arm base-columns transmissions crc
//! ```
//!
//! Numbers are IEEE 754 doubles, little endian, as they are: what comes out has the bits of what went in. `robot` is the
//! checksum of arm, base columns and [`FeatureConfig`], so that blocks of another robot, or made in another way, are refused. `sequence`
//! counts blocks that were complete, sent or not, so that a host knows how many it has not got.
//!
//! The format is that of one [`VERSION`]: chip and host are built of the same one, or the host says that they aren't.
//!
//! Reading order: this file, `image` (the robot), `sender`, `receiver`.
//!
//! # Source
//! postcard's wire specification; S. Cheshire and M. Baker, *Consistent Overhead Byte Stuffing* (1999).

mod image;
mod receiver;
mod sender;

pub use image::RobotImage;
pub use receiver::{BlockReceiver, Counts, Received};
pub use sender::BlockSender;

#[cfg(doc)]
use crate::offset::FeatureConfig;
use crate::offset::FeatureObserver;
use alloc::vec::Vec;

/// Version of what is written; another one is refused.
pub const VERSION: u8 = 2;

/// Checksum of every content and image.
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
/// Its bytes.
const CRC_BYTES: usize = 4;

/// Why bytes are no block, or no robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WireError {
    /// Bytes were lost or changed on the way, or this is something else.
    #[error("bytes were lost or changed on the way: the checksum is another")]
    Damaged,
    /// Written by another version of Sinew.
    #[error(
        "written as version {found}, read as version {VERSION}: build both sides of the same Sinew"
    )]
    Version {
        /// Version found.
        found: u8,
    },
    /// A block of another robot, or made with another configuration.
    #[error(
        "a block of robot {found:08x}, not of {expected:08x}: give the chip this robot's image"
    )]
    Robot {
        /// Robot the block is of.
        found: u32,
        /// Robot of the receiver.
        expected: u32,
    },
    /// Written as agreed, and still no block or robot: a length, a number or a parent that can't be.
    #[error("the checksum is right, and the content is none of this arm")]
    Content,
}

/// What blocks depend on, as a number. Allocates.
fn robot_id(features: &FeatureObserver) -> u32 {
    // Into memory there is no way for this to fail.
    let bytes = postcard::to_allocvec(&features.made_for()).unwrap_or_default();
    CRC.checksum(&bytes)
}

/// `bytes` without their checksum, which must be theirs, and without the version, which must be ours.
fn checked(bytes: &[u8]) -> Result<&[u8], WireError> {
    let written = bytes.len().checked_sub(CRC_BYTES);
    let (content, crc) = written
        .and_then(|at| bytes.split_at_checked(at))
        .ok_or(WireError::Damaged)?;
    if CRC.checksum(content).to_le_bytes() != crc {
        return Err(WireError::Damaged);
    }
    match content.split_first() {
        Some((&VERSION, rest)) => Ok(rest),
        Some((&found, _)) => Err(WireError::Version { found }),
        None => Err(WireError::Damaged),
    }
}

/// `value` with version and checksum. Allocates.
fn sealed<T: serde::Serialize>(value: &T) -> Vec<u8> {
    let mut bytes = postcard::to_allocvec(&(VERSION, value)).unwrap_or_default();
    let crc = CRC.checksum(&bytes);
    bytes.extend_from_slice(&crc.to_le_bytes());
    bytes
}
