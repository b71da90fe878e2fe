//! Tendons that cross several joints: from `robot.toml` to observer and blocks, by hand.

use crate::random::Random;
use sinew_model::feeder::{Feeder, FeederOptions, RobotSample};
use sinew_model::offset::{FeatureConfig, FeatureObserver, OffsetConfig, OffsetObserver};
use sinew_model::robot::{Robot, RobotFile};
use sinew_model::tendons::{Coupling, CouplingState};

pub(crate) const URDF: &str = r#"<robot name="two">
<link name="base"/>
<link name="upper"><inertial><origin xyz="0.15 0 0.02"/><mass value="0.8"/>
<inertia ixx="0.002" ixy="0" ixz="0" iyy="0.006" iyz="0" izz="0.006"/></inertial></link>
<link name="lower"><inertial><origin xyz="0.12 0.01 0"/><mass value="0.5"/>
<inertia ixx="0.001" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.003"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" effort="20" velocity="3"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" effort="20" velocity="3"/></joint>
</robot>"#;

/// The elbow's rope runs over the shoulder; its motor sits in the base, and its drum winds the other way.
const COUPLED: &str = r#"
[joints.shoulder]
stiffness_nm_per_rad = 40.0
motor_inertia_kg_m2 = 0.1
[motors.m2]
inertia_kg_m2 = 2e-5
friction = { coulomb_nm = 0.004, viscous_nm_s_per_rad = 0.001 }
[[tendons]]
name = "forearm"
drums_mm = { m2 = -5.0 }
moment_arms_mm = { shoulder = 10.0, elbow = 20.0 }
stiffness_n_per_mm = 50.0
length_mm = 900.0
"#;

/// A differential by ratios.
const DIFFERENTIAL: &str = r#"
[joints.shoulder]
joint_friction = { coulomb_nm = 0.1, viscous_nm_s_per_rad = 0.05 }
[motors]
m1 = { inertia_kg_m2 = 0.1 }
m2 = { inertia_kg_m2 = 0.1 }
[[tendons]]
name = "left"
motor = "m1"
ratios = { shoulder = 1.0, elbow = -0.6 }
stiffness_nm_per_rad = 60.0
drum_mm = 40.0
length_mm = 500.0
[[tendons]]
name = "right"
motor = "m2"
ratios = { shoulder = -1.0, elbow = -0.6 }
stiffness_nm_per_rad = 60.0
"#;

fn build(text: &str) -> Robot {
    let file = RobotFile::parse(text, "robot.toml").unwrap_or_else(|e| panic!("{e}"));
    file.build(URDF).unwrap_or_else(|e| panic!("{e}"))
}

fn refused(text: &str) -> String {
    let built = RobotFile::parse(text, "robot.toml").and_then(|file| file.build(URDF));
    built.unwrap_err().to_string()
}

/// Positions of the motors at their shafts where the tendons carry the torques `tau_el` and have the elongations `delta`, by the coupling
/// alone: `S theta = l(q) + delta + R⁻ᵀ tau_el / k`.
fn motors(robot: &Robot, q: [f64; 2], tau_el: [f64; 2], delta: [f64; 2]) -> [f64; 2] {
    let coupling: &Coupling = robot.coupling.as_ref().unwrap();
    let mut state = CouplingState::new(coupling);
    coupling
        .evaluate(&mut state, &[0.0; 2], &q, &[0.0; 2])
        .unwrap();
    let group = &coupling.groups()[0];
    let tension = coupling
        .tension_from_torque(&state, group, &tau_el)
        .unwrap();
    let mut theta = [0.0; 2];
    for i in 0..2 {
        let s = &coupling.drums()[2 * i..2 * i + 2];
        let motor = s.iter().position(|s| *s != 0.0).unwrap();
        let l = -state.extension()[i];
        let stretch = tension[i] / coupling.stiffness(i).unwrap();
        theta[motor] = (l + delta[i] + stretch) / s[motor];
    }
    theta
}

/// Order of the motors of a coupling in that of the joints they are paired with.
fn by_joint(robot: &Robot, theta: [f64; 2]) -> [f64; 2] {
    let names = robot.coupling.as_ref().unwrap().motor_names();
    let of = |joint: usize| {
        let motor = &robot.motor_names()[joint];
        theta[names.iter().position(|name| name == motor).unwrap()]
    };
    [of(0), of(1)]
}

