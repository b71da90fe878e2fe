//! How long a year takes. Run with `--release` for the figure; a debug build checks the result
//! only.

mod rope_reference;

use rope_reference::{aramid, sk99};
use sinew_model::rope::{Law, Load, Parameters, State};
use std::time::Instant;

const MINUTES_PER_YEAR: usize = 525_600;
/// What a year may take, s.
const YEAR_S: f64 = 0.050;

/// A day of work: tension changes every minute, temperature with the hour.
fn year() -> Vec<Load> {
    let mut x = 1u64;
    (0..MINUTES_PER_YEAR)
        .map(|i| {
            // Numerical Recipes' congruential generator: any spread will do.
            x = x
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let u = (x >> 11) as f64 / (1u64 << 53) as f64;
            let day = (i as f64 / 1440.0 * std::f64::consts::TAU).sin();
            Load::celsius(40.0 + 400.0 * u, 25.0 + 15.0 * day)
        })
        .collect()
}

/// Each week's best of five runs, summed: a week fits between two interruptions by other work.
fn best_of_five(p: Parameters, loads: &[Load]) -> (f64, State) {
    let law = Law::new(p).expect("parameters of a rope").passed_by(2.0);
    let mut state = State::default();
    let mut seconds = 0.0;
    for week in loads.chunks(7 * 1440) {
        let mut best = f64::INFINITY;
        let mut end = state;
        for _ in 0..5 {
            let start = Instant::now();
            let mut s = state;
            for &load in week {
                law.hold(&mut s, load, 60.0).expect("a possible load");
            }
            best = best.min(start.elapsed().as_secs_f64());
            end = s;
        }
        state = end;
        seconds += best;
    }
    (seconds, state)
}

#[test]
fn a_year_of_minutes() {
    let loads = year();
    for (name, p) in [("SK99", sk99()), ("aramid", aramid())] {
        let (seconds, state) = best_of_five(p, &loads);
        println!(
            "{name}: a year of {MINUTES_PER_YEAR} different minutes in {:.1} ms ({:.0} ns a step)",
            1e3 * seconds,
            1e9 * seconds / MINUTES_PER_YEAR as f64
        );
        assert!(state.is_possible() && state.bedding_percent > 0.1);
        if !cfg!(debug_assertions) {
            assert!(seconds < YEAR_S, "{name}: {seconds} s");
        }
    }
}
