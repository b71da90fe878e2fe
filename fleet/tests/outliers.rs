//! Outliers: deviating tendons are found, and the number of false ones is as expected.

use crate::support::source;
use crate::support::tendons::tendon;
use sinew_fleet::FleetError;
use sinew_fleet::args::Outliers;
use sinew_fleet::creep::Ages;
use sinew_fleet::gather::{CreepingTendon, FleetTable};
use sinew_fleet::outliers::{OutlierList, departing};
use std::path::Path;

const AGES: Ages = Ages {
    from_days: 1.0,
    to_days: 30.0,
};

fn listed(tendons: Vec<CreepingTendon>, by_chance: f64) -> Result<OutlierList, FleetError> {
    let request = Outliers {
        source: source(Path::new(".")),
        robots: Vec::new(),
        ages: AGES,
        by_chance,
        rows: 40,
        seed: 1,
        csv: None,
    };
    let gathered = FleetTable {
        tendons,
        ..FleetTable::default()
    };
    departing(&gathered, &request)
}

/// Usual tendons of four batches, the third of which creeps by 70 % more.
fn usual(from: usize, count: usize) -> Vec<CreepingTendon> {
    (from..from + count)
        .map(|i| {
            let factor = if i % 4 == 2 { 1.7 } else { 1.0 };
            tendon(
                i,
                ["a", "b", "c", "d"][i % 4],
                ["hall", "yard"][i / 4 % 2],
                factor,
            )
        })
        .collect()
}

#[test]
fn outliers_are_listed_with_ratio() {
    let mut tendons = usual(0, 300);
    for (i, factor) in [(10, 8.0), (100, 1000.0), (200, 0.1)] {
        // Each from the middle of its kind.
        let mut odd = tendon(i, "a", "hall", 1.0);
        odd.fit = tendons[i].fit.clone();
        odd.site = tendons[i].site.clone();
        let base = if i % 4 == 2 { 1.7 } else { 1.0 };
        odd.creep.per_decade_rad = base * factor * 3e-4 / 0.05;
        let share = if factor > 100.0 { 0.2 } else { 0.02 };
        odd.creep.std_rad = share * odd.creep.per_decade_rad;
        tendons[i] = odd;
    }
    let list = listed(tendons, 0.5).unwrap();
    let mut names: Vec<&str> = list.outliers.iter().map(|o| o.robot.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["arm-0010", "arm-0100", "arm-0200"], "{list:?}");
    for outlier in &list.outliers {
        let true_ratio = match outlier.robot.as_str() {
            "arm-0010" => 8.0,
            "arm-0100" => 1000.0,
            _ => 0.1,
        };
        let [ratio, low, high] = outlier.ratio;
        assert!(
            (ratio / true_ratio).ln().abs() < 0.3 && low < ratio && ratio < high,
            "{outlier:?}"
        );
        assert_eq!(
            outlier.is_significantly_more(),
            true_ratio > 1.0,
            "{outlier:?}"
        );
    }
}

#[test]
fn outliers_by_chance_have_expected_number() {
    // Of 900 that differ normally 15 are expected, with 4 as a standard deviation.
    let count = |from: usize| listed(usual(from, 300), 5.0).unwrap().outliers.len();
    let all: usize = (0..3).map(|i| count(1000 * i)).sum();
    assert!((4..=27).contains(&all), "{all}");
}

#[test]
fn outliers_exclude_imprecise_tendon() {
    let mut tendons = usual(0, 200);
    tendons[7].creep.per_decade_rad *= 30.0;
    tendons[7].creep.std_rad = 0.7 * tendons[7].creep.per_decade_rad;
    tendons[8].creep.per_decade_rad *= -1.0;
    tendons[8].creep.std_rad = 3.0 * tendons[8].creep.per_decade_rad.abs();
    let list = listed(tendons, 0.5).unwrap();
    let named = |robot: &str| list.outliers.iter().any(|o| o.robot == robot);
    assert!(!named("arm-0007") && !named("arm-0008"), "{list:?}");
}

#[test]
fn outliers_shrinking_tendon_has_negative_ratio() {
    let mut tendons = usual(0, 200);
    // Shrinks as much as others grow, with a standard deviation of 5 %: ratio −1 ± 0.1, plus the error of the usual creep.
    tendons[8].creep.per_decade_rad = -3e-4 / 0.05;
    let list = listed(tendons, 0.5).unwrap();
    let shrinks = list.outliers.iter().find(|o| o.robot == "arm-0008");
    let outlier = shrinks.unwrap();
    let [ratio, low, high] = outlier.ratio;
    assert!((-1.3..-0.75).contains(&ratio), "{outlier:?}");
    assert!(
        low < ratio - 0.09 && ratio + 0.09 < high && high < 0.0,
        "{outlier:?}"
    );
    assert!(!outlier.is_significantly_more(), "{outlier:?}");
}

#[test]
fn outliers_few_tendons_is_error() {
    let error = listed(usual(0, 12), 1.0);
    assert!(
        matches!(error, Err(FleetError::TooFewTendons { tendons: 12, .. })),
        "{error:?}"
    );
}
