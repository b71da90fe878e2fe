//! Groups with one equation per joint, against recordings of an independent simulation.

use crate::coupled;
use crate::support::{repository, seeds, shared};
use crate::tendons::since_baseline;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{
    self, Learning, MotorTorqueError, Recorded, Remedy, SessionEstimate, SessionOptions,
    TendonEstimate, Verdict, Warning,
};
use sinew_model::offset::Payload;
use sinew_model::robot::Robot;
use sinew_sim::scenario::Draw;
use std::path::Path;

/// Measurements of a recording that are used in addition to positions.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Uses {
    Positions,
    MotorTorque,
    Tension,
}

/// Folder of a reference robot. If tensions are not used, its tendons have names that the recording does not contain.
fn robot(folder: &Path, name: &str, uses: Uses) -> tempfile::TempDir {
    let place = folder.join("../robots").join(name);
    let copy = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(&place).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), copy.path().join(file.file_name())).unwrap();
    }
    if uses != Uses::Tension {
        let text = std::fs::read_to_string(place.join("robot.toml")).unwrap();
        let lines = text
            .lines()
            .map(|line| match line.strip_prefix("name = \"") {
                Some(rest) => format!("name = \"of_{rest}\n"),
                None => format!("{line}\n"),
            });
        std::fs::write(copy.path().join("robot.toml"), lines.collect::<String>()).unwrap();
    }
    copy
}

/// Estimate of a reference robot's session since its baseline, and its truth.
fn read(name: &str, uses: Uses) -> Option<(SessionEstimate, serde_json::Value)> {
    let folder = shared("tendons/recordings")?;
    let robot = robot(&folder, name, uses);
    let options = SessionOptions {
        payload: Payload::Empty,
        motor_torque: uses == Uses::MotorTorque,
        ..SessionOptions::default()
    };
    Some(since_baseline(&folder, name, robot.path(), &options))
}

/// Error and half of the 95 % interval of a tendon's elongation, mm.
fn elongation_mm(tendon: &TendonEstimate, truth: &serde_json::Value) -> [f64; 2] {
    let name = tendon.name.trim_start_matches("of_");
    let truth_mm = truth["elongation_mm"][name].as_f64().unwrap();
    let elongation_m = tendon.elongation_m.unwrap();
    [
        1e3 * elongation_m.mean - truth_mm,
        1e3 * elongation_m.half_width_95(),
    ]
}

/// Checks that the offsets of all joints are inside their intervals and within `within_mrad` of the truth.
fn assert_joint_offsets(estimate: &SessionEstimate, truth: &serde_json::Value, within_mrad: f64) {
    let truth = truth["joint_offset_mrad"].as_object().unwrap();
    assert_eq!(estimate.joint_offsets.len(), truth.len());
    for joint in &estimate.joint_offsets {
        let error_mrad = 1e3 * joint.offset_rad.mean - truth[&joint.name].as_f64().unwrap();
        let half_mrad = 1e3 * joint.offset_rad.half_width_95();
        println!("{}: {error_mrad:+.3} ± {half_mrad:.3} mrad", joint.name);
        assert!(
            error_mrad.abs() < within_mrad.min(half_mrad),
            "{}: {error_mrad} ± {half_mrad}",
            joint.name
        );
    }
}

// The common elongation of flexor and extensor is unobservable from motion. Motor torques determine it, tension sensors
// more precisely.
#[test]
fn antagonist_observability_depends_on_sensors() {
    let Some((estimate, truth)) = read("antagonistic-elbow", Uses::Positions) else {
        return;
    };
    assert_joint_offsets(&estimate, &truth, 0.15);
    for tendon in &estimate.joints {
        assert_eq!(tendon.verdict, Verdict::Inconclusive, "{}", tendon.name);
        let [error_mm, half_mm] = elongation_mm(tendon, &truth);
        assert!(error_mm.abs() < half_mm, "{error_mm} ± {half_mm}");
    }
    let [unobservable] = &estimate.unobservable[..] else {
        panic!("{:?}", estimate.unobservable);
    };
    let weights: Vec<f64> = unobservable
        .tendons
        .iter()
        .map(|tendon| tendon.weight)
        .collect();
    assert!(
        weights.len() == 2 && weights.iter().all(|w| *w > 0.8),
        "{weights:?}"
    );
    assert_eq!(
        unobservable.remedies,
        [Remedy::MotorTorque, Remedy::TensionSensors]
    );
    for (uses, within_mm) in [(Uses::MotorTorque, 0.1), (Uses::Tension, 0.01)] {
        let (estimate, truth) = read("antagonistic-elbow", uses).unwrap();
        assert_eq!(estimate.unobservable, []);
        for tendon in &estimate.joints {
            let [error_mm, half_mm] = elongation_mm(tendon, &truth);
            println!("{uses:?} {}: {error_mm:+.4} ± {half_mm:.4} mm", tendon.name);
            assert!(
                error_mm.abs() < half_mm.min(within_mm),
                "{error_mm} ± {half_mm}"
            );
            assert_eq!(tendon.verdict, Verdict::Elongated);
        }
    }
}

