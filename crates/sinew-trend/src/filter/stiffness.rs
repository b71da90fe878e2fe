//! Stiffness reported by sessions in addition to the offset: a strand failure reduces it.

use super::record::{Record, TrendEntry};
use sinew_model::Gaussian;

/// Prior of `k²`: shape and rate of the inverse gamma distribution; `k` is about 0.5.
const SHAPE: f64 = 1.0;
const RATE: f64 = 0.25;
/// Number of sessions over which `k` is forgotten.
const MEMORY: f64 = 50.0;
/// Random walk of the level between sessions, in reported standard deviations times `k`.
const WALK: f64 = 0.1;
/// Relative stiffness loss of a strand failure.
const LOSS: Gaussian = Gaussian::new(0.04, 0.03);
/// Minimum number of sessions before the stiffness is evidence.
const MIN_SESSIONS: u64 = 6;
/// Share of step changes that are strand failures; the others are slips, which do not change the
/// stiffness.
const STRANDS: f64 = 0.5;
/// Maximum log-evidence of the stiffness, so that stiffness alone never creates a step change.
const MAX_LOG_EVIDENCE: f64 = 5.0;

/// State estimate of the stiffness:
///
/// ```text
/// s = s₀ + β (T − T_ref) + k σ e,   e ~ N(0, 1)
/// ```
///
/// with the reported standard deviation `σ` and an unknown factor `k` on it (sessions since one
/// baseline share most of their error, so that they scatter by much less than they report). Level
/// and drift are normal given `k`, `k²` is inverse gamma: the predictive distribution of the next
/// session is Student's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiffness {
    /// Means of `s₀` (over nominal) and `β`, 1/K.
    pub mean: [f64; 2],
    /// Lower triangle of their covariance over `k²`.
    pub covariance: [f64; 3],
    /// Shape parameter of `k²`.
    pub shape: f64,
    /// Rate parameter of `k²`.
    pub rate: f64,
    /// Number of sessions so far.
    pub sessions: u64,
}

impl Stiffness {
    pub(super) fn new() -> Self {
        /// Wide prior relative to any stiffness and drift.
        const LEVEL: f64 = 1.0;
        const DRIFT_PER_K: f64 = 0.05;
        Self {
            mean: [0.0; 2],
            covariance: [LEVEL * LEVEL, 0.0, DRIFT_PER_K * DRIFT_PER_K],
            shape: SHAPE,
            rate: RATE,
            sessions: 0,
        }
    }

    /// Whether all values are valid.
    pub(super) fn is_possible(&self) -> bool {
        let finite = |v: &f64| v.is_finite();
        self.mean.iter().all(finite)
            && self.covariance.iter().all(finite)
            && self.shape > 0.0
            && self.rate > 0.0
            && self.shape.is_finite()
            && self.rate.is_finite()
    }

    /// Processes an entry; returns the log predictive density of a session's stiffness.
    pub(super) fn take(&mut self, entry: &TrendEntry, reference_c: f64) -> f64 {
        match entry {
            TrendEntry::Record(record) => self.update(record, reference_c),
            TrendEntry::StepChange { .. } => {
                // A step change occurred; whether a strand failed is unknown.
                self.open(0.0, LOSS.mean + LOSS.std);
                0.0
            }
            TrendEntry::Tensioned { .. } | TrendEntry::Baseline { .. } => {
                self.open(0.0, LOSS.std);
                0.0
            }
        }
    }

    /// Log-likelihood ratio of the stiffness of `entries` with a step change just before them
    /// against none: half of all step changes are strand failures, which reduce the stiffness.
    pub(super) fn support(&self, entries: &[TrendEntry], reference_c: f64) -> f64 {
        if self.sessions < MIN_SESSIONS {
            return 0.0;
        }
        let (mut kept, mut lost) = (*self, *self);
        lost.open(-LOSS.mean, LOSS.std);
        let mut ratio = 0.0;
        for entry in entries {
            ratio += lost.take(entry, reference_c) - kept.take(entry, reference_c);
        }
        if ratio.is_nan() {
            return 0.0;
        }
        // A strand failure reduces the stiffness: an increase contradicts it, whatever the step.
        if lost.mean[0] >= self.mean[0] {
            ratio = f64::NEG_INFINITY;
        }
        libm::log(1.0 - STRANDS + STRANDS * libm::exp(ratio.min(MAX_LOG_EVIDENCE)))
    }

