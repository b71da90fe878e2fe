//! What an estimate from one recording says.

use super::belief::Belief;
use super::change::{ChangePoint, offset_terms};
use super::prior::Prior;
use crate::{Gaussian, Interval95};
use alloc::vec::Vec;

/// Stiffness that may have changed since the prior was learned.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StiffnessChange {
    /// Posterior probability that it has.
    pub probability: f64,
    /// By how much the compliance rose if it has, over nominal.
    pub softening: Gaussian,
}

/// A tendon that may creep while the recording goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CreepEstimate {
    /// Posterior probability that it does.
    pub probability: f64,
    /// How fast its offset moves, rad/s: averaged over whether it does.
    pub rate_rad_per_s: Gaussian,
}

/// A constant force from outside that may act on the arm while the recording goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForceEstimate {
    /// Whether somebody stated it.
    pub is_stated: bool,
    /// Posterior probability that it does; 1 where it was stated.
    pub probability: f64,
    /// Along the axes of the base, N, if it does.
    pub force_n: [Gaussian; 3],
}

impl ForceEstimate {
    /// Whether it is likely enough to be named: more than 0.3.
    pub fn is_worth_a_word(&self) -> bool {
        const ACTS: f64 = 0.3;
        self.probability > ACTS
    }
}

/// Posterior of a change found within a recording: whether it happened, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChangePosterior {
    /// The change at the time the blocks, which lag, show it.
    pub change: ChangePoint,
    /// When it happened, s: that time less the lag ([`FeatureConfig::delay_s`](super::FeatureConfig::delay_s)).
    pub time_s: f64,
    /// Probability that it happened, 0…1.
    pub probability: f64,
    /// Probability that it is no noise, whatever it is.
    pub probability_not_noise: f64,
    /// 95 % interval of `time_s`.
    pub interval_s: Interval95,
}

/// Why the last descent of an estimate ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Termination {
    /// The last step was shorter than a tenth of a posterior standard deviation.
    SmallStep,
    /// The schedule of steps was over while the state still moved.
    ScheduleEnd,
}

/// How the last descent to an estimate ended.
///
/// The Gauss–Newton steps are a fixed schedule, because the equations are nearly linear: the
/// numbers do not depend on how it ended.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Convergence {
    /// Why it ended.
    pub termination: Termination,
    /// Gauss–Newton steps taken.
    pub iterations: usize,
    /// Length of the last step in posterior standard deviations (the Newton decrement).
    pub last_step: f64,
    /// Half the robust chi-square of data and prior at its end.
    pub cost: f64,
}

