//! Mean and covariance of a robot's state.

use super::error::MapError;
use crate::Gaussian;
use alloc::vec::Vec;

/// What an offset may be before anything is known, rad.
pub const UNKNOWN_OFFSET_RAD: f64 = 0.03;
/// Offsets right after tensioning are zero by definition, up to this, rad.
pub const TENSIONED_OFFSET_RAD: f64 = 1e-5;

/// Mean and covariance of the state, and what the offsets refer to.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief {
    /// Means, `d`.
    pub mean: Vec<f64>,
    /// Covariance, row-major `d × d`.
    pub covariance: Vec<f64>,
    /// Temperature the offsets refer to, °C; NaN where unknown.
    pub temperature_c: f64,
}

impl Belief {
    /// Entry `k`; NaN where there is none.
    pub fn entry(&self, k: usize) -> Gaussian {
        let d = self.mean.len();
        let at = |x: &[f64], k: usize| x.get(k).copied().unwrap_or(f64::NAN);
        Gaussian::new(
            at(&self.mean, k),
            libm::sqrt(at(&self.covariance, k * d + k)),
        )
    }

    /// Replaces entry `k` by `believed`, uncorrelated with the rest.
    pub fn open(&mut self, k: usize, believed: Gaussian) {
        let d = self.mean.len();
        if k >= d || self.covariance.len() != d * d {
            return;
        }
        self.mean[k] = believed.mean;
        for m in 0..d {
            self.covariance[k * d + m] = 0.0;
            self.covariance[m * d + k] = 0.0;
        }
        self.covariance[k * d + k] = believed.deviation * believed.deviation;
    }

    /// Refuses a belief that is not one of `dimension` entries.
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

/// What may be in the gripper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Payload {
    /// Nothing.
    Empty,
    /// Something unknown, as the tolerances say.
    Unknown,
    /// A known mass near where it is expected.
    Known {
        /// Mass, kg.
        mass_kg: Gaussian,
    },
}
