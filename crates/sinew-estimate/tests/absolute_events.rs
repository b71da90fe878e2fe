//! Events within and between recordings: loads, cuts, chains, stiffness loss.

use crate::support;

use sinew_estimate::session;
use sinew_estimate::session::{MotorTorque, Payload, SessionOptions, TendonChangeKind, Warning};
use sinew_model::Interval95;
use support::{biorob_like, online_answer, seeds, work_session};

const PITCH: usize = 1;
const ELBOW: usize = 2;

fn no_contact(text: String) -> String {
    text.replace("fraction = 0.1\n", "fraction = 0.0\n")
}

#[test]
fn payload_change_mid_session_is_detected_without_bias() {
    let robot = biorob_like();
    let load = |text: String| {
        no_contact(text)
            .replace("mass_kg = { min = 0.0, max = 0.5 }", "mass_kg = 0.4")
            .replace("attach_s = 60.0", "attach_s = 91.0")
    };
    let (parts, truth) = work_session(&robot, 11, load, &[60.0, 120.0]);
    let (baseline, _) =
        session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
    let (result, _) = session::estimate_recorded(
        &robot,
        &parts[1],
        "B",
        Some((&baseline, "baseline")),
        &SessionOptions::default(),
    )
    .unwrap();
    println!("{:?} {:?}", result.payload_changes, result.payload_kg);
    assert_eq!(
        result.payload_changes.len(),
        1,
        "{:?}",
        result.payload_changes
    );
    let change = &result.payload_changes[0];
    assert!((change.time_s - 91.0).abs() < 1.5, "{change:?}");
    assert!((change.change_kg.mean - 0.4).abs() < 0.1, "{change:?}");
    let Interval95 {
        low: from_s,
        high: to_s,
    } = change.interval_s.unwrap();
    assert!(
        from_s < 91.0 && 91.0 < to_s && to_s - from_s < 3.0,
        "{change:?}"
    );
    assert!(change.probability.unwrap() > 0.99, "{change:?}");
    for joint in [PITCH, ELBOW] {
        let found = &result.joints[joint];
        let error = 1e3 * found.offset_rad.mean - truth[joint];
        println!(
            "{} {error:+.2} ± {:.2}",
            found.name,
            1e3 * found.offset_rad.half_width_95()
        );
        assert!(
            error.abs() < 1e3 * found.offset_rad.half_width_95() && error.abs() < 1.0,
            "{error}"
        );
        assert!(found.changes.is_empty(), "{:?}", found.changes);
    }
    // If the gripper is specified as empty, the same load biases the offset or is rejected as
    // disturbance, and the estimate reports that much was rejected.
    let empty = SessionOptions {
        payload: Payload::Empty,
        ..SessionOptions::default()
    };
    let (result, _) = session::estimate_recorded(
        &robot,
        &parts[1],
        "B",
        Some((&baseline, "baseline")),
        &empty,
    )
    .unwrap();
    assert!(
        result.rejected_share > 0.3 && !result.warnings.is_empty(),
        "{result:?}"
    );
}

// The load of the baseline has been released.
// The load is as far from the gripper as a tool held by its end. With the second moments of a load at 10 cm, 15 % of 20
// robots were outside, RMSE 1.9 mrad.
#[test]
fn payload_far_from_gripper_does_not_bias_offset() {
    let robot = biorob_like();
    let far = |text: String| {
        no_contact(text)
            .replace("mass_kg = { min = 0.0, max = 0.5 }", "mass_kg = 0.4")
            .replace(
                "attach_s = 60.0",
                "attach_s = 60.0\ncom_m = [0.0, 0.0, 0.25]",
            )
    };
    for seed in [11, 12, 13] {
        let (parts, truth) = work_session(&robot, seed, far, &[60.0, 120.0]);
        let (baseline, _) =
            session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
        let known = Some((&baseline, "A"));
        let options = SessionOptions::default();
        let (result, _) =
            session::estimate_recorded(&robot, &parts[1], "B", known, &options).unwrap();
        let out = result.blocks.iter().filter(|b| b.is_rejected()).count();
        assert_eq!(
            result.rejected_share,
            out as f64 / result.blocks.len() as f64
        );
        for (joint, truth) in result.joints.iter().zip(&truth) {
            let error = 1e3 * joint.offset_rad.mean - truth;
            let half = 1e3 * joint.offset_rad.half_width_95();
            println!("{seed} {} {error:+.2} ± {half:.2}", joint.name);
            assert!(
                error.abs() < half.min(0.8),
                "{seed}, {}: {error} ± {half}",
                joint.name
            );
        }
    }
}

