//! External torque, its threshold and contacts: closed forms, identities, refusals.

use crate::spring_arms::{K, MGL, branching, known, motion, pendulum, springs};
use sinew_model::Gaussian;
use sinew_model::StepError;
use sinew_model::arm::Arm;
use sinew_model::correction::{
    ContactConfig, ContactDetector, ContactTolerances, CorrectionError, ExternalTorqueConfig,
    ExternalTorqueObserver, JointCorrection, SetPoint,
};
use sinew_model::observer::{ExactPole, FirstOrder};
use sinew_model::offset::{OffsetConfig, OffsetObserver, Sample, VelocityFilter};
use sinew_model::transmission::Transmission;

const RECORDED: ExternalTorqueConfig = ExternalTorqueConfig {
    gain_per_s: 30.0,
    velocity: VelocityFilter::Recorded,
};

fn observer(
    arm: &Arm,
    t: &[Option<Transmission>],
    c: &[JointCorrection],
    config: ExternalTorqueConfig,
) -> ExternalTorqueObserver {
    let quiet = ContactTolerances::new(vec![0.0; arm.dof()]);
    ExternalTorqueObserver::new(arm, t, c, config, quiet).unwrap()
}

/// Simulates a recording with external torques: the springs carry the torque of the motion minus
/// the external torque. Calls `each` with the observer and the applied torque after every step.
fn applied(
    config: ExternalTorqueConfig,
    seconds: f64,
    tau_ext: impl Fn(f64, usize) -> f64,
    mut each: impl FnMut(f64, &ExternalTorqueObserver, &[f64]),
) {
    let arm = branching();
    let n = arm.dof();
    let (t, c) = (springs(n), known(n));
    let mut observer = observer(&arm, &t, &c, config);
    let mut set = SetPoint::new(&arm, &t, &c).unwrap();
    const DT: f64 = 1e-3;
    for k in 0..(seconds / DT) as usize {
        let time = k as f64 * DT;
        let [q, dq, ddq] = motion(time, n);
        let push: Vec<f64> = (0..n).map(|i| tau_ext(time, i)).collect();
        let theta = set.follow(&q, &dq, &ddq, Some(&push)).unwrap();
        observer.step(DT, &q, theta, Some(&dq)).unwrap();
        each(time, &observer, &push);
    }
}

#[test]
fn external_torque_matches_applied_with_documented_lag() {
    let smooth = |t: f64, i: usize| (1.0 + 0.1 * i as f64) * (2.0 * t).sin().powi(2);
    let pole = ExactPole::new(RECORDED.gain_per_s, 1e-3);
    let mut lagging: Vec<Option<FirstOrder>> = vec![None; 9];
    let mut worst: f64 = 0.0;
    applied(RECORDED, 5.0, smooth, |time, observer, push| {
        for ((lag, push), found) in lagging.iter_mut().zip(push).zip(observer.tau_ext()) {
            let lag = lag.get_or_insert(FirstOrder::settled_at(*push));
            let expected = lag.step(&pole, *push);
            // The motion starts in full swing, which is taken as rest: e⁻³⁰ of that is left.
            if time > 1.0 {
                worst = worst.max((expected - found).abs());
            }
        }
    });
    // What remains is the straight line between samples: w₁ Δt² ü/12 and the corners of Coulomb
    // friction, 0.16 N·m over 10 ms at the last joint, of which a sample sees a hundredth.
    assert!(worst < 2e-4, "{worst} N·m");
}

#[test]
fn steady_external_torque_equals_applied_torque() {
    let arm = pendulum();
    let t = vec![Some(Transmission::spring(K))];
    let c = [JointCorrection::offset(Gaussian::new(0.01, 0.0))];
    for config in [RECORDED, ExternalTorqueConfig::default()] {
        let mut observer = observer(&arm, &t, &c, config);
        let (q, push) = (0.8f64, 0.35);
        let free = q + MGL * q.sin() / K + 0.01;
        observer.step(1e-3, &[q], &[free], Some(&[0.0])).unwrap();
        assert!(observer.tau_ext()[0].abs() < 1e-13);
        for _ in 0..2000 {
            let theta = free - push / K;
            observer.step(1e-3, &[q], &[theta], Some(&[0.0])).unwrap();
        }
        let found = observer.tau_ext()[0];
        // e⁻³⁰ (and e⁻⁶⁰ of the filter) of the step is left: below rounding.
        assert!((found - push).abs() < 1e-11, "{found}");
    }
}

