//! Daily sessions without simulating them: truth and the estimator's measured errors.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal, StudentT};
use serde::{Deserialize, Serialize};
use sinew_files::date::DAY_S;
use sinew_model::Gaussian;
use sinew_model::offset::SharedError;
use sinew_trend::filter::Record;

const MRAD: f64 = 1e-3;
const PERCENT: f64 = 0.01;

/// Errors are summed in the units they were measured in: years stay those of earlier programs.
pub fn mrad(rad: f64) -> f64 {
    1e3 * rad
}

fn percent(ratio: f64) -> f64 {
    100.0 * ratio
}

/// Errors of a daily session, as measured on the full chain (see `docs/src/science/years.md`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionErrors {
    /// Scale of the part that differs from session to session, rad.
    pub white_rad: f64,
    /// Degrees of freedom of its t distribution: how heavy its tails are.
    pub white_freedom: f64,
    /// Standard deviation of the part that sessions share, rad.
    pub slow_rad: f64,
    /// How long they share it, s.
    pub slow_time_s: f64,
    /// Standard deviation of the part that stays, rad.
    pub bias_rad: f64,
    /// Standard deviation after a year of a part that walks away from zero, rad.
    pub wander_rad: f64,
    /// Standard deviation of a part that comes and goes with the season and not with the temperature read, rad.
    pub season_rad: f64,
    /// Standard deviation of the drift with temperature, rad/K.
    pub drift_rad_per_k: f64,
    /// Standard deviation of the temperature's reading, K.
    pub thermometer_k: f64,
    /// What the estimator states as the standard deviation of what all sessions since the baseline share, rad.
    pub stated_shared_rad: f64,
    /// The same of the drift with temperature, rad/K.
    pub stated_drift_rad_per_k: f64,
    /// The same of the session's own error, rad.
    pub stated_own_rad: f64,
    /// The same of what a lost stiffness adds to the shared part, rad per whole stiffness.
    pub stated_softened_rad: f64,
    /// Whether sessions say which part is which; else the whole alone.
    pub parts_stated: bool,
    /// Share of sessions that couldn't tell.
    pub refused_share: f64,
    /// Offset that a lost stiffness reads as, rad per whole stiffness: mean over robots.
    pub stiffness_offset_rad: f64,
    /// Standard deviation of that between robots.
    pub stiffness_offset_spread_rad: f64,
    /// Share of a lost stiffness that the stiffness reported shows.
    pub stiffness_seen_share: f64,
    /// Standard deviation of the reported stiffness from session to session, as a fraction of nominal.
    pub stiffness_white_ratio: f64,
    /// Standard deviation of its drift with temperature, 1/K.
    pub stiffness_drift_ratio_per_k: f64,
    /// What the estimator states as one standard deviation of it.
    pub stiffness_stated_ratio: f64,
}

impl SessionErrors {
    /// A check over the same poses every day.
    pub fn check() -> Self {
        Self {
            white_rad: 0.06 * MRAD,
            white_freedom: 8.0,
            slow_rad: 0.02 * MRAD,
            slow_time_s: 20.0 * DAY_S,
            bias_rad: 0.15 * MRAD,
            wander_rad: 0.0,
            season_rad: 0.0,
            drift_rad_per_k: 0.1 * MRAD,
            thermometer_k: 0.5,
            stated_shared_rad: 0.15 * MRAD,
            stated_drift_rad_per_k: 0.1 * MRAD,
            stated_own_rad: 0.1 * MRAD,
            stated_softened_rad: 6e-3,
            parts_stated: true,
            refused_share: 0.0,
            stiffness_offset_rad: 0.0,
            stiffness_offset_spread_rad: 8e-3,
            stiffness_seen_share: 1.0,
            stiffness_white_ratio: 0.14 * PERCENT,
            stiffness_drift_ratio_per_k: 0.02 * PERCENT,
            stiffness_stated_ratio: 2.0 * PERCENT,
        }
    }

    /// A minute of work.
    pub fn work() -> Self {
        Self {
            white_rad: 0.22 * MRAD,
            bias_rad: 0.3 * MRAD,
            stated_shared_rad: 0.3 * MRAD,
            stated_own_rad: 0.22 * MRAD,
            stated_softened_rad: 12e-3,
            stiffness_offset_rad: 4e-3,
            stiffness_offset_spread_rad: 12e-3,
            stiffness_seen_share: 0.9,
            stiffness_white_ratio: 0.65 * PERCENT,
            ..Self::check()
        }
    }

    /// Errors larger than any measured: what a robot may do that the simulator doesn't.
    pub fn hard() -> Self {
        Self {
            white_rad: 0.35 * MRAD,
            white_freedom: 6.0,
            slow_rad: 0.3 * MRAD,
            slow_time_s: 20.0 * DAY_S,
            bias_rad: 0.3 * MRAD,
            wander_rad: 0.0,
            season_rad: 0.0,
            drift_rad_per_k: 0.1 * MRAD,
            thermometer_k: 0.5,
            stated_shared_rad: 0.3 * MRAD,
            stated_drift_rad_per_k: 0.1 * MRAD,
            stated_own_rad: 0.4 * MRAD,
            stated_softened_rad: 0.0,
            parts_stated: true,
            refused_share: 0.03,
            stiffness_offset_rad: 0.0,
            stiffness_offset_spread_rad: 0.01,
            stiffness_seen_share: 0.0,
            stiffness_white_ratio: 1.0 * PERCENT,
            stiffness_drift_ratio_per_k: 0.2 * PERCENT,
            stiffness_stated_ratio: 2.0 * PERCENT,
        }
    }

