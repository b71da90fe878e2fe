//! Selection of the next test: the plan's prediction is correct, and it selects tests at the duty.

use crate::support::bench::{SIGMA, base};
use sinew_creep::*;
use sinew_rope::Duty;
use sinew_rope::predict::{DAY_S, Request, Route};
use std::sync::Arc;

pub(crate) fn test(load_n: f64, temperature_c: f64, loaded_s: f64) -> BenchTest {
    BenchTest {
        preload_n: 2.0,
        preloaded_s: 60.0,
        load_n,
        temperature_c,
        loaded_s,
        recovery_s: 0.5 * loaded_s,
    }
}

pub(crate) fn request(
    tension_n: f64,
    temperature_c: f64,
    candidates: Vec<BenchTest>,
) -> PlanRequest {
    PlanRequest {
        base: Arc::new(base()),
        duty: Request {
            duty: Duty::constant(tension_n, temperature_c),
            route: Route::straight(0.7),
            times_s: vec![30.0 * DAY_S],
            read_at: None,
            draws: 0,
            seed: 1,
        },
        candidates,
        tests: 1,
        bench_s: 2.0 * DAY_S,
        existing: Vec::new(),
        reading_ratio: SIGMA,
        truths: 8,
        seed: 3,
    }
}

fn planned(request: &PlanRequest) -> Plan {
    plan(request, |_, _| {}).unwrap()
}

#[test]
fn planned_interval_matches_virtual_ropes() {
    let candidates = vec![test(100.0, 23.0, 5100.0), test(200.0, 23.0, 5100.0)];
    let mut asked = request(100.0, 23.0, candidates);
    asked.tests = 2;
    // Within the duration of the tests: only the parameters' uncertainty remains.
    asked.duty.times_s = vec![5100.0];
    let plan = planned(&asked);
    // A test narrows the interval, and one without an effect is not planned.
    let widths: Vec<f64> = plan.tests.iter().map(|t| t.half_width_share).collect();
    assert!(widths[0] < 0.5 * plan.half_width_share, "{plan:?}");
    assert!(widths.windows(2).all(|w| w[1] < 0.98 * w[0]), "{plan:?}");
    let promised = widths[widths.len() - 1];
    let check = check_plan(&plan, &asked, 12, |_| {}).unwrap();
    println!("promised {promised:.3}, found {check:?}");
    assert_eq!((check.ropes, check.failed), (12, 0));
    // Of twelve at 95 %, two outside have a probability of one in nine, four of one in 500.
    assert!(check.inside >= 9, "{check:?}");
    // Linearised, a mean over few ropes, against a median: tolerance of one third.
    let ratio = check.half_width_share / promised;
    assert!((0.67..1.5).contains(&ratio), "{ratio}");
}

#[test]
fn test_is_selected_at_conditions_of_duty() {
    let at = |temperature_c: f64| test(100.0, temperature_c, 5100.0);
    for celsius in [23.0, 45.0] {
        let plan = planned(&request(100.0, celsius, vec![at(23.0), at(45.0)]));
        assert_eq!(plan.tests[0].test.temperature_c, celsius, "{plan:?}");
        assert_eq!(plan.tests[0].candidates.len(), 2);
    }
    let load = |n: f64| test(n, 23.0, 5100.0);
    for newtons in [40.0, 400.0] {
        let plan = planned(&request(newtons, 23.0, vec![load(40.0), load(400.0)]));
        assert_eq!(plan.tests[0].test.load_n, newtons, "{plan:?}");
    }
    // For a duty of a month, a longer test is more informative than a shorter one, if the bench
    // time allows.
    let mut asked = request(
        100.0,
        23.0,
        vec![test(100.0, 23.0, 5100.0), test(100.0, 23.0, DAY_S)],
    );
    assert_eq!(planned(&asked).tests[0].test.loaded_s, DAY_S);
    asked.bench_s = DAY_S;
    assert_eq!(planned(&asked).tests[0].test.loaded_s, 5100.0);
}

#[test]
fn repeated_test_adds_little() {
    let mut asked = request(100.0, 23.0, vec![test(100.0, 23.0, 5100.0)]);
    let fresh = planned(&asked);
    let law = sinew_rope::law::Law::new(crate::support::bench::truth()).unwrap();
    let mut random = rand::SeedableRng::seed_from_u64(5);
    asked.existing = vec![crate::support::bench::record(
        *law.parameters(),
        crate::support::bench::Test {
            load_n: 100.0,
            celsius: 23.0,
            loaded_s: 5100.0,
            after_s: 2550.0,
        },
        SIGMA,
        &mut random,
    )];
    let again = planned(&asked);
    assert_eq!(again.existing, 1);
    // The existing record is as informative as the first test; a repeat only averages measurements.
    let first = fresh.tests[0].half_width_share;
    assert!(
        (again.half_width_share / first - 1.0).abs() < 0.1,
        "{again:?} {first}"
    );
    let left = again.tests[0].half_width_share;
    assert!(
        left <= again.half_width_share && left > 0.7 * first,
        "{again:?}"
    );
}

#[test]
fn infeasible_plans_are_rejected() {
    let mut asked = request(100.0, 23.0, vec![test(100.0, 23.0, 5100.0)]);
    asked.bench_s = 3600.0;
    let text = plan(&asked, |_, _| {}).unwrap_err().to_string();
    assert!(
        text.contains("no test fits into 1.0 h on the bench"),
        "{text}"
    );
    let broken = request(4400.0, 60.0, vec![test(100.0, 23.0, 5100.0)]);
    let text = plan(&broken, |_, _| {}).unwrap_err().to_string();
    assert!(text.starts_with("no plan: "), "{text}");
    // A test that breaks every rope is not a candidate.
    let heavy = request(100.0, 23.0, vec![test(9000.0, 23.0, 5100.0)]);
    assert!(plan(&heavy, |_, _| {}).is_err());
}
