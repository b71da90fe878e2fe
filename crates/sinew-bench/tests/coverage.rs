//! Offsets of whole sessions against their truth: errors agree with the intervals documented in
//! docs/src/validation.md. Intervals 0.7 or 1.4 times as wide fail.

use crate::score::Scores;
use crate::support::seeds;
use sinew_bench::scenarios::{
    End, Form, Options, Sessions, render_trajectories, run_recordings, run_trajectories,
};

/// Errors over reported standard deviations at the end of session B, of the selected joints.
fn scores(scenario: &str, recordings: u64, of: impl Fn(&str) -> bool) -> Scores {
    let options = Options {
        scenarios: vec![scenario.into()],
        robot: None,
        n: seeds(recordings),
        first_seed: 3000,
        sessions: Sessions::B,
        motor_torque: true,
        jobs: 2,
        out: None,
    };
    let (_, recordings) = run_recordings(&options, &mut |_, _| {}).expect("recordings");
    let mut scores = Scores::default();
    for joint in recordings.iter().flat_map(|r| &r.joints) {
        if of(&joint.name) {
            scores.add_error(joint.error_rad.mean, joint.error_rad.std);
        }
    }
    scores
}

/// A temperature that changes the zero by 0.1 mrad/K dominates the uncertainty: intervals are as wide as errors.
#[test]
#[ignore = "study: 20 recordings"]
fn estimate_warm_arm_errors_match_intervals() {
    scores("S8", 20, |_| true).hold("S8, all joints");
}

/// Without it, errors at the joints that carry the load are 0.70 of their reported standard deviation.
#[test]
#[ignore = "study: 30 recordings"]
fn estimate_loaded_joints_interval_ratio_matches_docs() {
    let loaded = |joint: &str| joint == "shoulder_pitch" || joint == "elbow";
    scores("S5", 30, loaded).hold_as("S5, shoulder pitch and elbow", 0.7 * 0.7);
}

/// Online estimate of recordings from a seed on: root mean square of the errors at the end of a session, rad, number
/// of offsets outside their interval and settled, and number of offsets.
fn online_ends(scenario: &str, (first_seed, n): (u64, u64), at: End) -> (f64, usize, usize) {
    let options = Options {
        scenarios: vec![scenario.into()],
        robot: None,
        n,
        first_seed,
        sessions: Sessions::Chain,
        motor_torque: true,
        jobs: 2,
        out: None,
    };
    let (_, recordings) = run_recordings(&options, &mut |_, _| {}).expect("recordings");
    let ends = recordings.iter().flat_map(|recording| &recording.ends);
    let (mut squares, mut silent, mut count) = (0.0, 0, 0);
    for end in ends.filter(|end| end.form == Form::Online && end.end == at) {
        let outside = end.errors_rad.iter().filter(|e| e.is_nonzero_95()).count();
        silent += if end.is_warned { 0 } else { outside };
        count += end.errors_rad.len();
        squares += end.errors_rad.iter().map(|e| e.mean * e.mean).sum::<f64>();
    }
    let rms_rad = (squares / count as f64).sqrt();
    println!(
        "{scenario}: {:.2} mrad, {silent} of {count} silent",
        1e3 * rms_rad
    );
    (rms_rad, silent, count)
}

/// Four poses, an unknown load, and two slips. A filter that takes the slips for stiffness, load and creep has an
/// error of 19 mrad, without a warning in six of 32.
#[test]
#[ignore = "study: four pairs of recordings"]
fn online_pick_and_place_tracks_slips() {
    let (rms_rad, silent, count) = online_ends("S9", (5000, 4), End::Chain);
    assert!(rms_rad < 8e-3, "{rms_rad} rad");
    assert!(silent <= 1, "{silent} of {count}");
}

/// A person leans on an arm at rest until the session's end. A filter that takes it for an offset has an error of 65
/// mrad and a narrow interval.
#[test]
fn online_lasting_contact_at_rest_is_no_offset() {
    let (rms_rad, silent, _) = online_ends("S9c", (5011, 1), End::B);
    assert!(rms_rad < 10e-3 && silent == 0, "{rms_rad} rad, {silent}");
}

/// Stiffness drops by 8 % while the arm works. A filter that models slips only takes it for one, with an error of 2.6
/// mrad.
#[test]
#[ignore = "study: three pairs of recordings"]
fn online_stiffness_loss_is_not_slip() {
    let (rms_rad, silent, count) = online_ends("U3b", (3000, 3), End::B);
    assert!(rms_rad < 1e-3, "{rms_rad} rad");
    assert!(silent <= 1, "{silent} of {count}");
}

/// Every block of three recordings. Over hundreds (docs/src/validation.md) the shares are a tenth to a half of these
/// limits.
#[test]
fn online_estimate_useful_share_and_silent_errors() {
    let options = Options {
        scenarios: ["S5", "S7", "S9b"].map(String::from).to_vec(),
        robot: None,
        n: 1,
        first_seed: 9101,
        sessions: Sessions::Chain,
        motor_torque: true,
        jobs: 2,
        out: None,
    };
    let report = run_trajectories(&options, &mut |_, _| {}).expect("trajectories");
    print!("{}", render_trajectories(&report));
    let all = report.scenarios.last().expect("all together");
    let [figures, ..] = &all.joints[..] else {
        panic!("no joints")
    };
    assert_eq!((all.recordings, all.slips.slips), (3, 6));
    let [first_s, _] = figures.first_useful_s;
    assert!(first_s.expect("some time") < 7.0, "{figures:?}");
    assert!(figures.useful_share > 0.8, "{figures:?}");
    assert!(
        figures.silent_share < 0.05 && figures.far_share < 0.01,
        "{figures:?}"
    );
    let calm = figures.calm_provisional_share.expect("some calm");
    assert!(calm < 0.03, "{figures:?}");
    let [median_s, _, longest_s] = all.slips.silent_s.map(|s| s.expect("slips"));
    assert!(median_s < 1.0 && longest_s < 6.0, "{:?}", all.slips);
    let [_, _, right_s] = all.slips.right_s.map(|s| s.expect("slips"));
    assert!(right_s < 10.0, "{:?}", all.slips);
}
