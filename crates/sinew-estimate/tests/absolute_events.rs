//! What happens within and between recordings: loads, cuts, chains, lost stiffness.

use crate::support;

use sinew_estimate::absolute;
use sinew_estimate::absolute::{Payload, WatchOptions};
use sinew_model::Gaussian;
use support::{biorob_like, block_by_block, seeds, work_session};

const PITCH: usize = 1;
const ELBOW: usize = 2;

fn no_contact(text: String) -> String {
    text.replace("fraction = 0.1\n", "fraction = 0.0\n")
}

#[test]
fn a_load_picked_up_in_mid_session_is_found_and_not_read_as_stretch() {
    let robot = biorob_like();
    let load = |text: String| {
        no_contact(text)
            .replace("mass_kg = { min = 0.0, max = 0.5 }", "mass_kg = 0.4")
            .replace("attach_s = 60.0", "attach_s = 91.0")
    };
    let (parts, truth) = work_session(&robot, 11, load, &[60.0, 120.0]);
    let (baseline, _) = absolute::learn_recorded(&robot, &parts[0], "A").unwrap();
    let (said, _) = absolute::watch_recorded(
        &robot,
        &parts[1],
        "B",
        Some((&baseline, "baseline")),
        &WatchOptions::default(),
    )
    .unwrap();
    println!("{:?} {:?}", said.payload_changes, said.payload_kg);
    assert_eq!(said.payload_changes.len(), 1, "{:?}", said.payload_changes);
    let change = &said.payload_changes[0];
    assert!((change.time_s - 91.0).abs() < 1.5, "{change:?}");
    assert!((change.change_kg - 0.4).abs() < 0.1, "{change:?}");
    let [from_s, to_s] = change.between_s.unwrap();
    assert!(
        from_s < 91.0 && 91.0 < to_s && to_s - from_s < 3.0,
        "{change:?}"
    );
    assert!(change.probability.unwrap() > 0.99, "{change:?}");
    for joint in [PITCH, ELBOW] {
        let found = &said.joints[joint];
        let error = found.offset_mrad - truth[joint];
        println!("{} {error:+.2} ± {:.2}", found.name, found.interval_95_mrad);
        assert!(
            error.abs() < found.interval_95_mrad && error.abs() < 1.0,
            "{error}"
        );
        assert!(found.steps.is_empty(), "{:?}", found.steps);
    }
    // Nothing in the gripper is something else: told so, the same load reads as stretch or as
    // disturbance, and the answer says that much did not fit.
    let empty = WatchOptions {
        payload: Payload::Empty,
        ..WatchOptions::default()
    };
    let (said, _) = absolute::watch_recorded(
        &robot,
        &parts[1],
        "B",
        Some((&baseline, "baseline")),
        &empty,
    )
    .unwrap();
    assert!(
        said.left_out_share > 0.3 && !said.warnings.is_empty(),
        "{said:?}"
    );
}

/// What the baseline took for the gripper is gone.
#[test]
fn a_load_below_nothing_is_no_load() {
    let robot = biorob_like();
    let load = |text: String| {
        no_contact(text)
            .replace("mass_kg = { min = 0.0, max = 0.5 }", "mass_kg = 0.4")
            .replace("attach_s = 60.0", "attach_s = 0.0\nrelease_s = 60.0")
    };
    let (parts, _) = work_session(&robot, 11, load, &[60.0, 120.0]);
    let (baseline, _) = absolute::learn_recorded(&robot, &parts[0], "A").unwrap();
    let watched = |part: usize| {
        let baseline = Some((&baseline, "A"));
        let options = WatchOptions::default();
        let (said, _) =
            absolute::watch_recorded(&robot, &parts[part], "B", baseline, &options).unwrap();
        let warned = said
            .warnings
            .iter()
            .any(|w| w.contains("less than nothing"));
        println!("{:?} {:?}", said.payload_kg, said.warnings);
        (said.payload_kg[0], warned)
    };
    let (payload_kg, warned) = watched(1);
    assert!(payload_kg < -0.1 && warned, "{payload_kg}");
    let (payload_kg, warned) = watched(0);
    assert!(payload_kg.abs() < 0.05 && !warned, "{payload_kg}");
}