#[test]
fn tendon_is_described_in_joint_coordinate() {
    let robot = build(COUPLED);
    assert_eq!(robot.tendon_names(), ["shoulder", "forearm"]);
    assert_eq!(robot.motor_names(), ["shoulder", "m2"]);
    assert_eq!(robot.tendon_index("forearm"), Some(1));
    let forearm = robot.transmissions[1].as_ref().unwrap();
    // 50 N/mm on 20 mm.
    assert!((forearm.stiffness_nm_per_rad - 20.0).abs() < 1e-12);
    assert!((forearm.motor_inertia_kg_m2.unwrap() - 2e-5 * 16.0).abs() < 1e-15);
    assert!((forearm.motor_friction.coulomb_nm - 0.016).abs() < 1e-15);
    assert!((forearm.motor_friction.viscous_nm_s_per_rad - 0.016).abs() < 1e-15);
    let rope = forearm.tendon.as_ref().unwrap();
    assert!((rope.elongation_m(0.01) - 0.2e-3).abs() < 1e-15);
    let routing = forearm.routing.as_ref().unwrap();
    assert_eq!(routing.moment_arms, [0.5, 1.0]);
    assert!((routing.drive_ratio + 0.25).abs() < 1e-15);
    // The shoulder's own tendon carries what the other one does not.
    let shoulder = robot.transmissions[0].as_ref().unwrap();
    let routing = shoulder.routing.as_ref().unwrap();
    assert_eq!(routing.moment_arms, [1.0, 0.0]);
    assert!((routing.torque_shares[1] + 0.5).abs() < 1e-12);
}

#[test]
fn single_joint_tendon_equals_shorthand() {
    let text = "[joints.shoulder]\nstiffness_nm_per_rad = 40.0\n[joints.elbow]\nstiffness_nm_per_rad = 20.0\n";
    let robot = build(text);
    assert!(robot.coupling.is_none());
    let routed = |t: &sinew_model::transmission::Transmission| t.routing.is_some();
    assert!(!robot.transmissions.iter().flatten().any(routed));
}

#[test]
fn observer_estimates_elongation_at_rest() {
    for text in [COUPLED, DIFFERENTIAL] {
        let robot = build(text);
        let (q, delta_rad) = ([0.4, -0.7], [3e-3, -2e-3]);
        let mut gravity = sinew_model::arm::ArmWorkspace::new(&robot.arm);
        let terms = robot.arm.momentum(&mut gravity, &q, &[0.0; 2]).unwrap();
        let tau_el = [terms.g[0], terms.g[1]];
        // From rad of the joints to the coordinates of the tendons.
        let coupling = robot.coupling.as_ref().unwrap();
        let paired = coupling.paired().unwrap();
        let mut delta = [0.0; 2];
        for (pair, rad) in paired.iter().flatten().zip(delta_rad) {
            delta[pair.tendon] = rad * pair.units_per_rad;
        }
        let theta = by_joint(&robot, motors(&robot, q, tau_el, delta));
        let observer =
            OffsetObserver::new(&robot.arm, &robot.transmissions, OffsetConfig::default()).unwrap();
        let mut feeder = Feeder::new(observer, &robot.transmissions, FeederOptions::default());
        for k in 0..2000_i64 {
            let reading = RobotSample {
                time_ns: k * 1_000_000,
                segment: 0,
                q: &q,
                theta: &theta,
                dq: &[],
                tau_el: &[],
                tau_m: &[],
                tau_ext: &[],
                tension: &[],
                temperature_c: f64::NAN,
            };
            feeder.take(&reading);
        }
        for (read, is) in feeder.observer().delta_e().iter().zip(delta_rad) {
            assert!((read - is).abs() < 1e-9, "{read} {is}");
        }
    }
}