#[test]
fn step_response_matches_gain() {
    let arm = pendulum();
    let t = vec![Some(Transmission::spring(K))];
    let mut observer = observer(&arm, &t, &[JointCorrection::default()], RECORDED);
    observer.step(1e-3, &[0.0], &[0.0], Some(&[0.0])).unwrap();
    // The step comes between two samples: a straight line over 1 ms, then constant.
    let pole = ExactPole::new(RECORDED.gain_per_s, 1e-3);
    let mut by_hand = pole.w1;
    for k in 0..200 {
        let theta = -1.0 / K;
        observer.step(1e-3, &[0.0], &[theta], Some(&[0.0])).unwrap();
        if k > 0 {
            by_hand = 1.0 - (1.0 - by_hand) * pole.a;
        }
        assert!((observer.tau_ext()[0] - by_hand).abs() < 1e-12);
    }
    // And as the continuous filter after the half sample that the straight line costs.
    let continuous = 1.0 - (-30.0f64 * 0.1995).exp();
    assert!((observer.tau_ext()[0] - continuous).abs() < 1e-4);
}

#[test]
fn uncorrected_offset_appears_as_contact_torque() {
    let arm = branching();
    let n = arm.dof();
    let t = springs(n);
    let offset = |i: usize| 0.002 * (i as f64 + 1.0);
    let c: Vec<_> = (0..n)
        .map(|i| JointCorrection::offset(Gaussian::new(offset(i), 0.0)))
        .collect();
    let none = vec![JointCorrection::default(); n];
    for config in [RECORDED, ExternalTorqueConfig::default()] {
        let mut corrected = observer(&arm, &t, &c, config);
        let mut blind = observer(&arm, &t, &none, config);
        let mut unstretched = observer(&arm, &t, &none, config);
        for k in 0..3000 {
            let [q, dq, _] = motion(1e-3 * f64::from(k), n);
            let theta: Vec<f64> = q.iter().map(|q| 1.1 * q).collect();
            let measured: Vec<f64> = theta
                .iter()
                .enumerate()
                .map(|(i, x)| x + offset(i))
                .collect();
            corrected.step(1e-3, &q, &measured, Some(&dq)).unwrap();
            blind.step(1e-3, &q, &measured, Some(&dq)).unwrap();
            unstretched.step(1e-3, &q, &theta, Some(&dq)).unwrap();
            for i in 0..n {
                let stiffness = 20.0 + 5.0 * i as f64;
                let false_contact = blind.tau_ext()[i] - corrected.tau_ext()[i];
                // Rounding of torques of some 10 N·m over a step of 1 ms.
                assert!((false_contact + stiffness * offset(i)).abs() < 1e-10);
                let same = corrected.tau_ext()[i] - unstretched.tau_ext()[i];
                assert!(same.abs() < 1e-10, "{same}");
            }
        }
    }
}

#[test]
fn contact_and_stretch_read_the_same_residual() {
    // r = K (delta_e − delta_e_hat), with the offset observer of the same gains.
    let arm = branching();
    let n = arm.dof();
    let t = springs(n);
    let c: Vec<_> = (0..n)
        .map(|i| JointCorrection::offset(Gaussian::new(0.003 * i as f64, 0.0)))
        .collect();
    let velocity = VelocityFilter::StateVariable {
        cutoff_rad_per_s: 40.0,
    };
    let config = ExternalTorqueConfig {
        gain_per_s: 20.0,
        velocity,
    };
    let mut external = observer(&arm, &t, &c, config);
    let mut offset = OffsetObserver::new(&arm, &t, OffsetConfig::default()).unwrap();
    for k in 0..3000 {
        // Neither the step nor the motion is even.
        let dt = if k % 3 == 0 { 2e-3 } else { 1e-3 };
        let [q, _, _] = motion(1.3e-3 * f64::from(k), n);
        let theta: Vec<f64> = q.iter().map(|q| 1.1 * q + 0.01).collect();
        external.step(dt, &q, &theta, None).unwrap();
        let sample = Sample {
            q: &q,
            theta_measured: &theta,
            ..Sample::default()
        };
        offset.step(dt, &sample).unwrap();
        for i in 0..n {
            let stiffness = 20.0 + 5.0 * i as f64;
            let expected = stiffness * (0.003 * i as f64 - offset.delta_e()[i]);
            let found = external.tau_ext()[i];
            assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
        }
    }
    assert!(external.is_settled());
    assert_eq!(external.settling_time_s(), offset.settling_time_s());
}

