//! Binary protocol between a microcontroller and its host: the robot (host to chip, once) and blocks (chip to host,
//! five a second).
//!
//! ```text
//! frame   = COBS(content) 0                       zero bytes occur nowhere else, so that a reader finds the next frame
//! content = version robot sequence block crc      fields as postcard writes them, CRC-32 (IEEE 802.3), little endian
//! image   = version arm base-columns transmissions crc
//! ```
//!
//! Numbers are IEEE 754 doubles, little endian, unchanged: decoded values are bitwise identical. `robot` is the
//! checksum of arm, base columns and [`FeatureConfig`], so that blocks of another robot, or of another configuration,
//! are rejected. `sequence` counts blocks that were complete, sent or not, so that a host can count the missing ones.
//!
//! The format is that of one [`VERSION`]: chip and host must be built with the same version, otherwise the host reports
//! an error.
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

/// Version of the format; other versions are rejected.
pub const VERSION: u8 = 2;

/// Checksum of every content and image.
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
/// Size of the checksum in bytes.
const CRC_BYTES: usize = 4;

/// Reason why bytes are not a valid block or robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WireError {
    /// Checksum mismatch: bytes were lost or changed in transmission, or the data is not a frame.
    #[error("checksum mismatch: bytes were lost or changed in transmission")]
    Damaged,
    /// Written by another version of Sinew.
    #[error(
        "written as version {found}, expected version {VERSION}: build both sides with the same version of Sinew"
    )]
    Version {
        /// Version of the bytes.
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
    /// Valid checksum but invalid content: a length, a number or a parent index is impossible.
    #[error("the checksum is valid, but the content does not match this arm")]
    Content,
}

/// Returns a checksum of the configuration of blocks. Allocates.
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
