//! A robot as bytes, for a chip that can't read URDF.

use super::{WireError, checked, sealed};
use crate::arm::Arm;
use crate::offset::{FeatureConfig, FeatureObserver};
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// What a chip knows of its robot.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RobotImage {
    /// The arm.
    pub arm: Arm,
    /// Columns of its base parameters: finding them takes more memory than a chip has.
    base_columns: Vec<usize>,
    /// One entry per joint; `None` for a rigid one.
    pub transmissions: Vec<Option<Transmission>>,
}

impl RobotImage {
    /// Of a robot, on the host. Allocates.
    pub fn new(arm: &Arm, transmissions: &[Option<Transmission>]) -> Self {
        Self {
            arm: arm.clone(),
            base_columns: arm.base_parameters().columns,
            transmissions: transmissions.to_vec(),
        }
    }

    /// As bytes. Allocates.
    pub fn write(&self) -> Vec<u8> {
        sealed(self)
    }

    /// Of bytes: the same robot, to the last bit. Allocates: for a program's start.
    ///
    /// # Errors
    /// [`WireError`] when they are damaged, of another version, or hold what no robot is.
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

    /// What makes blocks of this robot's samples. Takes no more memory than what makes them needs.
    ///
    /// # Errors
    /// [`WireError::Content`] when the base columns are none of this arm.
    pub fn features(&self, config: FeatureConfig) -> Result<FeatureObserver, WireError> {
        FeatureObserver::with_base_columns(&self.arm, config, &self.base_columns)
            .map(|features| features.with_transmissions(&self.transmissions))
            .map_err(|_| WireError::Content)
    }
}
