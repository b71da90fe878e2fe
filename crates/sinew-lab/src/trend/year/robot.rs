//! One robot's year, seen by every forecaster.

use super::forecaster::Forecaster;
use super::surrogate::{self, Failure};
use super::truth::{self, TendonYear};
use super::{YearError, YearRequest};
use crate::rope::draws::quantile;
use crate::rope::{Catalogue, CatalogueRope};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use serde::{Deserialize, Serialize};
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_model::trend::{Prior, Record, Trend, TrendConfig, first_passage};

const DAY_S: f64 = 86_400.0;
/// Days records are taken for.
const WATCHED: usize = 365;
/// Days forecasts are made on.
const FORECAST_DAYS: [usize; 3] = [60, 90, 120];
/// An alarm belongs to a failure when its record is this close to it, days.
const NEAR_DAYS: f64 = 3.0;

/// One robot's year.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobotYear {
    /// Seed.
    pub seed: u64,
    /// Joint whose strand failed.
    pub failed_joint: String,
    /// The failure.
    pub failure: Failure,
    /// One entry per forecaster and tendon.
    pub tendons: Vec<TendonResult>,
}

/// What a forecaster made of one tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TendonResult {
    /// Who.
    pub forecaster: Forecaster,
    /// Joint.
    pub joint: String,
    /// Days from the first session after the failure to its confirmation; `None`: not found, or
    /// no failure here.
    pub found_after_days: Option<f64>,
    /// Days of confirmed changes that weren't there.
    pub false_alarm_days: Vec<f64>,
    /// RMS of the filtered offset against the truth, mrad.
    pub error_rms_mrad: f64,
    /// Forecasts.
    pub forecasts: Vec<Forecast>,
}

/// A forecast of the day a limit is passed, no further failure supposed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Forecast {
    /// Day it was made.
    pub made_day: f64,
    /// True day, had nothing failed since.
    pub true_day: f64,
    /// Median; `None`: beyond ten years.
    pub median_day: Option<f64>,
    /// Quantiles of 2.5, 5, 95 and 97.5 %; infinite ones as `None`.
    pub quantile_days: [Option<f64>; 4],
}

/// What all years share.
pub(super) struct Fleet<'a> {
    request: &'a YearRequest,
    tendons: Vec<(String, &'a Tendon, &'a CatalogueRope)>,
    /// Per tendon and forecaster.
    priors: Vec<Vec<(Forecaster, Prior)>>,
}

impl<'a> Fleet<'a> {
    pub(super) fn new(
        robot: &'a Robot,
        catalogue: &'a Catalogue,
        request: &'a YearRequest,
    ) -> Result<Self, YearError> {
        let mut tendons = Vec::new();
        let mut priors = Vec::new();
        for joint in &request.joints {
            let tendon = robot
                .arm
                .joint_index(joint)
                .and_then(|i| robot.transmissions[i].as_ref())
                .and_then(|t| t.tendon.as_ref())
                .filter(|t| t.pretension_n.is_some())
                .ok_or_else(|| YearError::Joint(joint.clone()))?;
            let name = tendon
                .rope
                .as_ref()
                .ok_or_else(|| YearError::Joint(joint.clone()))?;
            let rope = catalogue.find(name)?;
            let mut own = Vec::new();
            for &who in &request.forecasters {
                own.push((
                    who,
                    who.prior(rope, tendon, &request.errors, request.oracle_curves)?,
                ));
            }
            tendons.push((joint.clone(), tendon, rope));
            priors.push(own);
        }
        Ok(Self {
            request,
            tendons,
            priors,
        })
    }

    pub(super) fn year(&self, seed: u64) -> Result<RobotYear, YearError> {
        // Seeds of neighbours and tendons must not be each other's.
        let base = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut rng = ChaCha8Rng::seed_from_u64(base);
        let temperature_c = truth::temperatures_c(&mut rng);
        let failed = rng.random_range(0..self.tendons.len());
        let failure = Failure {
            day: rng.random_range(10..WATCHED - 10),
            size_mrad: rng.random_range(2.0..4.0),
            stiffness_percent: rng.random_range(2.0..8.0),
        };
        let mut tendons = Vec::new();
        for (i, (joint, tendon, rope)) in self.tendons.iter().enumerate() {
            let year = truth::draw(rope, tendon, &temperature_c, base ^ (7919 * (i as u64 + 1)))?;
            let own = (i == failed).then_some(failure);
            let errors = &self.request.errors;
            let records =
                surrogate::records(&year.creep_rad, &temperature_c, own, errors, &mut rng);
            for (who, prior) in &self.priors[i] {
                let mut result = watch(prior, temperature_c[0], &records, &year, own, seed)?;
                result.forecaster = *who;
                result.joint.clone_from(joint);
                tendons.push(result);
            }
        }
        Ok(RobotYear {
            seed,
            failed_joint: self.tendons[failed].0.clone(),
            failure,
            tendons,
        })
    }
}

