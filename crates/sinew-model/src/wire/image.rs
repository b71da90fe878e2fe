//! Robot description as bytes, for a chip that cannot read URDF.

use super::{WireError, checked, sealed};
use crate::arm::Arm;
use crate::offset::{FeatureConfig, FeatureObserver};
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// Robot description on the chip.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RobotImage {
    /// Arm of the robot.
    pub arm: Arm,
    /// Columns of its base parameters: finding them takes more memory than a chip has.
    base_columns: Vec<usize>,
    /// One entry per joint; `None` for a rigid one.
    pub transmissions: Vec<Option<Transmission>>,
}

impl RobotImage {
    /// Creates the image of a robot on the host. Allocates.
    pub fn new(arm: &Arm, transmissions: &[Option<Transmission>]) -> Self {
        Self {
            arm: arm.clone(),
            base_columns: arm.base_parameters().columns,
            transmissions: transmissions.to_vec(),
        }
    }

    /// Encodes the image as bytes. Allocates.
    pub fn write(&self) -> Vec<u8> {
        sealed(self)
    }

    /// Decodes an image: the robot is bitwise identical. Allocates, for the start of a program.
    ///
    /// # Errors
    /// Returns a [`WireError`] if the bytes are damaged, of another version, or invalid for a
    /// robot.
    pub fn read(bytes: &[u8]) -> Result<Self, WireError> {
        let read: Self = postcard::from_bytes(checked(bytes)?).map_err(|_| WireError::Content)?;
        match read.is_whole() {
            true => Ok(read),
            false => Err(WireError::Content),
        }
    }

    fn is_whole(&self) -> bool {
        let mut springs = self.transmissions.iter().flatten();
        let stiff = springs.all(|spring| {
            let k = spring.stiffness_nm_per_rad;
            k.is_finite() && k > 0.0
        });
        stiff && self.arm.is_whole() && self.transmissions.len() == self.arm.dof()
    }

    /// Creates the observer that computes blocks from this robot's samples. Uses no more memory
    /// than the observer.
    ///
    /// # Errors
    /// Returns [`WireError::Content`] if the base columns are invalid for this arm.
    pub fn features(&self, config: FeatureConfig) -> Result<FeatureObserver, WireError> {
        FeatureObserver::with_base_columns(&self.arm, config, &self.base_columns)
            .map(|features| features.with_transmissions(&self.transmissions))
            .map_err(|_| WireError::Content)
    }
}
