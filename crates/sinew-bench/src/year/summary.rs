//! Many years in a few numbers.

use super::result::{
    DayForecast, DayInterval, DaysInside, ForecastSummary, Forecaster, RobotYear, TendonResult,
    YearSummary,
};
use crate::numbers::{finite, mean, quantile_of};
use sinew_model::Gaussian;
use sinew_model::statistics::upper_median;

/// Sums the years up for each forecaster.
pub fn summary(years: &[RobotYear]) -> Vec<YearSummary> {
    Forecaster::ALL
        .into_iter()
        .filter_map(|who| of(who, years))
        .collect()
}

fn of(who: Forecaster, years: &[RobotYear]) -> Option<YearSummary> {
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
    let delays = failed.clone().filter_map(|(_, t)| t.found_after_days);
    let delays: Vec<f64> = delays.collect();
    let rms = own.iter().map(|(_, t)| t.error_rms_rad).collect();
    let false_alarms = own.iter().map(|(_, t)| t.false_alarm_days.len()).sum();
    let mut days: Vec<f64> = own
        .iter()
        .flat_map(|(_, t)| t.forecasts.iter().map(|f| f.made_day))
        .collect();
    days.sort_unstable_by(f64::total_cmp);
    days.dedup();
    // Errors of a tendon's days are correlated: each tendon counts once.
    let covered = |days: &dyn Fn(&TendonResult) -> DaysInside| {
        let shares: Vec<f64> = (own.iter()).filter_map(|(_, t)| days(t).share()).collect();
        mean_of_independent(&shares)
    };
    let widths: Vec<f64> = own.iter().map(|(_, t)| t.half_width_95_rad).collect();
    Some(YearSummary {
        forecaster: who,
        robots: years.len(),
        failures: failed.count(),
        found_two_days: delays.iter().filter(|d| **d <= 2.0).count(),
        found: delays.len(),
        delay_median_days: finite(quantile_of(delays, 0.5)),
        false_alarms,
        sudden_creep: own.iter().map(|(_, t)| t.sudden_creep_days.len()).sum(),
        false_alarms_per_robot_year: false_alarms as f64 / years.len() as f64,
        tracking_rms_rad: quantile_of(rms, 0.5),
        covered_95: covered(&|t| t.whole),
        failed_covered_95: covered(&|t| t.failed),
        half_width_95_rad: finite(mean(&widths)),
        forecasts: days
            .into_iter()
            .map(|day| {
                let made: Vec<DayForecast> = own
                    .iter()
                    .flat_map(|(_, t)| t.forecasts.iter().copied())
                    .filter(|f| f.made_day == day)
                    .collect();
                forecasts(day, &made)
            })
            .collect(),
    })
}

/// Mean of independent values, with its standard error; `None` of fewer than two.
fn mean_of_independent(values: &[f64]) -> Option<Gaussian> {
    let (n, middle) = (values.len() as f64, mean(values));
    let squares: f64 = values.iter().map(|v| (v - middle) * (v - middle)).sum();
    (n > 1.0).then(|| Gaussian::new(middle, (squares / (n - 1.0) / n).sqrt()))
}

fn forecasts(made_day: f64, made: &[DayForecast]) -> ForecastSummary {
    let median = |f: &dyn Fn(&DayForecast) -> f64| {
        let mut all: Vec<f64> = made.iter().map(f).collect();
        // Between a finite and an infinite error no mean helps.
        upper_median(&mut all).and_then(finite)
    };
    let error = |f: &DayForecast| (f.median_day.unwrap_or(f64::INFINITY) - f.true_day).abs();
    let covered = |interval: &dyn Fn(&DayForecast) -> DayInterval| {
        let inside = made.iter().filter(|f| interval(f).contains(f.true_day));
        let n = made.len().max(1) as f64;
        let share = inside.count() as f64 / n;
        Gaussian::new(share, (share * (1.0 - share) / n).sqrt())
    };
    let end = |day: Option<f64>| day.unwrap_or(f64::INFINITY);
    ForecastSummary {
        made_day,
        forecasts: made.len(),
        error_of_day_ratio: median(&|f| error(f) / f.true_day),
        error_of_rest_ratio: median(&|f| error(f) / (f.true_day - f.made_day)),
        covered_90: covered(&|f| f.interval_90_day),
        covered_95: covered(&|f| f.interval_95_day),
        width_90_ratio: median(&|f| {
            (end(f.interval_90_day.high) - end(f.interval_90_day.low)) / f.true_day
        }),
    }
}
