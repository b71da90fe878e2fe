//! Online estimate in a loop at 1 kHz: duration of single steps at 1 to 17 joints, processor share of the worker, and
//! memory of the window and the program.
//!
//! `cargo bench -p sinew-estimate --bench online [-- JOINTS …]`
//!
//! The worker runs in a separate thread, and the loop spins until it has finished, as a recording is faster than a
//! robot. This time is not part of a step. Times include 20 to 50 ns of the clock, and other load of the computer.

#[path = "../../sinew-model/benches/own_models/mod.rs"]
mod own_models;

use cpu_time::ProcessTime;
use sinew_estimate::executor::Alone;
use sinew_estimate::online::{OnlineEstimator, OnlineWorker, StepOutcome};
use sinew_estimate::robot_dir;
use sinew_estimate::session::SessionOptions;
use sinew_model::arm::Arm;
use sinew_model::robot::Robot;
use std::fmt::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Period of the loop, s.
const DT_S: f64 = 1e-3;
/// Duration of the motion of a measurement, longer than a window, s.
const DURATION_S: f64 = 150.0;
/// Duration of the motion in a test of the bench, s.
const TEST_DURATION_S: f64 = 3.0;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let lasts_s = match arguments.iter().any(|a| a == "--bench") {
        true => DURATION_S,
        false => TEST_DURATION_S,
    };
    let wanted: Vec<usize> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    println!(
        "{:>6} | {:>10} {:>8} {:>8} {:>8} {:>8} | {:>8} {:>10} {:>10}",
        "joints",
        "median, µs",
        "99.9 %",
        "99.99 %",
        "slowest",
        "worker",
        "blocks",
        "window, MB",
        "in all, MB"
    );
    for (n, arm, motion) in own_models::moving_arms() {
        if n <= 17 && (wanted.is_empty() || wanted.contains(&n)) {
            measure(&robot(&arm), &motion, lasts_s);
        }
    }
}

/// Robot with a tendon at every joint.
fn robot(arm: &Arm) -> Robot {
    let folder = tempfile::tempdir().expect("a folder");
    let mut toml = String::from("urdf = \"arm.urdf\"\n");
    for name in arm.joint_names() {
        let _written = writeln!(
            toml,
            "[joints.{name}]\nstiffness_nm_per_rad = 40.0\nmotor_inertia_kg_m2 = 0.1"
        );
    }
    std::fs::write(folder.path().join("robot.toml"), toml).expect("written");
    let urdf = own_models::urdf_of(arm.dof()).expect("our own model");
    std::fs::write(folder.path().join("arm.urdf"), urdf).expect("written");
    robot_dir::load(folder.path(), None).expect("a robot").robot
}

fn measure(robot: &Robot, motion: &own_models::Motion, lasts_s: f64) {
    let n = robot.arm.dof();
    let before = resident_bytes();
    let options = SessionOptions::default();
    let online = OnlineEstimator::new(robot.clone(), None, &options, "loop");
    let mut online = online.expect("an estimator");
    let worker = online.take_worker().expect("its worker");
    let samples = (lasts_s / DT_S) as usize;
    let mut times = Vec::with_capacity(samples);
    let mut theta = vec![0.0; n];
    let (asked, done) = (AtomicU64::new(0), AtomicU64::new(0));
    let (worker, worked) = std::thread::scope(|scope| {
        let working = scope.spawn(|| worked_when(&asked, &done, worker));
        for k in 0..samples {
            let (q, _) = &motion[k % motion.len()];
            for (i, (theta, q)) in theta.iter_mut().zip(q).enumerate() {
                *theta = q + 0.005 + 1e-4 * (0.07 * k as f64 * (1.0 + 0.3 * i as f64)).sin();
            }
            let start = Instant::now();
            let outcome = online.step(DT_S, q, &theta, &[], 20.0);
            std::hint::black_box(online.answer());
            times.push(start.elapsed().as_nanos() as u64);
            if outcome.expect("a good sample") == StepOutcome::Block {
                let wanted = asked.fetch_add(1, Ordering::AcqRel) + 1;
                while done.load(Ordering::Acquire) < wanted {
                    std::hint::spin_loop();
                }
            }
        }
        asked.store(u64::MAX, Ordering::Release);
        working.join().expect("a worker that ends")
    });
    assert_eq!(online.blocks_dropped(), 0);
    times.sort_unstable();
    let at = |share: f64| {
        let place = ((times.len() - 1) as f64 * share) as usize;
        times.get(place).copied().unwrap_or(0) as f64 * 1e-3
    };
    let (blocks, window_bytes) = worker.window().size();
    let all_bytes = resident_bytes().saturating_sub(before);
    println!(
        "{n:>6} | {:>10.2} {:>8.2} {:>8.2} {:>8.2} {:>6.2} % | {blocks:>8} {:>10.2} {:>10.2}",
        at(0.5),
        at(0.999),
        at(0.9999),
        at(1.0),
        1e2 * worked.as_secs_f64() / lasts_s,
        1e-6 * window_bytes as f64,
        1e-6 * all_bytes as f64,
    );
}

/// Runs the worker for each request until [`u64::MAX`]; returns the worker, and the processor time of its thread and
/// its helpers.
fn worked_when(
    requested: &AtomicU64,
    done: &AtomicU64,
    mut worker: Box<OnlineWorker>,
) -> (Box<OnlineWorker>, Duration) {
    let mut worked = Duration::ZERO;
    // As `OnlineEstimator::start_worker` does.
    let _alone = Alone::new();
    loop {
        match requested.load(Ordering::Acquire) {
            u64::MAX => return (worker, worked),
            request if request > done.load(Ordering::Acquire) => {
                // The loop spins meanwhile: its time is subtracted.
                let (processor, clock) = (ProcessTime::now(), Instant::now());
                worker.work();
                worked += processor.elapsed().saturating_sub(clock.elapsed());
                done.store(request, Ordering::Release);
            }
            _ => std::hint::spin_loop(),
        }
    }
}

/// Memory of this program as reported by Linux, bytes; 0 on other systems.
fn resident_bytes() -> u64 {
    const PAGE: u64 = 4096;
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split_whitespace().nth(1).and_then(|p| p.parse().ok());
    PAGE * pages.unwrap_or(0_u64)
}
