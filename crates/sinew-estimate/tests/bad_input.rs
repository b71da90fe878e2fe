//! What imperfect recordings do to an estimate: each case decided, said, and survived.
//!
//! The recording is the nodding head of `examples/05-your-own-robot`, spoiled one way at a time.

use sinew_estimate::replay;
use sinew_estimate::replay::{Estimate, JointEstimate, JointRefusal, LossReason};
use sinew_estimate::session::{self, SessionOptions, Window};
use sinew_estimate::{EstimateError, Request};
use sinew_report::recording_warning;
use std::path::{Path, PathBuf};

fn story() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/05-your-own-robot")
}

/// Header and rows (time, pan, tilt, motor of tilt) of the sound recording.
fn sound() -> (String, Vec<Vec<String>>) {
    let text = std::fs::read_to_string(story().join("nod.csv")).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_string();
    let rows = lines
        .map(|l| l.split(',').map(str::to_string).collect())
        .collect();
    (header, rows)
}

fn estimate_of(header: &str, rows: &[Vec<String>]) -> Result<Estimate, EstimateError> {
    with_request(header, rows, |request| replay::run(request, &mut |_| {}))
}

/// A request for rows that are written for as long as `run` takes.
fn with_request<T>(header: &str, rows: &[Vec<String>], run: impl FnOnce(&Request) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("spoiled.csv");
    let mut text = format!("{header}\n");
    for row in rows {
        text += &row.join(",");
        text.push('\n');
    }
    std::fs::write(&log, text).unwrap();
    let mut request = Request::new(log);
    request.robot = Some(story());
    run(&request)
}

/// Why the sound recording with `spoil` done to it has no absolute offsets.
fn refused(spoil: impl FnOnce(&mut String, &mut Vec<Vec<String>>)) -> String {
    let (mut header, mut rows) = sound();
    spoil(&mut header, &mut rows);
    let run = |request: &Request| {
        let options = SessionOptions::default();
        session::estimate(request, Window::default(), None, &options, &mut |_| {})
    };
    with_request(&header, &rows, run).unwrap_err().to_string()
}

/// The sound recording with `spoil` done to it.
fn spoiled(
    spoil: impl FnOnce(&mut String, &mut Vec<Vec<String>>),
) -> Result<Estimate, EstimateError> {
    let (mut header, mut rows) = sound();
    spoil(&mut header, &mut rows);
    estimate_of(&header, &rows)
}

fn tilt(estimate: &Estimate) -> &JointEstimate {
    estimate.joints.iter().find(|j| j.name == "tilt").unwrap()
}

/// The offset in the recording is 6 mrad; a spoiled one must still say so or say nothing.
fn still_right(estimate: &Estimate) {
    let found = 1e3 * tilt(estimate).offset_rad.unwrap();
    assert!((found - 6.0).abs() < 0.1, "{found} mrad");
}

fn warned(estimate: &Estimate, words: &[&str]) {
    let all: Vec<String> = estimate.warnings.iter().map(recording_warning).collect();
    let all = all.join("\n");
    for word in words {
        assert!(all.contains(word), "no '{word}' in:\n{all}");
    }
}

#[test]
fn the_sound_recording_is_right_and_unwarned() {
    let estimate = spoiled(|_, _| ()).unwrap();
    still_right(&estimate);
    assert!(!estimate.damaged);
    assert!(tilt(&estimate).usable_share > 0.9);
    // The pan axis stands still in the recording, and the reader says so.
    assert!(
        estimate
            .warnings
            .iter()
            .all(|w| recording_warning(w).contains("q.pan is constant")),
        "{:?}",
        estimate.warnings
    );
}

#[test]
fn one_nan_costs_one_frame() {
    for column in [2, 3] {
        let estimate = spoiled(|_, rows| rows[500][column] = "NaN".into()).unwrap();
        still_right(&estimate);
        let clean = tilt(&spoiled(|_, _| ()).unwrap()).usable_frames;
        assert_eq!(tilt(&estimate).usable_frames, clean - 1, "column {column}");
        warned(&estimate, &["NaN"]);
    }
}

#[test]
fn an_all_nan_column_is_no_estimate_and_says_which() {
    // No motor position at all: nothing can be estimated, and the reason is there.
    let estimate = spoiled(|_, rows| rows.iter_mut().for_each(|r| r[3] = "NaN".into())).unwrap();
    let because = |reason| Some(JointRefusal::NoUsableFrame(Some(reason)));
    assert_eq!(tilt(&estimate).refused, because(LossReason::MotorPosition));
    assert!(tilt(&estimate).offset_rad.is_none());
    // No joint position: no frame can be used for any joint.
    let estimate = spoiled(|_, rows| rows.iter_mut().for_each(|r| r[2] = "NaN".into())).unwrap();
    assert_eq!(tilt(&estimate).refused, because(LossReason::JointPosition));
}

#[test]
fn a_gap_starts_the_observer_anew() {
    let estimate = spoiled(|_, rows| {
        for row in &mut rows[500..] {
            let t: f64 = row[0].parse().unwrap();
            row[0] = format!("{:.2}", t + 10.0);
        }
    })
    .unwrap();
    still_right(&estimate);
    assert_eq!(estimate.recording.segments, 2);
    warned(&estimate, &["1 gap", "10.0 s"]);
}

