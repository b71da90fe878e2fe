//! Many years in a few numbers.

use super::forecaster::Forecaster;
use super::robot::{Forecast, RobotYear, TendonResult};
use serde::Serialize;
use sinew_model::statistics::{quantile, upper_median};

/// What one forecaster reached.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Who.
    pub forecaster: Forecaster,
    /// Robots.
    pub robots: usize,
    /// Failures there were.
    pub failures: usize,
    /// Found within two days of the first session that could see them.
    pub found_two_days: usize,
    /// Found at all.
    pub found: usize,
    /// Median delay, days.
    pub delay_median_days: f64,
    /// False alarms.
    pub false_alarms: usize,
    /// Confirmed changes that were a hard day's creep.
    pub sudden_creep: usize,
    /// Per robot and year.
    pub false_alarms_per_robot_year: f64,
    /// RMS of the tracked offset against the truth, mrad: median over tendons.
    pub tracking_rms_mrad: f64,
    /// Forecasts by the day they were made.
    pub forecasts: Vec<ForecastSummary>,
}

/// Forecasts made on one day.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForecastSummary {
    /// Day they were made.
    pub made_day: f64,
    /// How many.
    pub forecasts: usize,
    /// Median of |error| over the true day, %.
    pub error_of_day_percent: f64,
    /// Median of |error| over what was left until the true day, %.
    pub error_of_rest_percent: f64,
    /// True day inside the 90 % interval, %.
    pub covered_90_percent: f64,
    /// True day inside the 95 % interval, %.
    pub covered_95_percent: f64,
    /// Median width of the 90 % interval over the true day, %; infinite as `None`.
    pub width_90_percent: Option<f64>,
}

/// Sums the years up for each forecaster.
pub fn summary(years: &[RobotYear]) -> Vec<Summary> {
    Forecaster::ALL
        .into_iter()
        .filter_map(|who| of(who, years))
        .collect()
}

fn of(who: Forecaster, years: &[RobotYear]) -> Option<Summary> {
    let mut own: Vec<(&RobotYear, &TendonResult)> = Vec::new();
    for year in years {
        own.extend(
            year.tendons
                .iter()
                .filter(|t| t.forecaster == who)
                .map(|t| (year, t)),
        );
    }
    if own.is_empty() {
        return None;
    }
    let failed = own.iter().filter(|(y, t)| y.failed_joint == t.joint);
    let mut delays: Vec<f64> = failed
        .clone()
        .filter_map(|(_, t)| t.found_after_days)
        .collect();
    delays.sort_unstable_by(f64::total_cmp);
    let mut rms: Vec<f64> = own.iter().map(|(_, t)| t.error_rms_mrad).collect();
    rms.sort_unstable_by(f64::total_cmp);
    let false_alarms = own.iter().map(|(_, t)| t.false_alarm_days.len()).sum();
    let mut days: Vec<f64> = own
        .iter()
        .flat_map(|(_, t)| t.forecasts.iter().map(|f| f.made_day))
        .collect();
    days.sort_unstable_by(f64::total_cmp);
    days.dedup();
    Some(Summary {
        forecaster: who,
        robots: years.len(),
        failures: failed.count(),
        found_two_days: delays.iter().filter(|d| **d <= 2.0).count(),
        found: delays.len(),
        delay_median_days: quantile(&delays, 0.5),
        false_alarms,
        sudden_creep: own.iter().map(|(_, t)| t.sudden_creep_days.len()).sum(),
        false_alarms_per_robot_year: false_alarms as f64 / years.len() as f64,
        tracking_rms_mrad: quantile(&rms, 0.5),
        forecasts: days
            .into_iter()
            .map(|day| {
                let made: Vec<Forecast> = own
                    .iter()
                    .flat_map(|(_, t)| t.forecasts.iter().copied())
                    .filter(|f| f.made_day == day)
                    .collect();
                forecasts(day, &made)
            })
            .collect(),
    })
}

fn forecasts(made_day: f64, made: &[Forecast]) -> ForecastSummary {
    let median = |f: &dyn Fn(&Forecast) -> f64| {
        let mut all: Vec<f64> = made.iter().map(f).collect();
        // Between a finite and an infinite error no mean helps.
        upper_median(&mut all).unwrap_or(f64::NAN)
    };
    let error = |f: &Forecast| (f.median_day.unwrap_or(f64::INFINITY) - f.true_day).abs();
    let covered = |low: usize, high: usize| {
        let inside = made.iter().filter(|f| {
            f.quantile_days[low].is_some_and(|q| q <= f.true_day)
                && f.quantile_days[high].is_none_or(|q| q >= f.true_day)
        });
        100.0 * inside.count() as f64 / made.len().max(1) as f64
    };
    let width = median(&|f| {
        let end = |i: usize| f.quantile_days[i].unwrap_or(f64::INFINITY);
        100.0 * (end(2) - end(1)) / f.true_day
    });
    ForecastSummary {
        made_day,
        forecasts: made.len(),
        error_of_day_percent: median(&|f| 100.0 * error(f) / f.true_day),
        error_of_rest_percent: median(&|f| 100.0 * error(f) / (f.true_day - f.made_day)),
        covered_90_percent: covered(1, 2),
        covered_95_percent: covered(0, 3),
        width_90_percent: width.is_finite().then_some(width),
    }
}
