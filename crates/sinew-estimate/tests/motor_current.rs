//! A motor's current as the second witness: its torque constant is known to a tenth only.
//!
//! `SINEW_SEEDS=32 cargo test --release -p sinew-estimate --test all motor_current:: -- --nocapture` measures it.

use crate::support;

use rand::SeedableRng;
use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Normal};
use sinew_estimate::session;
use sinew_estimate::session::{MotorTorque, Recorded, SessionEstimate, SessionOptions};
use sinew_model::robot::Robot;
use support::{asked_seeds, biorob_like, least, work_session};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Witness {
    None,
    Torque,
    Current,
}

/// What is said of session B since A.
fn watched(robot: &Robot, sessions: &[Recorded], witness: Witness) -> SessionEstimate {
    let [a, b] = [0, 1].map(|k| Recorded {
        motor_current: witness == Witness::Current,
        ..sessions[k].clone()
    });
    let motor_torque = witness != Witness::None;
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
fn a_torque_constant_a_tenth_off_is_within_what_is_believed_of_a_current() {
    let robot = biorob_like();
    let (asked, error) = (asked_seeds(), Normal::new(0.0, 0.1).unwrap());
    let recordings = asked.unwrap_or(2);
    // The mapping's constants are all that is off.
    let exact = |text: String| text.replace("scale_error = { std = 0.03 }", "scale_error = 0.0");
    for witness in [Witness::None, Witness::Torque, Witness::Current] {
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
            let said = watched(&robot, &parts, witness);
            assert_eq!(
                said.motor_torque == MotorTorque::FromCurrent,
                witness == Witness::Current
            );
            for (i, joint) in said.joints.iter().enumerate() {
                let error = 1e3 * joint.offset_rad.mean - truth[i];
                inside += u32::from(error.abs() <= 1e3 * joint.offset_rad.half_width_95());
                count += 1;
                squares[i] += error * error / recordings as f64;
                let own = |n: &&sinew_estimate::NuisanceChange| {
                    n.joint.as_ref() == Some(&joint.name) && n.name == "motor torque scale"
                };
                let scaled = said.nuisance.iter().find(own).unwrap().posterior;
                let off = (scaled.mean - (scale[i] - 1.0)).abs() / scaled.deviation;
                scales += u32::from(off < 1.96);
            }
        }
        let rmse: Vec<String> = (squares.iter())
            .map(|s| format!("{:.2}", s.sqrt()))
            .collect();
        println!(
            "{witness:?}: {inside} of {count} offsets inside, {scales} scales, RMSE {} mrad",
            rmse.join(", ")
        );
        match witness {
            Witness::Current => {
                let least = least(0.95, f64::from(count));
                assert!(f64::from(inside) >= least, "{inside} of {count}");
                assert!(f64::from(scales) >= least, "{scales} of {count}");
            }
            // The belief in a torque is too narrow for such constants.
            Witness::Torque => assert!(10 * scales < 9 * count, "{scales} of {count}"),
            Witness::None => {}
        }
    }
}
