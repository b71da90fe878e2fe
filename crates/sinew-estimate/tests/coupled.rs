//! Simulated recordings of robots whose tendons cross several joints, from the scenario to the result.

use crate::support;

use sinew_estimate::Request;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{
    self, Learning, Recorded, Recorder, SessionEstimate, SessionOptions, Window,
};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use sinew_sim::{Scenario, SimulateOptions, Simulation, run};
use support::{repository, seeds};

/// Start of the second session of both scenarios, and time of a tendon slip of 5 mrad, s.
const SECOND_FROM_S: f64 = 60.0;
const SLIP_AT_S: f64 = 90.0;

pub(crate) fn robot(name: &str) -> Robot {
    let place = repository().join("robots").join(name);
    robot_dir::load(&place, None).unwrap().robot
}

pub(crate) fn scenario(name: &str, seed: u64) -> Scenario {
    let path = repository().join("examples/scenarios").join(name);
    let mut scenario = Scenario::open(&path.with_extension("toml")).unwrap();
    scenario.seed = seed;
    scenario
}

/// Both sessions of a scenario, and the true offsets at its end, rad of the joint that each tendon is paired with.
pub(crate) fn recorded(robot: &Robot, scenario: &Scenario) -> ([Recorded; 2], Vec<f64>) {
    let mut simulation = Simulation::new(robot, scenario).unwrap();
    let recorder = || Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let (mut first, mut second) = (recorder(), recorder());
    while let Some(frame) = simulation.next_frame().unwrap().cloned() {
        let at_s = simulation.true_state().time_s;
        match at_s < SECOND_FROM_S {
            true => first.push(&frame, at_s),
            false => second.push(&frame, at_s),
        };
    }
    let truth = simulation.true_state().delta_e.clone();
    ([first.finish(), second.finish()], truth)
}

fn estimated(
    robot: &Robot,
    [first, second]: &[Recorded; 2],
    motor_torque: bool,
) -> SessionEstimate {
    let (baseline, _) = session::learn_recorded(robot, first, "A", &Learning::default()).unwrap();
    let options = SessionOptions {
        motor_torque,
        ..SessionOptions::default()
    };
    let known = Some((&baseline, "A"));
    let (estimate, _) = session::estimate_recorded(robot, second, "B", known, &options).unwrap();
    estimate
}

// Every tendon is within three standard deviations, and only the slipped one is reported.
#[test]
fn coupled_slip_is_found_at_slipped_tendon_only() {
    // The widest interval of ten draws of each robot, with and without motor torque, was ± 0.035 mm.
    const MAX_HALF_WIDTH_MM: f64 = 0.05;
    for (name, slipped) in [("coupled-arm", "elbow"), ("differential-wrist", "left")] {
        let robot = robot(name);
        let tendons = robot.tendon_names();
        for seed in 1..=seeds(2) {
            for motor_torque in [true, false] {
                let mut scenario = scenario(name, seed);
                scenario.record.tau_m = motor_torque;
                let (parts, truth) = recorded(&robot, &scenario);
                let estimate = estimated(&robot, &parts, motor_torque);
                for ((tendon, found), truth) in tendons.iter().zip(&estimate.joints).zip(&truth) {
                    let offset = found.offset_rad;
                    let error = 1e3 * (offset.mean - truth);
                    let std = 1e3 * offset.std;
                    let elongation = found.elongation_m.unwrap();
                    let half_mm = 1e3 * elongation.half_width_95();
                    println!(
                        "{name} {seed} {motor_torque} {tendon} {error:+.3} mrad, σ {std:.3}, ± {half_mm:.4} mm {:?}",
                        found.changes
                    );
                    assert!(error.abs() < 3.0 * std, "{name} {seed} {tendon}");
                    assert!(
                        half_mm < MAX_HALF_WIDTH_MM,
                        "{name} {seed} {tendon}: {half_mm}"
                    );
                    if tendon != slipped {
                        assert!(found.changes.is_empty(), "{tendon}: {:?}", found.changes);
                        continue;
                    }
                    let [slip] = &found.changes[..] else {
                        panic!("{name} {seed}: {:?}", found.changes);
                    };
                    assert!((slip.time_s - SLIP_AT_S).abs() < 1.0, "{slip:?}");
                    let size = slip.size_rad.unwrap();
                    assert!((size.mean - 5e-3).abs() < 3.0 * size.std, "{slip:?}");
                }
            }
        }
    }
}

// Columns with the names of motors reproduce the simulation: the result of the file equals that of the frames.
#[test]
fn motor_columns_from_file_equal_frames() {
    const NAME: &str = "differential-wrist";
    let (robot, scenario) = (robot(NAME), scenario(NAME, 5));
    let folder = tempfile::tempdir().unwrap();
    let (parts, truth) = recorded(&robot, &scenario);
    let of_frames = estimated(&robot, &parts, true);
    for ending in ["mcap", "parquet"] {
        let log = folder.path().join("work").with_extension(ending);
        run(&robot, &scenario, &SimulateOptions::new(&log), &mut |_| ()).unwrap();
        let request = Request {
            robot: Some(repository().join("robots").join(NAME)),
            ..Request::new(log)
        };
        let window = |from_s, to_s| Window { from_s, to_s };
        let first = window(0.0, SECOND_FROM_S);
        let learned = session::learn(&request, first, &Learning::default(), &mut |_| ());
        let (baseline, _) = learned.unwrap();
        let (estimate, _) = session::estimate(
            &request,
            window(SECOND_FROM_S, f64::INFINITY),
            Some((&baseline, "A")),
            &SessionOptions::default(),
            &mut |_| (),
        )
        .unwrap();
        for ((file, frames), truth) in estimate.joints.iter().zip(&of_frames.joints).zip(&truth) {
            let (mean, std) = (file.offset_rad.mean, file.offset_rad.std);
            println!("{ending} {} {mean:.6} {truth:.6} ± {std:.6}", file.name);
            assert!((mean - truth).abs() < 3.0 * std, "{ending} {}", file.name);
            assert!((mean - frames.offset_rad.mean).abs() < std);
        }
    }
}
