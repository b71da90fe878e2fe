//! Corrected torque, set-points and external torque of robots whose tendons cross several joints.

use crate::spring_arms::motion;
use sinew_model::Gaussian;
use sinew_model::arm::ArmWorkspace;
use sinew_model::correction::{
    ContactTolerances, Correction, CorrectionError, ExternalTorqueConfig, ExternalTorqueObserver,
    JointCorrection, SetPoint,
};
use sinew_model::offset::VelocityFilter;
use sinew_model::robot::{Robot, RobotFile};
use sinew_model::tendons::CouplingState;
use sinew_model::transmission::Transmission;

const RECORDED: ExternalTorqueConfig = ExternalTorqueConfig {
    gain_per_s: 30.0,
    velocity: VelocityFilter::Recorded,
};

/// The coupled arm and the differential wrist that are shipped; one motor of the latter counts backwards.
fn robots() -> [Robot; 2] {
    let read = |text: &str, urdf: &str| {
        let file = RobotFile::parse(text, "robot.toml");
        file.and_then(|f| f.build(urdf)).unwrap()
    };
    [
        read(
            include_str!("../../robots/coupled-arm/robot.toml"),
            include_str!("../../robots/coupled-arm/coupled-arm.urdf"),
        ),
        read(
            include_str!("../../robots/differential-wrist/robot.toml"),
            include_str!("../../robots/differential-wrist/differential-wrist.urdf"),
        ),
    ]
}

fn known(n: usize, stiffness_factor: f64, cubic_per_rad2: f64) -> Vec<JointCorrection> {
    (0..n)
        .map(|i| JointCorrection {
            delta_e_rad: Gaussian::new(0.004 * (i as f64 - 0.7), 0.0),
            stiffness_factor: Gaussian::new(stiffness_factor + 0.05 * i as f64, 0.0),
            cubic_per_rad2,
        })
        .collect()
}

fn of(robot: &Robot, i: usize) -> &Transmission {
    robot.transmissions[i].as_ref().unwrap()
}

/// The gravity torque comes from the description's coupling, whose motors, tendons and units are independent of the
/// pairing with joints.
#[test]
fn set_points_hold_joints_at_desired_positions() {
    for robot in robots() {
        let n = robot.arm.dof();
        let no_stiffening: Vec<_> = (0..n)
            .map(|i| JointCorrection::offset(Gaussian::new(0.004 * (i as f64 - 0.7), 0.0)))
            .collect();
        let mut set = SetPoint::new(&robot.arm, &robot.transmissions, &no_stiffening).unwrap();
        let coupling = robot.coupling.as_ref().unwrap();
        let mut state = CouplingState::new(coupling);
        let (tendons, motors) = (robot.tendon_names(), robot.motor_names());
        let place = |names: &[String], name: &str| names.iter().position(|n| n == name).unwrap();
        let q: Vec<f64> = (0..n).map(|i| 0.4 - 0.5 * i as f64).collect();
        let theta_set = set.hold(&q, None).unwrap().to_vec();
        let theta: Vec<f64> = (coupling.motor_names().iter())
            .map(|name| theta_set[place(&motors, name)])
            .collect();
        let none = vec![0.0; tendons.len()];
        coupling.evaluate(&mut state, &theta, &q, &none).unwrap();
        let delta: Vec<f64> = (coupling.tendon_names().enumerate())
            .map(|(t, name)| {
                let i = place(&tendons, name);
                state.moment_arms()[t * n + i].abs() * no_stiffening[i].delta_e_rad.mean
            })
            .collect();
        coupling.evaluate(&mut state, &theta, &q, &delta).unwrap();
        let mut ws = ArmWorkspace::new(&robot.arm);
        let g = robot.arm.momentum(&mut ws, &q, &vec![0.0; n]).unwrap().g;
        for j in 0..n {
            assert!((state.tau_el()[j] - g[j]).abs() < 1e-12, "{}", robot.name);
            assert!((set.tau_el()[j] - g[j]).abs() < 1e-15);
            let k = place(coupling.motor_names(), &motors[j]);
            let ratio = (of(&robot, j).routing.as_ref()).map_or(1.0, |r| r.drive_ratio);
            let motor = ratio * set.tendon_torque()[j];
            assert!((state.tau_motor()[k] - motor).abs() < 1e-12);
        }
    }
}

