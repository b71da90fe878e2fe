//! Estimate from one recording.

use super::change::{ChangeKind, ChangePoint, offset_terms};
use super::effects::JointParameter;
use super::prior::Prior;
use super::state_estimate::StateEstimate;
use crate::{Gaussian, Interval95};
use alloc::vec::Vec;

/// Possible change of the stiffness since the recording of the prior.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StiffnessChange {
    /// Posterior probability that the stiffness has changed by more than 5 %, under a model error that depends on pose and
    /// direction of motion.
    pub probability: f64,
    /// Increase of the compliance if it has changed, relative to the nominal value.
    pub compliance_increase: Gaussian,
    /// Relative change of the stiffness if it has changed; negative for a loss.
    pub change_ratio: Gaussian,
}

/// Creep of a tendon during the recording.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CreepEstimate {
    /// Posterior probability of creep.
    pub probability: f64,
    /// Rate of the offset, rad/s: averaged over the hypotheses with and without creep.
    pub rate_rad_per_s: Gaussian,
}

/// A constant external force on the arm during the recording.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForceEstimate {
    /// Whether the user specified the force.
    pub is_specified: bool,
    /// Posterior probability that the force acts; 1 if it was specified.
    pub probability: f64,
    /// Force along the axes of the base, N, given that it acts.
    pub force_n: [Gaussian; 3],
}

impl ForceEstimate {
    /// Whether the probability is high enough for the force to be reported: more than 0.3.
    pub fn is_reportable(&self) -> bool {
        const MIN_REPORTED_PROBABILITY: f64 = 0.3;
        self.probability > MIN_REPORTED_PROBABILITY
    }
}

/// Posterior of a change found within a recording: its probability and time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChangePosterior {
    /// Kind of the change, and its time in the delayed blocks.
    pub change: ChangePoint,
    /// Time of the change, s: that of the blocks minus the delay
    /// ([`FeatureConfig::delay_s`](super::FeatureConfig::delay_s)).
    pub time_s: f64,
    /// Probability that the change occurred, 0…1.
    pub probability: f64,
    /// Probability that the change is not noise, for any cause.
    pub probability_not_noise: f64,
    /// 95 % interval of `time_s`.
    pub interval_s: Interval95,
}

/// Reason for the end of the last descent of an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Termination {
    /// The last step was shorter than a tenth of a posterior standard deviation.
    SmallStep,
    /// The schedule of steps ended before the state converged.
    ScheduleEnd,
}

/// Convergence of the last descent to an estimate.
///
/// The Gauss–Newton steps follow a fixed schedule, because the equations are nearly linear: the numbers do not depend
/// on the termination.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Convergence {
    /// Reason for the end of the descent.
    pub termination: Termination,
    /// Number of Gauss–Newton steps.
    pub iterations: usize,
    /// Length of the last step in posterior standard deviations (the Newton decrement).
    pub last_step: f64,
    /// Half the robust chi-square of data and prior at the end of the descent.
    pub cost: f64,
}

impl Convergence {
    /// Creates the result of a descent whose last step had the Newton decrement `last_step`.
    pub(crate) fn new(iterations: usize, last_step: f64, cost: f64) -> Self {
        /// Newton decrement below which a step is negligible relative to the posterior standard deviation.
        const MAX_NEWTON_DECREMENT: f64 = 0.1;
        Self {
            termination: if last_step < MAX_NEWTON_DECREMENT {
                Termination::SmallStep
            } else {
                Termination::ScheduleEnd
            },
            iterations,
            last_step,
            cost,
        }
    }
}

/// Posterior of the state from one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct MapEstimate {
    /// Changes within the recording.
    pub changes: Vec<ChangePoint>,
    /// Offset changes that are slips of an encoder: they change the encoder zero, which has the same row as
    /// the offset, and not the rope.
    pub encoder_slips: Vec<ChangePoint>,
    /// State of the robot in the layout of [`Prior`], followed by the entries of every change.
    pub state: Vec<f64>,
    /// Covariance of the state, row-major.
    pub covariance: Vec<f64>,
    /// Temperature to which the offsets refer, °C; NaN if it is unknown.
    pub temperature_c: f64,
    /// End of the last block, s.
    pub end_s: f64,
    /// Robust noise of each joint's link equation, rad.
    pub noise_rad: Vec<f64>,
    /// Robust noise of each joint's motor equation, N·m.
    pub motor_noise_nm: Vec<f64>,
    /// Robust noise of the equations of tension sensors, `n`, N·m.
    pub tension_noise_nm: Vec<f64>,
    /// Weight of each block, 0 (rejected) to 1.
    pub weights: Vec<f64>,
    /// Convergence of the descent, with the cost at its end.
    pub convergence: Convergence,
    /// Change of each joint's stiffness since the recording of the prior; `None` if no change is searched for.
    pub stiffness_changes: Vec<Option<StiffnessChange>>,
    /// Creep of each joint's tendon; `None` if the recording provides no evidence of creep.
    pub creep: Vec<Option<CreepEstimate>>,
    /// A constant external force; `None` if the recording provides no evidence of one.
    pub force: Option<ForceEstimate>,
    /// Posterior of each change that was found ([`MapEstimate::posterior`]).
    pub posteriors: Vec<ChangePosterior>,
}

