//! Records of sessions from files: what is read, what is refused.

use crate::support;

use sinew_estimate::session::{
    MotorTorque, SessionEstimate, TemperatureSource, TendonEstimate, TorqueRange, Verdict, Warning,
};
use sinew_model::offset::SharedError;
use sinew_model::{Gaussian, Z95};
use sinew_report::trend::format_note;
use sinew_trend::{RecordError, SessionRecord, records_from_csv, records_from_json, sort};
use support::{DAY_S, session_record, utc};

#[test]
fn csv_says_line_and_cure() {
    let head = "time,joint,offset_mrad,interval_95_mrad,temperature_c\n";
    let good = records_from_csv(
        &format!("{head}# a note\n2026-03-01T08:30Z,elbow,1.5,0.4,21\n2026-03-02,elbow,,,\n"),
        "s.csv",
    )
    .unwrap();
    assert_eq!(
        good[0].offset_rad,
        Some(Gaussian::new(1.5e-3, 0.4e-3 / Z95))
    );
    assert_eq!(good[0].time_utc_s, utc("2026-03-01T08:30Z"));
    assert_eq!((good[1].offset_rad, good[1].temperature_c), (None, None));
    for (row, words) in [
        ("yesterday,elbow,1,0.4,21", "no date"),
        ("2026-03-01,elbow,nan,0.4,21", "not a finite number"),
        ("2026-03-01,elbow,1,0,21", "above 0 mrad"),
        ("2026-03-01,elbow,1,-0.3,21", "above 0 mrad"),
        ("2026-03-01,elbow,1,,21", "empty beside an offset"),
        ("2026-03-01,elbow,9999,1,21", "half a turn"),
        ("2026-03-01,,1,1,21", "'joint' is empty"),
        ("2026-03-01,elbow,1,1,warm", "temperature_c"),
    ] {
        let error = records_from_csv(&format!("{head}{row}\n"), "s.csv")
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(words) && error.contains("s.csv, line 2"),
            "{row}: {error}"
        );
    }
    let error = records_from_csv("time,joint\n", "s.csv")
        .unwrap_err()
        .to_string();
    assert!(error.contains("no column 'offset_mrad'"), "{error}");
}

/// A session that saw the elbow longer and could not tell of the wrist.
fn session() -> SessionEstimate {
    let tendon = |name: &str, [offset, half]: [f64; 2], verdict| TendonEstimate {
        slides: false,
        anchored: None,
        name: name.into(),
        offset_rad: Gaussian::new(1e-3 * offset, 1e-3 * half / Z95),
        shared_error: Some(SharedError {
            baseline_rad: 0.8e-3 * half / Z95,
            drift_rad: 0.1e-3 * half / Z95,
        }),
        elongation_m: None,
        strain_ratio: None,
        verdict,
        retension: None,
        changes: Vec::new(),
        stiffness_change_ratio: Gaussian::new(-0.02, 0.01 / Z95),
        stiffness_since_before: None,
        creep: None,
        slack_rad: None,
        torque_nm: TorqueRange {
            min: -1.0,
            max: 2.0,
        },
        noise_rad: 1e-4,
        misfit_rad: 0.0,
    };
    SessionEstimate {
        robot: "arm".into(),
        recording: "a.mcap".into(),
        baseline: Some("b".into()),
        baseline_time_utc_s: Some(1.767e9),
        start_time_utc_s: None,
        duration_s: 60.0,
        temperature_c: Some(22.5),
        temperature_source: TemperatureSource::Recorded,
        reference_temperature_c: None,
        joints: vec![
            tendon("elbow", [1.5, 0.4], Verdict::Longer),
            tendon("wrist", [9.0, 16.0], Verdict::CannotTell),
        ],
        segments: Vec::new(),
        blocks: Vec::new(),
        payload_kg: Gaussian::default(),
        payload_changes: Vec::new(),
        external_force: None,
        motor_torque: MotorTorque::Unused,
        left_out_share: 0.0,
        left_out: Vec::new(),
        poses: 12,
        live: None,
        nuisance: Vec::new(),
        damaged: false,
        warnings: vec![Warning::FramesMissing { frames: 3 }],
    }
}

