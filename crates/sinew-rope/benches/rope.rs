//! Computing time of the rope law: a year of one-minute steps under varying and under constant load, one step, one
//! ramp, and a duty of two blocks with a ramp over a year and over a century.
//!
//! `cargo bench -p sinew-rope --bench rope`

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sinew_rope::history::History;
use sinew_rope::law::entry::CatalogueEntry;
use sinew_rope::law::{Law, RopeLoad, State, ramp};
use sinew_rope::predict::YEAR_S;
use sinew_rope::{Duty, Stretch};
use std::hint::black_box;

const ROPE: &str = include_str!("../ropes/liros-dc000-0301.toml");
const MINUTES_PER_YEAR: usize = 525_600;

fn law() -> Law {
    let entry = CatalogueEntry::parse(ROPE, "liros-dc000-0301.toml").expect("shipped");
    Law::new(entry.parameters().expect("complete")).expect("a rope")
}

/// Tension changes every minute, temperature with the hour.
fn minutes(count: usize) -> Vec<RopeLoad> {
    let mut x = 1u64;
    (0..count)
        .map(|i| {
            // Knuth's congruential generator: any spread will do.
            x = x
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let u = (x >> 11) as f64 / (1u64 << 53) as f64;
            let day = (i as f64 / 1440.0 * std::f64::consts::TAU).sin();
            RopeLoad::celsius(40.0 + 400.0 * u, 25.0 + 15.0 * day)
        })
        .collect()
}

fn year(c: &mut Criterion) {
    let law = law();
    let loads = minutes(MINUTES_PER_YEAR);
    let mut group = c.benchmark_group("rope law");
    group.sample_size(10);
    group.throughput(Throughput::Elements(MINUTES_PER_YEAR as u64));
    group.bench_function("a year of one-minute steps", |b| {
        b.iter(|| {
            let mut state = State::default();
            for &load in &loads {
                law.hold(&mut state, black_box(load), 60.0).expect("a load");
            }
            state
        });
    });
    // Bedding-in continues at every step.
    for tension_n in [60.0, 200.0] {
        group.bench_function(format!("the same at {tension_n} N and 23 °C"), |b| {
            b.iter(|| {
                let mut state = State::default();
                for _ in 0..MINUTES_PER_YEAR {
                    let load = black_box(RopeLoad::at_reference(tension_n));
                    law.hold(&mut state, load, 60.0).expect("a load");
                }
                state
            });
        });
    }
    group.finish();
}

fn single(c: &mut Criterion) {
    let law = law();
    let mut group = c.benchmark_group("rope law, one");
    // A new rope: bedding-in at work, the dearest step there is.
    group.bench_function("step of a new rope", |b| {
        b.iter(|| {
            let mut state = State::default();
            law.hold(&mut state, black_box(RopeLoad::at_reference(60.0)), 60.0)
                .expect("a load");
            state
        });
    });
    group.bench_function("ramp of an hour, 60 to 200 N, 23 to 50 °C", |b| {
        b.iter(|| {
            let mut state = State::default();
            let (from, to) = (
                RopeLoad::celsius(60.0, 23.0),
                RopeLoad::celsius(200.0, 50.0),
            );
            ramp(&law, &mut state, black_box(from), black_box(to), 3600.0).expect("a load");
            state
        });
    });
    group.finish();
}

/// The cycle of a day and one of 15 s: the time must not grow with the number of cycles.
fn duty(c: &mut Criterion) {
    let law = law();
    let mut group = c.benchmark_group("duty of two blocks with a ramp");
    for (name, cycle_s) in [("a day", 86_400.0), ("15 s", 15.0)] {
        let load = |n: f64| RopeLoad::celsius(n, 40.0);
        let ramp = Stretch {
            from: load(60.0),
            to: load(90.5),
            duration_s: cycle_s / 3.0,
        };
        let duty = Duty {
            about: name.into(),
            stretches: vec![ramp, Stretch::hold(load(30.0), 2.0 * cycle_s / 3.0)],
            repeat: true,
        };
        for years in [1.0, 100.0] {
            group.bench_function(format!("cycle of {name}, {years} years"), |b| {
                b.iter(|| {
                    let mut history = History::new(&law, black_box(&duty), State::default());
                    history.at(years * YEAR_S).expect("a load")
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, year, single, duty);
criterion_main!(benches);
