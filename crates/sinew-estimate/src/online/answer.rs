//! Answer of the online estimate after each block.

use serde::{Deserialize, Serialize};
use sinew_model::offset::ForceEstimate;
use sinew_model::{Gaussian, Z95};

/// Reason why an offset is provisional: its interval is wide, or it may still change by more than the interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case", tag = "reason")]
pub enum Provisional {
    /// No window has been solved yet.
    Starting,
    /// The newest blocks are explained by a step of this offset. The interval is the hull of both hypotheses.
    Step {
        /// Most probable time of the step, s on the clock of the result.
        since_s: f64,
        /// Posterior probability of a step.
        probability: f64,
    },
    /// The window contains a change so late that it may be a contact that has not ended.
    ChangeNearEnd {
        /// Time of the change, s on the clock of the result.
        since_s: f64,
    },
    /// Too many blocks are rejected as outliers for the remaining ones to be representative.
    Rejected {
        /// Share of the window's blocks.
        share: f64,
    },
    /// The window could not be solved; the estimate is the previous one.
    #[serde(alias = "refused")]
    NotSolved,
}

impl Provisional {
    /// Shifts the times of the reason by `by_s` to another clock.
    #[must_use]
    pub fn on_clock(mut self, by_s: f64) -> Self {
        if let Self::Step { since_s, .. } | Self::ChangeNearEnd { since_s } = &mut self {
            *since_s += by_s;
        }
        self
    }
}

/// Estimate of one tendon at the time of an answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnlineJoint {
    /// Index of the joint.
    pub joint: usize,
    /// Offset, rad; NaN until a window has been solved.
    pub offset_rad: Gaussian,
    /// Part of the standard deviation of the offset due to an unknown temperature, now or in the baseline, rad; already
    /// included in `offset_rad`; 0 if both temperatures are known.
    pub unknown_temperature_rad: f64,
    /// Probability that the stiffness has changed since the baseline; `None` if not estimated.
    pub stiffness_changed_probability: Option<f64>,
    /// Reason why the offset is provisional; `None` if it is settled.
    pub provisional: Option<Provisional>,
}

/// Latest answer: a plain value of fixed size, which a control loop reads in constant time.
#[derive(Debug, Clone, PartialEq)]
pub struct OnlineAnswer {
    /// Number of blocks since the start of the session.
    pub blocks: u64,
    /// Middle of the last block, s since the start of the session; NaN before the first one.
    pub time_s: f64,
    /// Middle of the last block of the solution, s; NaN before the first one. The difference is the age of the answer.
    pub solved_s: f64,
    /// One entry for every elastic joint.
    pub joints: Vec<OnlineJoint>,
    /// Constant external force at the tool; `None` if none was detected.
    pub external_force: Option<ForceEstimate>,
    /// Probability of a contact in the last block, 0 to 1; 0 until a window has been solved.
    pub contact_probability: f64,
}

impl OnlineAnswer {
    pub(super) fn starting(elastic: &[usize]) -> Self {
        let nothing = Gaussian::new(f64::NAN, f64::NAN);
        Self {
            blocks: 0,
            time_s: f64::NAN,
            solved_s: f64::NAN,
            joints: (elastic.iter())
                .map(|joint| OnlineJoint {
                    joint: *joint,
                    offset_rad: nothing,
                    unknown_temperature_rad: 0.0,
                    stiffness_changed_probability: None,
                    provisional: Some(Provisional::Starting),
                })
                .collect(),
            external_force: None,
            contact_probability: 0.0,
        }
    }

    /// Returns the answer of a joint; `None` for a rigid one.
    pub fn joint(&self, joint: usize) -> Option<&OnlineJoint> {
        self.joints.iter().find(|own| own.joint == joint)
    }

    /// Whether any offset is provisional.
    pub fn is_provisional(&self) -> bool {
        self.joints.iter().any(|joint| joint.provisional.is_some())
    }
}

/// Returns the Gaussian whose 95 % interval is the hull of the two 95 % intervals.
pub(super) fn hull(a: Gaussian, b: Gaussian) -> Gaussian {
    let (a, b) = (a.interval_95(), b.interval_95());
    let (low, high) = (a.low.min(b.low), a.high.max(b.high));
    Gaussian::new(0.5 * (low + high), 0.5 * (high - low) / Z95)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hull_is_smallest_interval_around_both() {
        let (a, b) = (Gaussian::new(1.0, 0.5), Gaussian::new(4.0, 0.1));
        let both = hull(a, b).interval_95();
        assert!((both.low - a.interval_95().low).abs() < 1e-12);
        assert!((both.high - b.interval_95().high).abs() < 1e-12);
        let within = hull(a, Gaussian::new(1.1, 0.1));
        assert!((within.mean - 1.0).abs() < 1e-12 && (within.std - 0.5).abs() < 1e-12);
    }
}
