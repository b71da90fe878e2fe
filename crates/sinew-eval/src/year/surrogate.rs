//! Daily sessions without simulating them: truth and the estimator's measured errors.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal, StudentT};
use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_model::trend::Record;

/// Errors of a daily session, as measured on the full chain (see `docs/src/science/years.md`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SessionErrors {
    /// Scale of the part that differs from session to session, mrad.
    pub white_mrad: f64,
    /// Degrees of freedom of its t distribution: how heavy its tails are.
    pub white_freedom: f64,
    /// Deviation of the part that sessions share, mrad.
    pub slow_mrad: f64,
    /// How long they share it, days.
    pub slow_days: f64,
    /// Deviation of the part that stays, mrad.
    pub bias_mrad: f64,
    /// Deviation of the drift with temperature, mrad/K.
    pub drift_mrad_per_k: f64,
    /// Deviation of the temperature's reading, K.
    pub thermometer_k: f64,
    /// What the estimator states as one standard deviation, mrad.
    pub stated_mrad: f64,
    /// Share of sessions that couldn't tell.
    pub refused: f64,
    /// How much of a lost stiffness reads as offset, mrad per %: mean over robots.
    pub stiffness_mrad_per_percent: f64,
    /// Deviation of that between robots.
    pub stiffness_spread_mrad_per_percent: f64,
    /// Share of a lost stiffness that the stiffness reported shows.
    pub stiffness_seen: f64,
    /// Deviation of the reported stiffness from session to session, %.
    pub stiffness_white_percent: f64,
    /// Deviation of its drift with temperature, %/K.
    pub stiffness_drift_percent_per_k: f64,
    /// What the estimator states as one standard deviation of it, %.
    pub stiffness_stated_percent: f64,
}

impl SessionErrors {
    /// A check over the same poses every day.
    pub fn check() -> Self {
        Self {
            white_mrad: 0.04,
            white_freedom: 8.0,
            slow_mrad: 0.02,
            slow_days: 20.0,
            bias_mrad: 0.15,
            drift_mrad_per_k: 0.09,
            thermometer_k: 0.5,
            stated_mrad: 0.35,
            refused: 0.0,
            stiffness_mrad_per_percent: 0.4,
            stiffness_spread_mrad_per_percent: 0.2,
            stiffness_seen: 0.4,
            stiffness_white_percent: 0.14,
            stiffness_drift_percent_per_k: 0.02,
            stiffness_stated_percent: 2.0,
        }
    }

    /// A minute of work.
    pub fn work() -> Self {
        Self {
            white_mrad: 0.29,
            bias_mrad: 0.35,
            stated_mrad: 0.52,
            stiffness_white_percent: 0.65,
            ..Self::check()
        }
    }

    /// Errors larger than any measured: what a robot may do that the simulator doesn't.
    pub fn hard() -> Self {
        Self {
            white_mrad: 0.35,
            white_freedom: 6.0,
            slow_mrad: 0.3,
            slow_days: 20.0,
            bias_mrad: 0.0,
            drift_mrad_per_k: 0.1,
            thermometer_k: 0.5,
            stated_mrad: 0.5,
            refused: 0.03,
            stiffness_mrad_per_percent: 0.0,
            stiffness_spread_mrad_per_percent: 0.1,
            stiffness_seen: 0.0,
            stiffness_white_percent: 1.0,
            stiffness_drift_percent_per_k: 0.2,
            stiffness_stated_percent: 2.0,
        }
    }

    /// Standard deviation of the part that differs from session to session, mrad.
    pub(super) fn white_deviation_mrad(&self) -> f64 {
        self.white_mrad * (self.white_freedom / (self.white_freedom - 2.0)).sqrt()
    }
}

impl Default for SessionErrors {
    fn default() -> Self {
        Self::check()
    }
}

/// A strand that fails.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// First day that sees it.
    pub day: usize,
    /// Sudden offset, mrad.
    pub size_mrad: f64,
    /// Stiffness it takes along, %.
    pub stiffness_percent: f64,
}

/// Records of each day from 1 on, s since tensioning.
pub fn records(
    creep_rad: &[f64],
    temperature_c: &[f64],
    failure: Option<Failure>,
    errors: &SessionErrors,
    rng: &mut ChaCha8Rng,
) -> Vec<Record> {
    const DAY_S: f64 = 86_400.0;
    const MRAD: f64 = 1e-3;
    let normal = |rng: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(rng) };
    let drift = errors.drift_mrad_per_k * normal(rng);
    let bias = errors.bias_mrad * normal(rng);
    let per_percent =
        errors.stiffness_mrad_per_percent + errors.stiffness_spread_mrad_per_percent * normal(rng);
    let softening = errors.stiffness_drift_percent_per_k * normal(rng);
    let phi = (-1.0 / errors.slow_days).exp();
    let mut slow = errors.slow_mrad * normal(rng);
    let zero = slow;
    let tails = StudentT::new(errors.white_freedom).ok();
    let mut out = Vec::with_capacity(creep_rad.len());
    for day in 1..creep_rad.len() {
        slow = phi * slow + errors.slow_mrad * (1.0 - phi * phi).sqrt() * normal(rng);
        let white = errors.white_mrad * tails.map_or(0.0, |t| t.sample(rng));
        let lost = failure
            .filter(|f| day >= f.day)
            .map_or(0.0, |f| f.stiffness_percent);
        let jump = failure
            .filter(|f| day >= f.day)
            .map_or(0.0, |f| f.size_mrad + per_percent * lost);
        let warm = temperature_c[day] - temperature_c[0];
        let read = temperature_c[day] + errors.thermometer_k * normal(rng);
        // The baseline's own share of the slow error is in every offset since.
        let offset_mrad = 1e3 * creep_rad[day] + jump + bias + drift * warm + slow - zero + white;
        let stiffness_percent = softening * warm - errors.stiffness_seen * lost
            + errors.stiffness_white_percent * normal(rng);
        let refused = rng.random::<f64>() < errors.refused;
        out.push(Record {
            time_s: day as f64 * DAY_S,
            offset_rad: (!refused)
                .then_some(Gaussian::new(MRAD * offset_mrad, MRAD * errors.stated_mrad)),
            temperature_c: Some(read),
            stiffness: (!refused).then_some(Gaussian::new(
                0.01 * stiffness_percent,
                0.01 * errors.stiffness_stated_percent,
            )),
        });
    }
    out
}
