//! Simulated years: events found by the trend, and coverage of its forecasts.
//!
//! `SINEW_SEEDS=100 cargo test --release -p sinew-bench --test all trend_year -- --nocapture` prints the figures of
//! many robots; the ordinary run uses a few robots.

use crate::support;

use sinew_bench::year::{self, Forecaster, YearRequest};
use sinew_rope::Catalogue;
use support::{biorob_like, requested_seeds};

#[test]
fn failures_are_found_and_forecasts_cover() {
    let robot = biorob_like();
    let catalogue = Catalogue::shipped().unwrap();
    let seeds = requested_seeds();
    let mut request = YearRequest {
        robots: seeds.unwrap_or(2),
        ..YearRequest::default()
    };
    if seeds.is_none() {
        request.forecasters = vec![Forecaster::Generic];
    }
    let start = std::time::Instant::now();
    let report = year::run(&robot, &catalogue, &request, None, &mut |_, _| {}).unwrap();
    println!("{:.1} s", start.elapsed().as_secs_f64());
    for s in report.summary {
        println!("{}", serde_json::to_string_pretty(&s).unwrap());
        // A few robots give no statistics; only implausible results fail.
        assert!(s.found >= 1 && s.false_alarms <= s.robots, "{s:?}");
        assert!(1e3 * s.tracking_rms_rad < 1.5, "{s:?}");
        if s.robots >= 30 && s.forecaster == Forecaster::Rope {
            assert!(s.false_alarms_per_robot_year < 0.1, "{s:?}");
            assert!(20 * s.found >= 17 * s.failures, "{s:?}");
            let inside = s.covered_95.expect("tendons");
            assert!((0.88..=0.99).contains(&inside.mean), "{inside:?}");
            for f in &s.forecasts {
                assert!((0.72..=0.98).contains(&f.covered_90.mean), "{f:?}");
            }
        }
    }
}