#[test]
fn negative_payload_is_reported() {
    let robot = biorob_like();
    let load = |text: String| {
        no_contact(text)
            .replace("mass_kg = { min = 0.0, max = 0.5 }", "mass_kg = 0.4")
            .replace("attach_s = 60.0", "attach_s = 0.0\nrelease_s = 60.0")
    };
    let (parts, _) = work_session(&robot, 11, load, &[60.0, 120.0]);
    let (baseline, _) =
        session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
    let estimate_part = |part: usize| {
        let baseline = Some((&baseline, "A"));
        let options = SessionOptions::default();
        let (result, _) =
            session::estimate_recorded(&robot, &parts[part], "B", baseline, &options).unwrap();
        let warned = result
            .warnings
            .iter()
            .any(|w| matches!(w, Warning::NegativePayload { .. }));
        println!("{:?} {:?}", result.payload_kg, result.warnings);
        (result.payload_kg.mean, warned)
    };
    let (payload_kg, warned) = estimate_part(1);
    assert!(payload_kg < -0.1 && warned, "{payload_kg}");
    let (payload_kg, warned) = estimate_part(0);
    assert!(payload_kg.abs() < 0.05 && !warned, "{payload_kg}");
}

#[test]
fn motor_torque_separates_late_slip_from_contact() {
    let robot = biorob_like();
    let late = |text: String| {
        no_contact(text)
            + "\n[[offsets]]\njoint = \"shoulder_pitch\"\nkind = \"physical\"\nshape = \"step\"\nat_s = 114.0\nrad = 0.005\n"
    };
    let estimate_until = |cuts: &[f64], motor_torque: bool| {
        let (parts, truth) = work_session(&robot, 14, late, cuts);
        let (baseline, _) =
            session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
        let baseline = Some((&baseline, "A"));
        let options = SessionOptions {
            motor_torque,
            ..SessionOptions::default()
        };
        let (result, _) =
            session::estimate_recorded(&robot, &parts[1], "B", baseline, &options).unwrap();
        let is_provisional = result
            .warnings
            .iter()
            .any(|w| matches!(w, Warning::ChangeNearEnd { .. }));
        let joint = result.joints[PITCH].clone();
        let error = 1e3 * joint.offset_rad.mean - truth[PITCH];
        println!(
            "{error:+.2} ± {:.2} {:?}",
            1e3 * joint.offset_rad.half_width_95(),
            joint.changes
        );
        assert_eq!(joint.changes.len(), 1);
        assert!(
            error.abs() < 1e3 * joint.offset_rad.half_width_95(),
            "{error}"
        );
        // The interval over time ends as wide as the final one, and is not wider before.
        let last = 1e3 * result.blocks.last().unwrap().offset_rad[PITCH].half_width_95();
        assert!(
            (last - 1e3 * joint.offset_rad.half_width_95()).abs() < 1e-9,
            "{last}"
        );
        let end = 1e3 * result.segments.last().unwrap().offset_rad[PITCH].half_width_95();
        assert!(
            (end - 1e3 * joint.offset_rad.half_width_95()).abs() < 1e-9,
            "{end}"
        );
        let before = result.blocks.iter().find(|c| c.time_s > 40.0).unwrap();
        assert!(
            1e3 * before.offset_rad[PITCH].half_width_95() < 2.0,
            "{before:?}"
        );
        let Interval95 {
            low: from_s,
            high: to_s,
        } = joint.changes[0].interval_s.unwrap();
        assert!(from_s < 114.0 && 114.0 < to_s, "{from_s} {to_s}");
        let probability = joint.changes[0].probability.unwrap();
        (
            1e3 * joint.offset_rad.half_width_95(),
            is_provisional,
            probability,
        )
    };
    let (interval, is_provisional, probability) = estimate_until(&[60.0, 120.0], true);
    assert!(!is_provisional && interval < 2.0, "{interval}");
    assert!(probability > 0.9, "{probability}");
    // A constant contact is indistinguishable without the torque until it ends.
    let (interval, is_provisional, probability) = estimate_until(&[60.0, 120.0], false);
    assert!(is_provisional && interval > 4.5, "{interval}");
    assert!(probability < 0.9, "{probability}");
    // Ten seconds later a contact would have ended.
    let (interval, is_provisional, probability) = estimate_until(&[60.0, 130.0], false);
    assert!(!is_provisional && interval < 2.0, "{interval}");
    assert!(probability > 0.9, "{probability}");
}

