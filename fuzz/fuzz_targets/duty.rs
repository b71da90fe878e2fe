//! Any text as a table of blocks, TOML or CSV: no panic, and a duty that makes sense.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_rope::Duty;

fuzz_target!(|text: &str| {
    let (kind, text) = text.split_at(text.chars().next().map_or(0, char::len_utf8));
    let duty = if kind == "c" {
        Duty::from_csv(text, "d.csv")
    } else {
        Duty::from_toml(text, "d.toml")
    };
    let Ok(duty) = duty else {
        return;
    };
    assert!(duty.stretches.iter().all(|s| s.duration_s > 0.0));
    let sum = duty.summary();
    assert!(sum.duration_s.is_finite());
    let within = |low: f64, mean: f64, high: f64| {
        let slack = 1e-9 * (1.0 + low.abs() + high.abs());
        low - slack <= mean && mean <= high + slack
    };
    assert!(within(
        sum.tension_min_n,
        sum.tension_mean_n,
        sum.tension_max_n
    ));
    assert!(within(
        sum.temperature_min_c,
        sum.temperature_mean_c,
        sum.temperature_max_c
    ));
});