/// Blocks of a coupled robot are those of one whose joints have tendons of their own, by `rho` and `B`.
#[test]
fn blocks_are_combinations_of_those_of_the_joints() {
    let robot = build(DIFFERENTIAL);
    let rows = |row: fn(&sinew_model::tendons::Routing) -> &Vec<f64>| -> Vec<Vec<f64>> {
        let all = robot.transmissions.iter().flatten();
        all.map(|t| row(t.routing.as_ref().unwrap()).clone())
            .collect()
    };
    let (rho, shares) = (rows(|r| &r.moment_arms), rows(|r| &r.torque_shares));
    // B rhoᵀ is the identity.
    for i in 0..2 {
        for k in 0..2 {
            let sum: f64 = (0..2).map(|j| shares[i][j] * rho[k][j]).sum();
            assert!((sum - f64::from(u8::from(i == k))).abs() < 1e-12);
        }
    }
    let config = FeatureConfig::default();
    let mut plain = FeatureObserver::new(&robot.arm, config);
    let coupled = FeatureObserver::new(&robot.arm, config).with_transmissions(&robot.transmissions);
    let mut feeder = Feeder::new(coupled, &robot.transmissions, FeederOptions::default());
    let mut random = Random(5);
    let phase: Vec<f64> = (0..4).map(|_| 6.0 * random.uniform()).collect();
    let mut compared = 0;
    for k in 0..4000_i64 {
        let t = 2e-3 * k as f64;
        let q = [(1.1 * t + phase[0]).sin(), 0.8 * (1.7 * t + phase[1]).sin()];
        let motor = [(0.9 * t + phase[2]).cos(), 0.5 * (1.3 * t + phase[3]).sin()];
        let torque = [2.0 * (0.7 * t).sin(), 1.0 + (0.5 * t).cos()];
        // The plain observer sees the motors as positions in the coordinates of the tendons.
        let ratio = |i: usize| {
            let t = robot.transmissions[i].as_ref().unwrap();
            t.routing.as_ref().unwrap().drive_ratio
        };
        let theta = [0, 1].map(|i| ratio(i) * motor[i]);
        let reading = RobotSample {
            time_ns: k * 2_000_000,
            segment: 0,
            q: &q,
            theta: &motor,
            dq: &[],
            tau_el: &[],
            tau_m: &torque,
            tau_ext: &[],
            tension: &[],
            temperature_c: f64::NAN,
        };
        let there = feeder.take(&reading).output().unwrap_or(false);
        let slot = [0, 1].map(|i| torque[i] / ratio(i));
        let here = plain.step(2e-3, &q, &theta, &slot, f64::NAN).unwrap();
        assert_eq!(here, there);
        if !here {
            continue;
        }
        compared += 1;
        let (a, b) = (plain.block(), feeder.observer().block());
        let close = |x: f64, y: f64, what: &str| {
            assert!((x - y).abs() < 1e-9 * (1.0 + x.abs()), "{what}: {x} {y}");
        };
        let columns = a.phi.len() / 2;
        for i in 0..2 {
            // y_i = theta_i − Σ rho_ij q_j.
            let moved: f64 = (0..2).map(|j| rho[i][j] * a.turned[j]).sum();
            close(a.y[i] + a.turned[i] - moved, b.y[i], "y");
            for c in 0..columns {
                let sum: f64 = (0..2).map(|j| shares[i][j] * a.phi[j * columns + c]).sum();
                close(sum, b.phi[i * columns + c], "phi");
            }
            for (x, y, what) in [
                (&a.z, &b.z, "z"),
                (&a.dq, &b.dq, "dq"),
                (&a.turned, &b.turned, "turned"),
                (&a.motor_torque, &b.motor_torque, "torque"),
                (&a.motor_velocity, &b.motor_velocity, "velocity"),
                (&a.motor_acceleration, &b.motor_acceleration, "acceleration"),
                (&a.motor_z, &b.motor_z, "motor z"),
                (&a.motor_stood, &b.motor_stood, "stood"),
            ] {
                close(x[i], y[i], what);
            }
        }
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn tendon_error_names_problem() {
    let slip = |from: &str, to: &str| {
        assert!(COUPLED.contains(from), "{from}");
        refused(&COUPLED.replacen(from, to, 1))
    };
    for (from, to, expected) in [
        (
            "m2 = -5.0",
            "m3 = -5.0",
            "tendon 'forearm' names motor 'm3', which does not exist; choose one of: shoulder, m2",
        ),
        (
            "elbow = 20.0",
            "wrist = 20.0",
            "tendon 'forearm' names joint 'wrist', which does not exist",
        ),
        ("drums_mm = { m2 = -5.0 }\n", "", "drums_mm is missing"),
        (
            "stiffness_n_per_mm = 50.0",
            "stiffness_nm_per_rad = 50.0",
            "has both lengths in mm and keys that belong to ratios",
        ),
        (
            "stiffness_n_per_mm = 50.0",
            "stiffness_n_per_mm = -1.0",
            "tendons[0].stiffness_n_per_mm = -1.0 (N/mm): must be above 0",
        ),
        (
            "elbow = 20.0",
            "elbow = 0.0",
            "must be a number that is not 0: drop the entry",
        ),
        (
            "elbow = 20.0",
            "elbow = \"arm.csv\"",
            "is the table 'arm.csv', which has not been read",
        ),
        (
            "name = \"forearm\"",
            "name = \"shoulder\"",
            "tendon name 'shoulder' is empty or occurs twice",
        ),
        (
            "name = \"forearm\"",
            "name = \"forearm\"\nkind = \"strand\"",
            "all strands pull joint 'elbow' the same way",
        ),
        (
            "m2 = -5.0",
            "m2 = -5.0, shoulder = 3.0",
            "tendon 'forearm' has 2 motors",
        ),
        ("length_mm = 900.0", "rope = \"x\"", "length_mm is missing"),
        (
            "length_mm = 900.0",
            "lenght_mm = 900.0",
            "did you mean 'length_mm'",
        ),
        ("shoulder = 10.0, elbow = 20.0", "elbow = 20.0", ""),
    ] {
        if expected.is_empty() {
            // One joint and one motor, but with a name of its own.
            assert!(
                RobotFile::parse(&COUPLED.replacen(from, to, 1), "robot.toml")
                    .unwrap()
                    .build(URDF)
                    .is_ok()
            );
            continue;
        }
        let error = slip(from, to);
        assert!(
            error.contains(expected) && error.contains("robot.toml, line"),
            "{from}: {error}"
        );
    }
    // A joint that nothing drives.
    let error = refused(
        &COUPLED
            .replacen("elbow = 20.0", "shoulder = 20.0", 1)
            .replacen("shoulder = 10.0, ", "", 1),
    );
    assert!(
        error.contains("joint 'elbow' of the URDF is missing"),
        "{error}"
    );
}
