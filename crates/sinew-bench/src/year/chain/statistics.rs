//! Errors of sessions, from which the surrogate of the simulated years is calibrated.

use super::{Session, SessionJoint};
use crate::numbers::{finite, line, mean, rms};
use serde::{Deserialize, Serialize};
use sinew_model::statistics::quantile;

/// Minimum number of sessions of a robot for its statistics.
const MIN_SESSIONS: usize = 6;

/// Errors of a joint's sessions before a failure there, estimate minus truth; over robots.
///
/// Per robot a straight line over the measured temperature is subtracted from the errors: its value on the baseline's
/// day is the bias, its slope the drift, the residual the scatter. `None` if there are too few sessions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointErrors {
    /// Name of the joint.
    pub joint: String,
    /// Number of robots.
    pub robots: usize,
    /// Number of sessions.
    pub sessions: usize,
    /// Share of inconclusive sessions.
    pub inconclusive_share: Option<f64>,
    /// RMS of all errors, rad.
    pub rms_rad: Option<f64>,
    /// RMS over robots of the mean error, rad.
    pub bias_rad: Option<f64>,
    /// RMS over robots of the drift, rad/K.
    pub drift_rad_per_k: Option<f64>,
    /// RMS of the residual, rad.
    pub scatter_rad: Option<f64>,
    /// Ratio of the 99 % quantile to the 68 % quantile of its size; 2.6 for a normal distribution.
    pub tails_ratio: Option<f64>,
    /// Correlation of the residuals between sessions some days apart.
    pub correlation: Vec<LagCorrelation>,
    /// Mean reported standard deviation, rad.
    pub reported_std_rad: Option<f64>,
    /// Share of errors inside the reported 95 % interval.
    pub inside_95_share: Option<f64>,
    /// RMS scatter of the stiffness estimated, about each robot's straight line over temperature, as a
    /// fraction of nominal.
    pub stiffness_scatter_ratio: Option<f64>,
    /// RMS over robots of its drift, 1/K.
    pub stiffness_drift_ratio_per_k: Option<f64>,
    /// Share of sessions with a sudden change reported within, where there was none.
    pub steps_share: Option<f64>,
}

/// Correlation of the errors between sessions at a lag in days.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LagCorrelation {
    /// Days between them.
    pub lag_days: usize,
    /// −1 to 1.
    pub correlation: f64,
}

/// Effect of a failed strand on the following sessions of one robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FailureSeen {
    /// Seed of the robot.
    pub seed: u64,
    /// Name of the joint.
    pub joint: String,
    /// True size, rad.
    pub size_rad: f64,
    /// Estimated rise of the offset, means of up to ten sessions on either side, creep subtracted, rad.
    pub estimated_rise_rad: f64,
    /// Stiffness really lost, as a fraction of nominal.
    pub lost_ratio: f64,
    /// Stiffness lost as estimated.
    pub estimated_loss_ratio: f64,
}

/// The errors of every joint and the failures, over the sessions of many robots.
pub fn statistics(robots: &[Vec<Session>]) -> (Vec<JointErrors>, Vec<FailureSeen>) {
    let Some(first) = robots.iter().flatten().next() else {
        return (Vec::new(), Vec::new());
    };
    let joints: Vec<String> = first.joints.iter().map(|j| j.name.clone()).collect();
    let mut failures = Vec::new();
    let errors = joints
        .iter()
        .enumerate()
        .map(|(i, joint)| {
            let mut tally = Tally::default();
            for sessions in robots {
                let fails = failure(sessions, i);
                let end = fails.unwrap_or(sessions.len());
                tally.add(&sessions[..end], i);
                if let Some(at) = fails {
                    failures.extend(seen(sessions, i, at));
                }
            }
            tally.finish(joint)
        })
        .collect();
    failures.sort_by_key(|f| f.seed);
    (errors, failures)
}

/// Index of the first session after joint `i` lost stiffness.
fn failure(sessions: &[Session], i: usize) -> Option<usize> {
    /// Less than any failure takes.
    const MIN_STIFFNESS_LOSS_RATIO: f64 = 1e-3;
    let first = sessions.first()?.joints.get(i)?.true_stiffness_ratio;
    (sessions.iter())
        .position(|s| s.joints[i].true_stiffness_ratio < first - MIN_STIFFNESS_LOSS_RATIO)
}

/// Error of a session, rad.
fn error(joint: &SessionJoint) -> Option<f64> {
    joint.offset_rad.map(|y| y.mean - joint.truth_rad)
}