/// The same as a document of its own, with a date.
fn dated() -> String {
    let dated = SessionEstimate {
        start_time_utc_s: Some(1_772_353_800.0),
        ..session()
    };
    serde_json::to_string(&dated).unwrap()
}

#[test]
fn a_csv_may_say_what_sessions_share() {
    let head = "time,joint,offset_mrad,interval_95_mrad,shared_interval_95_mrad,drift_interval_95_mrad,\
                baseline_time,reference_temperature_c\n";
    let read = |row: &str| records_from_csv(&format!("{head}2026-03-02,elbow,{row}\n"), "s.csv");
    let record = &read("1.5,0.5,0.4,0.1,2026-03-01T09:00Z,18.5").unwrap()[0];
    let shared = record.shared_error.unwrap();
    assert_eq!(
        (shared.baseline_rad, shared.drift_rad),
        (0.4e-3 / Z95, 0.1e-3 / Z95)
    );
    assert_eq!(record.baseline_time_utc_s, Some(utc("2026-03-01T09:00Z")));
    assert_eq!(record.reference_c, Some(18.5));
    let record = &read("1.5,0.5,,,,").unwrap()[0];
    assert_eq!(
        (
            record.shared_error,
            record.baseline_time_utc_s,
            record.reference_c
        ),
        (None, None, None)
    );
    assert_eq!(
        read(",,,,,").unwrap()[0].shared_error,
        None,
        "it couldn't tell"
    );
    for (row, words) in [
        ("1.5,0.5,0.6,,,", "shared_interval_95_mrad"),
        ("1.5,0.5,-0.1,,,", "shared_interval_95_mrad"),
        ("1.5,0.5,0.4,0.7,,", "drift_interval_95_mrad"),
        ("1.5,0.5,0.4,0.1,march,", "no date"),
    ] {
        let error = read(row).unwrap_err().to_string();
        assert!(
            error.contains(words) && error.contains("s.csv, line 2"),
            "{row}: {error}"
        );
    }
}

/// The reader names the verdicts anew, as it doesn't see the estimator: each of the estimator's must be one.
#[test]
fn session_of_every_verdict_is_read() {
    for verdict in [
        Verdict::Longer,
        Verdict::Shorter,
        Verdict::Unchanged,
        Verdict::CannotTell,
    ] {
        let mut session = session();
        session.start_time_utc_s = Some(1_772_353_800.0);
        session.joints[0].verdict = verdict;
        let text = serde_json::to_string(&session).unwrap();
        let read = records_from_json(&text, "a.json").unwrap();
        let is_open = verdict == Verdict::CannotTell;
        assert_eq!(read[0].offset_rad.is_none(), is_open, "{verdict:?}");
    }
}

