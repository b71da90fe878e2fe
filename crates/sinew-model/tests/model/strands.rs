//! Groups with one equation per joint: from `robot.toml` to axes, and from samples to blocks.

use crate::routing::URDF;
use sinew_model::feeder::{Feeder, FeederOptions, RobotSample};
use sinew_model::offset::{
    FeatureConfig, FeatureObserver, JointParameter, Payload, Prior, StateEstimate, group_posteriors,
};
use sinew_model::robot::{Robot, RobotFile};
use sinew_model::tendons::{MomentArm, Routings, TendonKind};
use sinew_model::tolerances::Tolerances;

/// A shoulder with a tendon of its own; two strands pull the elbow, the flexor by a moment arm that varies.
const ANTAGONIST: &str = r#"
[joints.shoulder]
stiffness_nm_per_rad = 40.0
[joints.elbow]
joint_friction = { coulomb_nm = 0.04, viscous_nm_s_per_rad = 0.03 }
[motors.flexor]
inertia_kg_m2 = 0.002
[motors.extensor]
inertia_kg_m2 = 0.002
[[tendons]]
name = "flexor"
kind = "strand"
drums_mm = { flexor = 10.0 }
moment_arms_mm = { elbow = "arm.csv" }
stiffness_n_per_mm = 20.0
pretension_n = 60.0
length_mm = 400.0
[[tendons]]
name = "extensor"
kind = "strand"
drums_mm = { extensor = -10.0 }
moment_arms_mm = { elbow = -20.0 }
stiffness_n_per_mm = 20.0
pretension_n = 50.0
length_mm = 400.0
"#;

/// One strand bends both joints, which springs open.
const SPRUNG: &str = r#"
[joints.shoulder]
spring = { stiffness_nm_per_rad = 0.6, rest_rad = -0.5 }
joint_friction = { coulomb_nm = 0.004, viscous_nm_s_per_rad = 0.003 }
[joints.elbow]
spring = { stiffness_nm_per_rad = 0.4, rest_rad = -0.6 }
[motors.m1]
inertia_kg_m2 = 0.0002
[[tendons]]
name = "flexor"
kind = "strand"
drums_mm = { m1 = 5.0 }
moment_arms_mm = { shoulder = 7.0, elbow = 5.0 }
stiffness_n_per_mm = 22.0
"#;

/// Shortening of 20 mm/rad at zero, 15 at −1 and 25 at 1 rad.
const ARM: &str = "q_rad,shortening_mm\n-1.0,-17.5\n-0.5,-9.375\n0.0,0.0\n0.5,10.625\n1.0,22.5\n";