impl MapEstimate {
    /// Offset of a joint at the end of the recording, rad, without slips of its encoders.
    pub fn offset(&self, prior: &Prior, joint: usize) -> Gaussian {
        self.offset_at(prior, joint, self.end_s)
    }

    /// Offset of a joint at the time `time_s`, rad, without slips of its encoders.
    pub fn offset_at(&self, prior: &Prior, joint: usize, time_s: f64) -> Gaussian {
        let is_rope = |change: &ChangePoint| !self.encoder_slips.contains(change);
        let terms = offset_terms(prior.layout(), &self.changes, is_rope, joint, time_s);
        self.sum(&terms)
    }

    /// Size of change `k`; for a payload its mass, kg.
    pub fn change(&self, prior: &Prior, k: usize) -> Gaussian {
        let before: usize = self.changes[..k].iter().map(|c| c.kind.columns()).sum();
        self.sum(&[(prior.dimension() + before, 1.0)])
    }

    /// Posterior of a change within the recording; for a stiffness loss that accompanies a slip, that of the slip. `None` if changes were specified instead of searched for, and for what changed before the
    /// recording.
    pub fn posterior(&self, change: &ChangePoint) -> Option<&ChangePosterior> {
        let mut all = self.posteriors.iter();
        all.find(|p| p.change == *change || change.accompanies(&p.change))
    }

    /// Sum of entries of the state, each times its factor.
    fn sum(&self, terms: &[(usize, f64)]) -> Gaussian {
        let total = self.state.len();
        let (mut mean, mut variance) = (0.0, 0.0);
        for &(i, a) in terms {
            mean += a * self.state[i];
            for &(k, b) in terms {
                variance += a * b * self.covariance[i * total + k];
            }
        }
        Gaussian::new(mean, libm::sqrt(variance))
    }

    /// Returns the posterior of the robot at the end of the recording: every change is added to the parameter that it
    /// changed.
    pub fn state_estimate(&self, prior: &Prior) -> StateEstimate {
        let mut all = self.clone();
        all.fold(prior, |_| true);
        StateEstimate {
            mean: all.state,
            covariance: all.covariance,
            temperature_c: all.temperature_c,
        }
    }

