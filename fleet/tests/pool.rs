//! Pooled baselines: the prior of a new robot is closer to the truth and more precise.

use crate::support::repository;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{Learning, Recorder, SessionOptions, estimator, learn_recorded};
use sinew_fleet::FleetError;
use sinew_fleet::args::Pool;
use sinew_fleet::pool::{Excluded, pool};
use sinew_model::offset::shared_parameters::Kind;
use sinew_model::offset::{FeatureConfig, JointParameter, Payload, UNKNOWN_OFFSET_RAD};
use sinew_model::robot::Robot;
use sinew_sim::{Scenario, Simulation};
use std::path::Path;

/// Ratio of the stiffness of all robots of the type to that in robot.toml.
const STIFFNESS: f64 = 0.82;

fn robot() -> Robot {
    robot_dir::load(&repository("robots/biorob-like"), None)
        .unwrap()
        .robot
}

/// Half a minute right after tensioning, of a robot whose springs are all as soft.
fn learned(robot: &Robot, seed: u64) -> Baseline {
    let place = repository("examples/scenarios/work-session.toml");
    let text = std::fs::read_to_string(place).unwrap();
    let changed = text
        .replace(
            "stiffness_factor = { min = 0.8, max = 1.2 }",
            &format!("stiffness_factor = {STIFFNESS}"),
        )
        .replace("duration_s = 180.0", "duration_s = 30.0");
    let (changed, _) = changed.split_once("[[payloads]]").unwrap();
    let mut scenario = Scenario::from_toml(changed, "work-session.toml").unwrap();
    assert!(
        text.contains("stiffness_factor = { min"),
        "the scenario has changed"
    );
    (scenario.seed, scenario.robot_seed) = (seed, Some(seed));
    let mut simulation = Simulation::new(robot, &scenario).unwrap();
    let mut recorder = Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let mut frames = 0;
    while let Some(frame) = simulation.next_frame().unwrap() {
        recorder.push(frame, f64::from(frames) / 250.0);
        frames += 1;
    }
    let name = format!("arm-{seed}");
    learn_recorded(robot, &recorder.finish(), &name, &Learning::default())
        .unwrap()
        .0
}

fn request(folder: &Path) -> Pool {
    Pool {
        folder: folder.into(),
        robot: repository("robots/biorob-like"),
        creep: false,
        out: folder.join("type.known"),
    }
}

#[test]
fn pool_prior_has_stiffness_of_type() {
    let folder = tempfile::tempdir().unwrap();
    let robot = robot();
    for seed in 1..=4 {
        let path = folder.path().join(format!("arm-{seed}.baseline"));
        learned(&robot, seed).write(&path).unwrap();
    }
    std::fs::write(folder.path().join("broken.baseline"), "no baseline").unwrap();
    let pooled = pool(&request(folder.path())).unwrap();
    assert_eq!(pooled.robots, 4);
    assert!(
        matches!(&pooled.excluded[..], [(_, Excluded::Unreadable(_))]),
        "{:?}",
        pooled.excluded
    );
    let prior = estimator(&robot, &SessionOptions::default())
        .prior()
        .clone();
    let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let start = pooled.start.state_estimate(&robot, &prior, "type").unwrap();
    let truth = 1.0 / STIFFNESS - 1.0;
    let elastic: Vec<usize> = (0..prior.joints())
        .filter(|i| prior.is_elastic(*i))
        .collect();
    let mut surer = 0;
    for i in elastic {
        let k = prior.place(i, JointParameter::Compliance);
        let [now, before] = [start.entry(k), fresh.entry(k)];
        assert!((now.mean - truth).abs() < 2.5 * now.std, "{now:?}");
        surer += usize::from(now.std < 0.7 * before.std && now.mean > 0.5 * truth);
        let offset = prior.place(i, JointParameter::Offset);
        assert_eq!(start.entry(offset), fresh.entry(offset));
    }
    assert!(surer >= 2, "{surer}");
    let stiffness = pooled
        .similarity
        .iter()
        .find(|a| a.kind == Kind::Stiffness)
        .unwrap();
    assert!(stiffness.ratio < 0.6, "{stiffness:?}");
}

#[test]
fn pool_single_robot_is_error() {
    let folder = tempfile::tempdir().unwrap();
    let error = pool(&request(folder.path())).unwrap_err();
    assert!(
        matches!(error, FleetError::TooFewBaselines { found: 0, .. }),
        "{error}"
    );
}