#[test]
fn a_slip_in_the_last_seconds_may_be_a_contact_that_has_not_ended() {
    let robot = biorob_like();
    let late = |text: String| {
        no_contact(text)
            + "\n[[offsets]]\njoint = \"shoulder_pitch\"\nkind = \"physical\"\nshape = \"step\"\nat_s = 114.0\nrad = 0.005\n"
    };
    let watch = |cuts: &[f64]| {
        let (parts, truth) = work_session(&robot, 14, late, cuts);
        let (baseline, _) = absolute::learn_recorded(&robot, &parts[0], "A").unwrap();
        let baseline = Some((&baseline, "A"));
        let options = WatchOptions::default();
        let (said, _) =
            absolute::watch_recorded(&robot, &parts[1], "B", baseline, &options).unwrap();
        let doubted = said.warnings.iter().any(|w| w.contains("holds both"));
        let joint = said.joints[PITCH].clone();
        let error = joint.offset_mrad - truth[PITCH];
        println!(
            "{error:+.2} ± {:.2} {:?}",
            joint.interval_95_mrad, joint.steps
        );
        assert_eq!(joint.steps.len(), 1);
        assert!(error.abs() < joint.interval_95_mrad, "{error}");
        // What is said over time is as wide as the last word, and no wider before.
        let last = said.course.last().unwrap().interval_95_mrad[PITCH];
        assert!((last - joint.interval_95_mrad).abs() < 1e-9, "{last}");
        let end = said.series.last().unwrap().interval_95_mrad[PITCH];
        assert!((end - joint.interval_95_mrad).abs() < 1e-9, "{end}");
        let before = said.course.iter().find(|c| c.time_s > 40.0).unwrap();
        assert!(before.interval_95_mrad[PITCH] < 2.0, "{before:?}");
        let [from_s, to_s] = joint.steps[0].between_s.unwrap();
        assert!(from_s < 114.0 && 114.0 < to_s, "{from_s} {to_s}");
        let probability = joint.steps[0].probability.unwrap();
        (joint.interval_95_mrad, doubted, probability)
    };
    let (interval, doubted, probability) = watch(&[60.0, 120.0]);
    assert!(doubted && interval > 4.5, "{interval}");
    assert!(probability < 0.5, "{probability}");
    // Ten seconds later a contact would have ended.
    let (interval, doubted, probability) = watch(&[60.0, 130.0]);
    assert!(!doubted && interval < 2.0, "{interval}");
    assert!(probability > 0.9, "{probability}");
}

#[test]
fn a_tendon_that_somebody_tensioned_again_is_told_from_one_that_slipped_back() {
    let robot = biorob_like();
    let shorter = |text: String| {
        let step = |joint: &str, at_s: f64, rad: f64| {
            format!(
                "\n[[offsets]]\njoint = \"{joint}\"\nkind = \"physical\"\nshape = \"step\"\nat_s = {at_s}\nrad = {rad}\n"
            )
        };
        // Of 10 mrad at either joint.
        no_contact(text) + &step("shoulder_pitch", 85.0, -9e-3) + &step("elbow", 100.0, -3e-3)
    };
    let (parts, truth) = work_session(&robot, 14, shorter, &[60.0, 120.0]);
    let (baseline, _) = absolute::learn_recorded(&robot, &parts[0], "A").unwrap();
    let (baseline, options) = (Some((&baseline, "A")), WatchOptions::default());
    let (said, _) = absolute::watch_recorded(&robot, &parts[1], "B", baseline, &options).unwrap();
    for (joint, at_s, kind) in [(PITCH, 85.0, "re-tensioned"), (ELBOW, 100.0, "slip")] {
        let found = &said.joints[joint];
        println!("{:?}", found.steps);
        assert_eq!(found.steps.len(), 1);
        let step = &found.steps[0];
        assert_eq!(step.kind, kind);
        assert!((step.time_s - at_s).abs() < 0.5, "{step:?}");
        let error = found.offset_mrad - truth[joint];
        assert!(error.abs() < found.interval_95_mrad, "{error}");
    }
}

