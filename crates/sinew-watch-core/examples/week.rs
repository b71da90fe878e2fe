//! A week of a simulated robot, in minutes:
//!
//! `cargo run --release -p sinew-watch-core --example week -- [DAYS [SEED]]`
//!
//! A robot works two shifts of four hours from Monday to Friday, with a payload and contacts, and stands between them;
//! at night it is switched off. Its ropes creep by the logarithm of time. On the third day at ten the elbow slips by
//! 5 mrad; on the fifth at eight it is tensioned. Every night the monitor is killed, and starts from what was stored.
//!
//! It prints how far every record was off, how often the truth was in its interval, what was an alarm and what wasn't,
//! what the week took of a processor, and how much memory it held in the end.

#[path = "../tests/support/mod.rs"]
mod support;

use sinew_log::Frame;
use sinew_watch_core::alarm::Condition;
use sinew_watch_core::command::What;
use sinew_watch_core::journal::Event;
use sinew_watch_core::{Instant, Record};
use std::time::Duration;
use support::{HZ, MONDAY_NS, Store, Watched, biorob_like, config, frames};

const ELBOW: usize = 2;
const SLIP_RAD: f64 = 5e-3;
const HOUR_S: f64 = 3600.0;
const DAY_S: f64 = 86_400.0;

/// Creep of every tendon per e-fold of time, rad.
const CREEP_RAD: [f64; 4] = [0.3e-3, 0.6e-3, 0.8e-3, 0.5e-3];
/// Offset when the week begins, rad.
const BEGAN_RAD: [f64; 4] = [2e-3, 6e-3, 8e-3, 3e-3];

/// What the ropes do.
struct Ropes {
    /// When the elbow slipped and was tensioned, s since the week began.
    slipped_s: f64,
    tensioned_s: f64,
}

impl Ropes {
    /// Offsets since they were last tensioned, rad: they have crept for ten days before.
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

    /// The same as the motor's encoder has it: tensioning moves it back.
    fn shift(&self, frame: &mut Frame, at_s: f64) {
        for (theta, x) in frame.theta.iter_mut().zip(self.offsets(at_s)) {
            *theta += x;
        }
    }
}

/// How far the records were off.
#[derive(Default)]
struct Score {
    told: usize,
    inside: usize,
    untold: usize,
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
    // A minute with an empty gripper, and an hour of work with a payload and contacts; nothing slips by itself.
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

    let mut watched = Watched::restored(config(&robot), Store::default(), at(0.0));
    watched
        .say(What::Tensioned { joints: vec![] }, "on Friday of last week")
        .expect("said");
    // The offsets at the week's beginning count from here on: the baseline was learned before.
    watched.play(empty);
    watched.pass(70.0);
    let (mut robot_s, mut step_s, mut job_s) = (0.0, Duration::ZERO, Duration::ZERO);
    for day in 0..days {
        let is_work = day % 7 < 5;
        for hour in 0..8 {
            let hour = if hour < 4 { hour } else { hour + 1 };
            let from_s = day as f64 * DAY_S + f64::from(hour) * HOUR_S + 300.0;
            if !is_work || (day == 0 && hour == 0) {
                continue;
            }
            idle(&mut watched, from_s);
            if from_s >= ropes.tensioned_s && from_s < ropes.tensioned_s + HOUR_S {
                let joints = vec!["elbow".into()];
                watched.say(What::Tensioned { joints }, "").expect("said");
                hour_of(&mut watched, empty, &ropes, 60.0);
                watched.pass(70.0);
            }
            let began = cpu_s();
            let took = hour_of(&mut watched, work, &ropes, HOUR_S - 600.0);
            robot_s += HOUR_S - 600.0;
            job_s += took;
            step_s += Duration::from_secs_f64((cpu_s() - began).max(0.0)).saturating_sub(took);
        }
        let snapshot = watched.snapshot();
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
        watched = watched.restart(60.0);
    }
    report(&watched, &ropes);
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

/// Seconds since the week began.
fn since_s(watched: &Watched) -> f64 {
    (watched.now.utc_ns - MONDAY_NS) as f64 * 1e-9
}

/// Nothing comes until then; a tick a minute is enough.
fn idle(watched: &mut Watched, until_s: f64) {
    while since_s(watched) < until_s {
        let left_s = until_s - since_s(watched);
        watched.now = watched.now.after_s(left_s.min(60.0));
        watched.tick();
    }
}

/// Frames come, round and round, for so long; how long jobs took of it.
fn hour_of(watched: &mut Watched, frames: &[Frame], ropes: &Ropes, for_s: f64) -> Duration {
    let mut took = Duration::ZERO;
    let mut frame = frames[0].clone();
    let count = (for_s * HZ as f64) as usize;
    for k in 0..count {
        watched.now = watched.now.after_s(1.0 / HZ as f64);
        let source = &frames[k % frames.len()];
        frame.clone_from(source);
        frame.segment = (k / frames.len()) as u32;
        frame.time_ns = watched.now.utc_ns;
        ropes.shift(&mut frame, since_s(watched));
        watched.monitor.frame(&frame, watched.now);
        if k % 25 == 0 {
            watched.monitor.tick(watched.now);
            let began = cpu_s();
            watched.settle();
            took += Duration::from_secs_f64((cpu_s() - began).max(0.0));
        }
    }
    took
}

fn report(watched: &Watched, ropes: &Ropes) {
    let mut scores: Vec<(String, Score)> = Vec::new();
    for record in &watched.store.records {
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
    println!("| joint | records | RMSE, mrad | worst | inside 95 % | no offset |");
    println!("|---|---|---|---|---|---|");
    for (name, score) in &scores {
        println!(
            "| {name} | {} | {:.2} | {:.2} | {:.1} % | {} |",
            score.told + score.untold,
            1e3 * (score.square / score.told.max(1) as f64).sqrt(),
            1e3 * score.worst,
            100.0 * score.inside as f64 / score.told.max(1) as f64,
            score.untold
        );
    }
    let steps = watched.store.events(|event| match event {
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
        watched.store.transactions,
        watched.store.journal.len()
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
            self.untold += 1;
            return;
        };
        let error = offset.mean - truth_rad;
        self.told += 1;
        self.inside += usize::from(error.abs() < offset.half_width_95());
        self.square += error * error;
        self.worst = self.worst.max(error.abs());
    }
}

/// Resident memory, MB; 0 where the system doesn't say.
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
