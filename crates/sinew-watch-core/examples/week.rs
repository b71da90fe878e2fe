//! Simulation of one week of robot operation in minutes:
//!
//! `cargo run --release -p sinew-watch-core --example week -- [DAYS [SEED]]`
//!
//! A robot works two shifts of four hours from Monday to Friday, with a payload and contacts, and rests between them;
//! at night it is switched off. Its ropes creep logarithmically. On the third day at 10:00 the elbow slips by 5 mrad;
//! on the fifth at 8:00 it is re-tensioned. Every night the monitor is killed and restarts from its stored state.
//!
//! The output lists error and coverage of the records, the alarms, processor time and memory at the end.

#[path = "../tests/support/mod.rs"]
mod support;

use sinew_log::Frame;
use sinew_watch_core::alarm::Condition;
use sinew_watch_core::command::CommandKind;
use sinew_watch_core::journal::Event;
use sinew_watch_core::{Instant, Record};
use std::time::Duration;
use support::{HZ, Harness, MONDAY_NS, Store, biorob_like, config, frames};

const ELBOW: usize = 2;
const SLIP_RAD: f64 = 5e-3;
const HOUR_S: f64 = 3600.0;
const DAY_S: f64 = 86_400.0;

/// Creep of every tendon per e-fold of time, rad.
const CREEP_RAD: [f64; 4] = [0.3e-3, 0.6e-3, 0.8e-3, 0.5e-3];
/// Offset of each tendon at the start of the week, rad.
const BEGAN_RAD: [f64; 4] = [2e-3, 6e-3, 8e-3, 3e-3];

/// Simulated ropes with creep, a slip and a re-tensioning.
struct Ropes {
    /// Times of the slip and of the re-tensioning of the elbow, s since the start of the week.
    slipped_s: f64,
    tensioned_s: f64,
}

impl Ropes {
    /// Offsets since the last tensioning, rad; ropes have crept for ten days before the week.
    fn offsets(&self, at_s: f64) -> [f64; 4] {
        let hours = |since_s: f64, at_s: f64| 1.0 + (at_s - since_s).max(0.0) / HOUR_S;
        let began_s = -10.0 * DAY_S;
        let folds = (hours(began_s, at_s) / hours(began_s, 0.0)).ln();
        let mut out = BEGAN_RAD;
        for (x, creep_rad) in out.iter_mut().zip(CREEP_RAD) {
            *x += creep_rad * folds;
        }
        if at_s >= self.tensioned_s {
            out[ELBOW] = CREEP_RAD[ELBOW] * hours(self.tensioned_s, at_s).ln();
        } else if at_s >= self.slipped_s {
            out[ELBOW] += SLIP_RAD;
        }
        out
    }

    /// Adds the offsets to the motor positions; a re-tensioning removes them.
    fn shift(&self, frame: &mut Frame, at_s: f64) {
        for (theta, x) in frame.theta.iter_mut().zip(self.offsets(at_s)) {
            *theta += x;
        }
    }
}

/// Errors of the records.
#[derive(Default)]
struct Score {
    conclusive: usize,
    inside: usize,
    inconclusive: usize,
    square: f64,
    worst: f64,
}

fn main() {
    let mut arguments = std::env::args()
        .skip(1)
        .map(|a| a.parse::<u64>().expect("a number"));
    let days = arguments.next().unwrap_or(7);
    let seed = arguments.next().unwrap_or(1);
    let robot = biorob_like();
    // One minute with an empty gripper, and one hour of work with a payload and contacts, without slips.
    let all = frames(&robot, 700 + seed, 60.0 + HOUR_S, |text| {
        text.replace("rad = 0.010", "rad = 0.0")
            .replace("rad = 0.005", "rad = 0.0")
            .replace("rad = { min = 0.0, max = 0.012 }", "rad = 0.0")
    });
    let (empty, work) = all.split_at(60 * HZ);
    let ropes = Ropes {
        slipped_s: 2.0 * DAY_S + 2.0 * HOUR_S,
        tensioned_s: 4.0 * DAY_S,
    };
    println!("simulated; memory {:.1} MB", memory_mb());

    let mut harness = Harness::restored(config(&robot), Store::default(), at(0.0));
    harness
        .command(
            CommandKind::Tensioned { joints: vec![] },
            "on Friday of last week",
        )
        .expect("command is valid");
    // The offsets at the start of the week refer to this baseline.
    harness.play(empty);
    harness.pass(70.0);
    let (mut robot_s, mut step_s, mut job_s) = (0.0, Duration::ZERO, Duration::ZERO);
    for day in 0..days {
        let is_work = day % 7 < 5;
        for hour in 0..8 {
            let hour = if hour < 4 { hour } else { hour + 1 };
            let from_s = day as f64 * DAY_S + f64::from(hour) * HOUR_S + 300.0;
            if !is_work || (day == 0 && hour == 0) {
                continue;
            }
            idle(&mut harness, from_s);
            if from_s >= ropes.tensioned_s && from_s < ropes.tensioned_s + HOUR_S {
                let joints = vec!["elbow".into()];
                harness
                    .command(CommandKind::Tensioned { joints }, "")
                    .expect("command is valid");
                hour_of(&mut harness, empty, &ropes, 60.0);
                harness.pass(70.0);
            }
            let began = cpu_s();
            let took = hour_of(&mut harness, work, &ropes, HOUR_S - 600.0);
            robot_s += HOUR_S - 600.0;
            job_s += took;
            step_s += Duration::from_secs_f64((cpu_s() - began).max(0.0)).saturating_sub(took);
        }
        let snapshot = harness.snapshot();
        let alarms: Vec<String> = (snapshot.alarms.iter())
            .map(|a| {
                format!(
                    "{:?} {:?} {:?}",
                    a.key.joint.as_deref().unwrap_or("robot"),
                    a.key.condition,
                    a.state
                )
            })
            .collect();
        println!(
            "day {}: memory {:.1} MB; {}",
            day + 1,
            memory_mb(),
            alarms.join(", ")
        );
        harness = harness.restart(60.0);
    }
    report(&harness, &ropes);
    println!(
        "{robot_s:.0} s of work: {:.2} ms a robot-second in frames and ticks, {:.2} ms in jobs",
        1e3 * step_s.as_secs_f64() / robot_s,
        1e3 * job_s.as_secs_f64() / robot_s
    );
}