#[test]
fn time_that_goes_back_starts_a_segment() {
    let estimate = spoiled(|_, rows| {
        for row in &mut rows[500..] {
            let t: f64 = row[0].parse().unwrap();
            row[0] = format!("{:.2}", t - 3.0);
        }
    })
    .unwrap();
    still_right(&estimate);
    warned(&estimate, &["clock went back 1 time"]);
}

#[test]
fn duplicates_and_swapped_rows_are_put_right() {
    let estimate = spoiled(|_, rows| {
        let copy = rows[300].clone();
        rows.insert(301, copy);
        rows.swap(600, 603);
    })
    .unwrap();
    still_right(&estimate);
    warned(&estimate, &["out of order"]);
    assert!(
        estimate
            .losses
            .iter()
            .any(|l| l.reason == LossReason::Duplicate && l.frames == 1),
        "{:?}",
        estimate.losses
    );
}

#[test]
fn degrees_are_suspected() {
    let estimate = spoiled(|_, rows| {
        for row in rows {
            for column in [2, 3] {
                let x: f64 = row[column].parse().unwrap();
                row[column] = format!("{:.5}", x.to_degrees());
            }
        }
    })
    .unwrap();
    warned(&estimate, &["degrees"]);
    // Only the motor in degrees: an offset no rope can have.
    let estimate = spoiled(|_, rows| {
        for row in rows {
            let x: f64 = row[3].parse().unwrap();
            row[3] = format!("{:.5}", x.to_degrees());
        }
    })
    .unwrap();
    warned(&estimate, &["degrees"]);
}

#[test]
fn an_impossible_offset_is_doubted() {
    let estimate = spoiled(|_, rows| {
        for row in rows {
            let x: f64 = row[3].parse().unwrap();
            row[3] = format!("{:.6}", x + 0.5);
        }
    })
    .unwrap();
    warned(&estimate, &["506 mrad is no stretch"]);
}

#[test]
fn a_standing_arm_says_that_it_cannot_tell() {
    let estimate = spoiled(|_, rows| {
        let still = rows[0].clone();
        for row in rows.iter_mut() {
            row[1..4].clone_from_slice(&still[1..4]);
        }
    })
    .unwrap();
    warned(&estimate, &["torque hardly changes", "constant"]);
}

#[test]
fn joints_that_do_not_match_are_named() {
    let error = spoiled(|header, _| *header = header.replace("tilt", "nod"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("'tilt'") && error.contains("'nod'") && error.contains("--mapping"),
        "{error}"
    );
    let estimate = spoiled(|header, rows| {
        header.push_str(",q.tail_rad");
        for row in rows {
            row.push("0.5".into());
        }
    })
    .unwrap();
    still_right(&estimate);
    warned(&estimate, &["'tail'", "not in the robot"]);
}

#[test]
fn a_joint_without_positions_is_named_with_what_there_is_instead() {
    let renamed = refused(|header, _| *header = header.replace("theta.tilt", "theta.tild"));
    for word in [
        "motor position of 'tilt'",
        "did you mean 'tild'?",
        "--mapping",
    ] {
        assert!(renamed.contains(word), "no '{word}' in: {renamed}");
    }
    assert!(!renamed.contains("baseline"), "{renamed}");
    let empty = refused(|_, rows| rows.iter_mut().for_each(|row| row[2] = "nan".into()));
    let count = sound().1.len();
    let words =
        format!("joint position of 'tilt' is missing or not a number in {count} of {count}");
    assert!(empty.contains(&words), "no '{words}' in: {empty}");
}

#[test]
fn nothing_to_read_is_refused() {
    let error = spoiled(|_, rows| rows.clear()).unwrap_err().to_string();
    assert!(error.contains("spoiled.csv"), "{error}");
    let error = spoiled(|header, rows| {
        *header = header.replace(",theta.tilt_rad", "");
        for row in rows {
            row.pop();
        }
    })
    .unwrap_err()
    .to_string();
    assert!(
        error.contains("motor position is not recorded") && error.contains("--motor-topic"),
        "{error}"
    );
    let error = spoiled(|_, rows| rows[10][2] = "fast".into())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("fast") && error.contains("12") && error.contains("q.tilt_rad"),
        "{error}"
    );
}

#[test]
fn a_motor_that_drops_out_costs_only_its_own_joint_and_settles_again() {
    // 1 s without motor position: 100 frames; the first 10 are stepped over.
    let estimate =
        spoiled(|_, rows| rows[400..500].iter_mut().for_each(|r| r[3] = String::new())).unwrap();
    still_right(&estimate);
    let joint = tilt(&estimate);
    let missing: u64 = joint
        .losses
        .iter()
        .filter(|l| l.reason == LossReason::MotorPosition)
        .map(|l| l.frames)
        .sum();
    assert_eq!(missing, 100, "{:?}", joint.losses);
    let settling: u64 = joint
        .losses
        .iter()
        .filter(|l| l.reason == LossReason::Settling)
        .map(|l| l.frames)
        .sum();
    // Start and return, 0.575 s each at 100 Hz.
    assert!((110..=120).contains(&settling), "{settling}");
}