fn seen(sessions: &[Session], i: usize, at: usize) -> Option<FailureSeen> {
    const SESSIONS: usize = 10;
    const MIN_SESSIONS_PER_SIDE: usize = 3;
    let before = &sessions[at.saturating_sub(SESSIONS)..at];
    let after = &sessions[at..(at + SESSIONS).min(sessions.len())];
    if before.len().min(after.len()) < MIN_SESSIONS_PER_SIDE {
        return None;
    }
    let of = |part: &[Session], f: &dyn Fn(&SessionJoint) -> Option<f64>| {
        let all: Vec<f64> = part.iter().filter_map(|s| f(&s.joints[i])).collect();
        finite(mean(&all))
    };
    let change = |f: &dyn Fn(&SessionJoint) -> Option<f64>| Some(of(after, f)? - of(before, f)?);
    let (last, first) = (&sessions[at - 1].joints[i], &sessions[at].joints[i]);
    // Both contain the creep of a day.
    let size_rad = first.truth_rad - last.truth_rad;
    Some(FailureSeen {
        seed: sessions[at].seed,
        joint: first.name.clone(),
        size_rad,
        estimated_rise_rad: size_rad + change(&error)?,
        lost_ratio: last.true_stiffness_ratio - first.true_stiffness_ratio,
        estimated_loss_ratio: -change(&|j| Some(j.stiffness_ratio.mean))?,
    })
}

/// Days between sessions whose errors are compared.
const LAGS: [usize; 4] = [1, 3, 10, 30];

/// Sums over robots of one joint.
#[derive(Default)]
struct Tally {
    sessions: usize,
    inconclusive: usize,
    steps: usize,
    errors: Vec<f64>,
    inside: usize,
    stated: f64,
    bias: Vec<f64>,
    drift: Vec<f64>,
    left: Vec<f64>,
    soft: Vec<f64>,
    soft_drift: Vec<f64>,
    /// Products of the residuals at a lag, and squares.
    pairs: [[f64; 2]; LAGS.len()],
}

impl Tally {
    /// Adds the sessions of a robot.
    fn add(&mut self, own: &[Session], i: usize) {
        self.sessions += own.len();
        self.steps += own.iter().filter(|s| s.joints[i].steps > 0).count();
        for session in own {
            let joint = &session.joints[i];
            if let (Some(e), Some(offset)) = (error(joint), joint.offset_rad) {
                self.errors.push(e);
                self.stated += offset.std;
                self.inside += usize::from(e.abs() <= offset.half_width_95());
            }
        }
        let points: Vec<(usize, (f64, f64))> = own
            .iter()
            .filter_map(|s| Some((s.day, (s.temperature_c, error(&s.joints[i])?))))
            .collect();
        self.inconclusive += own.len() - points.len();
        if points.len() < MIN_SESSIONS {
            return;
        }
        let flat: Vec<(f64, f64)> = points.iter().map(|p| p.1).collect();
        let (mean, slope, rest) = line(&flat);
        self.bias.push(mean);
        self.drift.push(slope);
        for (lag, [product, square]) in LAGS.iter().zip(&mut self.pairs) {
            for (a, (day, _)) in points.iter().enumerate() {
                if let Ok(b) = points.binary_search_by_key(&(day + lag), |p| p.0) {
                    *product += rest[a] * rest[b];
                    *square += 0.5 * (rest[a] * rest[a] + rest[b] * rest[b]);
                }
            }
        }
        self.left.extend(rest);
        let stiffness: Vec<(f64, f64)> = (own.iter())
            .map(|s| (s.temperature_c, s.joints[i].stiffness_ratio.mean))
            .collect();
        let (_, slope, rest) = line(&stiffness);
        self.soft_drift.push(slope);
        self.soft.extend(rest);
    }

    fn finish(self, joint: &str) -> JointErrors {
        let mut sizes: Vec<f64> = self.left.iter().map(|e| e.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| quantile(&sizes, share);
        let share = |n: usize, of: usize| finite(n as f64 / of as f64);
        let assessed = self.errors.len();
        JointErrors {
            joint: joint.into(),
            robots: self.bias.len(),
            sessions: self.sessions,
            inconclusive_share: share(self.inconclusive, self.sessions),
            rms_rad: finite(rms(&self.errors)),
            bias_rad: finite(rms(&self.bias)),
            drift_rad_per_k: finite(rms(&self.drift)),
            scatter_rad: finite(rms(&self.left)),
            tails_ratio: finite(at(0.99) / at(0.68)),
            correlation: (LAGS.iter().zip(&self.pairs))
                .filter(|(_, [_, square])| *square > 0.0)
                .map(|(lag, [product, square])| LagCorrelation {
                    lag_days: *lag,
                    correlation: product / square,
                })
                .collect(),
            reported_std_rad: finite(self.stated / assessed as f64),
            inside_95_share: share(self.inside, assessed),
            stiffness_scatter_ratio: finite(rms(&self.soft)),
            stiffness_drift_ratio_per_k: finite(rms(&self.soft_drift)),
            steps_share: share(self.steps, self.sessions),
        }
    }
}