impl Convergence {
    /// Of a descent whose last step had the Newton decrement `last_step`.
    pub(crate) fn new(iterations: usize, last_step: f64, cost: f64) -> Self {
        /// Beside what isn't known, such a step is nothing.
        const SMALL: f64 = 0.1;
        Self {
            termination: if last_step < SMALL {
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

/// The posterior.
#[derive(Debug, Clone, PartialEq)]
pub struct MapEstimate {
    /// Changes within the recording.
    pub changes: Vec<ChangePoint>,
    /// State of the robot as [`Prior`] lays it out, then the entries of every change.
    pub state: Vec<f64>,
    /// Their covariance, row-major.
    pub covariance: Vec<f64>,
    /// Temperature the offsets refer to, °C; NaN where unknown.
    pub temperature_c: f64,
    /// End of the last block, s.
    pub end_s: f64,
    /// Robust noise of each joint's link equation, rad.
    pub noise_rad: Vec<f64>,
    /// Robust noise of each joint's motor equation, N·m.
    pub motor_noise_nm: Vec<f64>,
    /// Weight of each block, 0 (left out) to 1.
    pub weights: Vec<f64>,
    /// How the descent to it ended, with the cost there.
    pub convergence: Convergence,
    /// Whether each joint's stiffness has changed since the prior was learned; `None` where that isn't
    /// sought.
    pub stiffness_changes: Vec<Option<StiffnessChange>>,
    /// Creep of each joint's tendon; `None` where the recording shows none.
    pub creep: Vec<Option<CreepEstimate>>,
    /// A constant force from outside; `None` where the recording shows none.
    pub force: Option<ForceEstimate>,
    /// Posterior of each change that was found ([`MapEstimate::posterior`]).
    pub posteriors: Vec<ChangePosterior>,
}

impl MapEstimate {
    /// Offset of a joint at the end of the recording, rad.
    pub fn offset(&self, prior: &Prior, joint: usize) -> Gaussian {
        self.offset_at(prior, joint, self.end_s)
    }

    /// Offset of a joint at a time, s; rad.
    pub fn offset_at(&self, prior: &Prior, joint: usize, time_s: f64) -> Gaussian {
        self.sum(&offset_terms(prior.layout(), &self.changes, joint, time_s))
    }

    /// Size of change `k`; of a payload its mass, kg.
    pub fn change(&self, prior: &Prior, k: usize) -> Gaussian {
        let before: usize = self.changes[..k].iter().map(|c| c.kind.columns()).sum();
        self.sum(&[(prior.dimension() + before, 1.0)])
    }

    /// Posterior of a change within the recording; of a loss of stiffness that came with a slip,
    /// the slip's. `None` where changes were given, not sought, and for what changed before the
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

    /// What is believed of the robot at the end of the recording: every change has become part of
    /// what it changed.
    pub fn belief(&self, prior: &Prior) -> Belief {
        let mut all = self.clone();
        all.fold(prior, |_| true);
        Belief {
            mean: all.state,
            covariance: all.covariance,
            temperature_c: all.temperature_c,
        }
    }

    /// Makes some changes part of what they changed.
    pub(crate) fn fold(&mut self, prior: &Prior, which: impl Fn(&ChangePoint) -> bool) {
        let (d, total) = (prior.dimension(), self.state.len());
        // Place each column adds to.
        let mut places: Vec<(usize, f64)> = (0..d).map(|k| (k, 1.0)).collect();
        let mut left = d;
        for change in &self.changes {
            let columns = change.kind.columns();
            let (base, factor) = if which(change) {
                // What comes beside the state goes nowhere.
                let base = change.kind.place(prior.layout());
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
    use crate::offset::change::ChangeKind;
    use crate::offset::effects::JointParameter;
    use crate::offset::fixtures::turntable;

    const CREEP: ChangePoint = ChangePoint {
        kind: ChangeKind::Creep(0),
        at_s: 100.0,
    };

    /// At 300 s.
    fn estimate(changes: &[ChangePoint], state: Vec<f64>, covariance: Vec<f64>) -> MapEstimate {
        MapEstimate {
            changes: changes.to_vec(),
            state,
            covariance,
            temperature_c: f64::NAN,
            end_s: 300.0,
            noise_rad: Vec::new(),
            motor_noise_nm: Vec::new(),
            weights: Vec::new(),
            convergence: Convergence::new(0, 0.0, 0.0),
            stiffness_changes: Vec::new(),
            creep: Vec::new(),
            force: None,
            posteriors: Vec::new(),
        }
    }

    /// One change becomes part of the offset, the other one stays what it was.
    #[test]
    fn a_change_that_is_not_folded_stays_beside_the_state() {
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
        assert!((kept.deviation - 3e-4).abs() < 1e-15, "{kept:?}");
        // 200 s of what rate and slip share.
        for at in [offset * (d + 1) + d, d * (d + 1) + offset] {
            assert!((map.covariance[at] + 4e-8).abs() < 1e-20, "{at}");
        }
        let after = map.offset(&prior, 0);
        assert!(
            (after.mean - before.mean).abs() < 1e-15,
            "{before:?} {after:?}"
        );
        assert!((after.deviation - before.deviation).abs() < 1e-15);
    }

    /// An offset of 1.0 ± 0.1 mrad at 100 s that creeps by 10 ± 1 µrad/s, of which the compliance knows: at 300 s it is
    /// 3.0 ± √(0.1² + 0.2²) mrad.
    #[test]
    fn what_has_crept_is_part_of_the_offset_that_is_believed_after() {
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
        let after = map.belief(&prior);
        assert_eq!(after.mean.len(), d);
        let near = |is: f64, should: f64| (is - should).abs() < 1e-9 * should;
        let Gaussian { mean, deviation } = after.entry(offset);
        assert!(near(mean, 3e-3), "{mean}");
        assert!(near(deviation, libm::sqrt(5e-8)), "{deviation}");
        // The same by another way, and nothing else has moved.
        let at_end = map.offset(&prior, 0);
        assert!(near(at_end.mean, mean) && near(at_end.deviation, deviation));
        assert_eq!(after.entry(compliance), Gaussian::new(0.05, 0.02));
        // 200 s of what the rate and the compliance share, whichever is asked of the other.
        for (i, k) in [(offset, compliance), (compliance, offset)] {
            let shared = after.covariance[i * d + k];
            assert!(near(shared, 2e-6), "{shared}");
        }
    }
}
