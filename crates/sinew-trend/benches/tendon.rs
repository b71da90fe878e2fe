//! Computing time of the trend of one tendon of a fleet with daily sessions of two years: the draws of its rope, the
//! trend from its first session, the same with the state after each session, and one more session.
//!
//! `cargo bench -p sinew-trend --bench tendon`

use criterion::{Criterion, criterion_group, criterion_main};
use sinew_model::Gaussian;
use sinew_model::transmission::Tendon;
use sinew_rope::Catalogue;
use sinew_trend::fleet::{FleetTendon, RopePriors, trend_of_tendon};
use sinew_trend::{SessionRecord, TrendRequest, analyze_joint};
use std::hint::black_box;

const DAY_S: f64 = 86_400.0;
const DAYS: u32 = 730;

fn tendon() -> Tendon {
    Tendon {
        rope: Some("liros-dc000-0301".into()),
        length_m: 0.7,
        joint_pulley_radius_m: 0.025,
        pretension_n: Some(60.0),
        ..Tendon::default()
    }
}

/// Creep by the logarithm of time with a scatter of 0.15 mrad and a drift; half of a year later a new baseline.
fn sessions() -> Vec<SessionRecord> {
    (0..DAYS)
        .map(|day| {
            let t = f64::from(day);
            let wave = (2.4 * t).sin() + (0.7 * t).cos();
            let rebased = day >= 182;
            let creep = |t: f64| 1.5e-3 * (1.0 + 24.0 * t).log10();
            let zero = if rebased { creep(182.0) } else { 0.0 };
            SessionRecord {
                time_utc_s: 1.75e9 + (t + 0.3) * DAY_S,
                duration_s: Some(120.0),
                joint: "elbow".into(),
                baseline: Some(if rebased { "second" } else { "first" }.into()),
                offset_rad: Some(Gaussian::new(creep(t) - zero + 0.1e-3 * wave, 0.35e-3)),
                temperature_c: Some(22.0 + 3.0 * (1.3 * t).sin()),
                stiffness_ratio: Some(Gaussian::new(0.004 * wave, 0.02)),
                ..SessionRecord::default()
            }
        })
        .collect()
}

fn trends(c: &mut Criterion) {
    let (tendon, sessions) = (tendon(), sessions());
    let of = FleetTendon {
        joint: "elbow",
        robot: None,
        tendon: Some(&tendon),
        events: &[],
    };
    let priors = || RopePriors::new(Catalogue::shipped().expect("shipped"));
    let shared = priors();
    let (_, before) = sessions.split_last().expect("two years");
    let kept = trend_of_tendon(of, before, &shared, None, None)
        .expect("a trend")
        .kept;
    let request = TrendRequest {
        robot: None,
        catalogue: shared.catalogue(),
        stated: Vec::new(),
        duty: None,
        life: None,
        horizon_days: 365.0,
        seed: 1,
    };
    let mut group = c.benchmark_group("tendon");
    group.sample_size(10);
    group.bench_function("draws of its rope", |b| {
        b.iter(|| priors().of(Some(black_box(&tendon)), 22.0).expect("a rope"));
    });
    group.bench_function("from the first session", |b| {
        b.iter(|| trend_of_tendon(of, black_box(&sessions), &shared, None, None).expect("a trend"));
    });
    group.bench_function("one more session", |b| {
        b.iter(|| {
            let kept = Some(kept.clone());
            trend_of_tendon(of, black_box(&sessions), &shared, None, kept).expect("a trend")
        });
    });
    group.bench_function("all sessions, with the state after each", |b| {
        b.iter(|| analyze_joint("elbow", black_box(&sessions), &request).expect("a trend"));
    });
    group.finish();
}

criterion_group!(benches, trends);
criterion_main!(benches);
