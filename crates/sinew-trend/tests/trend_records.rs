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
fn csv_error_reports_line_and_fix() {
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
        ("yesterday,elbow,1,0.4,21", "date is invalid"),
        ("2026-03-01,elbow,nan,0.4,21", "not a finite number"),
        ("2026-03-01,elbow,1,0,21", "above 0 mrad"),
        ("2026-03-01,elbow,1,-0.3,21", "above 0 mrad"),
        ("2026-03-01,elbow,1,,21", "missing for an offset"),
        ("2026-03-01,elbow,9999,1,21", "half a revolution"),
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

/// Session in which the elbow is elongated and the wrist inconclusive.
fn session() -> SessionEstimate {
    let tendon = |name: &str, [offset, half]: [f64; 2], verdict| TendonEstimate {
        slides: false,
        slack_share: None,
        lower_bound_rad: None,
        lower_bound_m: None,
        anchored: None,
        name: name.into(),
        offset_rad: Gaussian::new(1e-3 * offset, 1e-3 * half / Z95),
        systematic_error: Some(SharedError {
            baseline_rad: 0.8e-3 * half / Z95,
            drift_rad: 0.1e-3 * half / Z95,
        }),
        elongation_m: None,
        strain_ratio: None,
        verdict,
        retension: None,
        changes: Vec::new(),
        stiffness_change_ratio: Gaussian::new(-0.02, 0.01 / Z95),
        stiffness_change: None,
        creep: None,
        slack_rad: None,
        torque_nm: TorqueRange {
            min: -1.0,
            max: 2.0,
        },
        noise_rad: 1e-4,
        excess_residual_rad: 0.0,
    };
    SessionEstimate {
        robot: "arm".into(),
        recording: "a.mcap".into(),
        baseline: Some("b".into()),
        baseline_time_utc_s: Some(1.767e9),
        zero_std_rad: None,
        start_time_utc_s: None,
        duration_s: 60.0,
        temperature_c: Some(22.5),
        temperature_source: TemperatureSource::Recorded,
        reference_temperature_c: None,
        joints: vec![
            tendon("elbow", [1.5, 0.4], Verdict::Elongated),
            tendon("wrist", [9.0, 16.0], Verdict::Inconclusive),
        ],
        joint_offsets: Vec::new(),
        unobservable: Vec::new(),
        segments: Vec::new(),
        blocks: Vec::new(),
        payload_kg: Gaussian::default(),
        payload_changes: Vec::new(),
        external_force: None,
        motor_torque: MotorTorque::Unused,
        tension_used: false,
        rejected_share: 0.0,
        rejected_intervals: Vec::new(),
        poses: 12,
        online: None,
        nuisance: Vec::new(),
        damaged: false,
        warnings: vec![Warning::FramesIncomplete { frames: 3 }],
    }
}

/// The same as a separate document, with a date.
fn dated() -> String {
    let dated = SessionEstimate {
        start_time_utc_s: Some(1_772_353_800.0),
        ..session()
    };
    serde_json::to_string(&dated).unwrap()
}

#[test]
fn csv_may_report_common_error() {
    let head = "time,joint,offset_mrad,interval_95_mrad,shared_interval_95_mrad,drift_interval_95_mrad,\
                baseline_time,reference_temperature_c\n";
    let read = |row: &str| records_from_csv(&format!("{head}2026-03-02,elbow,{row}\n"), "s.csv");
    let record = &read("1.5,0.5,0.4,0.1,2026-03-01T09:00Z,18.5").unwrap()[0];
    let shared = record.systematic_error.unwrap();
    assert_eq!(
        (shared.baseline_rad, shared.drift_rad),
        (0.4e-3 / Z95, 0.1e-3 / Z95)
    );
    assert_eq!(record.baseline_time_utc_s, Some(utc("2026-03-01T09:00Z")));
    assert_eq!(record.reference_c, Some(18.5));
    let record = &read("1.5,0.5,,,,").unwrap()[0];
    assert_eq!(
        (
            record.systematic_error,
            record.baseline_time_utc_s,
            record.reference_c
        ),
        (None, None, None)
    );
    assert_eq!(
        read(",,,,,").unwrap()[0].systematic_error,
        None,
        "it couldn't tell"
    );
    for (row, words) in [
        ("1.5,0.5,0.6,,,", "shared_interval_95_mrad"),
        ("1.5,0.5,-0.1,,,", "shared_interval_95_mrad"),
        ("1.5,0.5,0.4,0.7,,", "drift_interval_95_mrad"),
        ("1.5,0.5,0.4,0.1,march,", "date is invalid"),
    ] {
        let error = read(row).unwrap_err().to_string();
        assert!(
            error.contains(words) && error.contains("s.csv, line 2"),
            "{row}: {error}"
        );
    }
}

// The reader has its own list of verdicts, because it does not depend on the estimator: every
// verdict must be accepted.
#[test]
fn session_of_every_verdict_is_read() {
    for verdict in [
        Verdict::Elongated,
        Verdict::Shortened,
        Verdict::NoChangeDetected,
        Verdict::OffsetDetected,
        Verdict::NoneDetected,
        Verdict::Inconclusive,
    ] {
        let mut session = session();
        session.start_time_utc_s = Some(1_772_353_800.0);
        session.joints[0].verdict = verdict;
        let text = serde_json::to_string(&session).unwrap();
        let read = records_from_json(&text, "a.json").unwrap();
        let is_open = verdict == Verdict::Inconclusive;
        assert_eq!(read[0].offset_rad.is_none(), is_open, "{verdict:?}");
    }
}

#[test]
fn session_of_schema_version_1_is_read() {
    let text = r#"{"schema": "sinew/estimate/1", "reading": {"recording": {"start_time_ns": null}}, "session": {
        "robot": "arm", "recording": "a.mcap", "baseline": "b", "start_time_utc_s": 1772353800.0, "duration_s": 60.0,
        "temperature_c": 21.0, "reference_temperature_c": null, "joints": [
            {"name": "elbow", "offset_rad": {"mean": 0.0015, "deviation": 0.0002}, "verdict": "longer",
             "shared_error": {"baseline_rad": 1e-4, "drift_rad": 2e-5},
             "stiffness_change_ratio": {"mean": -0.02, "deviation": 0.005}},
            {"name": "wrist", "offset_rad": {"mean": 0.0, "deviation": 0.1}, "verdict": "cannot-tell",
             "stiffness_change_ratio": {"mean": 0.0, "deviation": 0.1}}]}}"#;
    let read = records_from_json(text, "a.json").unwrap();
    assert_eq!(read[0].offset_rad, Some(Gaussian::new(0.0015, 0.0002)));
    assert!(read[0].systematic_error.is_some());
    assert_eq!(read[1].offset_rad, None);
}