/// Checks that sessions ending at each of these times are within three standard deviations at every joint.
fn check_ends(ends_s: &[f64], change: impl Fn(String) -> String) {
    let robot = biorob_like();
    for &end_s in ends_s {
        let (parts, truth) = work_session(&robot, 14, &change, &[60.0, end_s]);
        let (baseline, _) =
            session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
        let (baseline, options) = (Some((&baseline, "A")), SessionOptions::default());
        let (result, _) =
            session::estimate_recorded(&robot, &parts[1], "B", baseline, &options).unwrap();
        for (joint, truth_mrad) in result.joints.iter().zip(&truth) {
            let error = 1e3 * joint.offset_rad.mean - truth_mrad;
            let stds = error / (1e3 * joint.offset_rad.std);
            println!(
                "{end_s} s: {} {error:+.2} mrad, {stds:+.1} deviations, {:?}",
                joint.name, joint.changes
            );
            assert!(stds.abs() < 3.0, "{} {stds}", joint.name);
        }
    }
}

// The second force deflects only the yaw, by 19 mrad, which the link equation cannot separate from a slip.
#[test]
fn contact_at_end_is_no_slip() {
    for force_n in ["[0.0, 0.0, -3.0]", "[1.0, 1.0, 0.0]"] {
        check_ends(&[115.0, 117.0, 119.0, 120.5], |text| {
            no_contact(text)
                + &format!(
                    "\n[[contacts]]\nstart_s = 113.0\nduration_s = 9.0\nlink = \"tool\"\nforce_n = {force_n}\n"
                )
        });
    }
}

#[test]
fn payload_change_at_end_is_no_slip() {
    check_ends(&[115.0, 116.5, 118.0, 120.0], |text| {
        no_contact(text)
            .replace("mass_kg = { min = 0.0, max = 0.5 }", "mass_kg = 0.4")
            .replace("attach_s = 60.0", "attach_s = 113.0")
    });
}

#[test]
fn re_tensioning_is_separated_from_slip() {
    let robot = biorob_like();
    let shorter = |text: String| {
        let step = |joint: &str, at_s: f64, rad: f64| {
            format!(
                "\n[[offsets]]\njoint = \"{joint}\"\nkind = \"physical\"\nshape = \"step\"\nat_s = {at_s}\nrad = {rad}\n"
            )
        };
        // From 10 mrad at both joints.
        no_contact(text) + &step("shoulder_pitch", 85.0, -9e-3) + &step("elbow", 100.0, -3e-3)
    };
    let (parts, truth) = work_session(&robot, 14, shorter, &[60.0, 120.0]);
    let (baseline, _) =
        session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
    let (baseline, options) = (Some((&baseline, "A")), SessionOptions::default());
    let (result, _) =
        session::estimate_recorded(&robot, &parts[1], "B", baseline, &options).unwrap();
    for (joint, at_s, kind) in [
        (PITCH, 85.0, TendonChangeKind::Retensioned),
        (ELBOW, 100.0, TendonChangeKind::Slip),
    ] {
        let found = &result.joints[joint];
        println!("{:?}", found.changes);
        assert_eq!(found.changes.len(), 1);
        let step = &found.changes[0];
        assert_eq!(step.kind, kind);
        assert!((step.time_s - at_s).abs() < 0.5, "{step:?}");
        let error = 1e3 * found.offset_rad.mean - truth[joint];
        assert!(
            error.abs() < 1e3 * found.offset_rad.half_width_95(),
            "{error}"
        );
    }
}

#[test]
fn creeping_rope_widens_interval_and_is_reported() {
    let robot = biorob_like();
    let (mut inside, mut reported, mut half) = (0, [0, 0], [0.0, 0.0]);
    let seeds = seeds(3);
    for seed in 0..seeds {
        for (k, share) in [0.0, 0.04].into_iter().enumerate() {
            let creeping = |text: String| {
                no_contact(text).replace(
                    "[truth]\n",
                    &format!(
                        "[truth]\nviscoelastic_fraction = {share}\nviscoelastic_time_s = 30.0\n"
                    ),
                )
            };
            let (parts, truth) = work_session(&robot, 40 + seed, creeping, &[60.0, 120.0]);
            let (baseline, _) =
                session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default())
                    .unwrap();
            let (baseline, options) = (Some((&baseline, "A")), SessionOptions::default());
            let (result, _) =
                session::estimate_recorded(&robot, &parts[1], "B", baseline, &options).unwrap();
            let named = result
                .warnings
                .iter()
                .filter(|w| matches!(w, Warning::RopeMemory { .. }));
            reported[k] += named.count();
            for i in [PITCH, ELBOW] {
                let joint = &result.joints[i];
                let error = 1e3 * joint.offset_rad.mean - truth[i];
                println!(
                    "{share} {}: {error:+.2} ± {:.2}",
                    joint.name,
                    1e3 * joint.offset_rad.half_width_95()
                );
                half[k] += 1e3 * joint.offset_rad.half_width_95();
                inside +=
                    usize::from(k == 1 && error.abs() < 1e3 * joint.offset_rad.half_width_95());
                assert!(
                    error.abs() < 1.5 * 1e3 * joint.offset_rad.half_width_95(),
                    "{error}"
                );
            }
        }
    }
    println!("{inside} inside, {reported:?} named, {half:?}");
    // 22 of 24 offsets of twelve robots are inside; none of six may be far outside.
    assert!(
        reported[0] == 0 && reported[1] as u64 > seeds,
        "{reported:?}"
    );
    assert!(half[1] > 1.1 * half[0], "{half:?}");
}