#[test]
fn set_point_torque_equals_spring_torque() {
    for robot in robots() {
        let n = robot.arm.dof();
        let corrections = known(n, 0.9, 1.3);
        let mut set = SetPoint::new(&robot.arm, &robot.transmissions, &corrections).unwrap();
        let without: Vec<_> = (corrections.iter())
            .map(|c| JointCorrection {
                delta_e_rad: Gaussian::new(0.0, 0.0),
                ..*c
            })
            .collect();
        let without = Correction::new(&robot.transmissions, &without).unwrap();
        let (mut tau_el, mut of_motor, mut theta) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in 0..20 {
            let [q, dq, ddq] = motion(0.3 * f64::from(k), n);
            let measured = set.follow(&q, &dq, &ddq, None).unwrap().to_vec();
            let correction = set.correction();
            correction
                .elastic_torque(&measured, &q, &mut tau_el)
                .unwrap();
            for (found, wanted) in tau_el.iter().zip(set.tau_el()) {
                assert!((found - wanted).abs() < 1e-12, "{found} for {wanted}");
            }
            correction.motor_position(&measured, &mut theta).unwrap();
            without.elastic_torque(&theta, &q, &mut of_motor).unwrap();
            for (a, b) in of_motor.iter().zip(&tau_el) {
                assert!((a - b).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn coupled_external_torque_equals_applied_torque() {
    for robot in robots() {
        let n = robot.arm.dof();
        let corrections = known(n, 0.9, 1.3);
        let mut set = SetPoint::new(&robot.arm, &robot.transmissions, &corrections).unwrap();
        let mut observer = ExternalTorqueObserver::new(
            &robot.arm,
            &robot.transmissions,
            &corrections,
            RECORDED,
            ContactTolerances::new(vec![0.0; n]),
        )
        .unwrap();
        let push: Vec<f64> = (0..n).map(|i| 0.3 - 0.25 * i as f64).collect();
        for k in 0..3000 {
            let [q, dq, ddq] = motion(1e-3 * f64::from(k), n);
            let theta = set.follow(&q, &dq, &ddq, Some(&push)).unwrap();
            observer.step(1e-3, &q, theta, Some(&dq)).unwrap();
        }
        for (found, applied) in observer.tau_ext().iter().zip(&push) {
            // The trapezoidal rule over a millisecond of this motion.
            assert!((found - applied).abs() < 1e-4, "{found} for {applied}");
        }
    }
}

/// In mm of rope: the left loop has 16 and 12 mm, 40 N/mm, and an offset with a standard deviation of 0.1 mm.
#[test]
fn tendon_uncertainty_widens_thresholds_of_crossed_joints() {
    let [_, robot] = robots();
    let tendons = robot.tendon_names();
    let left = tendons.iter().position(|name| name == "left").unwrap();
    let radius_mm = [16.0, 12.0][left];
    let mut corrections = vec![JointCorrection::default(); 2];
    corrections[left].delta_e_rad.std = 0.1 / radius_mm;
    let mut tolerances = ContactTolerances::new(vec![0.0; 2]);
    tolerances.friction_share = 0.0;
    let (arm, t) = (&robot.arm, &robot.transmissions);
    let mut observer =
        ExternalTorqueObserver::new(arm, t, &corrections, RECORDED, tolerances).unwrap();
    let mut set = SetPoint::new(arm, t, &corrections).unwrap();
    let q = [0.3, -0.2];
    let theta = set.hold(&q, None).unwrap();
    observer.step(1e-3, &q, theta, Some(&[0.0; 2])).unwrap();
    let sigma_n = 40.0 * 0.1;
    for (found, radius_mm) in observer.threshold().iter().zip([16.0, 12.0]) {
        let by_hand = 4.0 * sigma_n * 1e-3 * radius_mm;
        assert!((found - by_hand).abs() < 1e-12, "{found} for {by_hand}");
    }
    // A stiffness known to 10 %.
    corrections[left].delta_e_rad.std = 0.0;
    corrections[left].stiffness_factor.std = 0.1;
    observer.set(left, &corrections[left]).unwrap();
    observer.step(1e-3, &q, theta, Some(&[0.0; 2])).unwrap();
    let f = set.tendon_torque()[left] / (1e-3 * [16.0, 12.0][left]);
    for (found, radius_mm) in observer.threshold().iter().zip([16.0, 12.0]) {
        let by_hand = 4.0 * (0.1 * f * 1e-3 * radius_mm).abs();
        assert!((found - by_hand).abs() < 1e-9, "{found} for {by_hand}");
    }
}

#[test]
fn routing_of_other_robot_returns_error() {
    let [coupled, _] = robots();
    let two = &coupled.transmissions[..2];
    let refused = Correction::none(two).unwrap_err();
    let expected = CorrectionError::Length {
        expected: 2,
        found: 3,
    };
    assert_eq!(refused, expected);
}
