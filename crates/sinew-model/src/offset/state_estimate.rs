//! Mean and covariance of a robot's state.

use super::error::MapError;
use crate::Gaussian;
use alloc::vec::Vec;

/// Prior standard deviation of an unknown offset, rad.
pub const UNKNOWN_OFFSET_RAD: f64 = 0.03;
/// Offsets right after tensioning are zero by definition, up to this, rad.
pub const TENSIONED_OFFSET_RAD: f64 = 1e-5;

/// Mean and covariance of the state, and the reference of the offsets.
#[derive(Debug, Clone, PartialEq)]
pub struct StateEstimate {
    /// Mean of each state entry, `d`.
    pub mean: Vec<f64>,
    /// Covariance, row-major `d × d`.
    pub covariance: Vec<f64>,
    /// Temperature the offsets refer to, °C; NaN where unknown.
    pub temperature_c: f64,
}

impl StateEstimate {
    /// Entry `k`; NaN where there is none.
    pub fn entry(&self, k: usize) -> Gaussian {
        let d = self.mean.len();
        let at = |x: &[f64], k: usize| x.get(k).copied().unwrap_or(f64::NAN);
        Gaussian::new(
            at(&self.mean, k),
            libm::sqrt(at(&self.covariance, k * d + k)),
        )
    }

    /// Replaces entry `k` by `prior`, uncorrelated with the rest.
    pub fn reset(&mut self, k: usize, prior: Gaussian) {
        let d = self.mean.len();
        if k >= d || self.covariance.len() != d * d {
            return;
        }
        self.mean[k] = prior.mean;
        for m in 0..d {
            self.covariance[k * d + m] = 0.0;
            self.covariance[m * d + k] = 0.0;
        }
        self.covariance[k * d + k] = prior.std * prior.std;
    }

    /// Checks that a posterior has `dimension` entries.
    pub(crate) fn check_dimension(&self, dimension: usize) -> Result<(), MapError> {
        if self.mean.len() != dimension || self.covariance.len() != dimension * dimension {
            return Err(MapError::Dimension {
                expected: dimension,
                found: self.mean.len(),
            });
        }
        Ok(())
    }
}

/// Prior of the payload in the gripper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Payload {
    /// Gripper without payload.
    Empty,
    /// Unknown payload, with the prior of the tolerances.
    Unknown,
    /// Payload of specified mass near the expected point.
    Specified {
        /// Mass of the payload, kg.
        mass_kg: Gaussian,
    },
}
