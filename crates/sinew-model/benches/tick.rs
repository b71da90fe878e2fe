//! The recursive estimate in a loop at 1 kHz: how long single calls take at 1 to 32 joints, a block's work at once and in
//! slices, over a million samples each, and how large its state is.
//!
//! `cargo bench -p sinew-model --bench tick [-- JOINTS …]`
//!
//! `SINEW_SAMPLES` states another number of samples. Every 60 s something leans on the arm for 20 s, so that the second filter goes over the last blocks each time: that is the most
//! a block takes. Times hold the clock's 20–50 ns, and whatever else the machine did meanwhile.

mod own_models;

use sinew_model::arm::Arm;
use sinew_model::arm::urdf;
use sinew_model::offset::{
    ExternalForce, FeatureConfig, FeatureObserver, MapEstimator, OffsetConfig, OffsetObserver,
    Payload, Prior, RecursiveOffsets, Sample, UNKNOWN_OFFSET_RAD,
};
use sinew_model::tolerances::Tolerances;
use sinew_model::transmission::Transmission;
use std::time::Instant;

/// A control loop's period, s.
const DT_S: f64 = 1e-3;
/// Samples of a measurement.
const SAMPLES: usize = 1_000_000;
/// Enough to see that the bench runs.
const FEW: usize = 1_000;

const ONE_JOINT: &str = r#"<robot name="one"><link name="base"/><link name="link"><inertial><origin xyz="0 0 0.2"/>
<mass value="1.5"/><inertia ixx="0.02" iyy="0.02" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="joint" type="revolute"><parent link="base"/><child link="link"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="10" velocity="5"/></joint></robot>"#;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let stated = std::env::var("SINEW_SAMPLES")
        .ok()
        .and_then(|s| s.parse().ok());
    let samples = match arguments.iter().any(|a| a == "--bench") {
        true => stated.unwrap_or(SAMPLES),
        false => FEW,
    };
    let wanted: Vec<usize> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let one = urdf::parse(ONE_JOINT, &urdf::UrdfOptions::default()).expect("a model");
    let arms = own_models::moving_arms().map(|(n, arm, _)| (n, arm));
    println!("{samples} samples each; times in µs; observer: its median step");
    println!(
        "{:>6} {:>9} {:>8} {:>10} | {:>6} {:>8} {:>8} {:>8} {:>9} {:>8}",
        "joints",
        "state kB",
        "observer",
        "work",
        "slices",
        "median",
        "99 %",
        "99.99 %",
        "slowest",
        "ratio"
    );
    for (n, arm) in std::iter::once((1, one.arm)).chain(arms) {
        if wanted.is_empty() || wanted.contains(&n) {
            measure(n, &arm, samples);
        }
    }
}

fn measure(n: usize, arm: &Arm, samples: usize) {
    let observer = observer_us(n, arm, samples.min(20_000));
    let made = filter(n, arm);
    let before = resident_bytes();
    let kept = made.clone();
    let state = resident_bytes().saturating_sub(before);
    let sliced = made
        .slices_per_block()
        .div_ceil((FeatureConfig::default().block_s / DT_S) as usize);
    for slices in [None, Some(sliced)] {
        let mut filter = kept.clone();
        let mut times = calls(n, arm, &mut filter, (samples, slices));
        times.sort_unstable();
        let at = |share: f64| {
            let place = (times.len() - 1) as f64 * share;
            times.get(place as usize).copied().unwrap_or(0) as f64 * 1e-3
        };
        println!(
            "{n:>6} {:>9.0} {observer:>8.2} {:>10} | {:>6} {:>8.2} {:>8.2} {:>8.2} {:>9.2} {:>8.1}",
            state as f64 * 1e-3,
            if slices.is_some() {
                "in slices"
            } else {
                "at once"
            },
            slices.unwrap_or(made.slices_per_block()),
            at(0.5),
            at(0.99),
            at(0.9999),
            at(1.0),
            at(0.9999) / observer,
        );
        println!(
            "       offset of joint 0: {:.17e} rad",
            filter.offset(0).mean
        );
    }
}

