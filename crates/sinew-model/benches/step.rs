//! Time of an observer step and of a full offset step at 4 to 32 joints, with the slowest step.
//!
//! `cargo bench -p sinew-model --bench step`

mod own_models;
#[path = "../tests/support/routed.rs"]
mod routed;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use sinew_model::arm::ArmWorkspace;
use sinew_model::feeder::{Feeder, FeederOptions, RobotSample};
use sinew_model::observer::MomentumObserver;
use sinew_model::offset::{FeatureConfig, FeatureObserver, OffsetConfig, OffsetObserver, Sample};
use sinew_model::transmission::Transmission;
use std::hint::black_box;
use std::time::Instant;

/// A control loop's period, s.
const DT_S: f64 = 1e-3;

fn observer_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("observer step (pass and exact pole)");
    for (n, arm, samples) in own_models::moving_arms() {
        let mut ws = ArmWorkspace::new(&arm);
        let mut observer = MomentumObserver::new(&vec![20.0; n]).expect("a gain");
        let mut alpha = vec![0.0; n];
        let mut samples = samples.iter().cycle();
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                let (q, dq) = samples.next().expect("a cycle has no end");
                let terms = arm.momentum(&mut ws, black_box(q), black_box(dq));
                let terms = terms.expect("finite");
                for (alpha, (c, g)) in alpha.iter_mut().zip(terms.ct_dq.iter().zip(terms.g)) {
                    *alpha = c - g;
                }
                observer
                    .step(DT_S, terms.p, &alpha, None)
                    .expect("a good sample");
            });
        });
    }
    group.finish();
}

fn offset_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("offset step (filters, pass, observer, comparison)");
    for (n, arm, samples) in own_models::moving_arms() {
        let transmissions = vec![Some(Transmission::spring(40.0)); n];
        let mut offset = OffsetObserver::new(&arm, &transmissions, OffsetConfig::default())
            .expect("a configuration");
        let mut all = samples.iter().cycle();
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                let (q, _) = all.next().expect("a cycle has no end");
                let sample = Sample {
                    q: black_box(q),
                    theta_measured: black_box(q),
                    ..Default::default()
                };
                offset.step(DT_S, &sample).expect("a good sample");
            });
        });
        print_slowest(n, &mut offset, &samples);
    }
    group.finish();
}

/// Blocks of the absolute estimate, a sample at a time, from joints with tendons of their own and from routed ones.
fn feature_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("feeder and feature step");
    for (n, arm, samples) in own_models::moving_arms() {
        let own = vec![Some(Transmission::spring(40.0)); n];
        for (name, transmissions) in [("own tendons", own), ("routed tendons", routed::routed(n))] {
            let features = FeatureObserver::new(&arm, FeatureConfig::default())
                .with_transmissions(&transmissions);
            let mut feeder = Feeder::new(features, &transmissions, FeederOptions::default());
            let mut all = samples.iter().cycle();
            let torque = vec![0.3; n];
            let mut time_ns = 0;
            group.bench_function(BenchmarkId::new(name, n), |b| {
                b.iter(|| {
                    let (q, _) = all.next().expect("a cycle has no end");
                    time_ns += 1_000_000;
                    feeder.take(&RobotSample {
                        time_ns,
                        segment: 0,
                        q: black_box(q),
                        theta: black_box(q),
                        dq: &[],
                        tau_el: &[],
                        tau_m: &torque,
                        tau_ext: &[],
                        tension: &[],
                        temperature_c: 20.0,
                    })
                });
            });
        }
    }
    group.finish();
}

/// Prints the slowest steps, which matter more to a control loop than the mean; the clock's 20–50 ns are included.
fn print_slowest(n: usize, offset: &mut OffsetObserver, samples: &own_models::Motion) {
    let mut times: Vec<u128> = Vec::with_capacity(100_000);
    for (q, _) in samples.iter().cycle().take(times.capacity()) {
        let sample = Sample {
            q,
            theta_measured: q,
            ..Default::default()
        };
        let start = Instant::now();
        offset.step(DT_S, &sample).expect("a good sample");
        times.push(start.elapsed().as_nanos());
    }
    times.sort_unstable();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!(
        "offset step, {n} joints, {} single steps: half within {} ns, 99 % within {} ns, 99.99 % within {} ns, slowest {} ns",
        times.len(),
        at(0.5),
        at(0.99),
        at(0.9999),
        at(1.0)
    );
}

criterion_group!(benches, observer_step, offset_step, feature_step);
criterion_main!(benches);