#[test]
fn what_estimate_prints_is_read() {
    let estimate = format!(
        r#"{{"reading": {{"recording": {{"path": "a.mcap", "start_time_ns": 1772353800000000000}}}},
            "robot": {{"name": "arm"}}, "joints": [], "session": {}}}"#,
        serde_json::to_string(&session()).unwrap()
    );
    let read = records_from_json(&estimate, "a.json").unwrap();
    assert_eq!(read.len(), 2);
    assert_eq!(read[0].time_utc_s, 1_772_353_800.0);
    assert_eq!(read[0].robot.as_deref(), Some("arm"));
    let change = read[0].stiffness_ratio.unwrap();
    assert!((change.mean + 0.02).abs() < 1e-14 && (change.deviation - 0.01 / Z95).abs() < 1e-14);
    let shared = read[0].shared_error.unwrap();
    let parts = [shared.baseline_rad, shared.drift_rad].map(|part| 1e3 * Z95 * part);
    assert!(
        (parts[0] - 0.32).abs() < 1e-12 && (parts[1] - 0.04).abs() < 1e-12,
        "{parts:?}"
    );
    assert_eq!(read[0].baseline_time_utc_s, Some(1.767e9));
    assert_eq!(read[1].offset_rad, None, "it couldn't tell");
    assert_eq!(read[1].shared_error, None);
    // A file of a program that said less.
    let mut less: serde_json::Value = serde_json::from_str(&dated()).unwrap();
    less.as_object_mut().unwrap().remove("baseline_time_utc_s");
    for joint in less["joints"].as_array_mut().unwrap() {
        joint.as_object_mut().unwrap().remove("shared_error");
    }
    let read = records_from_json(&less.to_string(), "a.json").unwrap();
    assert_eq!(
        (read[0].shared_error, read[0].baseline_time_utc_s),
        (None, None)
    );
    // The session's estimate alone, with a date of its own; a list; one document after another.
    let alone = dated();
    assert_eq!(
        records_from_json(&alone, "a.json").unwrap()[0].temperature_c,
        Some(22.5)
    );
    assert_eq!(
        records_from_json(&format!("[{alone},{alone}]"), "a")
            .unwrap()
            .len(),
        4
    );
    assert_eq!(
        records_from_json(&format!("{alone}\n{alone}"), "a")
            .unwrap()
            .len(),
        4
    );
    for (text, words) in [
        (
            estimate.replace("1772353800000000000", "12"),
            "says no date",
        ),
        (alone.replace("1772353800.0", "0.0"), "says no date"),
        (
            r#"{"reading": {"recording": {"path": "a"}, "joints": []}}"#.into(),
            "--baseline",
        ),
        ("{}".into(), "not a session's estimate"),
        ("[1, 2".into(), "not JSON"),
        (" ".into(), "is empty"),
        (
            alone.replace(&(0.4e-3 / Z95).to_string(), "-1"),
            "above 0 mrad",
        ),
    ] {
        let error = records_from_json(&text, "a.json").unwrap_err().to_string();
        assert!(
            error.contains(words) && error.contains("a.json"),
            "{text}: {error}"
        );
    }
}

#[test]
fn records_are_put_in_order_and_freed_of_repeats() {
    let mut late = session_record(3.0, 2.0);
    late.source = "again".into();
    let mut overlapping = session_record(2.0, 7.0);
    overlapping.time_utc_s += 30.0;
    let sorted = sort(
        vec![
            session_record(3.0, 2.0),
            session_record(2.0, 1.5),
            late,
            session_record(1.0, 1.0),
            overlapping,
        ],
        None,
    )
    .unwrap();
    let days: Vec<f64> = (sorted.joints[0].1.iter())
        .map(|r| (r.time_utc_s - utc("2026-03-01")) / DAY_S)
        .collect();
    assert_eq!(days, [1.0, 2.0, 3.0]);
    assert!(
        sorted
            .notes
            .iter()
            .any(|n| format_note(n).contains("counted once")),
        "{:?}",
        sorted.notes
    );
    assert!(
        sorted
            .notes
            .iter()
            .any(|n| format_note(n).contains("overlaps")),
        "{:?}",
        sorted.notes
    );

    let conflict = sort(
        vec![session_record(1.0, 1.0), session_record(1.0, 2.0)],
        None,
    )
    .unwrap_err();
    assert!(conflict.to_string().contains("2026-03-02"), "{conflict}");
    let mut other = session_record(2.0, 1.0);
    other.robot = Some("other".into());
    let error = sort(vec![session_record(1.0, 1.0), other], None).unwrap_err();
    assert!(matches!(error, RecordError::Robot { .. }), "{error}");
    let joints = ["wrist".to_string()];
    let error = sort(
        vec![session_record(1.0, 1.0)],
        Some(("biorob-like", &joints)),
    )
    .unwrap_err();
    assert!(error.to_string().contains("'elbow'") && error.to_string().contains("wrist"));
    assert_eq!(sort(Vec::new(), None), Err(RecordError::Empty));
}