#[test]
fn a_rope_that_goes_on_stretching_widens_the_interval_and_is_named() {
    let robot = biorob_like();
    let (mut inside, mut said_of, mut half) = (0, [0, 0], [0.0, 0.0]);
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
            let (baseline, _) = absolute::learn_recorded(&robot, &parts[0], "A").unwrap();
            let (baseline, options) = (Some((&baseline, "A")), WatchOptions::default());
            let (said, _) =
                absolute::watch_recorded(&robot, &parts[1], "B", baseline, &options).unwrap();
            let named = said.warnings.iter().filter(|w| w.contains("half a minute"));
            said_of[k] += named.count();
            for i in [PITCH, ELBOW] {
                let joint = &said.joints[i];
                let error = joint.offset_mrad - truth[i];
                println!(
                    "{share} {}: {error:+.2} ± {:.2}",
                    joint.name, joint.interval_95_mrad
                );
                half[k] += joint.interval_95_mrad;
                inside += usize::from(k == 1 && error.abs() < joint.interval_95_mrad);
                assert!(error.abs() < 1.5 * joint.interval_95_mrad, "{error}");
            }
        }
    }
    println!("{inside} inside, {said_of:?} named, {half:?}");
    // 22 of 24 offsets of a dozen robots are inside; of six none may be far outside.
    assert!(said_of[0] == 0 && said_of[1] as u64 > seeds, "{said_of:?}");
    assert!(half[1] > 1.1 * half[0], "{half:?}");
}

#[test]
fn a_small_loss_of_stiffness_between_recordings_is_allowed_for() {
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
        let (baseline, _) = absolute::learn_recorded(&robot, &parts[0], "A").unwrap();
        let options = WatchOptions {
            payload: Payload::Empty,
            ..WatchOptions::default()
        };
        let since = Some((&baseline, "A"));
        let (said, _) = absolute::watch_recorded(&robot, &parts[1], "B", since, &options).unwrap();
        for i in [PITCH, ELBOW] {
            let joint = &said.joints[i];
            let (error, half) = (joint.offset_mrad - truth[i], joint.interval_95_mrad);
            println!("seed {seed} {}: {error:+.2} ± {half:.2}", joint.name);
            all += 1;
            inside += usize::from(error.abs() < half);
            squares += (error / half).powi(2);
        }
        others_mrad += said.joints[ELBOW].interval_95_mrad;
        let since = |i: usize| said.joints[i].stiffness_since_before.unwrap();
        println!("{:?} {:?}", since(PITCH), since(ELBOW));
        assert!(since(ELBOW).probability < 0.5);
        let [loss, unsure] = since(PITCH).change_percent;
        assert!((loss + 3.0).abs() < 1.5 * unsure, "{loss} ± {unsure}");
        let (filter, _) = block_by_block(&robot, &baseline, &options, &parts[1]);
        let Gaussian {
            mean: offset,
            deviation,
        } = filter.offset(PITCH).scaled(1e3);
        let (apart, half) = (
            (offset - said.joints[PITCH].offset_mrad).abs(),
            1.96 * deviation,
        );
        println!(
            "block by block {offset:.2} ± {half:.2}, {:.2}",
            filter.stiffness_changed(PITCH)
        );
        assert!((offset - truth[PITCH]).abs() < 1.7 * half, "{offset}");
        assert!(apart < 0.5 * half, "{apart} apart");
        let about = |w: &&String| w.starts_with("shoulder_pitch: stiffness");
        warned += u64::from(said.warnings.iter().any(|w| about(&w)));
        println!("{:?}", said.warnings);
    }
    let (rms, others_mrad) = (f64::sqrt(squares / all as f64), others_mrad / seeds as f64);
    println!("{inside} of {all} inside, {rms:.2} of it, {warned} warned, ± {others_mrad:.2}");
    // With the stiffness of before, the shoulder is 1.5 to 2.3 mrad off and believes in ± 0.2 to 0.4.
    assert!(
        8 * inside >= 7 * all && rms < 0.8,
        "{inside} of {all}, {rms}"
    );
    assert!(4 * warned >= 3 * seeds, "{warned}");
    assert!(
        others_mrad < 0.7,
        "the elbow has lost nothing: {others_mrad}"
    );
}

