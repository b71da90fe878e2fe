//! How wrong sessions are: what the surrogate of the simulated years is set from.

use super::{Session, SessionJoint};
use serde::Serialize;
use sinew_model::statistics::quantile;

/// Sessions of a robot below which nothing is said of it.
const FEWEST: usize = 6;

/// Errors of a joint's sessions before anything failed there, estimate less truth; over robots.
///
/// Per robot a straight line over the temperature read is taken off the errors: its value at the
/// baseline's day is the bias, its slope the drift, what is left the scatter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointErrors {
    /// Joint.
    pub joint: String,
    /// Robots.
    pub robots: usize,
    /// Sessions.
    pub sessions: usize,
    /// Sessions that couldn't tell, %.
    pub refused_percent: f64,
    /// RMS of all errors, mrad.
    pub rms_mrad: f64,
    /// RMS over robots of the mean error, mrad.
    pub bias_mrad: f64,
    /// RMS over robots of the drift, mrad/K.
    pub drift_mrad_per_k: f64,
    /// RMS of what is left, mrad.
    pub scatter_mrad: f64,
    /// Its 99 % quantile over its 68 % quantile; 2.6 of a normal distribution.
    pub tails: f64,
    /// Correlation of what is left between sessions so many days apart.
    pub correlation: Vec<(usize, f64)>,
    /// Mean of the half 95 % interval stated, mrad.
    pub stated_95_mrad: f64,
    /// Errors inside it, %.
    pub inside_95_percent: f64,
    /// RMS scatter of the stiffness estimated, about each robot's straight line over temperature, %.
    pub stiffness_scatter_percent: f64,
    /// RMS over robots of its drift, %/K.
    pub stiffness_drift_percent_per_k: f64,
    /// Share of sessions with a sudden change reported within, where there was none, %.
    pub steps_percent: f64,
}

/// What a failed strand did to the sessions after it, of one robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FailureSeen {
    /// Robot.
    pub seed: u64,
    /// Joint.
    pub joint: String,
    /// True size, mrad.
    pub size_mrad: f64,
    /// Offset's rise as estimated, means of up to ten sessions on either side, creep taken off, mrad.
    pub seen_mrad: f64,
    /// Stiffness really lost, %.
    pub lost_percent: f64,
    /// Stiffness lost as estimated, %.
    pub seen_lost_percent: f64,
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
    /// Less than any failure takes, %.
    const LEAST_PERCENT: f64 = 0.1;
    let first = sessions.first()?.joints.get(i)?.true_stiffness_percent;
    (sessions.iter()).position(|s| s.joints[i].true_stiffness_percent < first - LEAST_PERCENT)
}

/// Error of a session, mrad.
fn error(joint: &SessionJoint) -> Option<f64> {
    joint.offset_mrad.map(|[y, _]| y - joint.truth_mrad)
}

fn seen(sessions: &[Session], i: usize, at: usize) -> Option<FailureSeen> {
    const SESSIONS: usize = 10;
    const FEWEST: usize = 3;
    let before = &sessions[at.saturating_sub(SESSIONS)..at];
    let after = &sessions[at..(at + SESSIONS).min(sessions.len())];
    if before.len().min(after.len()) < FEWEST {
        return None;
    }
    let mean = |part: &[Session], f: &dyn Fn(&SessionJoint) -> Option<f64>| {
        let all: Vec<f64> = part.iter().filter_map(|s| f(&s.joints[i])).collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    };
    let change =
        |f: &dyn Fn(&SessionJoint) -> Option<f64>| Some(mean(after, f)? - mean(before, f)?);
    let (last, first) = (&sessions[at - 1].joints[i], &sessions[at].joints[i]);
    // A day's creep is in both.
    let size_mrad = first.truth_mrad - last.truth_mrad;
    Some(FailureSeen {
        seed: sessions[at].seed,
        joint: first.name.clone(),
        size_mrad,
        seen_mrad: size_mrad + change(&error)?,
        lost_percent: last.true_stiffness_percent - first.true_stiffness_percent,
        seen_lost_percent: -change(&|j| Some(j.stiffness_percent[0]))?,
    })
}

/// Intercept at the middle, slope, and what is left.
fn line(points: &[(f64, f64)]) -> (f64, f64, Vec<f64>) {
    let n = points.len() as f64;
    let (mx, my) = points
        .iter()
        .fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| {
        (a + (x - mx) * (y - my), b + (x - mx) * (x - mx))
    });
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    let left = points
        .iter()
        .map(|(x, y)| y - my - slope * (x - mx))
        .collect();
    (my, slope, left)
}

/// Root mean square; NaN of none.
fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Days between sessions whose errors are compared.
const LAGS: [usize; 4] = [1, 3, 10, 30];

/// Sums over robots of one joint.
#[derive(Default)]
struct Tally {
    sessions: usize,
    refused: usize,
    steps: usize,
    errors: Vec<f64>,
    inside: usize,
    stated: f64,
    bias: Vec<f64>,
    drift: Vec<f64>,
    left: Vec<f64>,
    soft: Vec<f64>,
    soft_drift: Vec<f64>,
    /// Products of what is left a lag apart, and squares.
    pairs: [[f64; 2]; LAGS.len()],
}

impl Tally {
    /// Adds the sessions of a robot.
    fn add(&mut self, own: &[Session], i: usize) {
        self.sessions += own.len();
        self.steps += own.iter().filter(|s| s.joints[i].steps > 0).count();
        for session in own {
            let joint = &session.joints[i];
            if let (Some(e), Some([_, half])) = (error(joint), joint.offset_mrad) {
                self.errors.push(e);
                self.stated += half;
                self.inside += usize::from(e.abs() <= half);
            }
        }
        let points: Vec<(usize, (f64, f64))> = own
            .iter()
            .filter_map(|s| Some((s.day, (s.temperature_c, error(&s.joints[i])?))))
            .collect();
        self.refused += own.len() - points.len();
        if points.len() < FEWEST {
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
            .map(|s| (s.temperature_c, s.joints[i].stiffness_percent[0]))
            .collect();
        let (_, slope, rest) = line(&stiffness);
        self.soft_drift.push(slope);
        self.soft.extend(rest);
    }

    fn finish(self, joint: &str) -> JointErrors {
        let mut sizes: Vec<f64> = self.left.iter().map(|e| e.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| quantile(&sizes, share);
        let share = |n: usize, of: usize| 100.0 * n as f64 / of as f64;
        let told = self.errors.len();
        JointErrors {
            joint: joint.into(),
            robots: self.bias.len(),
            sessions: self.sessions,
            refused_percent: share(self.refused, self.sessions),
            rms_mrad: rms(&self.errors),
            bias_mrad: rms(&self.bias),
            drift_mrad_per_k: rms(&self.drift),
            scatter_mrad: rms(&self.left),
            tails: at(0.99) / at(0.68),
            correlation: (LAGS.iter().zip(&self.pairs))
                .filter(|(_, [_, square])| *square > 0.0)
                .map(|(lag, [product, square])| (*lag, product / square))
                .collect(),
            stated_95_mrad: self.stated / told as f64,
            inside_95_percent: share(self.inside, told),
            stiffness_scatter_percent: rms(&self.soft),
            stiffness_drift_percent_per_k: rms(&self.soft_drift),
            steps_percent: share(self.steps, self.sessions),
        }
    }
}