#[test]
fn small_stiffness_loss_is_covered_by_interval() {
    let robot = biorob_like();
    let (mut inside, mut all, mut warned) = (0, 0, 0);
    let (mut squares, mut others_mrad) = (0.0, 0.0);
    let seeds = seeds(4);
    for seed in 0..seeds {
        let weaker = |text: String| {
            no_contact(text)
                .replace("mass_kg = { min = 0.0, max = 0.5 }", "mass_kg = 0.0")
                .replace(
                    "[truth]\n",
                    "[truth]\nstiffness_later_factor = { shoulder_pitch = 0.97 }\nstiffness_later_from_s = 60.0\n",
                )
        };
        let (parts, truth) = work_session(&robot, 40 + seed, weaker, &[60.0, 120.0]);
        let (baseline, _) =
            session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
        let options = SessionOptions {
            payload: Payload::Empty,
            ..SessionOptions::default()
        };
        let since = Some((&baseline, "A"));
        let (result, _) =
            session::estimate_recorded(&robot, &parts[1], "B", since, &options).unwrap();
        for i in [PITCH, ELBOW] {
            let joint = &result.joints[i];
            let (error, half) = (
                1e3 * joint.offset_rad.mean - truth[i],
                1e3 * joint.offset_rad.half_width_95(),
            );
            println!("seed {seed} {}: {error:+.2} ± {half:.2}", joint.name);
            all += 1;
            inside += usize::from(error.abs() < half);
            squares += (error / half).powi(2);
        }
        others_mrad += 1e3 * result.joints[ELBOW].offset_rad.half_width_95();
        let since = |i: usize| result.joints[i].stiffness_change.unwrap();
        println!("{:?} {:?}", since(PITCH), since(ELBOW));
        assert!(since(ELBOW).probability < 0.5);
        let change = since(PITCH).change_ratio;
        let (loss, half_width) = (100.0 * change.mean, 100.0 * change.half_width_95());
        assert!(
            (loss + 3.0).abs() < 1.5 * half_width,
            "{loss} ± {half_width}"
        );
        let online = online_answer(&robot, &baseline, &options, &parts[1]).joints[PITCH];
        assert_eq!(online.offset_rad, result.joints[PITCH].offset_rad);
        let probability = result.joints[PITCH].stiffness_change.map(|s| s.probability);
        assert_eq!(online.stiffness_changed_probability, probability);
        let about = |w: &Warning| matches!(w, Warning::StiffnessChanged { joint, .. } if joint == "shoulder_pitch");
        warned += u64::from(result.warnings.iter().any(about));
        println!("{:?}", result.warnings);
    }
    let (rms, others_mrad) = (f64::sqrt(squares / all as f64), others_mrad / seeds as f64);
    println!("{inside} of {all} inside, {rms:.2} of it, {warned} warned, ± {others_mrad:.2}");
    // With the previous stiffness, the error of the shoulder is 1.5 to 2.3 mrad at an interval of ± 0.2 to 0.4 mrad.
    assert!(
        8 * inside >= 7 * all && rms < 0.8,
        "{inside} of {all}, {rms}"
    );
    // The question is a change by more than 5 %.
    assert_eq!(warned, 0);
    assert!(
        others_mrad < 0.7,
        "the elbow has lost nothing: {others_mrad}"
    );
}

