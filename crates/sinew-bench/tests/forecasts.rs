//! Coverage of forecasts of recently tensioned tendons against the true creep of their ropes.

use crate::support;
use sinew_bench::year::{RopePrior, extrapolate};
use sinew_rope::Catalogue;

/// Minimum coverage over the forecast days.
fn inside(tendons: u64, rope_prior: RopePrior) -> f64 {
    let robot = support::biorob_like();
    let catalogue = Catalogue::shipped().unwrap();
    let forecast = extrapolate(&robot, &catalogue, rope_prior, tendons).unwrap();
    println!("{forecast:?}");
    let shares = forecast.days.iter().map(|day| day.coverage_share);
    shares.fold(f64::INFINITY, f64::min)
}

/// Share minus two standard errors of `count`.
fn least(share: f64, count: u64) -> f64 {
    share - 2.0 * (share * (1.0 - share) / count as f64).sqrt()
}

/// Minimum shares: those of 400 tendons (92 and 88 %), less two standard errors of this smaller number. With curve
/// shapes alone, and a first year limited to a strain of 0.1 %, they were 77, 63 and 50 % of 400.
#[test]
#[ignore = "study: 150 tendons"]
fn forecast_unknown_rope_covers_truth() {
    let share = inside(support::seeds(100), RopePrior::Tendon);
    assert!(share >= least(0.92, support::seeds(100)), "{share}");
    let half = support::seeds(100).div_ceil(2);
    let share = inside(half, RopePrior::Nothing);
    assert!(share >= least(0.88, half), "{share}");
}

/// Minimum shares of 95 % for a specified rope. When a rope was taken to work before its baseline, they were 92, 88
/// and 83 % of 400: bedding-in
/// follows the baseline.
#[test]
#[ignore = "study: 100 tendons"]
fn forecast_catalogue_rope_covers_truth() {
    let share = inside(support::seeds(100), RopePrior::Law);
    assert!(share >= least(0.95, support::seeds(100)), "{share}");
}
