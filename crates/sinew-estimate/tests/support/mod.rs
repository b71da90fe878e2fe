//! Inputs shared by several tests of this crate.

// Each test file uses its own part of this.
#![allow(dead_code)]

use sinew_estimate::baseline::Baseline;
use sinew_estimate::online::{OnlineAnswer, Window};
use sinew_estimate::robot_dir;
use sinew_estimate::session::{Payload, Recorded, Recorder, SessionOptions};
use sinew_log::Frame;
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use sinew_sim::protocol::Plan;
use sinew_sim::{Scenario, Simulation};
use std::path::{Path, PathBuf};

#[path = "../../../sinew-files/tests/support/skipped.rs"]
mod skipped;
pub(crate) use skipped::shared;

/// Root folder of the repository.
pub(crate) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Folder of the shipped robot `biorob-like`.
pub(crate) fn biorob_like_folder() -> PathBuf {
    repository().join("robots/biorob-like")
}

/// Shipped robot `biorob-like`.
pub(crate) fn biorob_like() -> Robot {
    robot_dir::load(&biorob_like_folder(), None).unwrap().robot
}

/// Number of draws of a test: `SINEW_SEEDS`, or the default.
pub(crate) fn seeds(ordinary: u64) -> u64 {
    requested_seeds().unwrap_or(ordinary)
}

/// Minimum number of successes of `count` with probability `share`: 2.5 standard errors below the mean.
pub(crate) fn least(share: f64, count: f64) -> f64 {
    share * count - 2.5 * (share * (1.0 - share) * count).sqrt()
}

/// Value of `SINEW_SEEDS`.
pub(crate) fn requested_seeds() -> Option<u64> {
    std::env::var("SINEW_SEEDS").ok()?.parse().ok()
}

/// Records the work session of the examples, changed by `edit` and cut at `cuts_s`; returns it with the true offsets at
/// 120 s, mrad.
pub(crate) fn work_session(
    robot: &Robot,
    seed: u64,
    edit: impl Fn(String) -> String,
    cuts_s: &[f64],
) -> (Vec<Recorded>, Vec<f64>) {
    let place = repository().join("examples/scenarios");
    let text = std::fs::read_to_string(place.join("work-session.toml")).unwrap();
    let mut scenario = Scenario::from_toml(&edit(text), "work-session.toml").unwrap();
    scenario.seed = seed;
    let mut simulation = Simulation::new(robot, &scenario).unwrap();
    let recorder = || Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let mut parts = vec![recorder()];
    let mut cuts = cuts_s.iter().copied().peekable();
    let mut truth = Vec::new();
    let mut frame_at = 0.0;
    while let Some(frame) = simulation.next_frame().unwrap() {
        if cuts.next_if(|cut| frame_at >= *cut).is_some() {
            parts.push(recorder());
        }
        parts.last_mut().unwrap().push(frame, frame_at);
        frame_at += 1.0 / 250.0;
        if frame_at < 120.0 {
            truth = simulation
                .true_state()
                .delta_e
                .iter()
                .map(|x| 1e3 * x)
                .collect();
        }
    }
    (parts.into_iter().map(Recorder::finish).collect(), truth)
}

/// Records sessions A and B; returns them with the true offsets at the end of B, mrad.
pub(crate) fn sessions(plan: &Plan, seed: u64) -> ([Recorded; 2], Vec<f64>) {
    let mut scenario = plan.scenario.clone();
    scenario.seed = seed;
    let end_s = scenario.sessions[1].to_s;
    let begin_s = scenario.sessions[1].from_s;
    let mut simulation = Simulation::new(&plan.simulated, &scenario).unwrap();
    let recorder = || Recorder::new(&plan.robot, &FeatureConfig::default(), 0.5);
    let (mut a, mut b) = (recorder(), recorder());
    let mut truth = Vec::new();
    let step_s = 1.0 / scenario.sample_rate_hz;
    let mut k = 0.0;
    while let Some(frame) = simulation.next_frame().unwrap() {
        let t: f64 = k * step_s;
        k += 1.0;
        if t >= end_s {
            break;
        }
        if t < begin_s {
            a.push(frame, t);
        } else {
            b.push(frame, t);
        }
        truth = simulation.true_state().delta_e.clone();
    }
    let truth = truth.iter().map(|x| 1e3 * x).collect();
    ([a.finish(), b.finish()], truth)
}

/// Session options for a scenario of the bench.
pub(crate) fn watching(plan: &Plan) -> SessionOptions {
    let payload = if plan.scenario.payloads.is_empty() {
        Payload::Empty
    } else {
        Payload::Unknown
    };
    SessionOptions {
        payload,
        ..SessionOptions::default()
    }
}

/// Answer of the online estimate for the blocks of a recording.
pub(crate) fn online_answer(
    robot: &Robot,
    baseline: &Baseline,
    options: &SessionOptions,
    recorded: &Recorded,
) -> OnlineAnswer {
    let with = Some((baseline.clone(), "baseline".to_owned()));
    let window = Window::new(robot.clone(), with, options, "session");
    let mut window = window.unwrap();
    window.push(recorded);
    window.solve();
    window.answer().clone()
}

/// Baseline and session B of the example; `change` changes the frame at a time, s.
pub(crate) fn work_session_with(
    robot: &Robot,
    seed: u64,
    mut change: impl FnMut(&mut Frame, f64),
) -> Vec<Recorded> {
    let place = repository().join("examples/scenarios");
    let text = std::fs::read_to_string(place.join("work-session.toml")).unwrap();
    let mut scenario = Scenario::from_toml(&text, "work-session.toml").unwrap();
    scenario.seed = seed;
    let mut simulation = Simulation::new(robot, &scenario).unwrap();
    let recorder = || Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let (mut a, mut b) = (recorder(), recorder());
    let mut t_s = 0.0;
    while let Some(frame) = simulation.next_frame().unwrap() {
        let mut frame = frame.clone();
        change(&mut frame, t_s);
        match t_s {
            ..60.0 => drop(a.push(&frame, t_s)),
            ..120.0 => drop(b.push(&frame, t_s)),
            _ => break,
        }
        t_s += 1.0 / 250.0;
    }
    vec![a.finish(), b.finish()]
}
