//! From a torque and its threshold to "something touches".

use super::error::CorrectionError;
use crate::StepError;
use crate::error::is_time_step;
use alloc::vec::Vec;

/// When a contact begins and ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactConfig {
    /// A contact ends when the torque falls below this share of the threshold, in 0…1: a torque
    /// about the threshold makes one contact, not fifty.
    pub release_share: f64,
    /// The torque has to be above the threshold for so long before it counts, s.
    pub confirm_s: f64,
}

impl Default for ContactConfig {
    /// Ends a contact at 70 % of the threshold, and reports it without delay.
    fn default() -> Self {
        Self {
            release_share: 0.7,
            confirm_s: 0.0,
        }
    }
}

/// State of one joint.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct JointContact {
    touching: bool,
    above_s: f64,
}

/// Contacts with hysteresis, joint by joint.
///
/// ```text
/// begins   |tau_ext| > threshold for confirm_s
/// ends     |tau_ext| ≤ release_share · threshold
/// ```
///
/// # Realtime
/// Everything is allocated at construction.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactDetector {
    config: ContactConfig,
    joints: Vec<JointContact>,
}

impl ContactDetector {
    /// A detector of `n` joints.
    ///
    /// # Errors
    /// Returns [`CorrectionError::Tolerance`] for a share outside 0…1 or a time outside 0…1e6 s.
    pub fn new(n: usize, config: ContactConfig) -> Result<Self, CorrectionError> {
        for (what, value, most, must) in [
            (
                "release share",
                config.release_share,
                1.0,
                "between 0 and 1",
            ),
            (
                "confirmation time (s)",
                config.confirm_s,
                1e6,
                "between 0 and 1e6",
            ),
        ] {
            if !(0.0..=most).contains(&value) {
                return Err(CorrectionError::Tolerance {
                    what,
                    joint: 0,
                    value,
                    must,
                });
            }
        }
        Ok(Self {
            config,
            joints: alloc::vec![JointContact::default(); n],
        })
    }

    /// Nothing touches any more.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn reset(&mut self) {
        for joint in &mut self.joints {
            *joint = JointContact::default();
        }
    }

    /// Steps by `dt_s`; returns whether a contact is detected at any joint.
    ///
    /// * `tau_ext`, `threshold`: `n`, N·m, of
    ///   [`ExternalTorqueObserver`](super::ExternalTorqueObserver). NaN means that the joint
    ///   provides no information (rigid, or no sample yet): its state is kept.
    ///
    /// # Errors
    /// Returns [`StepError::Length`] for a wrong length and [`StepError::TimeStep`] for an invalid
    /// time step; the state is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n).
    pub fn step(
        &mut self,
        dt_s: f64,
        tau_ext: &[f64],
        threshold: &[f64],
    ) -> Result<bool, StepError> {
        if tau_ext.len() != self.joints.len() || threshold.len() != self.joints.len() {
            return Err(StepError::Length);
        }
        if !is_time_step(dt_s) {
            return Err(StepError::TimeStep);
        }
        for (joint, (tau, threshold)) in self.joints.iter_mut().zip(tau_ext.iter().zip(threshold)) {
            let size = tau.abs();
            if size > *threshold {
                joint.above_s += dt_s;
                joint.touching |= joint.above_s >= self.config.confirm_s;
            } else if size <= *threshold {
                joint.above_s = 0.0;
                // Equality ends it too, so that a share of 0 ends at a torque of 0.
                joint.touching &= size > self.config.release_share * threshold;
            }
        }
        Ok(self.is_touching())
    }

    /// Whether something touches at any joint.
    pub fn is_touching(&self) -> bool {
        self.joints.iter().any(|j| j.touching)
    }

    /// Whether something touches at joint `i`; `false` past the last.
    pub fn is_touching_at(&self, i: usize) -> bool {
        self.joints.get(i).is_some_and(|j| j.touching)
    }
}