#[test]
fn estimate_output_is_read() {
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
    assert!((change.mean + 0.02).abs() < 1e-14 && (change.std - 0.01 / Z95).abs() < 1e-14);
    let shared = read[0].systematic_error.unwrap();
    let parts = [shared.baseline_rad, shared.drift_rad].map(|part| 1e3 * Z95 * part);
    assert!(
        (parts[0] - 0.32).abs() < 1e-12 && (parts[1] - 0.04).abs() < 1e-12,
        "{parts:?}"
    );
    assert_eq!(read[0].baseline_time_utc_s, Some(1.767e9));
    assert_eq!(read[1].offset_rad, None, "it couldn't tell");
    assert_eq!(read[1].systematic_error, None);
    // File of an earlier program with fewer fields.
    let mut less: serde_json::Value = serde_json::from_str(&dated()).unwrap();
    less.as_object_mut().unwrap().remove("baseline_time_utc_s");
    for joint in less["joints"].as_array_mut().unwrap() {
        joint.as_object_mut().unwrap().remove("systematic_error");
    }
    let read = records_from_json(&less.to_string(), "a.json").unwrap();
    assert_eq!(
        (read[0].systematic_error, read[0].baseline_time_utc_s),
        (None, None)
    );
    // Session estimate alone with its own date; a list; several documents in sequence.
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
        (estimate.replace("1772353800000000000", "12"), "has no date"),
        (alone.replace("1772353800.0", "0.0"), "has no date"),
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
fn records_are_sorted_and_deduplicated() {
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
fn consecutive_sessions_are_kept_overlapping_dropped() {
    let at = |start_s: f64, duration_s: f64, recording: &str| SessionRecord {
        time_utc_s: utc("2026-03-01") + start_s,
        duration_s: Some(duration_s),
        recording: Some(recording.into()),
        ..session_record(0.0, start_s)
    };
    let kept = |records: Vec<SessionRecord>| sort(records, None).map(|s| s.joints[0].1.len());
    // 90.6 s after 90.4 s, both rounded: consecutive, and one second too long.
    assert_eq!(
        kept(vec![
            at(0.0, 91.0, "a"),
            at(90.0, 91.0, "b"),
            at(181.0, 60.0, "c")
        ]),
        Ok(3)
    );
    // Three seconds of common motion.
    assert_eq!(kept(vec![at(0.0, 93.0, "a"), at(90.0, 91.0, "b")]), Ok(1));
    // Two short ones within a second, distinguished by their recordings, or by their cycles.
    assert_eq!(kept(vec![at(0.0, 0.4, "a"), at(0.0, 0.4, "b")]), Ok(2));
    let cycle = |cycle: f64| SessionRecord {
        cycle: Some(cycle),
        ..at(0.0, 30.0, "a")
    };
    assert_eq!(kept(vec![cycle(8.0), cycle(7.0), cycle(7.0)]), Ok(2));
    // Not distinguishable.
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
fn damaged_files_are_rejected_without_panic() {
    let csv = "time,joint,offset_mrad,interval_95_mrad,temperature_c,stiffness_change_percent\n\
               2026-03-01T08:30Z,elbow,1.5,0.4,21,-2\n2026-03-02,elbow,,,,\n";
    let json = &dated()[..];
    // Bytes replaced, removed and doubled at pseudo-random positions.
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
                                    .is_none_or(|y| y.mean.is_finite() && y.std > 0.0)
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
