//! Cases in which a recursive filter was wrong with a narrow interval.

use crate::support;

use sinew_bench::scenarios::{End, EndScore, Form, Sessions, record};
use sinew_estimate::online::{Window, replay};
use sinew_estimate::session;
use sinew_estimate::session::{SessionOptions, Warning};
use sinew_model::{Gaussian, Z95};
use sinew_sim::protocol::plan_named;
use support::{biorob_like, online_answer, seeds, work_session};

/// Two tendons slip by 5 mrad, 20 s apart, without notice to the estimator.
#[test]
fn online_two_slips_provisional_then_tracked() {
    const PITCH: usize = 1;
    const ELBOW: usize = 2;
    /// Slips of the work session: joint, time, s, and size, rad.
    const SLIPS: [(usize, f64, f64); 2] = [(PITCH, 130.0, 5e-3), (ELBOW, 150.0, 5e-3)];
    /// The longest silence after a slip in 60 other recordings, s.
    const SILENT_S: f64 = 11.8;
    let robot = biorob_like();
    let (mut inside, mut settled, mut ends) = (0, 0, 0);
    // The second slip of the eleventh looks like lost stiffness.
    for seed in (0..seeds(1)).chain([10]) {
        let (parts, truth_mrad) = work_session(&robot, 60 + seed, |t| t, &[60.0]);
        let learning = session::Learning::default();
        let (baseline, _) = session::learn_recorded(&robot, &parts[0], "A", &learning).unwrap();
        let options = SessionOptions::default();
        let (mut silent_s, mut last_s) = ([0.0; SLIPS.len()], f64::NAN);
        let mut each = |window: &Window| {
            let answer = window.answer();
            let block_s = answer.time_s - last_s;
            last_s = answer.time_s;
            for (own, truth_mrad) in answer.joints.iter().zip(&truth_mrad) {
                let mut truth_rad = 1e-3 * truth_mrad;
                let mut slip = None;
                for (k, (joint, at_s, size_rad)) in SLIPS.iter().enumerate() {
                    if *joint == own.joint && *at_s < answer.time_s {
                        truth_rad += size_rad;
                        slip = Some(k);
                    }
                }
                let off = (own.offset_rad.mean - truth_rad).abs() / own.offset_rad.std;
                if own.provisional.is_none() {
                    settled += 1;
                    inside += usize::from(off < Z95);
                    if let Some(k) = slip.filter(|_| off > 3.0) {
                        silent_s[k] += block_s;
                    }
                }
            }
        };
        let with = Some((&baseline, "A"));
        let window = replay(&robot, &parts[1], with, &options, "B", &mut each).unwrap();
        println!("seed {seed}: three deviations off and settled for {silent_s:.1?} s");
        assert!(silent_s.iter().all(|s| *s < SILENT_S), "{silent_s:?}");
        for (joint, _, size_rad) in SLIPS {
            let own = window.answer().joints[joint];
            let inconsistency_rad = own.offset_rad.mean - 1e-3 * truth_mrad[joint] - size_rad;
            assert!(own.provisional.is_none(), "{own:?}");
            ends += usize::from(inconsistency_rad.abs() < own.offset_rad.half_width_95());
        }
    }
    println!("{inside} of {settled} inside, {ends} slips in the end");
    assert!(10 * inside > 9 * settled && ends >= 3);
}

/// In four poses a second slip, ten to twenty seconds after the first, resembles a stiffness loss: taken for that,
/// the elbow had an error of 31 to 46 mrad that was not provisional.
#[test]
fn online_second_slip_is_not_stiffness_loss() {
    let plan = plan_named("S9").unwrap();
    for seed in [5008, 5045, 10012, 10022] {
        let recording = record(&plan, seed, Sessions::Chain).unwrap();
        let at_end = |end: &&EndScore| (end.form, end.end) == (Form::Online, End::Chain);
        let end = recording.ends.iter().find(at_end).unwrap();
        for (i, error) in end.errors_rad.iter().enumerate() {
            let off = error.mean.abs() / error.std;
            println!("{seed}, {i}: {off:.1} deviations, {}", end.is_warned);
            assert!(off < 3.0 || end.is_warned, "{seed}, {i}: {error:?}");
        }
    }
}

/// A robot that warmed up by 15 K, whose zeros drift: without a thermometer the drift is unknown, and a specified
/// temperature counts as if it had been recorded.
#[test]
fn online_temperature_matches_recording_result() {
    let mut robot = biorob_like();
    robot.tolerances.drift_rad_per_k = Some(0.1e-3);
    let (parts, _) = work_session(&robot, 40, |t| t, &[60.0, 120.0]);
    let (mut first, mut second) = (parts[0].clone(), parts[1].clone());
    first.blocks.iter_mut().for_each(|b| b.temperature_c = 22.0);
    let learning = session::Learning::default();
    let (baseline, _) = session::learn_recorded(&robot, &first, "A", &learning).unwrap();
    let stated = SessionOptions {
        temperature_c: Some(Gaussian::new(37.0, 0.5)),
        ..SessionOptions::default()
    };
    let plain = SessionOptions::default();
    let unknown = f64::NAN;
    let mut widths = Vec::new();
    for (recorded_c, options) in [(37.0, &plain), (unknown, &plain), (unknown, &stated)] {
        for block in &mut second.blocks {
            block.temperature_c = recorded_c;
        }
        let with = Some((&baseline, "A"));
        let (batch, _) = session::estimate_recorded(&robot, &second, "B", with, options).unwrap();
        let online = online_answer(&robot, &baseline, options, &second);
        let added_rad = |own: &sinew_estimate::online::OnlineJoint| own.unknown_temperature_rad;
        let most_rad = online.joints.iter().map(added_rad).fold(0.0, f64::max);
        let warned_rad = batch.warnings.iter().find_map(|warning| match warning {
            Warning::TemperatureUnknown {
                half_width_95_rad, ..
            } => Some(half_width_95_rad / Z95),
            _ => None,
        });
        // The result shows that the temperature is unknown, as the estimate warns.
        let is_unknown = recorded_c.is_nan() && options.temperature_c.is_none();
        assert_eq!(warned_rad.is_some(), is_unknown);
        assert!(
            (most_rad - warned_rad.unwrap_or(0.0)).abs() < 1e-12,
            "{most_rad}"
        );
        for (own, joint) in online.joints.iter().zip(&batch.joints) {
            assert_eq!(own.offset_rad, joint.offset_rad);
            assert!(own.unknown_temperature_rad < own.offset_rad.std);
        }
        widths.push(online.joints[0].offset_rad.std);
    }
    // A baseline without a temperature leaves it as unknown as a robot without one.
    let mut untold = baseline.clone();
    untold.temperature_c = None;
    for block in &mut second.blocks {
        block.temperature_c = 37.0;
    }
    let online = online_answer(&robot, &untold, &plain, &second);
    assert!(online.joints[0].unknown_temperature_rad > 0.0);
    // 15 K times 0.1 mrad/K, with known and unknown temperature; the room varies by a few kelvin only.
    assert!(widths[0] > 1e-3 && widths[2] > 1e-3, "{widths:?}");
}