#[test]
fn estimate_is_independent_of_segmentation() {
    let robot = biorob_like();
    let options = SessionOptions::default();
    let (whole, _) = work_session(&robot, 12, no_contact, &[60.0]);
    let (cut, truth) = work_session(&robot, 12, no_contact, &[60.0, 118.0]);
    let (baseline, _) =
        session::learn_recorded(&robot, &whole[0], "A", &session::Learning::default()).unwrap();
    let (once, _) = session::estimate_recorded(
        &robot,
        &whole[1],
        "BC",
        Some((&baseline, "baseline")),
        &options,
    )
    .unwrap();
    let (first, next) = session::estimate_recorded(
        &robot,
        &cut[1],
        "B",
        Some((&baseline, "baseline")),
        &options,
    )
    .unwrap();
    let (second, last) =
        session::estimate_recorded(&robot, &cut[2], "C", Some((&next, "next")), &options).unwrap();
    assert_eq!(last.recordings, ["A", "B", "C"]);
    for (a, b) in once.joints.iter().zip(&second.joints) {
        let apart = (1e3 * a.offset_rad.mean - 1e3 * b.offset_rad.mean).abs();
        println!(
            "{}: {:.3} ± {:.2} at once, {:.3} ± {:.2} in two",
            a.name,
            1e3 * a.offset_rad.mean,
            1e3 * a.offset_rad.half_width_95(),
            1e3 * b.offset_rad.mean,
            1e3 * b.offset_rad.half_width_95()
        );
        assert!(apart < 0.35 * 1e3 * a.offset_rad.half_width_95(), "{apart}");
        assert!(1e3 * b.offset_rad.half_width_95() < 1.6 * 1e3 * a.offset_rad.half_width_95());
        assert_eq!(
            a.changes.len(),
            b.changes.len(),
            "{:?} {:?}",
            a.changes,
            b.changes
        );
    }
    for (joint, at_s) in [(PITCH, 130.0), (ELBOW, 150.0)] {
        let step = &second.joints[joint].changes[0];
        assert!((step.time_s - at_s).abs() < 2.0, "{step:?}");
        assert!(
            (1e3 * step.size_rad.unwrap().mean - 5.0).abs()
                < 1e3 * step.size_rad.unwrap().half_width_95(),
            "{step:?}"
        );
        let error = 1e3 * first.joints[joint].offset_rad.mean - truth[joint];
        assert!(error.abs() < 1e3 * first.joints[joint].offset_rad.half_width_95());
    }
}

#[test]
fn baseline_without_motor_torque_option_ignores_it() {
    let robot = biorob_like();
    let (parts, _) = work_session(&robot, 11, no_contact, &[30.0, 32.0]);
    let learn = |motor_torque: bool| {
        let learning = session::Learning {
            motor_torque,
            ..session::Learning::default()
        };
        let learned = session::learn_recorded(&robot, &parts[0], "A", &learning);
        let (_, result) = learned.unwrap();
        let drive = result
            .nuisance
            .iter()
            .find(|m| m.joint.as_deref() == Some("elbow") && m.name.contains("drive Coulomb"));
        (
            result.motor_torque != MotorTorque::Unused,
            drive.unwrap().moved,
        )
    };
    assert_eq!((learn(true), learn(false)), ((true, true), (false, false)));
}

#[test]
fn estimate_without_baseline_covers_truth() {
    let robot = biorob_like();
    let (mut inside, mut all) = (0, 0);
    for seed in 0..seeds(2) {
        let (parts, truth) = work_session(&robot, 13 + seed, no_contact, &[60.0, 120.0]);
        for motor_torque in [false, true] {
            let options = SessionOptions {
                motor_torque,
                ..SessionOptions::default()
            };
            let (baseline, _) =
                session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default())
                    .unwrap();
            let with = Some((&baseline, "baseline"));
            let (sure, _) =
                session::estimate_recorded(&robot, &parts[1], "B", with, &options).unwrap();
            let (result, _) =
                session::estimate_recorded(&robot, &parts[1], "B", None, &options).unwrap();
            print!("seed {seed}, motor torque {motor_torque}:");
            for (joint, (with, without)) in sure.joints.iter().zip(&result.joints).enumerate() {
                let error = 1e3 * without.offset_rad.mean - truth[joint];
                print!(
                    " {} {error:+.2} ± {:.2}",
                    without.name,
                    1e3 * without.offset_rad.half_width_95()
                );
                all += 1;
                inside += usize::from(error.abs() < 1e3 * without.offset_rad.half_width_95());
                assert!(
                    1e3 * without.offset_rad.half_width_95()
                        > 1e3 * with.offset_rad.half_width_95()
                );
            }
            println!();
            assert!(result.warnings.contains(&Warning::NoBaseline));
            assert!(
                result.nuisance.iter().any(|m| m.moved) && result.nuisance.iter().any(|m| !m.moved)
            );
        }
    }
    println!("{inside} of {all} inside");
    // With a coverage of 95 %, fewer than 13 of 16 are inside with a probability of 1 %.
    assert!(16 * inside >= 13 * all, "{inside} of {all}");
}
