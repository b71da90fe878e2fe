//! Estimates of faulty recordings: each fault is handled and reported.
//!
//! The recording is the nodding head of `examples/05-your-own-robot` with one fault at a time.

use sinew_estimate::replay;
use sinew_estimate::replay::{Estimate, JointError, JointEstimate, LossReason};
use sinew_estimate::session::{self, SessionOptions, Window};
use sinew_estimate::{EstimateError, Request};
use sinew_report::recording_warning;
use std::path::{Path, PathBuf};

fn story() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/05-your-own-robot")
}

/// Header and rows (time, pan, tilt, motor of tilt) of the valid recording.
fn valid() -> (String, Vec<Vec<String>>) {
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

/// Calls `run` with a request for a temporary file of these rows.
fn with_request<T>(header: &str, rows: &[Vec<String>], run: impl FnOnce(&Request) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("corrupt.csv");
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

/// Error of the absolute estimate for the valid recording changed by `corrupt`.
fn error_of(corrupt: impl FnOnce(&mut String, &mut Vec<Vec<String>>)) -> String {
    let (mut header, mut rows) = valid();
    corrupt(&mut header, &mut rows);
    let run = |request: &Request| {
        let options = SessionOptions::default();
        session::estimate(request, Window::default(), None, &options, &mut |_| {})
    };
    with_request(&header, &rows, run).unwrap_err().to_string()
}

/// Estimate of the valid recording changed by `corrupt`.
fn corrupted(
    corrupt: impl FnOnce(&mut String, &mut Vec<Vec<String>>),
) -> Result<Estimate, EstimateError> {
    let (mut header, mut rows) = valid();
    corrupt(&mut header, &mut rows);
    estimate_of(&header, &rows)
}

fn tilt(estimate: &Estimate) -> &JointEstimate {
    estimate.joints.iter().find(|j| j.name == "tilt").unwrap()
}

/// Checks the offset of 6 mrad.
fn assert_offset(estimate: &Estimate) {
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
fn valid_recording_raises_no_warning() {
    let estimate = corrupted(|_, _| ()).unwrap();
    assert_offset(&estimate);
    assert!(!estimate.damaged);
    assert!(tilt(&estimate).usable_share > 0.9);
    // The pan axis is at rest in the recording, which raises a warning.
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
fn single_nan_rejects_one_frame() {
    for column in [2, 3] {
        let estimate = corrupted(|_, rows| rows[500][column] = "NaN".into()).unwrap();
        assert_offset(&estimate);
        let clean = tilt(&corrupted(|_, _| ()).unwrap()).usable_frames;
        assert_eq!(tilt(&estimate).usable_frames, clean - 1, "column {column}");
        warned(&estimate, &["NaN"]);
    }
}

#[test]
fn all_nan_column_error_names_column() {
    // No motor position at all: nothing can be estimated, and the reason is reported.
    let estimate = corrupted(|_, rows| rows.iter_mut().for_each(|r| r[3] = "NaN".into())).unwrap();
    let because = |reason| Some(JointError::NoUsableFrame(Some(reason)));
    assert_eq!(tilt(&estimate).reason, because(LossReason::MotorPosition));
    assert!(tilt(&estimate).offset_rad.is_none());
    // No joint position: no frame can be used for any joint.
    let estimate = corrupted(|_, rows| rows.iter_mut().for_each(|r| r[2] = "NaN".into())).unwrap();
    assert_eq!(tilt(&estimate).reason, because(LossReason::JointPosition));
}

#[test]
fn gap_reinitialises_observer() {
    let estimate = corrupted(|_, rows| {
        for row in &mut rows[500..] {
            let t: f64 = row[0].parse().unwrap();
            row[0] = format!("{:.2}", t + 10.0);
        }
    })
    .unwrap();
    assert_offset(&estimate);
    assert_eq!(estimate.recording.segments, 2);
    warned(&estimate, &["1 gap", "10.0 s"]);
}

#[test]
fn non_monotonic_time_starts_segment() {
    let estimate = corrupted(|_, rows| {
        for row in &mut rows[500..] {
            let t: f64 = row[0].parse().unwrap();
            row[0] = format!("{:.2}", t - 3.0);
        }
    })
    .unwrap();
    assert_offset(&estimate);
    warned(&estimate, &["stepped 1 time"]);
}

#[test]
fn duplicate_and_swapped_rows_are_corrected() {
    let estimate = corrupted(|_, rows| {
        let copy = rows[300].clone();
        rows.insert(301, copy);
        rows.swap(600, 603);
    })
    .unwrap();
    assert_offset(&estimate);
    warned(&estimate, &["reordered by time stamp"]);
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
fn degrees_raise_unit_warning() {
    let estimate = corrupted(|_, rows| {
        for row in rows {
            for column in [2, 3] {
                let x: f64 = row[column].parse().unwrap();
                row[column] = format!("{:.5}", x.to_degrees());
            }
        }
    })
    .unwrap();
    warned(&estimate, &["degrees"]);
    // Only the motor in degrees: an implausible offset for a rope.
    let estimate = corrupted(|_, rows| {
        for row in rows {
            let x: f64 = row[3].parse().unwrap();
            row[3] = format!("{:.5}", x.to_degrees());
        }
    })
    .unwrap();
    warned(&estimate, &["degrees"]);
}

/// The error of the absolute estimate names the line of the mapping that corrects it.
#[test]
fn wrong_unit_gear_ratio_or_sign_is_error_with_remedy() {
    let scaled = |columns: &[usize], factor: f64| {
        error_of(|_, rows| {
            for row in rows {
                for &column in columns {
                    let x: f64 = row[column].parse().unwrap();
                    row[column] = format!("{:.7}", factor * x);
                }
            }
        })
    };
    let (q, theta) = (2, 3);
    let degrees = 180.0 / std::f64::consts::PI;
    for (columns, factor, remedy) in [
        (
            &[theta][..],
            degrees,
            "[joints.tilt] theta = { …, unit = \"deg\" }",
        ),
        (&[theta], -1.0, "[joints.tilt] theta = { …, sign = -1 }"),
        (&[theta], 50.0, "gear_ratio = "),
        (&[q], degrees, "[joints.tilt] q = { …, unit = \"deg\" }"),
        (&[q, theta], degrees, "unit = \"deg\" for q and theta"),
    ] {
        let error = scaled(columns, factor);
        assert!(error.contains(remedy), "{factor}: {error}");
    }
}

#[test]
fn implausible_offset_raises_warning() {
    let estimate = corrupted(|_, rows| {
        for row in rows {
            let x: f64 = row[3].parse().unwrap();
            row[3] = format!("{:.6}", x + 0.5);
        }
    })
    .unwrap();
    warned(&estimate, &["506 mrad is implausible"]);
}

#[test]
fn arm_at_rest_raises_torque_range_warning() {
    let estimate = corrupted(|_, rows| {
        let still = rows[0].clone();
        for row in rows.iter_mut() {
            row[1..4].clone_from_slice(&still[1..4]);
        }
    })
    .unwrap();
    warned(&estimate, &["torque range", "constant"]);
}

#[test]
fn unmatched_joints_are_named() {
    let error = corrupted(|header, _| *header = header.replace("tilt", "nod"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("'tilt'") && error.contains("'nod'") && error.contains("--mapping"),
        "{error}"
    );
    let estimate = corrupted(|header, rows| {
        header.push_str(",q.tail_rad");
        for row in rows {
            row.push("0.5".into());
        }
    })
    .unwrap();
    assert_offset(&estimate);
    warned(&estimate, &["'tail'", "not in the robot"]);
}

#[test]
fn missing_joint_error_lists_available_names() {
    let renamed = error_of(|header, _| *header = header.replace("theta.tilt", "theta.tild"));
    for word in [
        "motor position of 'tilt'",
        "did you mean 'tild'?",
        "--mapping",
    ] {
        assert!(renamed.contains(word), "no '{word}' in: {renamed}");
    }
    assert!(!renamed.contains("baseline"), "{renamed}");
    let empty = error_of(|_, rows| rows.iter_mut().for_each(|row| row[2] = "nan".into()));
    let count = valid().1.len();
    let words = format!("joint position of 'tilt' is missing or non-finite in {count} of {count}");
    assert!(empty.contains(&words), "no '{words}' in: {empty}");
}

#[test]
fn empty_or_invalid_recording_returns_error() {
    let error = corrupted(|_, rows| rows.clear()).unwrap_err().to_string();
    assert!(error.contains("corrupt.csv"), "{error}");
    let error = corrupted(|header, rows| {
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
    let error = corrupted(|_, rows| rows[10][2] = "fast".into())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("fast") && error.contains("12") && error.contains("q.tilt_rad"),
        "{error}"
    );
}

#[test]
fn motor_dropout_affects_only_its_joint_and_recovers() {
    // 1 s without motor position: 100 frames; the first 10 are bridged.
    let estimate =
        corrupted(|_, rows| rows[400..500].iter_mut().for_each(|r| r[3] = String::new())).unwrap();
    assert_offset(&estimate);
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
