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

/// Errors are summed in the units of their measurement, so that simulated years equal those of earlier versions.
pub fn mrad(rad: f64) -> f64 {
    1e3 * rad
}

fn percent(ratio: f64) -> f64 {
    100.0 * ratio
}

/// Errors of a daily session, as measured on the full chain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionErrors {
    /// Scale of the part that differs from session to session, rad.
    pub white_rad: f64,
    /// Degrees of freedom of its t distribution: how heavy its tails are.
    pub white_freedom: f64,
    /// Standard deviation of the slowly varying part common to neighbouring sessions, rad.
    pub slow_rad: f64,
    /// Correlation time of that part, s.
    pub slow_time_s: f64,
    /// Standard deviation of the constant part, rad.
    pub bias_rad: f64,
    /// Standard deviation of a random-walk part after a year, rad.
    pub wander_rad: f64,
    /// Standard deviation of a seasonal part that is independent of the measured temperature, rad.
    pub season_rad: f64,
    /// Standard deviation of the drift with temperature, rad/K.
    pub drift_rad_per_k: f64,
    /// Standard deviation of the measured temperature, K.
    pub thermometer_k: f64,
    /// Reported standard deviation of the systematic error that all sessions since the baseline share, rad.
    pub reported_systematic_rad: f64,
    /// Reported standard deviation of the drift with temperature, rad/K.
    pub reported_drift_rad_per_k: f64,
    /// Reported standard deviation of the independent error of a session, rad.
    pub reported_independent_rad: f64,
    /// Reported standard deviation that a stiffness loss adds to the systematic error, rad per whole stiffness.
    pub reported_stiffness_loss_rad: f64,
    /// Whether sessions report the systematic and the independent part; otherwise only the total.
    pub parts_specified: bool,
    /// Share of inconclusive sessions.
    pub inconclusive_share: f64,
    /// Offset error caused by a stiffness loss, rad per whole stiffness: mean over robots.
    pub stiffness_offset_rad: f64,
    /// Standard deviation of that between robots.
    pub stiffness_offset_spread_rad: f64,
    /// Share of a stiffness loss that the reported stiffness contains.
    pub stiffness_reported_share: f64,
    /// Standard deviation of the reported stiffness from session to session, as a fraction of nominal.
    pub stiffness_white_ratio: f64,
    /// Standard deviation of its drift with temperature, 1/K.
    pub stiffness_drift_ratio_per_k: f64,
    /// Reported standard deviation of the stiffness ratio.
    pub reported_stiffness_std_ratio: f64,
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
            reported_systematic_rad: 0.15 * MRAD,
            reported_drift_rad_per_k: 0.1 * MRAD,
            reported_independent_rad: 0.1 * MRAD,
            reported_stiffness_loss_rad: 6e-3,
            parts_specified: true,
            inconclusive_share: 0.0,
            stiffness_offset_rad: 0.0,
            stiffness_offset_spread_rad: 8e-3,
            stiffness_reported_share: 1.0,
            stiffness_white_ratio: 0.14 * PERCENT,
            stiffness_drift_ratio_per_k: 0.02 * PERCENT,
            reported_stiffness_std_ratio: 2.0 * PERCENT,
        }
    }

    /// A minute of work.
    pub fn work() -> Self {
        Self {
            white_rad: 0.22 * MRAD,
            bias_rad: 0.3 * MRAD,
            reported_systematic_rad: 0.3 * MRAD,
            reported_independent_rad: 0.22 * MRAD,
            reported_stiffness_loss_rad: 12e-3,
            stiffness_offset_rad: 4e-3,
            stiffness_offset_spread_rad: 12e-3,
            stiffness_reported_share: 0.9,
            stiffness_white_ratio: 0.65 * PERCENT,
            ..Self::check()
        }
    }

    /// Errors larger than any measured, for effects that the simulator does not model.
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
            reported_systematic_rad: 0.3 * MRAD,
            reported_drift_rad_per_k: 0.1 * MRAD,
            reported_independent_rad: 0.4 * MRAD,
            reported_stiffness_loss_rad: 0.0,
            parts_specified: true,
            inconclusive_share: 0.03,
            stiffness_offset_rad: 0.0,
            stiffness_offset_spread_rad: 0.01,
            stiffness_reported_share: 0.0,
            stiffness_white_ratio: 1.0 * PERCENT,
            stiffness_drift_ratio_per_k: 0.2 * PERCENT,
            reported_stiffness_std_ratio: 2.0 * PERCENT,
        }
    }

    /// Reported standard deviation of a session at a temperature difference and a stiffness loss: total, and its
    /// parts.
    fn reported(&self, warm_k: f64, stiffness_loss_ratio: f64) -> (f64, Option<SharedError>) {
        let drift_rad = (self.reported_drift_rad_per_k * warm_k).abs();
        let stiffness_loss_rad = self.reported_stiffness_loss_rad * stiffness_loss_ratio;
        let shared = SharedError {
            baseline_rad: self.reported_systematic_rad.hypot(stiffness_loss_rad),
            drift_rad,
        };
        let whole = (self.reported_independent_rad.hypot(drift_rad)).hypot(shared.baseline_rad);
        (whole, self.parts_specified.then_some(shared))
    }

    /// Returns the unit of the independent error that a trend scales with its factor, rad.
    pub fn own_unit_rad(&self) -> f64 {
        let (whole, shared) = self.reported(0.0, 0.0);
        let record = Record {
            offset_rad: Some(Gaussian::new(0.0, whole)),
            shared,
            temperature_c: Some(21.0),
            ..Record::default()
        };
        record.own_std_rad(0.0)
    }

    /// Standard deviation of the part that differs from session to session, mrad.
    pub fn white_std_mrad(&self) -> f64 {
        mrad(self.white_rad) * (self.white_freedom / (self.white_freedom - 2.0)).sqrt()
    }
}

impl Default for SessionErrors {
    fn default() -> Self {
        Self::check()
    }
}

/// Failure of a strand in a simulated year.
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
    let stiffness_drift_percent_per_k = percent(errors.stiffness_drift_ratio_per_k) * normal(rng);
    let phi = (-DAY_S / errors.slow_time_s).exp();
    let slow_mrad = mrad(errors.slow_rad);
    let mut slow = slow_mrad * normal(rng);
    let zero = slow;
    // Drawn from a separate stream: a year without them is identical to that of earlier versions.
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
        let (reported_std_rad, shared) = errors.reported(read - temperature_c[0], PERCENT * lost);
        let stiffness_percent = stiffness_drift_percent_per_k * warm
            - errors.stiffness_reported_share * lost
            + percent(errors.stiffness_white_ratio) * normal(rng);
        let inconclusive = rng.random::<f64>() < errors.inconclusive_share;
        out.push(Record {
            time_s: day as f64 * DAY_S,
            offset_rad: (!inconclusive)
                .then_some(Gaussian::new(MRAD * offset_mrad, reported_std_rad)),
            shared: shared.filter(|_| !inconclusive),
            temperature_c: Some(read),
            reference_c: Some(temperature_c[0]),
            stiffness: (!inconclusive).then_some(Gaussian::new(
                PERCENT * stiffness_percent,
                errors.reported_stiffness_std_ratio,
            )),
        });
    }
    out
}
