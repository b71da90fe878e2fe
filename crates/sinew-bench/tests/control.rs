//! A stretched arm with and without correction, from scenario text to scores.

use crate::support;

use sinew_sim::control::{compare, noise_nm, run};
use sinew_sim::{Scenario, SimulateError, Simulation};
use support::biorob_like;

fn scenario(text: &str) -> Scenario {
    Scenario::from_toml(text, "control.toml").unwrap()
}

/// Without friction and with perfect sensors the closed forms are valid.
const STANDING: &str = r#"
duration_s = 6.0
settle_s = 6.0
[motion]
kind = "hold"
pose_rad = { shoulder_pitch = 0.9, elbow = 0.5 }
[joint_friction]
coulomb_nm = 0.0
viscous_nm_s_per_rad = 0.3
[motor_friction]
coulomb_nm = 0.0
[[offsets]]
joint = "shoulder_pitch"
kind = "physical"
rad = 0.010
[[offsets]]
joint = "elbow"
kind = "physical"
rad = -0.006
"#;

fn with(extra: &str) -> Scenario {
    scenario(&format!("{STANDING}{extra}"))
}

#[test]
fn corrected_arm_reaches_set_point_without_false_torque() {
    let robot = biorob_like();
    let comparison = compare(&robot, &with("[correction]\noffset = \"true\"\n")).unwrap();
    let corrected = &comparison.with;
    for joint in &corrected.joints {
        // Six seconds of settling leave e^(−6·3) of the start's swing at the slowest joint.
        assert!(joint.rest_rms_rad < 1e-6, "{joint:?}");
        assert!(joint.false_torque_nm.abs() < 1e-4, "{joint:?}");
    }
    assert_eq!(corrected.contacts.false_alarms, 0);

    // Uncorrected: (1 + (1/K + 1/K_P) G) e = −delta_e with the stiffness matrix G of gravity.
    let blind = &comparison.without;
    let (pitch, elbow) = (&blind.joints[1], &blind.joints[2]);
    let (k, kp) = ([40.0, 20.0, 8.0], [50.0, 25.0, 10.0]);
    let q = [0.9, 0.5, 0.0];
    // Gravity of the three links in the plane: first moments computed from the URDF, kg·m.
    let moments = [
        0.55 * 0.12 + (0.3 + 0.25) * 0.31,
        0.3 * 0.13 + 0.25 * 0.31,
        0.25 * 0.07,
    ];
    let angle = |i: usize| q[..=i].iter().sum::<f64>();
    let mut a = [[0.0; 4]; 3];
    for i in 0..3 {
        for j in 0..3 {
            let g: f64 = (i.max(j)..3)
                .map(|l| 9.81 * moments[l] * angle(l).cos())
                .sum();
            a[i][j] = f64::from(u8::from(i == j)) + (1.0 / k[i] + 1.0 / kp[i]) * g;
        }
    }
    let delta = [0.010, -0.006, 0.0];
    for i in 0..3 {
        a[i][3] = -1e3 * delta[i];
    }
    let e = solve(a);
    // Second order: ½ g'' e² (1/K + 1/K_P) is some 0.01 mrad.
    assert!(
        (1e3 * pitch.rest_mean_rad - e[0]).abs() < 0.02,
        "{pitch:?} {e:?}"
    );
    assert!(
        (1e3 * elbow.rest_mean_rad - e[1]).abs() < 0.02,
        "{elbow:?} {e:?}"
    );
    // A false contact of −K delta_e.
    assert!((pitch.false_torque_nm + 0.40).abs() < 1e-4, "{pitch:?}");
    assert!((elbow.false_torque_nm - 0.12).abs() < 1e-4, "{elbow:?}");
    assert!(blind.contacts.false_share() > 0.99);
}

