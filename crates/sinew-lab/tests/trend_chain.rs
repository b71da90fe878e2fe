//! The errors of a daily session, measured on the whole chain: what the surrogate of the simulated years
//! is made of.
//!
//! `SINEW_CHAIN=2 SINEW_DAYS=40 cargo test --release -p sinew-lab --test trend_chain -- --nocapture`
//! prints the statistics of so many robots and sessions; the ordinary run makes do with two sessions.

use sinew_lab::robot_dir;
use sinew_lab::trend::year::chain::{Chain, Day};
use sinew_lab::trend::year::surrogate::Failure;
use std::path::Path;

fn number(name: &str) -> Option<usize> {
    std::env::var(name).ok().and_then(|s| s.parse().ok())
}

#[test]
fn a_days_session_finds_what_the_tendons_have_become() {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/biorob-like");
    let robot = robot_dir::load(&place, None).unwrap().robot;
    let folder = tempfile::tempdir().unwrap();
    let (robots, days) = (
        number("SINEW_CHAIN").unwrap_or(1),
        number("SINEW_DAYS").unwrap_or(2),
    );
    let joints = ["shoulder_pitch", "elbow"];
    // Errors by joint: robot, day, warming, error, stated half width, failed.
    let mut rows: Vec<[Vec<[f64; 3]>; 2]> = Vec::new();
    for seed in 0..robots as u64 {
        let chain = Chain::new(&robot, &place, folder.path(), 500 + seed, 21.0).unwrap();
        let mut own = [Vec::new(), Vec::new()];
        for i in 0..days {
            let warm = 7.0 * (i as f64 * 2.399).sin();
            let failed = (i >= days / 2).then(|| {
                let failure = Failure {
                    day: 0,
                    size_mrad: 3.0,
                    stiffness_percent: 6.0,
                };
                ("shoulder_pitch".to_string(), failure)
            });
            let creep = 1e-3 * (5.0 + 0.1 * i as f64);
            let day = Day {
                day: i + 1,
                offsets_rad: joints.map(|j| (j.to_string(), creep)).to_vec(),
                temperature_c: 21.0 + warm,
                failed: failed.clone(),
            };
            let said = chain.session(&day).unwrap();
            for (joint, own) in joints.iter().zip(&mut own) {
                let found = said.joints.iter().find(|j| j.name == *joint).unwrap();
                let jump = match &failed {
                    Some((j, f)) if j == joint => f.size_mrad,
                    _ => 0.0,
                };
                let error = found.offset_mrad - 1e3 * creep - jump;
                println!(
                    "robot {seed} day {:3} {warm:+5.1} K {joint}: {error:+.3} ± {:.3} mrad{}",
                    i + 1,
                    found.interval_95_mrad,
                    if failed.is_some() {
                        ", strand failed"
                    } else {
                        ""
                    }
                );
                own.push([warm, error, found.interval_95_mrad]);
                // A failed strand's stiffness reads as offset; that is what is measured here.
                let bound = 3.0 * found.interval_95_mrad.max(0.5);
                assert!(
                    failed.is_some() || error.abs() < bound,
                    "{joint}: {error} {bound}"
                );
            }
        }
        rows.push(own);
    }
    for (k, joint) in joints.iter().enumerate() {
        for (seed, own) in rows.iter().enumerate() {
            statistics(&format!("robot {seed} {joint}"), &own[k], days / 2);
        }
    }
}

/// Mean, drift and scatter before the failure, and what the failure's stiffness adds.
fn statistics(name: &str, rows: &[[f64; 3]], half: usize) {
    let n = half as f64;
    if half < 3 {
        return;
    }
    let mean = |f: &dyn Fn(&[f64; 3]) -> f64, r: &[[f64; 3]]| {
        r.iter().map(f).sum::<f64>() / r.len() as f64
    };
    let before = &rows[..half];
    let (mw, me) = (mean(&|r| r[0], before), mean(&|r| r[1], before));
    let drift =
        mean(&|r| (r[0] - mw) * (r[1] - me), before) / mean(&|r| (r[0] - mw).powi(2), before);
    let left: Vec<f64> = before
        .iter()
        .map(|r| r[1] - me - drift * (r[0] - mw))
        .collect();
    let scatter = (left.iter().map(|e| e * e).sum::<f64>() / (n - 2.0)).sqrt();
    let neighbours = left.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / (n * scatter * scatter);
    let after = mean(&|r| r[1] - drift * (r[0] - mw), &rows[half..]) - me;
    println!(
        "{name}: mean {me:+.2}, drift {drift:+.3} mrad/K, scatter {scatter:.2} mrad, \
         neighbours {neighbours:+.2}, stated ± {:.2}, failure adds {after:+.2}",
        mean(&|r| r[2], rows)
    );
}