fn transmissions(n: usize) -> Vec<Option<Transmission>> {
    let mut spring = Transmission::spring(40.0);
    spring.motor_inertia_kg_m2 = Some(0.1);
    vec![Some(spring); n]
}

fn filter(n: usize, arm: &Arm) -> RecursiveOffsets {
    let transmissions = transmissions(n);
    // As after a baseline: which joints have lost stiffness is asked, too.
    let tolerances = Tolerances {
        stiffness: 0.02,
        ..Tolerances::default()
    };
    let prior = Prior::new(arm, &transmissions, n - 1, [0.0; 3], tolerances);
    let start = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    // As of a robot whose robot.toml says nothing of forces.
    let force = ExternalForce::possible(tolerances.external_force_n);
    let estimator =
        MapEstimator::new(prior, &FeatureConfig::default()).with_external_force(arm, force);
    RecursiveOffsets::new(estimator, start).expect("a prior")
}

/// A smooth motion, and motor positions with an offset, a push now and then and some noise.
fn motion(k: usize, q: &mut [f64], theta: &mut [f64]) {
    let t = DT_S * k as f64;
    let pushed = if t % 60.0 > 40.0 { 0.1 } else { 0.0 };
    for (i, (q, theta)) in q.iter_mut().zip(theta).enumerate() {
        let rate = 1.0 + 0.3 * i as f64;
        *q = 0.5 * (rate * t).sin();
        *theta = *q + 0.005 + pushed + 1e-4 * (7.0 * rate * t).sin();
    }
}

/// Nanoseconds of every call: a sample, and what of the estimate's work falls to it.
fn calls(
    n: usize,
    arm: &Arm,
    filter: &mut RecursiveOffsets,
    (samples, slices): (usize, Option<usize>),
) -> Vec<u64> {
    let mut features = FeatureObserver::new(arm, FeatureConfig::default());
    let (mut q, mut theta, torque) = (vec![0.0; n], vec![0.0; n], vec![0.4; n]);
    let mut times = Vec::with_capacity(samples);
    for k in 0..samples {
        motion(k, &mut q, &mut theta);
        let start = Instant::now();
        let complete = features.step(DT_S, &q, &theta, &torque, 20.0);
        if complete.expect("a good sample") {
            match slices {
                None => drop(filter.step(features.block()).expect("a block")),
                Some(_) => assert!(filter.begin(features.block()).expect("a block")),
            }
        }
        filter.advance(slices.unwrap_or(0));
        times.push(start.elapsed().as_nanos() as u64);
    }
    filter.finish();
    times
}

/// Median step of the offset observer, which a loop runs anyway, µs.
fn observer_us(n: usize, arm: &Arm, samples: usize) -> f64 {
    let mut offset = OffsetObserver::new(arm, &transmissions(n), OffsetConfig::default())
        .expect("a configuration");
    let (mut q, mut theta) = (vec![0.0; n], vec![0.0; n]);
    let mut times = Vec::with_capacity(samples);
    for k in 0..samples {
        motion(k, &mut q, &mut theta);
        let start = Instant::now();
        let sample = Sample {
            q: &q,
            theta_measured: &theta,
            ..Default::default()
        };
        offset.step(DT_S, &sample).expect("a good sample");
        times.push(start.elapsed().as_nanos());
    }
    times.sort_unstable();
    times.get(samples / 2).copied().unwrap_or(0) as f64 * 1e-3
}

/// Memory of this program, as Linux counts it; 0 elsewhere.
fn resident_bytes() -> u64 {
    const PAGE: u64 = 4096;
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split_whitespace().nth(1).and_then(|p| p.parse().ok());
    PAGE * pages.unwrap_or(0_u64)
}
