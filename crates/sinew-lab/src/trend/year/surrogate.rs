//! Daily sessions without simulating them: truth and the estimator's measured errors.

use super::truth::DAYS;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal, StudentT};
use serde::{Deserialize, Serialize};
use sinew_model::trend::Record;

/// Errors of a daily session, as measured on the full chain (see `docs/trend.md`).
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
    /// Deviation of the drift with temperature, mrad/K.
    pub drift_mrad_per_k: f64,
    /// Deviation of the temperature's reading, K.
    pub thermometer_k: f64,
    /// What the estimator states as one standard deviation, mrad.
    pub stated_mrad: f64,
    /// Share of sessions that couldn't tell.
    pub refused: f64,
    /// How much of a lost stiffness reads as offset, mrad per %.
    pub stiffness_mrad_per_percent: f64,
}

impl Default for SessionErrors {
    fn default() -> Self {
        Self {
            white_mrad: 0.35,
            white_freedom: 6.0,
            slow_mrad: 0.3,
            slow_days: 20.0,
            drift_mrad_per_k: 0.1,
            thermometer_k: 0.5,
            stated_mrad: 0.5,
            refused: 0.03,
            stiffness_mrad_per_percent: 0.1,
        }
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
    // Sign and share of what the failed strand's stiffness does are the session's own business.
    let stiffness = errors.stiffness_mrad_per_percent * normal(rng);
    let phi = (-1.0 / errors.slow_days).exp();
    let mut slow = errors.slow_mrad * normal(rng);
    let zero = slow;
    let tails = StudentT::new(errors.white_freedom).ok();
    let mut out = Vec::with_capacity(DAYS);
    for day in 1..creep_rad.len() {
        slow = phi * slow + errors.slow_mrad * (1.0 - phi * phi).sqrt() * normal(rng);
        let white = errors.white_mrad * tails.map_or(0.0, |t| t.sample(rng));
        let jump = failure
            .filter(|f| day >= f.day)
            .map_or(0.0, |f| f.size_mrad + stiffness * f.stiffness_percent);
        let warm = temperature_c[day] - temperature_c[0];
        let read = temperature_c[day] + errors.thermometer_k * normal(rng);
        // The baseline's own share of the slow error is in every offset since.
        let offset_mrad = 1e3 * creep_rad[day] + jump + drift * warm + slow - zero + white;
        let refused = rng.random::<f64>() < errors.refused;
        out.push(Record {
            time_s: day as f64 * DAY_S,
            offset_rad: (!refused).then_some([MRAD * offset_mrad, MRAD * errors.stated_mrad]),
            temperature_c: Some(read),
        });
    }
    out
}