#[test]
fn finger_four_strands_estimate_three_joint_offsets() {
    let Some((estimate, truth)) = read("n-plus-1-finger", Uses::Positions) else {
        return;
    };
    assert_joint_offsets(&estimate, &truth, 0.1);
    assert_eq!(estimate.unobservable.len(), 1);
    for tendon in &estimate.joints {
        assert_eq!(tendon.verdict, Verdict::Inconclusive, "{}", tendon.name);
        let [error_mm, half_mm] = elongation_mm(tendon, &truth);
        assert!(error_mm.abs() < half_mm, "{error_mm} ± {half_mm}");
    }
    let within_mm = [
        ("flexor_deep", 0.005),
        ("extensor_dip", 0.005),
        ("extensor_pip", 0.010),
        ("extensor_mcp", 0.020),
    ];
    for (uses, share) in [(Uses::MotorTorque, 1.0), (Uses::Tension, 0.4)] {
        let (estimate, truth) = read("n-plus-1-finger", uses).unwrap();
        assert_joint_offsets(&estimate, &truth, 0.1);
        assert_eq!(estimate.unobservable, []);
        for (name, within_mm) in within_mm {
            let mut tendons = estimate.joints.iter();
            let tendon = tendons.find(|t| t.name.trim_start_matches("of_") == name);
            let [error_mm, half_mm] = elongation_mm(tendon.unwrap(), &truth);
            println!("{uses:?} {name}: {error_mm:+.4} ± {half_mm:.4} mm");
            assert!(
                error_mm.abs() < half_mm.min(share * within_mm),
                "{name}: {error_mm} ± {half_mm}"
            );
        }
    }
}

/// Estimate of the second session of a robot with strands since the first; the gripper is empty.
fn since(robot: &Robot, [first, second]: &[Recorded; 2], motor_torque: bool) -> SessionEstimate {
    let learning = Learning {
        motor_torque,
        ..Learning::default()
    };
    let (baseline, _) = session::learn_recorded(robot, first, "A", &learning).unwrap();
    let options = SessionOptions {
        payload: Payload::Empty,
        motor_torque,
        ..SessionOptions::default()
    };
    let known = Some((&baseline, "A"));
    let (estimate, _) = session::estimate_recorded(robot, second, "B", known, &options).unwrap();
    estimate
}

/// Removes the recorded tensions.
fn without_tension(mut parts: [Recorded; 2]) -> [Recorded; 2] {
    for block in parts.iter_mut().flat_map(|part| &mut part.blocks) {
        block.tension_nm.fill(f64::NAN);
    }
    parts
}

fn assert_inside(robot: &Robot, estimate: &SessionEstimate, truth: &[f64]) {
    for ((name, tendon), truth) in robot.tendon_names().iter().zip(&estimate.joints).zip(truth) {
        let (error, std) = (tendon.offset_rad.mean - truth, tendon.offset_rad.std);
        println!("{name} {:+.3} mrad, σ {:.3}", 1e3 * error, 1e3 * std);
        assert!(error.abs() < 3.0 * std, "{name}: {error} {std}");
    }
}

// With torques or tensions every strand is identifiable, and a slip is found only at the slipped strand.
#[test]
fn strand_slip_is_found_with_torques_or_tensions() {
    for (name, size_rad) in [("antagonistic-elbow", 4e-3), ("n-plus-1-finger", 5e-3)] {
        let robot = coupled::robot(name);
        for seed in 1..=seeds(2) {
            let (parts, truth) = coupled::recorded(&robot, &coupled::scenario(name, seed));
            for tension in [true, false] {
                let parts = match tension {
                    true => parts.clone(),
                    false => without_tension(parts.clone()),
                };
                let estimate = since(&robot, &parts, true);
                assert_inside(&robot, &estimate, &truth);
                assert_eq!(estimate.unobservable, []);
                for tendon in &estimate.joints {
                    if tendon.name != "flexor" {
                        assert!(tendon.changes.is_empty(), "{name} {seed}: {tendon:?}");
                        continue;
                    }
                    assert_eq!(tendon.verdict, Verdict::Elongated);
                    let [slip] = &tendon.changes[..] else {
                        panic!("{name} {seed}: {:?}", tendon.changes);
                    };
                    let size = slip.size_rad.unwrap();
                    assert!((slip.time_s - 90.0).abs() < 1.0, "{slip:?}");
                    assert!((size.mean - size_rad).abs() < 3.0 * size.std, "{slip:?}");
                }
            }
        }
    }
}

