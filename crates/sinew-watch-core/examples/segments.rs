//! Accuracy and cost of estimating a session in segments, each starting from the previous posterior:
//!
//! `cargo run --release -p sinew-watch-core --example segments -- [SEEDS]`
//!
//! Ten minutes of work (payload, contacts, two slips of 5 mrad) after a baseline of one minute, divided into segments
//! of several lengths; `estimate`: the whole session in one batch, as in `sinew estimate`. The output lists errors and
//! coverage of the final offsets and the number of slips detected.

use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{
    Learning, Recorded, Recorder, SessionEstimate, SessionOptions, Since, TendonChangeKind,
    estimate_recorded, estimate_segment, learn_recorded,
};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use sinew_sim::{Scenario, Simulation};
use std::path::Path;
use std::time::{Duration, Instant};

const SEGMENTS_S: [f64; 5] = [25.0, 50.0, 60.0, 120.0, f64::INFINITY];
const BASELINE_S: f64 = 60.0;
const END_S: f64 = 660.0;

/// Simulated robot: recordings, and its final offsets, rad.
struct Run {
    baseline: Recorded,
    work: Recorded,
    truth_rad: Vec<f64>,
}

/// Errors of one segment length.
#[derive(Default)]
struct Score {
    errors_rad: Vec<f64>,
    inside: usize,
    half_widths_rad: Vec<f64>,
    slips: usize,
    other_changes: usize,
    time: Duration,
}

fn main() {
    let seeds: u64 = std::env::args()
        .nth(1)
        .map_or(8, |s| s.parse().expect("a number of seeds"));
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let robot = robot_dir::load(&root.join("robots/biorob-like"), None)
        .expect("robot")
        .robot;
    let text = std::fs::read_to_string(root.join("examples/scenarios/work-session.toml"));
    let text = text
        .expect("scenario")
        .replace("duration_s = 180.0", "duration_s = 660.0");
    let mut scores: Vec<Score> = SEGMENTS_S.iter().map(|_| Score::default()).collect();
    for seed in 0..seeds {
        let run = simulate(&robot, &text, 9000 + seed);
        let (baseline, _) =
            learn_recorded(&robot, &run.baseline, "A", &Learning::default()).expect("baseline");
        for (segment_s, score) in SEGMENTS_S.iter().zip(&mut scores) {
            let began = Instant::now();
            let estimates = in_segments(&robot, &run.work, &baseline, *segment_s);
            score.time += began.elapsed();
            score.take(&estimates, &run.truth_rad);
        }
        eprintln!("seed {seed}");
    }
    println!(
        "| segment | RMSE (mrad) | maximum (mrad) | inside 95 % | mean half-width (mrad) | slips detected | other changes | time |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let per_run = 1.0 / seeds as f64;
    for (segment_s, score) in SEGMENTS_S.iter().zip(&scores) {
        let n = score.errors_rad.len();
        let square = score.errors_rad.iter().map(|e| e * e).sum::<f64>() / n as f64;
        let worst = score.errors_rad.iter().fold(0.0_f64, |a, e| a.max(e.abs()));
        let width = score.half_widths_rad.iter().sum::<f64>() / n as f64;
        let name = match segment_s.is_finite() {
            true => format!("{segment_s} s"),
            false => "estimate".into(),
        };
        println!(
            "| {name} | {:.3} | {:.2} | {} of {n} | {:.2} | {} of {} | {} | {:.2} s |",
            1e3 * square.sqrt(),
            1e3 * worst,
            score.inside,
            1e3 * width,
            score.slips,
            2 * seeds,
            score.other_changes,
            per_run * score.time.as_secs_f64()
        );
    }
}

fn simulate(robot: &Robot, text: &str, seed: u64) -> Run {
    // Times of the two slips, spread evenly over the session.
    let at = |i: u64| {
        format!(
            "{:.1}",
            90.0 + 540.0 * (0.618_034 * (2 * seed + i) as f64).fract()
        )
    };
    let text = text
        .replace("at_s = 130.0", &format!("at_s = {}", at(0)))
        .replace("at_s = 150.0", &format!("at_s = {}", at(1)));
    let mut scenario = Scenario::from_toml(&text, "work-session.toml").expect("scenario");
    scenario.seed = seed;
    let mut simulation = Simulation::new(robot, &scenario).expect("simulation");
    let recorder = || Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let (mut baseline, mut work) = (recorder(), recorder());
    let mut first_ns = None;
    while let Some(frame) = simulation.next_frame().expect("frame") {
        let time_s = (frame.time_ns - *first_ns.get_or_insert(frame.time_ns)) as f64 * 1e-9;
        if time_s < BASELINE_S {
            baseline.push(frame, time_s);
        } else if time_s < END_S {
            work.push(frame, time_s);
        }
    }
    Run {
        baseline: baseline.finish(),
        work: work.finish(),
        truth_rad: simulation.true_state().delta_e.clone(),
    }
}

fn in_segments(
    robot: &Robot,
    work: &Recorded,
    baseline: &Baseline,
    segment_s: f64,
) -> Vec<SessionEstimate> {
    let options = SessionOptions::default();
    if !segment_s.is_finite() {
        let with = Some((baseline, "A"));
        let estimate = estimate_recorded(robot, work, "B", with, &options);
        return vec![estimate.expect("estimate").0];
    }
    let mut out = Vec::new();
    let mut chain = baseline.clone();
    let mut since = Since::Days(1.0);
    let mut from = 0;
    while from < work.blocks.len() {
        let end_s = work.blocks[from].time_s + segment_s;
        let to = from + work.blocks[from..].partition_point(|b| b.time_s < end_s);
        let part = Recorded {
            blocks: work.blocks[from..to].to_vec(),
            duration_s: segment_s,
            ..work.clone()
        };
        let with = (Some((&chain, "chain")), since);
        let (estimate, next) =
            estimate_segment(robot, &part, "B", with, &options).expect("estimate");
        chain = next;
        out.push(estimate);
        since = Since::Now;
        from = to;
    }
    out
}

impl Score {
    fn take(&mut self, estimates: &[SessionEstimate], truth_rad: &[f64]) {
        let last = estimates.last().expect("an estimate");
        for (joint, truth) in last.joints.iter().zip(truth_rad) {
            let error = joint.offset_rad.mean - truth;
            self.errors_rad.push(error);
            self.half_widths_rad.push(joint.offset_rad.half_width_95());
            self.inside += usize::from(error.abs() < joint.offset_rad.half_width_95());
        }
        let changes = estimates.iter().flat_map(|e| &e.joints);
        for joint in changes {
            for change in &joint.changes {
                let is_probable = change.probability.is_none_or(|p| p >= 0.5);
                let is_large = change.size_rad.is_some_and(|s| s.mean.abs() >= 1e-3);
                let is_slip = change.kind == TendonChangeKind::Slip;
                let has_slip = ["shoulder_pitch", "elbow"].contains(&&*joint.name);
                let matches_size = change
                    .size_rad
                    .is_some_and(|s| (s.mean - 5e-3).abs() < 1.5e-3);
                match is_probable && is_large {
                    true if is_slip && has_slip && matches_size => self.slips += 1,
                    true => self.other_changes += 1,
                    false => {}
                }
            }
        }
    }
}