    /// Shifts the level and inflates its variance by an absolute standard deviation.
    fn open(&mut self, by: f64, std: f64) {
        self.mean[0] += by;
        self.covariance[0] += std * std * self.shape / self.rate;
    }

    fn update(&mut self, record: &Record, reference_c: f64) -> f64 {
        let Some(Gaussian { mean: value, std }) = record.credible_stiffness() else {
            return 0.0;
        };
        let warm = record.temperature_c.map_or(0.0, |t| t - reference_c);
        let [c00, c10, c11] = self.covariance;
        let c00 = c00 + WALK * WALK * std * std;
        let (p0, p1) = (c00 + c10 * warm, c10 + c11 * warm);
        let variance = p0 + p1 * warm + std * std;
        let error = value - self.mean[0] - self.mean[1] * warm;
        let k2 = self.rate / self.shape;
        let log_density = log_student(error, 2.0 * self.shape, k2 * variance);
        // An outlying session must not narrow the estimate of `k`: bound of its squared error in
        // `k²`.
        const MAX_SQUARED_ERROR: f64 = 9.0;
        let square = (error * error / variance).min(MAX_SQUARED_ERROR * k2);
        let gain = [p0 / variance, p1 / variance];
        self.mean[0] += gain[0] * error;
        self.mean[1] += gain[1] * error;
        self.covariance = [
            (c00 - gain[0] * p0).max(0.0),
            c10 - gain[1] * p0,
            (c11 - gain[1] * p1).max(0.0),
        ];
        let kept = 1.0 - 1.0 / MEMORY;
        self.shape = SHAPE + kept * (self.shape - SHAPE) + 0.5;
        self.rate = RATE + kept * (self.rate - RATE) + 0.5 * square;
        self.sessions += 1;
        log_density
    }
}

/// Log density of Student's distribution with `freedom` degrees and a squared scale.
fn log_student(error: f64, freedom: f64, scale2: f64) -> f64 {
    let half = 0.5 * (freedom + 1.0);
    libm::lgamma(half)
        - libm::lgamma(0.5 * freedom)
        - 0.5 * libm::log(core::f64::consts::PI * freedom * scale2)
        - half * libm::log1p(error * error / (freedom * scale2))
}

#[cfg(test)]
mod tests {
    use super::{Stiffness, log_student};
    use crate::filter::record::{Record, TrendEntry};
    use sinew_model::Gaussian;

    fn session(day: i32, stiffness: f64, celsius: f64) -> TrendEntry {
        TrendEntry::Record(Record {
            time_s: 86_400.0 * f64::from(day),
            offset_rad: Some(Gaussian::new(0.0, 1e-3)),
            temperature_c: Some(celsius),
            stiffness: Some(Gaussian::new(stiffness, 0.02)),
            ..Record::default()
        })
    }

    #[test]
    fn students_density_integrates_to_one() {
        let h = 0.01;
        let sum: f64 = (-40_000..40_000)
            .map(|i| h * libm::exp(log_student(h * f64::from(i), 3.0, 0.25)))
            .sum();
        // Tails beyond 400 contain about 2 · 0.5³ · 1.1 / 400³ = 4e-9.
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
    }

    #[test]
    fn stiffness_loss_supports_step_thermal_drift_does_not() {
        let mut estimate = Stiffness::new();
        let wave = |i: i32| libm::sin(f64::from(i) * 2.4);
        for i in 0..40 {
            let warm = 6.0 * wave(i);
            let s = 0.05 - 0.002 * warm + 0.002 * wave(3 * i + 1);
            estimate.take(&session(i, s, 23.0 + warm), 23.0);
        }
        let next = |lost: f64, warm: f64| {
            let s = 0.05 - 0.002 * warm - lost;
            let two = [session(40, s, 23.0 + warm), session(41, s, 23.0 + warm)];
            estimate.support(&two, 23.0)
        };
        assert!(next(0.04, 0.0) > 4.0, "{}", next(0.04, 0.0));
        // Slip: half of the step changes leave the stiffness unchanged.
        let slip = next(0.0, 0.0);
        assert!((slip + core::f64::consts::LN_2).abs() < 0.05, "{slip}");
        assert!(next(0.0, 8.0) < 0.0, "{}", next(0.0, 8.0));
        // An increase is not a strand failure.
        assert!(next(-0.04, 0.0) < 0.0, "{}", next(-0.04, 0.0));
    }
}
