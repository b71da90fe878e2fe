//! Corrected torque and set-points: closed forms, identities, refusals.

use crate::spring_arms::{K, MGL, branching, known, motion, pendulum, springs};
use sinew_model::Gaussian;
use sinew_model::StepError;
use sinew_model::arm::{ArmWorkspace, BodyInertia};
use sinew_model::correction::{Correction, CorrectionError, JointCorrection, SetPoint, Spring};
use sinew_model::transmission::Transmission;

#[test]
fn spring_inverse_recovers_deflection() {
    for c in [0.0, 1e-12, 0.5, 2.0, 6.0, 1e4, -0.5, -2.0] {
        let spring = Spring::new(40.0, c).unwrap();
        for k in -60..=60 {
            let x = 0.006 * f64::from(k);
            // A softening spring is one to one up to x² = 1/(3|c|).
            if c < 0.0 && 3.0 * -c * x * x >= 0.98 {
                continue;
            }
            let back = spring.deflection(spring.torque(x)).unwrap();
            // Near its largest torque the inverse of a softening spring is steep: rounding grows
            // with 1/(1 + 3 c x²), at most 50 here.
            assert!((back - x).abs() <= 1e-14, "c {c}: {back} for {x}");
        }
    }
}

#[test]
fn offsets_are_read_back_as_they_were_set() {
    let mut transmissions = springs(2);
    transmissions[1] = None;
    let stretched = |mean| JointCorrection::offset(Gaussian::new(mean, 1e-3));
    let corrections = [stretched(3e-3), JointCorrection::default()];
    let mut correction = Correction::new(&transmissions, &corrections).unwrap();
    let read = |c: &Correction| [0, 1, 2].map(|joint| c.delta_e(joint));
    assert_eq!(read(&correction), [Some(3e-3), None, None]);
    correction.set(0, &stretched(-2e-3)).unwrap();
    assert_eq!(read(&correction), [Some(-2e-3), None, None]);
}

#[test]
fn stiffening_by_hand() {
    // 40 · 0.1 · (1 + 2 · 0.01) = 4.08; slope 40 · (1 + 6 · 0.01) = 42.4.
    let spring = Spring::new(40.0, 2.0).unwrap();
    assert!((spring.torque(0.1) - 4.08).abs() < 1e-15);
    assert!((spring.slope(0.1) - 42.4).abs() < 1e-13);
    assert!((spring.deflection(4.08).unwrap() - 0.1).abs() < 1e-15);
    assert!((spring.deflection(-4.08).unwrap() + 0.1).abs() < 1e-15);
}

#[test]
fn softening_spring_rejects_torque_above_maximum() {
    // Largest torque (2/3) K x at x = 1/√(3|c|): 40 · (2/3) · 0.5 = 13.33 for |c| = 4/3.
    let spring = Spring::new(40.0, -4.0 / 3.0).unwrap();
    let most = 40.0 * 2.0 / 3.0 * 0.5;
    assert!(spring.deflection(most * (1.0 - 1e-12)).is_some());
    assert_eq!(spring.deflection(most * (1.0 + 1e-9)), None);
    assert_eq!(spring.deflection(f64::NAN), None);
    assert_eq!(spring.deflection(f64::INFINITY), None);
    let mut t = springs(1);
    t[0].as_mut().unwrap().stiffness_nm_per_rad = 1.0;
    let soft = JointCorrection {
        cubic_per_rad2: -4.0 / 3.0,
        ..JointCorrection::default()
    };
    let mut set = SetPoint::new(&pendulum(), &t, &[soft]).unwrap();
    let before = set.hold(&[0.1], None).unwrap().to_vec();
    // It carries 0.333 N·m; the pendulum requires 1.47 N·m at 90°.
    assert_eq!(
        set.hold(&[1.57], None).unwrap_err(),
        StepError::Spring { joint: 0 }
    );
    assert_eq!(set.theta_set(), before);
}

#[test]
fn pendulum_set_point_matches_closed_form() {
    let arm = pendulum();
    let t = vec![Some(Transmission::spring(K))];
    let mut set = SetPoint::new(
        &arm,
        &t,
        &[JointCorrection::offset(Gaussian::new(0.01, 0.0))],
    )
    .unwrap();
    for k in -10..=10 {
        let q = 0.3 * f64::from(k);
        let by_hand = q + MGL * q.sin() / K + 0.01;
        let theta = set.hold(&[q], None).unwrap()[0];
        assert!((theta - by_hand).abs() < 1e-14, "{theta} for {by_hand}");
        assert!((set.tau_el()[0] - MGL * q.sin()).abs() < 1e-14);
    }
    // In motion: M = m l², no Coriolis in one joint; a push of 0.2 N·m helps.
    let theta = set.follow(&[0.5], &[2.0], &[3.0], Some(&[0.2])).unwrap()[0];
    let tau = 0.5 * 0.09 * 3.0 + MGL * 0.5f64.sin() - 0.2;
    assert!((theta - (0.5 + tau / K + 0.01)).abs() < 1e-14);
}

