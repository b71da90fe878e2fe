//! Motor current as an independent measurement, with a torque constant of 10 % tolerance.
//!
//! `SINEW_SEEDS=32 cargo test --release -p sinew-estimate --test all motor_current:: -- --nocapture` measures it.

use crate::support;

use rand::SeedableRng;
use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Normal};
use sinew_estimate::session;
use sinew_estimate::session::{MotorTorque, Recorded, SessionEstimate, SessionOptions};
use sinew_model::robot::Robot;
use support::{biorob_like, least, requested_seeds, work_session};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Measurement {
    None,
    Torque,
    Current,
}

/// Estimate of session B since A.
fn estimate_b(robot: &Robot, sessions: &[Recorded], measurement: Measurement) -> SessionEstimate {
    let [a, b] = [0, 1].map(|k| Recorded {
        motor_current: measurement == Measurement::Current,
        ..sessions[k].clone()
    });
    let motor_torque = measurement != Measurement::None;
    let learning = session::Learning {
        motor_torque,
        ..session::Learning::default()
    };
    let (baseline, _) = session::learn_recorded(robot, &a, "A", &learning).unwrap();
    let options = SessionOptions {
        motor_torque,
        ..SessionOptions::default()
    };
    let with = Some((&baseline, "A"));
    session::estimate_recorded(robot, &b, "B", with, &options)
        .unwrap()
        .0
}

#[test]
fn motor_current_tolerance_covers_10_percent_scale_error() {
    let robot = biorob_like();
    let (requested, error) = (requested_seeds(), Normal::new(0.0, 0.1).unwrap());
    let recordings = requested.unwrap_or(2);
    // Only the torque constants of the mapping are wrong.
    let exact = |text: String| text.replace("scale_error = { std = 0.03 }", "scale_error = 0.0");
    for measurement in [Measurement::None, Measurement::Torque, Measurement::Current] {
        let (mut inside, mut scales, mut count) = (0_u32, 0_u32, 0_u32);
        let mut squares = vec![0.0; robot.arm.dof()];
        for seed in 0..recordings {
            let mut rng = ChaCha12Rng::seed_from_u64(seed);
            let scale: Vec<f64> = (squares.iter())
                .map(|_| 1.0 + error.sample(&mut rng))
                .collect();
            let (mut parts, truth) = work_session(&robot, 900 + seed, exact, &[60.0, 120.0]);
            // Features are linear in it.
            for block in parts.iter_mut().flat_map(|part| &mut part.blocks) {
                for (torque, scale) in block.motor_torque.iter_mut().zip(&scale) {
                    *torque *= scale;
                }
            }
            let result = estimate_b(&robot, &parts, measurement);
            assert_eq!(
                result.motor_torque == MotorTorque::FromCurrent,
                measurement == Measurement::Current
            );
            for (i, joint) in result.joints.iter().enumerate() {
                let error = 1e3 * joint.offset_rad.mean - truth[i];
                inside += u32::from(error.abs() <= 1e3 * joint.offset_rad.half_width_95());
                count += 1;
                squares[i] += error * error / recordings as f64;
                let own = |n: &&sinew_estimate::NuisanceChange| {
                    n.joint.as_ref() == Some(&joint.name) && n.name == "motor torque scale"
                };
                let scaled = result.nuisance.iter().find(own).unwrap().posterior;
                let off = (scaled.mean - (scale[i] - 1.0)).abs() / scaled.std;
                scales += u32::from(off < 1.96);
            }
        }
        let rmse: Vec<String> = (squares.iter())
            .map(|s| format!("{:.2}", s.sqrt()))
            .collect();
        println!(
            "{measurement:?}: {inside} of {count} offsets inside, {scales} scales, RMSE {} mrad",
            rmse.join(", ")
        );
        match measurement {
            Measurement::Current => {
                let least = least(0.95, f64::from(count));
                assert!(f64::from(inside) >= least, "{inside} of {count}");
                assert!(f64::from(scales) >= least, "{scales} of {count}");
            }
            // The prior of a torque is too narrow for such constants.
            Measurement::Torque => assert!(10 * scales < 9 * count, "{scales} of {count}"),
            Measurement::None => {}
        }
    }
}