fn file(text: &str) -> RobotFile {
    RobotFile::parse(text, "robot.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn antagonist() -> Robot {
    let file = file(ANTAGONIST).with_table("arm.csv", "arm.csv", ARM);
    let built = file.and_then(|file| file.build(URDF));
    built.unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn second_strand_has_axis_after_joints() {
    let robot = antagonist();
    assert_eq!(robot.axes(), 3);
    assert_eq!(robot.tendon_names(), ["shoulder", "flexor", "extensor"]);
    assert_eq!(robot.motor_names(), ["shoulder", "flexor", "extensor"]);
    let names: Vec<&str> = (0..3).map(|axis| robot.axis_name(axis)).collect();
    assert_eq!(names, ["shoulder", "elbow", "extensor"]);
    assert!(robot.has_joint_equations() && robot.pulling_tendon(0).is_none());
    let pull = |axis: usize| {
        let transmission = robot.transmissions[axis].as_ref().unwrap();
        let routing = transmission.routing.as_ref().unwrap();
        (transmission, routing, routing.pull.as_ref().unwrap())
    };
    let (transmission, routing, own) = pull(2);
    // Its coordinate is the rad of the elbow: 20 mm.
    assert!((routing.drive_ratio + 0.5).abs() < 1e-12);
    assert_eq!(routing.moment_arms, [0.0, -1.0]);
    assert_eq!(routing.joint, 1);
    assert!((transmission.stiffness_nm_per_rad - 20e3 * 4e-4).abs() < 1e-9);
    assert!((own.pretension_nm - 50.0 * 0.02).abs() < 1e-12);
    assert_eq!(own.kind, TendonKind::Strand);
    assert_eq!(own.joints[0].friction.coulomb_nm, 0.04);
    let (_, routing, own) = pull(1);
    assert!((routing.moment_arms[1] - 1.0).abs() < 1e-12);
    let MomentArm::Table(table) = &own.joints[0].arm else {
        panic!("{:?}", own.joints);
    };
    // l = 20 q + 2.5 q² mm.
    for q in [-0.8, 0.3, 0.9] {
        let [l, arm, _] = table.evaluate(q);
        assert!((l - (q + 0.125 * q * q)).abs() < 1e-12, "{q}: {l}");
        assert!((arm - (1.0 + 0.25 * q)).abs() < 1e-12, "{q}: {arm}");
    }
    // At the motor's shaft and back.
    let q = [0.1, 0.7];
    let reflected = routing.reflected(1, 0.9, &q);
    let by_hand = routing.drive_ratio * 0.9 - (0.7 + 0.125 * 0.49) + 0.7;
    assert!((reflected - by_hand).abs() < 1e-12);
    assert!((routing.at_motor(1, reflected, &q) - 0.9).abs() < 1e-12);
}

#[test]
fn joint_without_motor_has_equation() {
    let robot = file(SPRUNG).build(URDF).unwrap();
    assert_eq!(robot.axes(), 2);
    let has_tendon: Vec<bool> = robot.transmissions.iter().map(Option::is_some).collect();
    assert_eq!(has_tendon, [true, false]);
    let prior = Prior::new(
        &robot.arm,
        &robot.transmissions,
        1,
        [0.0; 3],
        Tolerances::default(),
    );
    assert!(prior.is_elastic(0) && !prior.is_elastic(1));
    let state_estimate = prior.state_estimate(Payload::Empty, 0.03);
    let std = |axis, parameter| state_estimate.entry(prior.place(axis, parameter)).std;
    // The friction of the joint is free; that of a missing tendon is fixed.
    assert!(std(1, JointParameter::Coulomb) > 1e-6);
    assert!(std(1, JointParameter::Offset) < 1e-8);
    assert!(std(0, JointParameter::Offset) > 0.02);
    let springs = (0..prior.dimension()).filter_map(|k| prior.describe(k));
    let springs = springs.filter(|entry| entry.name.starts_with("joint spring"));
    let of: Vec<Option<usize>> = springs.map(|entry| entry.joint).collect();
    assert_eq!(of, [Some(0), Some(0), Some(1), Some(1)]);
}

#[test]
fn invalid_moment_arm_table_error_names_location() {
    for (text, expected) in [
        ("q_rad,arm_mm\n0,1\n", "shortening_mm"),
        ("q_rad,shortening_mm\n0,0\n1,2\n", "between 4"),
        (
            "q_rad,shortening_mm\n0,0\n1,2\n0.5,3\n2,4\n",
            "must increase",
        ),
        ("q_rad,shortening_mm\n0,0\n1,x\n2,3\n3,4\n", "line 3"),
    ] {
        let refused = file(ANTAGONIST).with_table("arm.csv", "arm.csv", text);
        let refused = refused.unwrap_err().to_string();
        assert!(refused.contains(expected), "{refused}");
    }
    let unread = file(ANTAGONIST).build(URDF).unwrap_err().to_string();
    assert!(unread.contains("has not been read"), "{unread}");
}

/// Both strands on one motor: the second axis has no motor of its own.
#[test]
fn strands_that_share_a_motor_have_its_position() {
    let text = ANTAGONIST
        .replace("\"arm.csv\"", "20.0")
        .replace("{ extensor = -10.0 }", "{ flexor = -10.0 }");
    let robot = file(&text).build(URDF).unwrap();
    assert!(!robot.shares_motor(1) && robot.shares_motor(2));
    let routings = Routings::of(&robot.transmissions).unwrap();
    assert_eq!([0, 1, 2].map(|axis| routings.motor_axis(axis)), [0, 1, 1]);
    let features = FeatureObserver::new(&robot.arm, FeatureConfig::default())
        .with_transmissions(&robot.transmissions);
    let mut feeder = Feeder::new(features, &robot.transmissions, FeederOptions::default());
    let reading = RobotSample {
        time_ns: 0,
        segment: 0,
        q: &[0.1, 0.4, 0.0],
        theta: &[0.2, 0.9, f64::NAN],
        dq: &[],
        tau_el: &[],
        tau_m: &[f64::NAN; 3],
        tau_ext: &[],
        tension: &[],
        temperature_c: 20.0,
    };
    assert!(feeder.take(&reading).output().is_some());
    // y = s theta / a − rho q.
    let extension = |axis: usize| feeder.theta()[axis] - reading.q[axis];
    assert!((extension(1) - (0.5 * 0.9 - 0.4)).abs() < 1e-12);
    assert!((extension(2) - (-0.5 * 0.9 + 0.4)).abs() < 1e-12);
}

/// With two antagonistic strands the joint determines the difference; the sum keeps its prior.
#[test]
fn common_tension_of_pair_is_unobservable() {
    let text = ANTAGONIST.replace("\"arm.csv\"", "20.0");
    let robot = file(&text).build(URDF).unwrap();
    let prior = Prior::new(
        &robot.arm,
        &robot.transmissions,
        1,
        [0.0; 3],
        Tolerances::default(),
    );
    const BEFORE_RAD: f64 = 0.03;
    let before = prior.state_estimate(Payload::Empty, BEFORE_RAD);
    let mut after: StateEstimate = before.clone();
    let d = prior.dimension();
    let [a, b] = [1, 2].map(|axis| prior.place(axis, JointParameter::Offset));
    (after.mean[a], after.mean[b]) = (0.012, 0.004);
    // The difference is known to 0.1 mrad, the sum as before.
    let (sum, difference) = (0.5 * BEFORE_RAD * BEFORE_RAD, 0.5 * 0.1e-3_f64.powi(2));
    for (i, k, covariance) in [
        (a, a, sum + difference),
        (b, b, sum + difference),
        (a, b, sum - difference),
        (b, a, sum - difference),
    ] {
        after.covariance[i * d + k] = covariance;
    }
    let groups = group_posteriors(&prior, &before, &after, &[40.0, 8.0, 8.0]);
    let [group] = &groups[..] else {
        panic!("{groups:?}");
    };
    assert_eq!(
        (&group.joints[..], &group.tendons[..]),
        (&[1][..], &[1, 2][..])
    );
    let [unobservable] = &group.unobservable[..] else {
        panic!("{:?}", group.unobservable);
    };
    assert_eq!(unobservable.weights.len(), 2);
    assert!(
        unobservable
            .weights
            .iter()
            .all(|(_, weight)| (weight - 1.0).abs() < 1e-6)
    );
    assert!((unobservable.std_rad - BEFORE_RAD / 2.0_f64.sqrt()).abs() < 1e-6);
    // (Δ_a − Δ_b) / 2.
    let offset = group.joint_offsets_rad.as_ref().unwrap()[0];
    assert!((offset.mean - 0.004).abs() < 1e-9, "{offset:?}");
    assert!(
        (offset.std - 0.05e-3 * 2.0_f64.sqrt()).abs() < 1e-6,
        "{offset:?}"
    );
}