fn at(s: f64) -> Instant {
    Instant {
        monotonic_ns: 1_000_000_000,
        utc_ns: MONDAY_NS + (s * 1e9) as i64,
    }
}

/// Time since the start of the week, s.
fn since_s(harness: &Harness) -> f64 {
    (harness.now.utc_ns - MONDAY_NS) as f64 * 1e-9
}

/// Advances time without data; one tick per minute is sufficient.
fn idle(harness: &mut Harness, until_s: f64) {
    while since_s(harness) < until_s {
        let left_s = until_s - since_s(harness);
        harness.now = harness.now.after_s(left_s.min(60.0));
        harness.tick();
    }
}

/// Plays the frames cyclically for `for_s` seconds; returns the processor time of the jobs.
fn hour_of(harness: &mut Harness, frames: &[Frame], ropes: &Ropes, for_s: f64) -> Duration {
    let mut took = Duration::ZERO;
    let mut frame = frames[0].clone();
    let count = (for_s * HZ as f64) as usize;
    for k in 0..count {
        harness.now = harness.now.after_s(1.0 / HZ as f64);
        let source = &frames[k % frames.len()];
        frame.clone_from(source);
        frame.segment = (k / frames.len()) as u32;
        frame.time_ns = harness.now.utc_ns;
        ropes.shift(&mut frame, since_s(harness));
        harness.monitor.frame(&frame, harness.now);
        if k % 25 == 0 {
            harness.monitor.tick(harness.now);
            let began = cpu_s();
            harness.settle();
            took += Duration::from_secs_f64((cpu_s() - began).max(0.0));
        }
    }
    took
}

fn report(harness: &Harness, ropes: &Ropes) {
    let mut scores: Vec<(String, Score)> = Vec::new();
    for record in &harness.store.records {
        let i = match scores.iter().position(|(name, _)| *name == record.joint) {
            Some(i) => i,
            None => {
                scores.push((record.joint.clone(), Score::default()));
                scores.len() - 1
            }
        };
        scores[i].1.take(
            record,
            ropes.offsets(end_s(record))[joint_of(&record.joint)],
        );
    }
    println!("| joint | records | RMSE (mrad) | maximum (mrad) | inside 95 % | inconclusive |");
    println!("|---|---|---|---|---|---|");
    for (name, score) in &scores {
        println!(
            "| {name} | {} | {:.2} | {:.2} | {:.1} % | {} |",
            score.conclusive + score.inconclusive,
            1e3 * (score.square / score.conclusive.max(1) as f64).sqrt(),
            1e3 * score.worst,
            100.0 * score.inside as f64 / score.conclusive.max(1) as f64,
            score.inconclusive
        );
    }
    let steps = harness.store.events(|event| match event {
        Event::Alarm { transition } if transition.key.condition != Condition::NoData => {
            let joint = transition.key.joint.clone().unwrap_or("robot".into());
            let condition = transition.key.condition;
            Some(format!(
                "{joint} {condition:?}: {:?} → {:?}",
                transition.from, transition.to
            ))
        }
        _ => None,
    });
    println!("alarms: {}", steps.join("; "));
    println!(
        "{} transactions, {} entries of the journal",
        harness.store.transactions,
        harness.store.journal.len()
    );
}

fn end_s(record: &Record) -> f64 {
    record.time_utc_s - MONDAY_NS as f64 * 1e-9 + record.duration_s
}

fn joint_of(name: &str) -> usize {
    let names = ["shoulder_yaw", "shoulder_pitch", "elbow", "wrist"];
    names.iter().position(|n| *n == name).expect("a joint")
}

impl Score {
    fn take(&mut self, record: &Record, truth_rad: f64) {
        let Some(offset) = record.offset() else {
            self.inconclusive += 1;
            return;
        };
        let error = offset.mean - truth_rad;
        self.conclusive += 1;
        self.inside += usize::from(error.abs() < offset.half_width_95());
        self.square += error * error;
        self.worst = self.worst.max(error.abs());
    }
}

/// Resident memory, MB; 0 if not available.
fn memory_mb() -> f64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text
        .split_whitespace()
        .nth(1)
        .and_then(|p| p.parse::<f64>().ok());
    pages.unwrap_or(0.0) * 4096.0 * 1e-6
}

/// Processor time of this process, all threads, s.
fn cpu_s() -> f64 {
    cpu_time::ProcessTime::now().as_duration().as_secs_f64()
}
