//! A motor's current as the second witness: its torque constant is known to a tenth only.
//!
//! `SINEW_SEEDS=40 cargo test --release --workspace --test motor_current -- --nocapture` measures it.

mod support;

use rand::SeedableRng;
use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Normal};
use sinew_lab::absolute::{self, Recorded, Recorder, WatchOptions};
use sinew_lab::simulate::{Scenario, Simulation};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use support::{asked_seeds, biorob_like, repository};

/// Sessions A and B of the examples' work session, torques times `scale`, and the true offsets, mrad.
fn sessions(robot: &Robot, seed: u64, scale: &[f64]) -> ([Recorded; 2], Vec<f64>) {
    let place = repository().join("examples/scenarios/work-session.toml");
    let text = std::fs::read_to_string(place).unwrap();
    let mut scenario = Scenario::from_toml(&text, "work-session.toml").unwrap();
    scenario.seed = seed;
    let mut simulation = Simulation::new(robot, &scenario).unwrap();
    let recorder = || Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let (mut a, mut b) = (recorder(), recorder());
    let mut truth = Vec::new();
    while let Some(frame) = simulation.next_frame().unwrap() {
        let mut frame = frame.clone();
        let t = simulation.true_state().time_s;
        for (torque, scale) in frame.tau_m.iter_mut().zip(scale) {
            *torque *= scale;
        }
        if t < 60.0 {
            a.push(&frame, t);
        } else if t < 120.0 {
            b.push(&frame, t);
            let offsets = &simulation.true_state().delta_e;
            truth = offsets.iter().map(|x| 1e3 * x).collect();
        } else {
            break;
        }
    }
    ([a.finish(), b.finish()], truth)
}

#[derive(Clone, Copy, Debug)]
enum Witness {
    None,
    Torque,
    Current,
}

/// Errors over half intervals, and errors, mrad, of all joints.
fn judged(
    robot: &Robot,
    sessions: &[Recorded; 2],
    truth: &[f64],
    witness: Witness,
) -> Vec<[f64; 2]> {
    let sessions = sessions.clone().map(|recorded| Recorded {
        motor_current: matches!(witness, Witness::Current),
        ..recorded
    });
    let [a, b] = &sessions;
    let motor_torque = !matches!(witness, Witness::None);
    let learning = absolute::Learning {
        motor_torque,
        ..absolute::Learning::default()
    };
    let (baseline, _) = absolute::learn_recorded_from(robot, a, "A", &learning).unwrap();
    let options = WatchOptions {
        motor_torque,
        ..WatchOptions::default()
    };
    let with = Some((&baseline, "A"));
    let (said, _) = absolute::watch_recorded(robot, b, "B", with, &options).unwrap();
    assert_eq!(said.motor_current, matches!(witness, Witness::Current));
    let joints = said.joints.iter().zip(truth);
    joints
        .map(|(joint, truth)| {
            let error = joint.offset_mrad - truth;
            [error / joint.interval_95_mrad, error]
        })
        .collect()
}

#[test]
fn a_torque_constant_a_tenth_off_is_within_what_is_believed_of_a_current() {
    let robot = biorob_like();
    let (asked, error) = (asked_seeds(), Normal::new(0.0, 0.1).unwrap());
    for witness in [Witness::None, Witness::Torque, Witness::Current] {
        let (mut inside, mut count) = (0, 0);
        let mut squares = vec![0.0; robot.arm.dof()];
        let recordings = asked.unwrap_or(2);
        for seed in 0..recordings {
            let mut rng = ChaCha12Rng::seed_from_u64(seed);
            let scale: Vec<f64> = (squares.iter())
                .map(|_| 1.0 + error.sample(&mut rng))
                .collect();
            let (recorded, truth) = sessions(&robot, 900 + seed, &scale);
            for ([share, error], square) in judged(&robot, &recorded, &truth, witness)
                .into_iter()
                .zip(&mut squares)
            {
                inside += usize::from(share.abs() <= 1.0);
                count += 1;
                *square += error * error / recordings as f64;
            }
        }
        let rmse: Vec<String> = squares.iter().map(|s| format!("{:.2}", s.sqrt())).collect();
        println!(
            "{witness:?}: {inside} of {count} inside, RMSE {} mrad",
            rmse.join(", ")
        );
        if matches!(witness, Witness::Current) {
            assert!(10 * inside >= 9 * count, "{inside} of {count}");
        }
    }
}