#[test]
fn threshold_equals_model_uncertainty() {
    let arm = pendulum();
    let mut spring = Transmission::spring(K);
    spring.joint_friction.coulomb_nm = 0.05;
    let t = vec![Some(spring)];
    let c = [JointCorrection {
        delta_e_rad: Gaussian::new(0.0, 0.0005),
        stiffness_factor: Gaussian::new(1.0, 0.03),
        cubic_per_rad2: 2.0,
    }];
    let tolerances = ContactTolerances {
        sigmas: 4.0,
        noise_nm: vec![0.02],
        mass_std: 0.05,
        friction_share: 1.0,
    };
    let mut observer = ExternalTorqueObserver::new(&arm, &t, &c, RECORDED, tolerances).unwrap();
    let (q, x) = (0.9f64, 0.07);
    let tau_el = K * x * (1.0 + 2.0 * x * x);
    observer.step(1e-3, &[q], &[q + x], Some(&[0.0])).unwrap();
    let parts: [f64; 4] = [
        K * (1.0 + 6.0 * x * x) * 0.0005,
        0.03 * tau_el,
        0.05 * MGL * q.sin(),
        0.02,
    ];
    let sigma = parts.iter().map(|p| p * p).sum::<f64>().sqrt();
    let found = observer.threshold()[0];
    assert!((found - (4.0 * sigma + 0.05)).abs() < 1e-12, "{found}");
    // A changed offset moves the estimate, its deviation the threshold.
    observer
        .set(0, &JointCorrection::offset(Gaussian::new(0.01, 0.0)))
        .unwrap();
    observer.step(1e-3, &[q], &[q + x], Some(&[0.0])).unwrap();
    assert!(observer.threshold()[0] < found);
}

#[test]
fn rigid_joint_has_no_torque_and_no_side_effect() {
    let arm = branching();
    let n = arm.dof();
    let (mut t, mut c) = (springs(n), known(n));
    let mut all = observer(&arm, &t, &c, ExternalTorqueConfig::default());
    t[3] = None;
    assert_eq!(
        ExternalTorqueObserver::new(&arm, &t, &c, RECORDED, ContactTolerances::new(vec![0.0; n]))
            .unwrap_err(),
        CorrectionError::Rigid { joint: 3 }
    );
    c[3] = JointCorrection::default();
    let mut some = observer(&arm, &t, &c, ExternalTorqueConfig::default());
    let mut detector = ContactDetector::new(n, ContactConfig::default()).unwrap();
    for k in 0..500 {
        let [q, _, _] = motion(1e-3 * f64::from(k), n);
        let mut theta: Vec<f64> = q.iter().map(|q| 1.1 * q).collect();
        all.step(1e-3, &q, &theta, None).unwrap();
        theta[3] = f64::NAN;
        some.step(1e-3, &q, &theta, None).unwrap();
        detector
            .step(1e-3, some.tau_ext(), some.threshold())
            .unwrap();
        for i in (0..n).filter(|i| *i != 3) {
            assert_eq!(some.tau_ext()[i], all.tau_ext()[i]);
        }
        assert!(some.tau_ext()[3].is_nan() && some.threshold()[3].is_nan());
    }
    assert!(!detector.is_touching_at(3));
    let mut set = SetPoint::new(&arm, &t, &c).unwrap();
    assert_eq!(set.hold(&vec![0.2; n], None).unwrap()[3], 0.2);
}