/// Gaussian elimination; the matrix is near the identity.
fn solve(mut a: [[f64; 4]; 3]) -> [f64; 3] {
    for i in 0..3 {
        for j in 0..3 {
            if i != j {
                let factor = a[j][i] / a[i][i];
                for c in 0..4 {
                    a[j][c] -= factor * a[i][c];
                }
            }
        }
    }
    [0, 1, 2].map(|i| a[i][3] / a[i][i])
}

#[test]
fn specified_offset_is_corrected() {
    let robot = biorob_like();
    let truth = with("[correction]\noffset = \"true\"\n");
    let stated = with("[correction]\noffset_rad = { shoulder_pitch = 0.010, elbow = -0.006 }\n");
    let off = with("[correction]\noffset_rad = { shoulder_pitch = 0.012, elbow = -0.006 }\n");
    let quiet = vec![0.01; 4];
    let [truth, stated, off] = [truth, stated, off].map(|s| run(&robot, &s, &quiet).unwrap());
    assert_eq!(truth, stated);
    // Two milliradians too much: as far beyond, and a torque of K · 2 mrad.
    let pitch = &off.joints[1];
    assert!((1e3 * pitch.rest_mean_rad - 2.0).abs() < 0.3, "{pitch:?}");
    assert!((pitch.false_torque_nm - 0.08).abs() < 1e-4, "{pitch:?}");
}

