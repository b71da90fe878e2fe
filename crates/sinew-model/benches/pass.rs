//! Time of the O(n) momentum pass, and of what a simulator needs besides, at 4 to 32 joints.
//!
//! `cargo bench -p sinew-model --bench pass`; comparison with other engines:
//! `benches/peers/run.py`.

mod own_models;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use sinew_model::arm::ArmWorkspace;
use std::hint::black_box;

fn passes(c: &mut Criterion) {
    let mut group = c.benchmark_group("momentum pass");
    for (n, arm, samples) in own_models::moving_arms() {
        let mut ws = ArmWorkspace::new(&arm);
        let mut samples = samples.iter().cycle();
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                let (q, dq) = samples.next().expect("a cycle has no end");
                let terms = arm.momentum(&mut ws, black_box(q), black_box(dq));
                black_box(terms.expect("finite").p.len())
            });
        });
    }
    group.finish();

    let mut group = c.benchmark_group("forward dynamics");
    for (n, arm, samples) in own_models::moving_arms() {
        let mut ws = ArmWorkspace::new(&arm);
        let (tau, mut ddq) = (vec![0.0; n], vec![0.0; n]);
        let mut samples = samples.iter().cycle();
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                let (q, dq) = samples.next().expect("a cycle has no end");
                arm.forward_dynamics(&mut ws, black_box(q), black_box(dq), &tau, &mut ddq)
                    .expect("a physical arm");
            });
        });
    }
    group.finish();
}

criterion_group!(benches, passes);
criterion_main!(benches);