#[test]
fn contact_threshold_has_hysteresis() {
    let config = ContactConfig {
        release_share: 0.7,
        confirm_s: 0.0025,
    };
    let mut detector = ContactDetector::new(1, config).unwrap();
    let mut step = |tau: f64| detector.step(1e-3, &[tau], &[1.0]).unwrap();
    // Two samples above the threshold are not sufficient, and a lower value resets the count.
    assert_eq!([1.1, -1.2, 0.9, 1.1, 1.1].map(&mut step), [false; 5]);
    assert!(step(1.1));
    // Near the threshold the contact remains active; NaN keeps the state.
    assert_eq!([0.9, 1.1, -0.8, f64::NAN, 0.71].map(&mut step), [true; 5]);
    assert!(!step(0.7));
    assert!(!step(f64::NAN));
    let mut at_once = ContactDetector::new(2, ContactConfig::default()).unwrap();
    assert!(at_once.step(1e-3, &[0.0, -2.0], &[1.0, 1.0]).unwrap());
    assert!(!at_once.is_touching_at(0) && at_once.is_touching_at(1));
    at_once.reset();
    assert!(!at_once.is_touching());
}

#[test]
fn rejected_sample_keeps_external_torque_state() {
    let arm = branching();
    let n = arm.dof();
    let (t, c) = (springs(n), known(n));
    for config in [RECORDED, ExternalTorqueConfig::default()] {
        let mut observer = observer(&arm, &t, &c, config);
        let mut untouched = observer.clone();
        let (nan, short) = (vec![f64::NAN; n], vec![0.0; n - 1]);
        let huge = vec![1e59; n];
        for k in 0..300 {
            let [q, dq, _] = motion(1e-3 * f64::from(k), n);
            let theta: Vec<f64> = q.iter().map(|q| 1.1 * q).collect();
            if k % 7 == 3 {
                use StepError::{Length, NotFinite, TimeStep};
                let mut refuse = |dt, q: &[f64], theta: &[f64], dq, error| {
                    assert_eq!(observer.step(dt, q, theta, dq), Err(error));
                };
                refuse(1e-3, &nan, &theta, Some(&dq), NotFinite);
                refuse(1e-3, &q, &nan, Some(&dq), NotFinite);
                refuse(1e-3, &q, &huge, Some(&dq), NotFinite);
                refuse(1e-3, &short, &theta, Some(&dq), Length);
                refuse(1e-3, &q, &short, Some(&dq), Length);
                refuse(0.0, &q, &theta, Some(&dq), TimeStep);
                refuse(f64::NAN, &q, &theta, Some(&dq), TimeStep);
                if config == RECORDED {
                    refuse(1e-3, &q, &theta, None, Length);
                    refuse(1e-3, &q, &theta, Some(&nan), NotFinite);
                }
            }
            observer.step(1e-3, &q, &theta, Some(&dq)).unwrap();
            untouched.step(1e-3, &q, &theta, Some(&dq)).unwrap();
            assert_eq!(observer.tau_ext(), untouched.tau_ext());
        }
    }
}

#[test]
fn bad_observers_name_the_joint_and_the_value() {
    let arm = branching();
    let n = arm.dof();
    let t = springs(n);
    let build = |config, tolerances| {
        ExternalTorqueObserver::new(&arm, &t, &known(n), config, tolerances)
            .unwrap_err()
            .to_string()
    };
    let quiet = || ContactTolerances::new(vec![0.0; n]);
    let mut noisy = quiet();
    noisy.noise_nm[2] = f64::NAN;
    assert!(build(RECORDED, noisy).contains("noise (N·m) of joint 2 is NaN"));
    assert!(build(RECORDED, ContactTolerances::new(vec![])).contains("0 entries"));
    let slow = ExternalTorqueConfig {
        gain_per_s: 0.0,
        ..RECORDED
    };
    assert!(build(slow, quiet()).contains("gain of joint 0 is 0 1/s"));
    let filter = VelocityFilter::StateVariable {
        cutoff_rad_per_s: f64::NAN,
    };
    let odd = ExternalTorqueConfig {
        velocity: filter,
        ..RECORDED
    };
    assert!(build(odd, quiet()).contains("cut-off is NaN rad/s"));
    let share = ContactConfig {
        release_share: 1.5,
        ..ContactConfig::default()
    };
    assert!(ContactDetector::new(1, share).is_err());
}