// An implausible tension is reported and rejected: the result equals the one without tensions.
#[test]
fn inconsistent_tension_is_rejected() {
    const NAME: &str = "antagonistic-elbow";
    let robot = coupled::robot(NAME);
    let (parts, truth) = coupled::recorded(&robot, &coupled::scenario(NAME, 4));
    let without = since(&robot, &without_tension(parts.clone()), true);
    let with = |tension: fn(f64) -> f64| {
        let mut parts = parts.clone();
        for block in parts.iter_mut().flat_map(|part| &mut part.blocks) {
            block.tension_nm.iter_mut().for_each(|t| *t = tension(*t));
        }
        since(&robot, &parts, true)
    };
    let faults = |estimate: &SessionEstimate| -> Vec<MotorTorqueError> {
        let all = estimate.warnings.iter();
        all.filter_map(|warning| match warning {
            Warning::TensionRejected { fault, .. } => Some(*fault),
            _ => None,
        })
        .collect()
    };
    let sound = with(|t| t);
    assert!(sound.tension_used && faults(&sound).is_empty());
    // A dead sensor, one in kilogram-force, and one with the opposite sign.
    let dead = with(|_| 0.0);
    assert_eq!(faults(&dead), [MotorTorqueError::Constant; 2]);
    for (estimate, expected) in [(with(|t| t / 9.81), 1.0 / 9.81), (with(|t| -t), -1.0)] {
        let slopes = faults(&estimate);
        assert_eq!(slopes.len(), 2);
        for fault in slopes {
            let MotorTorqueError::Contradicts { slope } = fault else {
                panic!("{fault:?}");
            };
            assert!((slope / expected - 1.0).abs() < 0.3, "{slope} {expected}");
        }
        for (found, of_without) in estimate.joints.iter().zip(&without.joints) {
            assert_eq!(found.offset_rad, of_without.offset_rad);
        }
        assert!(!estimate.tension_used);
        assert_inside(&robot, &estimate, &truth);
    }
}

// Flexor and extensor act on the same joint, so that a slip of either has the same effect.
#[test]
fn ambiguous_strand_slip_is_assigned_to_no_strand() {
    const NAME: &str = "antagonistic-elbow";
    let robot = coupled::robot(NAME);
    for seed in 1..=seeds(3) {
        let (parts, truth) = coupled::recorded(&robot, &coupled::scenario(NAME, seed));
        let estimate = since(&robot, &without_tension(parts), false);
        assert_inside(&robot, &estimate, &truth);
        let [unobservable] = &estimate.unobservable[..] else {
            panic!("{:?}", estimate.unobservable);
        };
        let [change] = &unobservable.changes[..] else {
            panic!("{:?}", unobservable.changes);
        };
        assert!((change.time_s - 90.0).abs() < 1.0, "{change:?}");
        for tendon in &estimate.joints {
            assert_eq!(tendon.verdict, Verdict::Inconclusive);
            assert!(tendon.changes.is_empty(), "{:?}", tendon.changes);
        }
    }
}

// Strands without pretension are slack, one of them nearly always: it has a bound and no verdict.
#[test]
fn slack_strand_has_bound_and_no_verdict() {
    const NAME: &str = "antagonistic-elbow";
    let place = tempfile::tempdir().unwrap();
    let from = repository().join("robots").join(NAME);
    let urdf = format!("{NAME}.urdf");
    std::fs::copy(from.join(&urdf), place.path().join(&urdf)).unwrap();
    let text = std::fs::read_to_string(from.join("robot.toml")).unwrap();
    let text = text.replace("pretension_n = 70.0", "pretension_n = 25.0");
    std::fs::write(place.path().join("robot.toml"), text).unwrap();
    let robot = robot_dir::load(place.path(), None).unwrap().robot;
    let (mut bounds, mut slack) = (0, 0);
    for seed in 1..=seeds(4) {
        let mut scenario = coupled::scenario(NAME, seed);
        scenario.co_contraction = None;
        // Both are elongated by 1.1 mm, without a slip.
        scenario.offsets.truncate(2);
        for offset in &mut scenario.offsets {
            offset.size_rad = Draw::Fixed(0.05);
        }
        let (parts, truth) = coupled::recorded(&robot, &scenario);
        let estimate = since(&robot, &without_tension(parts), true);
        assert_inside(&robot, &estimate, &truth);
        for (tendon, truth_rad) in estimate.joints.iter().zip(&truth) {
            slack += usize::from(tendon.slack_share.is_some());
            if tendon.slack_share.is_some() {
                assert_eq!(tendon.verdict, Verdict::Inconclusive);
            }
            if let Some(lower_bound_rad) = tendon.lower_bound_rad {
                bounds += 1;
                assert!(
                    lower_bound_rad < *truth_rad,
                    "{lower_bound_rad} {truth_rad}"
                );
                assert!(
                    lower_bound_rad > 0.5 * truth_rad,
                    "{lower_bound_rad} {truth_rad}"
                );
            }
        }
        assert_eq!(estimate.joint_offsets, []);
    }
    assert!(bounds > 0 && slack > 0, "{bounds} {slack}");
}