/// Gives a year's records to a trend, day by day.
fn watch(
    prior: &Prior,
    reference_c: f64,
    records: &[Record],
    year: &TendonYear,
    failure: Option<Failure>,
    seed: u64,
) -> Result<TendonResult, YearError> {
    let prior = Prior {
        temperature_ref_c: reference_c,
        ..prior.clone()
    };
    let mut trend = Trend::new(prior, TrendConfig::default())?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x00f0_7eca_5700);
    let mut out = TendonResult {
        forecaster: Forecaster::Rope,
        joint: String::new(),
        found_after_days: None,
        false_alarm_days: Vec::new(),
        error_rms_mrad: 0.0,
        forecasts: Vec::new(),
    };
    let true_rad = |day: usize, failed_by: usize| {
        let jump = failure.filter(|f| day >= f.day && f.day <= failed_by);
        year.creep_rad[day] + jump.map_or(0.0, |f| 1e-3 * f.size_mrad)
    };
    let (mut squares, mut counted) = (0.0, 0.0);
    for record in &records[..WATCHED] {
        let day = (record.time_s / DAY_S).round() as usize;
        if let Some(event) = trend.add(*record)?.confirmed {
            let at = event.time_s / DAY_S;
            // A failure shows in the first session after it that could tell.
            match failure.filter(|f| (at - f.day as f64).abs() <= NEAR_DAYS) {
                Some(f) if out.found_after_days.is_none() => {
                    out.found_after_days = Some(event.confirmed_s / DAY_S - f.day as f64);
                }
                _ => out.false_alarm_days.push(event.confirmed_s / DAY_S),
            }
        }
        if day.is_multiple_of(15) {
            let error = mean_offset(&trend, &mut rng) - true_rad(day, day);
            squares += error * error;
            counted += 1.0;
        }
        if FORECAST_DAYS.contains(&day) {
            let path: Vec<f64> = (day..year.creep_rad.len())
                .map(|d| true_rad(d, day))
                .collect();
            let times: Vec<f64> = (day..year.creep_rad.len()).map(|d| d as f64).collect();
            let true_day = first_passage(&times, &[path], year.limit_rad)[0];
            if true_day > day as f64 && true_day.is_finite() {
                out.forecasts
                    .push(forecast(&trend, day, true_day, year.limit_rad, &mut rng));
            }
        }
    }
    out.error_rms_mrad = 1e3 * (squares / f64::max(counted, 1.0)).sqrt();
    Ok(out)
}

/// Mean of the present offset, rad.
fn mean_offset(trend: &Trend, rng: &mut ChaCha8Rng) -> f64 {
    const PATHS: usize = 100;
    let paths = trend.paths(&[trend.time_s()], PATHS, &mut || StandardNormal.sample(rng));
    paths.offset_rad.iter().map(|p| p[0]).sum::<f64>() / PATHS as f64
}

fn forecast(
    trend: &Trend,
    day: usize,
    true_day: f64,
    limit_rad: f64,
    rng: &mut ChaCha8Rng,
) -> Forecast {
    const PATHS: usize = 1000;
    const STEPS: i32 = 120;
    const HORIZON_DAYS: f64 = 3652.5;
    let ratio = (HORIZON_DAYS / day as f64).powf(1.0 / f64::from(STEPS));
    let times: Vec<f64> = (0..=STEPS)
        .map(|i| trend.time_s() * ratio.powi(i))
        .collect();
    let paths = trend.paths(&times, PATHS, &mut || StandardNormal.sample(rng));
    let mut found = first_passage(&paths.times_s, &paths.offset_rad, limit_rad);
    found.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| {
        quantile(&found, share)
            .filter(|t| t.is_finite())
            .map(|t| t / DAY_S)
    };
    Forecast {
        made_day: day as f64,
        true_day,
        median_day: at(0.5),
        quantile_days: [at(0.025), at(0.05), at(0.95), at(0.975)],
    }
}