#[test]
fn an_answer_does_not_depend_on_how_a_recording_is_cut() {
    let robot = biorob_like();
    let options = WatchOptions::default();
    let (whole, _) = work_session(&robot, 12, no_contact, &[60.0]);
    let (cut, truth) = work_session(&robot, 12, no_contact, &[60.0, 118.0]);
    let (baseline, _) = absolute::learn_recorded(&robot, &whole[0], "A").unwrap();
    let (once, _) = absolute::watch_recorded(
        &robot,
        &whole[1],
        "BC",
        Some((&baseline, "baseline")),
        &options,
    )
    .unwrap();
    let (first, next) = absolute::watch_recorded(
        &robot,
        &cut[1],
        "B",
        Some((&baseline, "baseline")),
        &options,
    )
    .unwrap();
    let (second, last) =
        absolute::watch_recorded(&robot, &cut[2], "C", Some((&next, "next")), &options).unwrap();
    assert_eq!(last.recordings, ["A", "B", "C"]);
    for (a, b) in once.joints.iter().zip(&second.joints) {
        let apart = (a.offset_mrad - b.offset_mrad).abs();
        println!(
            "{}: {:.3} ± {:.2} at once, {:.3} ± {:.2} in two",
            a.name, a.offset_mrad, a.interval_95_mrad, b.offset_mrad, b.interval_95_mrad
        );
        assert!(apart < 0.35 * a.interval_95_mrad, "{apart}");
        assert!(b.interval_95_mrad < 1.6 * a.interval_95_mrad);
        assert_eq!(a.steps.len(), b.steps.len(), "{:?} {:?}", a.steps, b.steps);
    }
    for (joint, at_s) in [(PITCH, 130.0), (ELBOW, 150.0)] {
        let step = &second.joints[joint].steps[0];
        assert!((step.time_s - at_s).abs() < 2.0, "{step:?}");
        assert!(
            (step.size_mrad - 5.0).abs() < step.interval_95_mrad,
            "{step:?}"
        );
        let error = first.joints[joint].offset_mrad - truth[joint];
        assert!(error.abs() < first.joints[joint].interval_95_mrad);
    }
}

#[test]
fn a_baseline_leaves_the_motor_torque_out_when_told_so() {
    let robot = biorob_like();
    let (parts, _) = work_session(&robot, 11, no_contact, &[30.0, 32.0]);
    let learn = |motor_torque: bool| {
        let learning = absolute::Learning {
            motor_torque,
            ..absolute::Learning::default()
        };
        let learned = absolute::learn_recorded_from(&robot, &parts[0], "A", &learning);
        let (_, said) = learned.unwrap();
        let drive = said
            .nuisance
            .iter()
            .find(|m| m.joint == "elbow" && m.name.contains("drive Coulomb"));
        (said.motor_torque, drive.unwrap().moved)
    };
    assert_eq!((learn(true), learn(false)), ((true, true), (false, false)));
}

#[test]
fn without_a_baseline_the_answer_is_wider_and_still_right() {
    let robot = biorob_like();
    let (mut inside, mut all) = (0, 0);
    for seed in 0..seeds(2) {
        let (parts, truth) = work_session(&robot, 13 + seed, no_contact, &[60.0, 120.0]);
        for motor_torque in [false, true] {
            let options = WatchOptions {
                motor_torque,
                ..WatchOptions::default()
            };
            let (baseline, _) = absolute::learn_recorded(&robot, &parts[0], "A").unwrap();
            let with = Some((&baseline, "baseline"));
            let (sure, _) =
                absolute::watch_recorded(&robot, &parts[1], "B", with, &options).unwrap();
            let (said, _) =
                absolute::watch_recorded(&robot, &parts[1], "B", None, &options).unwrap();
            print!("seed {seed}, motor torque {motor_torque}:");
            for (joint, (with, without)) in sure.joints.iter().zip(&said.joints).enumerate() {
                let error = without.offset_mrad - truth[joint];
                print!(
                    " {} {error:+.2} ± {:.2}",
                    without.name, without.interval_95_mrad
                );
                all += 1;
                inside += usize::from(error.abs() < without.interval_95_mrad);
                assert!(without.interval_95_mrad > with.interval_95_mrad);
            }
            println!();
            assert!(
                said.warnings
                    .iter()
                    .any(|w| w.contains("without a baseline"))
            );
            assert!(
                said.nuisance.iter().any(|m| m.moved) && said.nuisance.iter().any(|m| !m.moved)
            );
        }
    }
    println!("{inside} of {all} inside");
    // At 95 % each, fewer than 13 of 16 has a chance of 1 %.
    assert!(16 * inside >= 13 * all, "{inside} of {all}");
}