    /// What a session states that much warmer or colder than the baseline, and softer than nominal: the whole deviation,
    /// and its parts.
    fn stated(&self, warm_k: f64, softer_ratio: f64) -> (f64, Option<SharedError>) {
        let drift_rad = (self.stated_drift_rad_per_k * warm_k).abs();
        let softened_rad = self.stated_softened_rad * softer_ratio;
        let shared = SharedError {
            baseline_rad: self.stated_shared_rad.hypot(softened_rad),
            drift_rad,
        };
        let whole = (self.stated_own_rad.hypot(drift_rad)).hypot(shared.baseline_rad);
        (whole, self.parts_stated.then_some(shared))
    }

    /// What a trend multiplies its factor of the own error with, rad.
    pub fn own_unit_rad(&self) -> f64 {
        let (whole, shared) = self.stated(0.0, 0.0);
        let record = Record {
            offset_rad: Some(Gaussian::new(0.0, whole)),
            shared,
            temperature_c: Some(21.0),
            ..Record::default()
        };
        record.own_deviation_rad(0.0)
    }

    /// Standard deviation of the part that differs from session to session, mrad.
    pub fn white_deviation_mrad(&self) -> f64 {
        mrad(self.white_rad) * (self.white_freedom / (self.white_freedom - 2.0)).sqrt()
    }
}

impl Default for SessionErrors {
    fn default() -> Self {
        Self::check()
    }
}

/// A strand that fails.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Failure {
    /// First day that sees it.
    pub day: usize,
    /// Sudden offset, rad.
    pub size_rad: f64,
    /// Stiffness it takes along, as a fraction of nominal.
    pub stiffness_ratio: f64,
}

/// Records of each day from 1 on, s since tensioning.
pub fn records(
    creep_rad: &[f64],
    temperature_c: &[f64],
    failure: Option<Failure>,
    errors: &SessionErrors,
    rng: &mut ChaCha8Rng,
) -> Vec<Record> {
    let normal = |rng: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(rng) };
    let drift = mrad(errors.drift_rad_per_k) * normal(rng);
    let bias = mrad(errors.bias_rad) * normal(rng);
    let per_percent = mrad(0.01 * errors.stiffness_offset_rad)
        + mrad(0.01 * errors.stiffness_offset_spread_rad) * normal(rng);
    let softening = percent(errors.stiffness_drift_ratio_per_k) * normal(rng);
    let phi = (-DAY_S / errors.slow_time_s).exp();
    let slow_mrad = mrad(errors.slow_rad);
    let mut slow = slow_mrad * normal(rng);
    let zero = slow;
    // Drawn apart: a year without them is that of a program that knew nothing of them.
    let mut apart = ChaCha8Rng::seed_from_u64((1e9 * slow).to_bits());
    let season_mrad = mrad(errors.season_rad) * normal(&mut apart) * std::f64::consts::SQRT_2;
    let phase = std::f64::consts::TAU * apart.random::<f64>();
    let season = |day: usize| {
        let angle = std::f64::consts::TAU * day as f64 / 365.25 + phase;
        season_mrad * (angle.sin() - phase.sin())
    };
    let mut wander = 0.0;
    let tails = StudentT::new(errors.white_freedom).ok();
    let mut out = Vec::with_capacity(creep_rad.len());
    for day in 1..creep_rad.len() {
        slow = phi * slow + slow_mrad * (1.0 - phi * phi).sqrt() * normal(rng);
        wander += mrad(errors.wander_rad) * (1.0_f64 / 365.0).sqrt() * normal(&mut apart);
        let white = mrad(errors.white_rad) * tails.map_or(0.0, |t| t.sample(rng));
        let lost = failure
            .filter(|f| day >= f.day)
            .map_or(0.0, |f| percent(f.stiffness_ratio));
        let jump = failure
            .filter(|f| day >= f.day)
            .map_or(0.0, |f| mrad(f.size_rad) + per_percent * lost);
        let warm = temperature_c[day] - temperature_c[0];
        let read = temperature_c[day] + errors.thermometer_k * normal(rng);
        // The baseline's own share of the slow error is in every offset since.
        let shared = bias + drift * warm + slow - zero + wander + season(day);
        let offset_mrad = mrad(creep_rad[day]) + jump + shared + white;
        let (stated_rad, shared) = errors.stated(read - temperature_c[0], PERCENT * lost);
        let stiffness_percent = softening * warm - errors.stiffness_seen_share * lost
            + percent(errors.stiffness_white_ratio) * normal(rng);
        let refused = rng.random::<f64>() < errors.refused_share;
        out.push(Record {
            time_s: day as f64 * DAY_S,
            offset_rad: (!refused).then_some(Gaussian::new(MRAD * offset_mrad, stated_rad)),
            shared: shared.filter(|_| !refused),
            temperature_c: Some(read),
            reference_c: Some(temperature_c[0]),
            stiffness: (!refused).then_some(Gaussian::new(
                PERCENT * stiffness_percent,
                errors.stiffness_stated_ratio,
            )),
        });
    }
    out
}