#[test]
fn at_its_set_point_the_arm_stays_where_it_is_wanted() {
    // The stretched, stiffening springs at (theta_set, q_d) carry gravity: no acceleration.
    let arm = branching();
    let n = arm.dof();
    let (t, c) = (springs(n), known(n));
    let payload = BodyInertia::point(0.4, [0.0, 0.0, 0.05]);
    let loaded = arm.with_payload("left_tip", payload).unwrap().unwrap();
    for arm in [arm, loaded] {
        let mut set = SetPoint::new(&arm, &t, &c).unwrap();
        let mut ws = ArmWorkspace::new(&arm);
        let mut tau_el = vec![0.0; n];
        let mut ddq = vec![0.0; n];
        for k in 0..20 {
            let [q, dq, wanted] = motion(0.3 * f64::from(k), n);
            let still = vec![0.0; n];
            let theta = set.hold(&q, None).unwrap().to_vec();
            set.correction()
                .elastic_torque(&theta, &q, &mut tau_el)
                .unwrap();
            arm.forward_dynamics(&mut ws, &q, &still, &tau_el, &mut ddq)
                .unwrap();
            // Rounding of the torque (1e-14) over the smallest inertia of this arm, some 1e-4.
            assert!(ddq.iter().all(|a| a.abs() < 1e-9), "{ddq:?}");

            // In motion with friction: the desired acceleration.
            let theta = set.follow(&q, &dq, &wanted, None).unwrap().to_vec();
            set.correction()
                .elastic_torque(&theta, &q, &mut tau_el)
                .unwrap();
            for (i, tau) in tau_el.iter_mut().enumerate() {
                *tau -= t[i].as_ref().unwrap().joint_friction.torque(dq[i]);
            }
            arm.forward_dynamics(&mut ws, &q, &dq, &tau_el, &mut ddq)
                .unwrap();
            for (a, b) in ddq.iter().zip(&wanted) {
                assert!((a - b).abs() < 1e-9, "{a} for {b}");
            }
        }
    }
}

#[test]
fn default_correction_is_identity() {
    let n = 3;
    let none = Correction::none(&springs(n)).unwrap();
    let (theta, q) = ([0.3, -0.2, 0.7], [0.1, 0.0, 0.9]);
    let (mut out, mut tau) = ([0.0; 3], [0.0; 3]);
    none.motor_position(&theta, &mut out).unwrap();
    none.elastic_torque(&theta, &q, &mut tau).unwrap();
    assert_eq!(out, theta);
    for i in 0..n {
        assert_eq!(tau[i], (20.0 + 5.0 * i as f64) * (theta[i] - q[i]));
    }
}

#[test]
fn bad_configurations_name_the_joint_and_the_value() {
    let arm = branching();
    let n = arm.dof();
    let t = springs(n);
    let with = |change: &dyn Fn(&mut JointCorrection)| {
        let mut c = known(n);
        change(&mut c[4]);
        Correction::new(&t, &c).unwrap_err().to_string()
    };
    let message = with(&|c| c.delta_e_rad.mean = f64::NAN);
    assert!(message.contains("joint 4 is NaN rad"), "{message}");
    let message = with(&|c| c.delta_e_rad.std = -1.0);
    assert!(message.contains("offset of joint 4 is -1"), "{message}");
    let message = with(&|c| c.stiffness_factor.mean = 0.0);
    assert!(message.contains("joint 4 is 0 N·m/rad"), "{message}");
    let message = with(&|c| c.cubic_per_rad2 = f64::INFINITY);
    assert!(message.contains("joint 4 is inf 1/rad²"), "{message}");

    let short = Correction::new(&t, &known(n - 1)).unwrap_err();
    assert_eq!(
        short,
        CorrectionError::Length {
            expected: n,
            found: n - 1
        }
    );
    let mut correction = Correction::new(&t, &known(n)).unwrap();
    let before = correction.clone();
    let bad = JointCorrection::offset(Gaussian::new(f64::INFINITY, 0.0));
    assert!(correction.set(1, &bad).is_err());
    assert_eq!(
        correction.set(n, &JointCorrection::default()),
        Err(CorrectionError::Rigid { joint: n })
    );
    assert_eq!(correction, before);
    // Factors refer to the description, however often they are set.
    for _ in 0..2 {
        let half = JointCorrection {
            stiffness_factor: Gaussian::new(0.5, 0.0),
            ..JointCorrection::default()
        };
        correction.set(0, &half).unwrap();
        assert_eq!(correction.spring(0).unwrap().stiffness_nm_per_rad(), 10.0);
    }
}
