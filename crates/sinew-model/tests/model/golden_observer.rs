//! Golden results of the observers on a synthetic arm, sample by sample, in every configuration.

use crate::answers::Answers;
use crate::synthetic_arm::{CALM, DT_S, Motion, N, Plant, STRETCHED_RAD, Truth, robot};
use sinew_model::Gaussian;
use sinew_model::correction::{
    ContactConfig, ContactDetector, ContactTolerances, ExternalTorqueConfig,
    ExternalTorqueObserver, JointCorrection,
};
use sinew_model::offset::{
    Comparison, OffsetConfig, OffsetObserver, Sample, TorqueSource, VelocityFilter,
};

const SAMPLES: usize = 3_000;
/// Number of samples between two stored results; they fall within moves and rests.
const STORED_STRIDE: usize = 230;

const FILTERED: VelocityFilter = VelocityFilter::StateVariable {
    cutoff_rad_per_s: 35.0,
};

fn truth() -> Truth {
    Truth {
        seed: 8,
        offset_rad: STRETCHED_RAD,
        slip: Some((1, 6.0, 4e-3)),
        push_at_s: Some(9.0),
        force_n: [0.5, 0.0, -1.0],
        ..CALM
    }
}

#[test]
fn observer_results_match_golden() {
    let robot = robot();
    let mut answers = Answers::default();
    for source in [
        TorqueSource::Observer,
        TorqueSource::TorqueSensor,
        TorqueSource::Motor,
    ] {
        for comparison in [Comparison::Matched, Comparison::Paper] {
            for (speeds, velocity, pushes) in [
                ("filtered", FILTERED, true),
                ("recorded", VelocityFilter::Recorded, false),
            ] {
                let config = OffsetConfig {
                    source,
                    comparison,
                    gain_per_s: 15.0,
                    velocity,
                };
                let observer = OffsetObserver::new(&robot.arm, &robot.transmissions, config);
                // Velocities of motors are not recorded.
                let Ok(mut observer) = observer else { continue };
                let motion = Motion::new(8, 1.0);
                let mut plant = Plant::new(&robot, truth());
                for k in 0..SAMPLES {
                    let found = plant.sample(k as f64 * DT_S, &motion);
                    let sample = Sample {
                        q: &found.q,
                        theta_measured: &found.theta,
                        dq: Some(&found.dq),
                        tau_el: Some(&found.tau_el),
                        tau_m: Some(&found.tau_m),
                        tau_ext: pushes.then_some(&found.pushed[..]),
                    };
                    // The first two samples have no motor torque yet.
                    let taken = observer.step(DT_S, &sample);
                    assert!(taken.is_ok() || k < 2, "{taken:?}");
                    if k % STORED_STRIDE != STORED_STRIDE - 1 {
                        continue;
                    }
                    answers.about(&format!("{source:?} {comparison:?} {speeds} {k}"));
                    for i in 0..N {
                        answers.usually(&format!("offset {i}"), observer.delta_e()[i], 1e-3);
                        answers.usually(&format!("torque {i}"), observer.tau_el()[i], 1.0);
                        answers.usually(&format!("spring {i}"), observer.deflection()[i], 1e-2);
                        answers.usually(&format!("speed {i}"), observer.dq()[i], 1.0);
                    }
                    answers.probability("settled", f64::from(u8::from(observer.is_settled())));
                }
            }
        }
    }
    answers.hold("golden_observer.csv");
}

#[test]
fn contact_results_match_golden() {
    let robot = robot();
    let mut answers = Answers::default();
    let correction = |i: usize| JointCorrection {
        delta_e_rad: Gaussian::new(STRETCHED_RAD[i], 0.3e-3),
        stiffness_factor: Gaussian::new(1.02, 0.03),
        cubic_per_rad2: 0.02 * i as f64,
    };
    let corrections: Vec<JointCorrection> = (0..N).map(correction).collect();
    let pushed = Truth {
        force_n: [0.0; 3],
        slip: None,
        stiffness_factor: [1.02; N],
        ..truth()
    };
    for (speeds, velocity) in [
        ("filtered", FILTERED),
        ("recorded", VelocityFilter::Recorded),
    ] {
        let config = ExternalTorqueConfig {
            gain_per_s: 18.0,
            velocity,
        };
        let mut tolerances = ContactTolerances::new(vec![0.02, 0.02, 0.01, 0.01]);
        tolerances.mass_std = 0.05;
        let observer = ExternalTorqueObserver::new(
            &robot.arm,
            &robot.transmissions,
            &corrections,
            config,
            tolerances,
        );
        let mut observer = observer.expect("an observer");
        let detector = ContactDetector::new(N, ContactConfig::default());
        let mut detector = detector.expect("a detector");
        let motion = Motion::new(8, 1.0);
        let mut plant = Plant::new(&robot, pushed);
        let mut touched = [0.0; N];
        for k in 0..SAMPLES {
            let found = plant.sample(k as f64 * DT_S, &motion);
            let taken = observer.step(DT_S, &found.q, &found.theta, Some(&found.dq));
            taken.expect("a sample");
            let touches = detector.step(DT_S, observer.tau_ext(), observer.threshold());
            touches.expect("a sample");
            for (i, touched) in touched.iter_mut().enumerate() {
                *touched += f64::from(u8::from(detector.is_touching_at(i)));
            }
            if k % STORED_STRIDE != STORED_STRIDE - 1 {
                continue;
            }
            answers.about(&format!("{speeds} {k}"));
            for i in 0..N {
                answers.usually(&format!("torque {i}"), observer.tau_ext()[i], 0.1);
                answers.usually(&format!("threshold {i}"), observer.threshold()[i], 0.1);
                answers.number(&format!("touched {i}"), touched[i]);
            }
        }
    }
    answers.hold("golden_contact.csv");
}
