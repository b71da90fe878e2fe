//! Coverage of intervals and forecasts of creep fits: the tables of docs/src/science/creep.md.
//!
//! `cargo run --release -p sinew-creep --example coverage -- TABLE [SEEDS]`; TABLE is `laws`, `rope`, `one-load`, `sampled` or
//! `decades`.

#[path = "../tests/support/mod.rs"]
#[allow(dead_code, reason = "tests use more of it")]
mod support;

use sinew_creep::*;
use sinew_rope::law::Parameters;
use std::process::ExitCode;
use support::bench::{
    COLD, SIGMA, by_name, options, records_of, sampled, scores, truth_of, truth_of_one_load,
};
use support::laws::KNOWN;
use support::outside::{END_S, Family, forecast_and_truth};
use support::score::{Scores, heading};

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let seeds = |ordinary: u64| {
        let specified = args.get(1).and_then(|s| s.parse().ok());
        specified.unwrap_or(ordinary)
    };
    match args.first().map(String::as_str) {
        Some("laws") => laws(seeds(1000)),
        Some("rope") => rope(seeds(300), truth_of, |seed| {
            records_of(truth_of(seed), &COLD, SIGMA, 100 + seed)
        }),
        Some("one-load") => rope(seeds(300), truth_of_one_load, |seed| {
            records_of(truth_of_one_load(seed), &COLD[..1], SIGMA, 900 + seed)
        }),
        Some("sampled") => rope(seeds(300), truth_of, |seed| {
            let test = |(i, t): (u64, &support::bench::Test)| {
                sampled(truth_of(seed), *t, 30.0, SIGMA, 7000 + 10 * seed + i).curve
            };
            (0..).zip(&COLD).map(test).collect()
        }),
        Some("decades") => decades(seeds(100)),
        // `cargo test --examples` only checks that it runs.
        None => println!("{}", heading()),
        Some(other) => {
            eprintln!(
                "table '{other}' not found; available: laws, rope, one-load, sampled, decades"
            );
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

/// Coverage of parameters of laws that generated the records.
fn laws(seeds: u64) {
    println!("{}", heading());
    for known in &KNOWN {
        for (scores, (name, _)) in known.scores(seeds).iter().zip(known.numbers) {
            println!("{}", scores.row(&format!("{} {name}", known.law.name())));
        }
    }
}

/// Coverage of parameters of the rope law that generated the records.
fn rope(
    seeds: u64,
    truth: impl Fn(u64) -> Parameters + Sync,
    curves: impl Fn(u64) -> Vec<Curve> + Sync,
) {
    let numbers: Vec<u64> = (0..seeds).collect();
    let rows = each(
        &numbers,
        |&seed| {
            fit(Law::Rope, &curves(seed), &options(seed))
                .map_or_else(|_| Vec::new(), |found| scores(&found, &truth(seed)))
        },
        |_| {},
    );
    println!("{}", heading());
    let mut all = Scores::default();
    for (name, own) in by_name(rows) {
        println!("{}", own.row(name));
        all.append(own);
    }
    println!("{}", all.row("all"));
}

/// Coverage of forecasts by all laws of curves that none of them generated, over decades of time.
fn decades(seeds: u64) {
    // Ten, a hundred and a thousand times the record, and a year.
    const YEAR_S: f64 = 365.25 * 86_400.0;
    let later = [10.0 * END_S, 100.0 * END_S, 1000.0 * END_S, YEAR_S];
    println!(
        "{:18} {:>6} {:>22} {:>34}",
        "family", "of", "inside, % at ×10, 100, 1000, a year", "median half width, % of the creep"
    );
    for family in Family::ALL {
        let numbers: Vec<u64> = (0..seeds).collect();
        let rows = each(
            &numbers,
            |&seed| forecast_and_truth(family, seed, &later),
            |_| {},
        );
        let rows: Vec<_> = rows.into_iter().flatten().collect();
        let n = rows.len() as f64;
        let inside = [0, 1, 2, 3].map(|i| {
            let held = rows.iter().filter(|(f, truth)| {
                f.low_strain_ratio[i] <= truth[i] && truth[i] <= f.high_strain_ratio[i]
            });
            100.0 * held.count() as f64 / n
        });
        let width = [0, 1, 2, 3].map(|i| {
            let mut widths: Vec<f64> = rows
                .iter()
                .map(|(f, _)| 0.5 * (f.high_strain_ratio[i] - f.low_strain_ratio[i]) / 1e-3)
                .collect();
            widths.sort_by(f64::total_cmp);
            100.0 * widths[widths.len() / 2]
        });
        println!(
            "{:18} {:6} {:6.1} {:6.1} {:6.1} {:6.1}    {:6.0} {:6.0} {:6.0} {:6.0}",
            family.name(),
            rows.len(),
            inside[0],
            inside[1],
            inside[2],
            inside[3],
            width[0],
            width[1],
            width[2],
            width[3]
        );
    }
}