    /// Adds the selected changes to the parameters that they change.
    pub(crate) fn fold(&mut self, prior: &Prior, which: impl Fn(&ChangePoint) -> bool) {
        let (d, total) = (prior.dimension(), self.state.len());
        // Place each column adds to.
        let mut places: Vec<(usize, f64)> = (0..d).map(|k| (k, 1.0)).collect();
        let mut left = d;
        for change in &self.changes {
            let columns = change.kind.columns();
            let (base, factor) = if which(change) {
                // Entries outside the state are not folded.
                let base = match change.kind {
                    ChangeKind::Offset(joint) if self.encoder_slips.contains(change) => {
                        Some(prior.place(joint, JointParameter::Zero))
                    }
                    kind => kind.place(prior.layout()),
                };
                base.map_or((0, 0.0), |base| (base, change.factor(self.end_s)))
            } else {
                left += columns;
                (left - columns, 1.0)
            };
            places.extend((base..base + columns).map(|place| (place, factor)));
        }
        let (mut mean, mut covariance) = (alloc::vec![0.0; left], alloc::vec![0.0; left * left]);
        for (i, &(to_i, a)) in places.iter().enumerate() {
            mean[to_i] += a * self.state[i];
            for (k, &(to_k, b)) in places.iter().enumerate() {
                covariance[to_i * left + to_k] += a * b * self.covariance[i * total + k];
            }
        }
        self.changes.retain(|change| !which(change));
        (self.state, self.covariance) = (mean, covariance);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::turntable;

    const CREEP: ChangePoint = ChangePoint {
        kind: ChangeKind::Creep(0),
        at_s: 100.0,
    };

    /// At 300 s.
    fn estimate(changes: &[ChangePoint], state: Vec<f64>, covariance: Vec<f64>) -> MapEstimate {
        MapEstimate {
            changes: changes.to_vec(),
            encoder_slips: Vec::new(),
            state,
            covariance,
            temperature_c: f64::NAN,
            end_s: 300.0,
            noise_rad: Vec::new(),
            motor_noise_nm: Vec::new(),
            tension_noise_nm: Vec::new(),
            weights: Vec::new(),
            convergence: Convergence::new(0, 0.0, 0.0),
            stiffness_changes: Vec::new(),
            creep: Vec::new(),
            force: None,
            posteriors: Vec::new(),
        }
    }

    /// One change is added to the offset, the other one is kept separate.
    #[test]
    fn unfolded_change_is_kept_outside_state() {
        let prior = turntable().prior;
        let d = prior.dimension();
        let offset = prior.place(0, JointParameter::Offset);
        let slip = ChangePoint {
            kind: ChangeKind::Offset(0),
            at_s: 200.0,
        };
        let (mut state, mut covariance) =
            (alloc::vec![0.0; d + 2], alloc::vec![0.0; (d + 2) * (d + 2)]);
        (state[d], state[d + 1]) = (1e-5, 4e-3);
        covariance[d * (d + 2) + d] = 1e-12;
        covariance[(d + 1) * (d + 2) + d + 1] = 9e-8;
        for at in [d * (d + 2) + d + 1, (d + 1) * (d + 2) + d] {
            covariance[at] = -2e-10;
        }
        let mut map = estimate(&[CREEP, slip], state, covariance);
        let before = map.offset(&prior, 0);
        map.fold(&prior, |change| *change == CREEP);
        assert_eq!(map.changes, [slip]);
        let kept = map.change(&prior, 0);
        assert_eq!(kept.mean, 4e-3);
        assert!((kept.std - 3e-4).abs() < 1e-15, "{kept:?}");
        // 200 s of what rate and slip share.
        for at in [offset * (d + 1) + d, d * (d + 1) + offset] {
            assert!((map.covariance[at] + 4e-8).abs() < 1e-20, "{at}");
        }
        let after = map.offset(&prior, 0);
        assert!(
            (after.mean - before.mean).abs() < 1e-15,
            "{before:?} {after:?}"
        );
        assert!((after.std - before.std).abs() < 1e-15);
    }

    /// A slip of an encoder changes its zero and leaves the offset of the rope alone.
    #[test]
    fn encoder_slip_changes_zero_not_offset() {
        let prior = turntable().prior;
        let d = prior.dimension();
        let [offset, zero] =
            [JointParameter::Offset, JointParameter::Zero].map(|p| prior.place(0, p));
        let slip = ChangePoint {
            kind: ChangeKind::Offset(0),
            at_s: 200.0,
        };
        let (mut state, mut covariance) =
            (alloc::vec![0.0; d + 1], alloc::vec![0.0; (d + 1) * (d + 1)]);
        (state[offset], state[d]) = (1e-3, 40e-3);
        covariance[offset * (d + 2)] = 1e-8;
        covariance[d * (d + 2)] = 4e-8;
        for at in [offset * (d + 1) + d, d * (d + 1) + offset] {
            covariance[at] = -1e-8;
        }
        let mut map = estimate(&[slip], state, covariance);
        map.encoder_slips = alloc::vec![slip];
        let near = |found: Gaussian, mean: f64, std: f64| {
            (found.mean - mean).abs() < 1e-15 && (found.std - std).abs() < 1e-12
        };
        assert!(near(map.offset(&prior, 0), 1e-3, 1e-4));
        let after = map.state_estimate(&prior);
        assert!(near(after.entry(offset), 1e-3, 1e-4));
        assert!(near(after.entry(zero), 40e-3, 2e-4));
        // Offset and zero together are better known than either.
        let shared = after.covariance[offset * d + zero];
        assert!((shared + 1e-8).abs() < 1e-20, "{shared}");
    }

    /// An offset of 1.0 ± 0.1 mrad at 100 s that creeps by 10 ± 1 µrad/s, correlated with the compliance: at 300 s it
    /// is 3.0 ± √(0.1² + 0.2²) mrad.
    #[test]
    fn posterior_offset_includes_creep() {
        let prior = turntable().prior;
        let d = prior.dimension();
        let [offset, compliance] = [JointParameter::Offset, JointParameter::Compliance]
            .map(|parameter| prior.place(0, parameter));
        let (mut state, mut covariance) =
            (alloc::vec![0.0; d + 1], alloc::vec![0.0; (d + 1) * (d + 1)]);
        (state[offset], state[compliance], state[d]) = (1e-3, 0.05, 1e-5);
        let mut set = |i: usize, k: usize, value: f64| {
            covariance[i * (d + 1) + k] = value;
            covariance[k * (d + 1) + i] = value;
        };
        set(offset, offset, 1e-8);
        set(compliance, compliance, 4e-4);
        set(d, d, 1e-12);
        set(d, compliance, 1e-8);
        let map = estimate(&[CREEP], state, covariance);
        let after = map.state_estimate(&prior);
        assert_eq!(after.mean.len(), d);
        let near = |is: f64, should: f64| (is - should).abs() < 1e-9 * should;
        let Gaussian { mean, std } = after.entry(offset);
        assert!(near(mean, 3e-3), "{mean}");
        assert!(near(std, libm::sqrt(5e-8)), "{std}");
        // The same by another computation; all other entries are unchanged.
        let at_end = map.offset(&prior, 0);
        assert!(near(at_end.mean, mean) && near(at_end.std, std));
        assert_eq!(after.entry(compliance), Gaussian::new(0.05, 0.02));
        // The covariance of the rate and the compliance, times 200 s, in both directions.
        for (i, k) in [(offset, compliance), (compliance, offset)] {
            let shared = after.covariance[i * d + k];
            assert!(near(shared, 2e-6), "{shared}");
        }
    }
}