#[test]
fn correction_reads_estimate_json_with_units() {
    let robot = biorob_like();
    let json = r#"{"reading": {"joints": [{"name": "elbow", "offset_rad": 0.099, "standard_error_rad": 0.001}]},
        "session": {"joints": [
            {"name": "shoulder_pitch", "offset_rad": {"mean": 0.01, "std": 0.0005}},
            {"name": "elbow", "offset_rad": {"mean": -0.006, "std": 0.00025}}]}}"#;
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("since.json"), json).unwrap();
    let mut s = with("[correction]\nestimate = \"since.json\"\n");
    let unread = Simulation::new(&robot, &s).unwrap_err().to_string();
    assert!(unread.contains("not read"), "{unread}");
    s.correction.read_estimate(folder.path()).unwrap();
    // Schema version 1 calls the standard deviation `deviation`.
    let mut former = with("[correction]\nestimate = \"since.json\"\n");
    let text = json.replace("\"std\"", "\"deviation\"");
    former
        .correction
        .take_estimate(&text, "since.json")
        .unwrap();
    let former = Simulation::new(&robot, &former).unwrap();
    let simulation = Simulation::new(&robot, &s).unwrap();
    assert_eq!(
        former.correction_at(1, 0.0),
        simulation.correction_at(1, 0.0)
    );
    let known = simulation.correction_at(1, 0.0);
    assert!((known.delta_e_rad.mean - 0.010).abs() < 1e-15);
    assert!((known.delta_e_rad.std - 0.0005).abs() < 1e-15);
    assert_eq!(simulation.correction_at(0, 0.0).delta_e_rad.mean, 0.0);
    let score = run(&robot, &s, &[0.01; 4]).unwrap();
    assert!(score.joints[1].rest_rms_rad < 1e-6);

    let refuse = |text: &str| {
        let mut s = with("[correction]\nestimate = \"since.json\"\n");
        let error = s.correction.take_estimate(text, "since.json").unwrap_err();
        assert!(matches!(error, SimulateError::Estimate { .. }));
        error.to_string()
    };
    assert!(refuse("nonsense").contains("since.json"));
    assert!(refuse("{}").contains("no joints"));
    assert!(refuse(r#"{"reading": {"joints": [{"offset_rad": 1}]}}"#).contains("no name"));
    let message = refuse(r#"{"reading": {"joints": [{"name": "elbow", "offset_rad": null}]}}"#);
    assert!(
        message.contains("'elbow'") && message.contains("offset_rad"),
        "{message}"
    );
    // A joint that the robot does not have.
    let mut s = with("[correction]\nestimate = \"since.json\"\n");
    let odd =
        r#"{"reading": {"joints": [{"name": "hip", "offset_rad": 1, "standard_error_rad": 0}]}}"#;
    s.correction.take_estimate(odd, "since.json").unwrap();
    let message = Simulation::new(&robot, &s).unwrap_err().to_string();
    assert!(message.contains("'hip'"), "{message}");
}

/// Work with contacts; the rope gives way in the middle of the recording.
const WORKING: &str = r#"
duration_s = 24.0
seed = 3
[motion]
kind = "random"
range_rad = { shoulder_yaw = { min = -1.2, max = 1.2 }, shoulder_pitch = { min = 0.0, max = 1.7 }, elbow = { min = 0.0, max = 1.8 }, wrist = { min = -1.0, max = 1.0 } }
[encoder]
joint_bits = 13
motor_resolution_rad = 0.00006
motor_noise_rad = 0.0002
[motor_friction]
coulomb_nm = 0.0
[random_contacts]
fraction = 0.2
link = "tool"
force_n = { min = 4.0, max = 10.0 }
duration_s = { min = 0.4, max = 1.0 }
rise_s = 0.05
from_s = 2.0
[[offsets]]
joint = "shoulder_pitch"
kind = "physical"
shape = "step"
at_s = 12.0
rad = 0.010
[correction]
offset = "true"
offset_std_rad = 0.0005
"#;

#[test]
fn contacts_uncorrected_cause_false_alarms() {
    let robot = biorob_like();
    let s = scenario(WORKING);
    let comparison = compare(&robot, &s).unwrap();
    let (with, without) = (&comparison.with.contacts, &comparison.without.contacts);
    assert!(with.contacts >= 3, "{with:?}");
    assert_eq!(with.contacts, without.contacts);
    // Half of the recording is stretched: the alarm is on for most of that.
    assert!(without.false_share() > 0.25, "{without:?}");
    assert!(with.false_share() < 0.02, "{with:?}");
    assert!(without.missed > with.missed, "{with:?} {without:?}");
    assert!((0.02..0.2).contains(&with.delay_median_s()), "{with:?}");
}

#[test]
fn score_same_scenario_is_identical() {
    let robot = biorob_like();
    let mut s = scenario(WORKING);
    s.duration_s = Some(4.0);
    let noise = noise_nm(&robot, &s).unwrap();
    assert!(noise.iter().all(|n| *n > 1e-4 && *n < 0.2), "{noise:?}");
    // As text: a joint that was never at rest without contact has a NaN, which does not equal itself.
    let text = || format!("{:?}", run(&robot, &s, &noise).unwrap());
    assert_eq!(text(), text());
    // Given noise is taken as it is.
    s.contact_detection.noise_nm = sinew_sim::scenario::PerJoint::fixed(0.25);
    assert_eq!(noise_nm(&robot, &s).unwrap(), vec![0.25; 4]);
}

#[test]
fn correction_leaves_other_draws_unchanged() {
    // Same motion and same contacts with every correction.
    let robot = biorob_like();
    let mut known = scenario(WORKING);
    known.duration_s = Some(5.0);
    let mut blind = known.clone();
    blind.correction = Default::default();
    let mut runs = [known, blind].map(|s| Simulation::new(&robot, &s).unwrap());
    loop {
        let [a, b] = &mut runs;
        let more = a.next_frame().unwrap().is_some();
        assert_eq!(more, b.next_frame().unwrap().is_some());
        if !more {
            break;
        }
        assert_eq!(a.true_state().q_d, b.true_state().q_d);
        // Before the offset begins there is nothing to correct: bitwise identical.
        assert_eq!(a.true_state(), b.true_state());
    }
}

#[test]
fn compare_without_correction_returns_error() {
    let message = compare(&biorob_like(), &with("")).unwrap_err().to_string();
    assert!(
        message.contains("correction:") && message.contains("offset"),
        "{message}"
    );
}

#[test]
fn correction_errors_name_file_line_key_value() {
    let cases: [(&str, &[&str]); 9] = [
        (
            "[correction]\noffset = \"some\"",
            &["correction.offset", "\"stated\""],
        ),
        (
            "[correction]\noffset = \"stated\"",
            &["offset_rad", "line 20: correction"],
        ),
        (
            "[correction]\noffset = \"true\"\noffset_rad = 0.01",
            &["correction.offset_rad = 0.01 (rad)", "omitted"],
        ),
        (
            "[correction]\noffset_rad = { ellbow = 0.01 }",
            &["'ellbow'", "elbow"],
        ),
        (
            "[correction]\noffset_rad = 10.0",
            &["correction.offset_rad = 10.0 (rad)", "between -1 and 1"],
        ),
        (
            "[correction]\noffset_rad = 0.01\nestimate = \"a.json\"",
            &["correction.estimate", "omitted"],
        ),
        (
            "[correction]\noffset_rad = 0.01\nset_point = \"fast\"",
            &["correction.set_point", "\"dynamic\""],
        ),
        (
            "[contact_detection]\nsigmas = -1",
            &["contact_detection.sigmas = -1"],
        ),
        (
            "[contact_detection]\nthreshold = 1",
            &["'threshold'", "sigmas"],
        ),
    ];
    for (text, parts) in cases {
        let text = format!("{STANDING}{text}\n");
        let message = match Scenario::from_toml(&text, "bad.toml") {
            Ok(s) => Simulation::new(&biorob_like(), &s).unwrap_err().to_string(),
            Err(e) => e.to_string(),
        };
        for part in parts.iter().chain(&["bad.toml, line"]) {
            assert!(message.contains(part), "'{part}' missing in: {message}");
        }
    }
}

#[test]
fn page_contains_table_and_closed_forms() {
    use sinew_bench::paper::{Effort, Knowledge, RobotCase, control, table, write};
    // Ten seconds of one session: the table is generated, its statistics are not assessed here. The full page is
    // `sinew paper control`, which reports the statements that hold.
    let effort = Effort {
        seeds: 1,
        seconds: 10.0,
    };
    let mut made = control(&biorob_like(), effort).unwrap();
    assert_eq!(made.rows.len(), 20);
    // The statements of the first row are based on closed forms, not on statistics.
    for s in &made.sentences[..7] {
        assert!(s.holds, "{s:?}");
    }
    let rest = |robot: RobotCase, knowledge: Knowledge| {
        let row = made
            .rows
            .iter()
            .find(|r| r.robot == robot && r.knowledge == knowledge);
        row.unwrap().joints[0].rest_rad.mean
    };
    let stretched = RobotCase::Stretched;
    assert!(rest(stretched, Knowledge::Nothing) > 5.0 * rest(stretched, Knowledge::True));
    let (head, cells) = table(&made.rows);
    assert!(cells.iter().all(|row| row.len() == head.len()));

    let folder = tempfile::tempdir().unwrap();
    write(&mut made, folder.path()).unwrap();
    let written = made.files.unwrap();
    let html = std::fs::read_to_string(&written.html).unwrap();
    assert!(html.contains("Before and after") && html.contains("K −20 %"));
    let csv = std::fs::read_to_string(folder.path().join("control.csv")).unwrap();
    let columns: Vec<usize> = csv.lines().map(|l| l.split(',').count()).collect();
    assert_eq!(columns, vec![columns[0]; 21]);
}

#[test]
fn page_missing_joint_returns_error() {
    use sinew_bench::paper::{Effort, control};
    let mut robot = biorob_like();
    robot.arm = sinew_model::arm::urdf::parse(
        r#"<robot name="rod"><link name="base"/><link name="rod"><inertial><mass value="1"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
        <joint name="hip" type="continuous"><parent link="base"/><child link="rod"/>
        <axis xyz="0 1 0"/></joint></robot>"#,
        &Default::default(),
    )
    .unwrap()
    .arm;
    let message = control(&robot, Effort::default()).unwrap_err().to_string();
    assert!(
        message.contains("shoulder_pitch") && message.contains("control"),
        "{message}"
    );
}