#[test]
fn sessions_back_to_back_are_kept_and_those_that_share_motion_are_not() {
    let at = |start_s: f64, duration_s: f64, recording: &str| SessionRecord {
        time_utc_s: utc("2026-03-01") + start_s,
        duration_s: Some(duration_s),
        recording: Some(recording.into()),
        ..session_record(0.0, start_s)
    };
    let kept = |records: Vec<SessionRecord>| sort(records, None).map(|s| s.joints[0].1.len());
    // 90.6 s after 90.4 s, both rounded: back to back, and a second too long.
    assert_eq!(
        kept(vec![
            at(0.0, 91.0, "a"),
            at(90.0, 91.0, "b"),
            at(181.0, 60.0, "c")
        ]),
        Ok(3)
    );
    // Three seconds of motion in both.
    assert_eq!(kept(vec![at(0.0, 93.0, "a"), at(90.0, 91.0, "b")]), Ok(1));
    // Two short ones within a second, told apart by their recordings, or by their cycles.
    assert_eq!(kept(vec![at(0.0, 0.4, "a"), at(0.0, 0.4, "b")]), Ok(2));
    let cycle = |cycle: f64| SessionRecord {
        cycle: Some(cycle),
        ..at(0.0, 30.0, "a")
    };
    assert_eq!(kept(vec![cycle(8.0), cycle(7.0), cycle(7.0)]), Ok(2));
    // Nothing tells these apart.
    let other = SessionRecord {
        offset_rad: Some(Gaussian::new(5e-3, 1e-4)),
        ..at(0.0, 0.4, "a")
    };
    assert!(matches!(
        kept(vec![at(0.0, 0.4, "a"), other]),
        Err(RecordError::Conflict { .. })
    ));
}

#[test]
fn damaged_files_are_refused_and_never_break_anything() {
    let csv = "time,joint,offset_mrad,interval_95_mrad,temperature_c,stiffness_change_percent\n\
               2026-03-01T08:30Z,elbow,1.5,0.4,21,-2\n2026-03-02,elbow,,,,\n";
    let json = &dated()[..];
    // Bytes replaced, cut out and doubled at places of a simple generator.
    let mut state = 7_u64;
    let mut next = |most: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % most.max(1)
    };
    let (mut taken, mut refused) = (0, 0);
    for _ in 0..4000 {
        for (text, is_csv) in [(csv, true), (json, false)] {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..=next(4) {
                if bytes.is_empty() {
                    break;
                }
                let at = next(bytes.len());
                match next(3) {
                    0 => {
                        let with = b"0123456789-+.eE,:\"[]{}\n \xffnaif";
                        bytes[at] = with[next(with.len())];
                    }
                    1 => drop(bytes.drain(at..(at + next(20)).min(bytes.len()))),
                    _ => {
                        let piece = bytes[at..(at + next(20)).min(bytes.len())].to_vec();
                        bytes.splice(at..at, piece);
                    }
                }
            }
            let text = String::from_utf8_lossy(&bytes);
            let read = if is_csv {
                records_from_csv(&text, "f")
            } else {
                records_from_json(&text, "f")
            };
            match read.and_then(|records| sort(records, None)) {
                Ok(sorted) => {
                    taken += 1;
                    for (_, records) in sorted.joints {
                        for r in records {
                            assert!(r.time_utc_s.is_finite());
                            assert!(
                                r.offset_rad
                                    .is_none_or(|y| y.mean.is_finite() && y.deviation > 0.0)
                            );
                        }
                    }
                }
                Err(error) => {
                    refused += 1;
                    assert!(!error.to_string().is_empty());
                }
            }
        }
    }
    assert!(taken > 100 && refused > 100, "{taken} {refused}");
}
