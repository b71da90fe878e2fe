//! First passage of limits.

use super::passage::FirstPassage;
use super::result::{ForecastPoint, Limit, LimitForecast, LimitState};
use crate::filter::{Paths, Trend, first_passage};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use sinew_files::date::PLAUSIBLE_S;
use sinew_model::Interval95;
use sinew_model::statistics::quantile;
use sinew_model::transmission::Tendon;

/// Number of paths drawn: the 2.5 % quantile is based on fifty.
const PATHS: usize = 2000;
/// Number of times evaluated up to the horizon.
const STEPS: usize = 150;
/// Minimum number of sessions for a forecast without a rope.
const MIN_SESSIONS: u64 = 3;

/// Forecast paths of the tendon from now to the horizon: times grow by a constant ratio since
/// tensioning.
pub(super) fn forecast_paths(trend: &Trend, horizon_s: f64, seed: u64) -> Paths {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let start = trend.time_s().max(3600.0);
    let ratio = ((start + horizon_s) / start).powf(1.0 / STEPS as f64);
    let times: Vec<f64> = (0..=STEPS)
        .map(|i| trend.time_s() + start * (ratio.powi(i as i32) - 1.0))
        .collect();
    Paths::draw(trend, &times, PATHS, &mut || {
        StandardNormal.sample(&mut rng)
    })
}

/// Offset at every time of the paths, which count from `start_utc_s`.
pub(super) fn forecast(paths: &Paths, start_utc_s: f64) -> Vec<ForecastPoint> {
    (paths.times_s.iter().enumerate())
        .map(|(i, t)| {
            let column = paths.offset_rad.iter().map(|p| p[i]).collect();
            point(column, start_utc_s + t)
        })
        .collect()
}

/// Offset at one time, linear between those of the paths; `None` beyond their end.
pub(super) fn forecast_at(paths: &Paths, time_s: f64, time_utc_s: f64) -> Option<ForecastPoint> {
    let next = paths.times_s.partition_point(|t| *t < time_s);
    let before = next.saturating_sub(1);
    let (t0, t1) = (*paths.times_s.get(before)?, *paths.times_s.get(next)?);
    let share = if t1 > t0 {
        (time_s - t0) / (t1 - t0)
    } else {
        0.0
    };
    let between = |path: &Vec<f64>| path[before] + share * (path[next] - path[before]);
    Some(point(
        paths.offset_rad.iter().map(between).collect(),
        time_utc_s,
    ))
}

/// Median and interval of all paths at one time.
fn point(mut offsets_rad: Vec<f64>, time_utc_s: f64) -> ForecastPoint {
    offsets_rad.sort_unstable_by(f64::total_cmp);
    let [low, offset_rad, high] = [0.025, 0.5, 0.975].map(|q| quantile(&offsets_rad, q));
    ForecastPoint {
        time_utc_s,
        offset_rad,
        interval_95_rad: Interval95::new(low, high),
    }
}

/// First passage of the limits of a tendon.
///
/// * `rope_specified`: whether the prior is that of its rope. `last_utc_s`: date of the last
///   session.
pub(super) fn limits(
    tendon: Option<&Tendon>,
    trend: &Trend,
    paths: &Paths,
    rope_specified: bool,
    last_utc_s: f64,
) -> Vec<LimitForecast> {
    let Some(tendon) = tendon else {
        return Vec::new();
    };
    let radius_m = tendon.joint_pulley_radius_m;
    let few = trend.records() < if rope_specified { 1 } else { MIN_SESSIONS };
    let retension = tendon.retension_at_m.map(|elongation_m| {
        let limit_rad = elongation_m / radius_m;
        (Limit::Retension { elongation_m }, limit_rad)
    });
    let replace = tendon.replace_at_strain.map(|strain_ratio| {
        let limit_rad = strain_ratio * tendon.length_m / radius_m;
        (Limit::Replace { strain_ratio }, limit_rad)
    });
    (retension.into_iter().chain(replace))
        .map(|(limit, limit_rad)| {
            let found_s = found_s(limit, limit_rad, paths);
            let passed = passage(limit, limit_rad, &found_s, trend.time_s(), few);
            match PLAUSIBLE_S.contains(&last_utc_s) {
                true => dated(passed, last_utc_s),
                false => passed,
            }
        })
        .collect()
}

/// First-passage time of each path, s after tensioning, sorted; infinite: not before its end.
fn found_s(limit: Limit, limit_rad: f64, paths: &Paths) -> Vec<f64> {
    let offsets_rad = match limit {
        Limit::Retension { .. } => &paths.offset_rad,
        Limit::Replace { .. } => &paths.whole_rad,
    };
    let mut found_s = first_passage(&paths.times_s, offsets_rad, limit_rad);
    found_s.sort_unstable_by(f64::total_cmp);
    found_s
}

/// First-passage distribution behind the quantiles of a limit's forecast; `None` with too few
/// sessions.
pub(super) fn passage_times(found: &LimitForecast, paths: &Paths) -> Option<FirstPassage> {
    let looked_s = [*paths.times_s.first()?, *paths.times_s.last()?];
    let has_forecast = found.state != LimitState::TooFewSessions;
    has_forecast.then(|| {
        let found_s = found_s(found.limit, found.limit_rad, paths);
        FirstPassage::of(found.limit, &found_s, looked_s)
    })
}

/// Adds the dates of all times.
fn dated(limit: LimitForecast, last_utc_s: f64) -> LimitForecast {
    let date = |after_s: Option<f64>| after_s.map(|t| last_utc_s + t);
    LimitForecast {
        at_utc_s: date(limit.after_s),
        at_low_utc_s: date(limit.after_low_s),
        at_high_utc_s: date(limit.after_high_s),
        ..limit
    }
}

fn passage(limit: Limit, limit_rad: f64, found_s: &[f64], now_s: f64, few: bool) -> LimitForecast {
    let count = found_s.len().max(1) as f64;
    let passed_probability = found_s.iter().filter(|t| **t <= now_s).count() as f64 / count;
    let at = |share: f64| {
        let t = quantile(found_s, share);
        t.is_finite().then_some((t - now_s).max(0.0))
    };
    let (low, median, high) = (at(0.025), at(0.5), at(0.975));
    let state = match (low, median) {
        _ if few => LimitState::TooFewSessions,
        _ if passed_probability > 0.5 => LimitState::Passed,
        (_, Some(_)) => LimitState::Forecast,
        (Some(_), None) => LimitState::NotBefore,
        (None, None) => LimitState::NotWithinHorizon,
    };
    let is_dated = matches!(state, LimitState::Passed | LimitState::Forecast);
    LimitForecast {
        limit,
        limit_rad,
        state,
        passed_probability,
        after_s: median.filter(|_| is_dated),
        after_low_s: low.filter(|_| !few),
        after_high_s: high.filter(|_| !few),
        at_utc_s: None,
        at_low_utc_s: None,
        at_high_utc_s: None,
    }
}
