//! Tests of the three clocks: time stamps give time differences, the monotonic clock staleness, the civil clock dates.

use crate::support::{HZ, Harness, biorob_like, config, later, seconds, tensioned};
use sinew_log::Frame;
use sinew_watch_core::alarm::{AlarmState, Condition};
use sinew_watch_core::journal::{Event, SessionEnd};
use sinew_watch_core::record::Clock;
use sinew_watch_core::snapshot::Freshness;
use sinew_watch_core::{ClockChoice, Instant, MonitorConfig};

fn steps(harness: &Harness) -> Vec<f64> {
    harness.store.events(|event| match event {
        Event::ClockStep { by_s } => Some(*by_s),
        _ => None,
    })
}

fn ends(harness: &Harness) -> Vec<SessionEnd> {
    harness.store.events(|event| match event {
        Event::Session { end, .. } => Some(*end),
        _ => None,
    })
}

/// Whether the offset of every record is zero (the truth) within four standard deviations.
fn is_right(harness: &Harness) -> bool {
    let records = &harness.store.records;
    let right = records.iter().all(|record| {
        let offset = record.offset().expect("an offset");
        offset.mean.abs() < 4.0 * offset.std
    });
    right && !records.is_empty()
}

/// Plays frames with wrong time stamps, each one sample period after the last.
fn play_anyhow(harness: &mut Harness, frames: &[Frame]) {
    for frame in frames {
        harness.now = harness.now.after_s(1.0 / HZ as f64);
        harness.frame(frame);
    }
}

#[test]
fn stamp_jump_of_one_hour_only_restarts_filters() {
    for by_s in [3600.0, -3600.0] {
        for segmented in [true, false] {
            let mut harness = Harness::new(tensioned());
            harness.play(seconds(60, 90));
            let mut jumped = later(seconds(90, 130), by_s);
            if segmented {
                // The frame assembler starts another segment.
                jumped.iter_mut().for_each(|frame| frame.segment += 1);
            }
            play_anyhow(&mut harness, &jumped);
            harness.pass(70.0);
            assert_eq!(steps(&harness), [0.0; 0], "{by_s}");
            assert_eq!(ends(&harness), [SessionEnd::Lost]);
            assert!(is_right(&harness), "{by_s} s: {:?}", harness.store.records);
            let record = harness.last("elbow");
            assert_eq!(record.clock, Clock::Utc);
            assert!(record.duration_s > 30.0 && record.duration_s < 70.0);
            let lost = record.frames_lost;
            assert!(lost <= 8, "{lost} frames of {by_s} s lost");
        }
    }
}

#[test]
fn civil_clock_step_ends_and_marks_session() {
    for by_s in [3600.0, -3600.0] {
        let mut harness = Harness::new(tensioned());
        harness.play(seconds(60, 100));
        harness.now.utc_ns += (by_s * 1e9) as i64;
        harness.play(seconds(100, 140));
        harness.pass(70.0);
        let steps = steps(&harness);
        assert!(
            steps.len() == 1 && (steps[0] - by_s).abs() < 0.1,
            "{steps:?}"
        );
        assert_eq!(ends(&harness), [SessionEnd::ClockStep, SessionEnd::Lost]);
        let clocks: Vec<Clock> = (harness.store.records.iter())
            .filter(|r| r.joint == "wrist")
            .map(|r| r.clock)
            .collect();
        assert_eq!(clocks, [Clock::Stepped, Clock::Utc]);
        assert!(is_right(&harness), "{by_s}");
    }
}

#[test]
fn simultaneous_stamp_and_clock_step_ends_session() {
    for by_s in [3600.0, -3600.0] {
        let mut harness = Harness::new(tensioned());
        harness.play(seconds(60, 100));
        harness.now.utc_ns += (by_s * 1e9) as i64;
        play_anyhow(&mut harness, &later(seconds(100, 140), by_s));
        harness.pass(70.0);
        assert_eq!(ends(&harness), [SessionEnd::ClockStep, SessionEnd::Lost]);
        assert!(is_right(&harness), "{by_s}");
    }
}

#[test]
fn slewed_civil_clock_is_tracked() {
    let mut harness = Harness::new(tensioned());
    for frame in seconds(60, 90) {
        harness.now = harness.now.after_s(1.0 / HZ as f64);
        // 130 s in 30 s.
        harness.now.utc_ns += 13_000_000;
        harness.frame(frame);
    }
    assert!(steps(&harness).is_empty() && harness.snapshot().session.is_some());
}

#[test]
fn zero_stamps_raise_data_alarm_without_session() {
    let mut harness = Harness::new(tensioned());
    let mut frames = seconds(60, 100).to_vec();
    frames.iter_mut().for_each(|frame| frame.time_ns = 0);
    play_anyhow(&mut harness, &frames);
    assert_eq!(
        harness.alarm(None, Condition::Data),
        Some(AlarmState::Active)
    );
    assert!(harness.store.records.is_empty() && harness.snapshot().session.is_none());
    // Increasing time stamps are sufficient for recovery.
    play_anyhow(&mut harness, seconds(100, 200));
    assert_eq!(
        harness.alarm(None, Condition::Data),
        Some(AlarmState::Cleared)
    );
    harness.pass(70.0);
    assert!(is_right(&harness));
}

#[test]
fn stamps_from_boot_or_beyond_2038_are_accepted() {
    let first = seconds(60, 61)[0].time_ns as f64 * 1e-9;
    for at_s in [0.0, 2_147_483_640.0, 5e9] {
        let mut harness = Harness::new(tensioned());
        harness.play(&later(seconds(60, 100), at_s - first));
        harness.pass(70.0);
        assert!(is_right(&harness), "{at_s}");
        assert_eq!(harness.last("elbow").clock, Clock::Utc);
    }
}

#[test]
fn session_date_beyond_2038_valid_unset_clock_stepped() {
    for (utc_s, clock) in [
        (2_147_483_640.0, Clock::Utc),
        (0.0, Clock::Stepped),
        (1_577_836_799.0, Clock::Stepped),
    ] {
        let config = tensioned();
        let now = Instant {
            monotonic_ns: 0,
            utc_ns: (utc_s * 1e9) as i64,
        };
        let mut harness = Harness::restored(config, Default::default(), now);
        harness.play(seconds(60, 100));
        harness.pass(70.0);
        let record = harness.last("elbow");
        assert_eq!(record.clock, clock, "{utc_s}");
        assert!(
            (record.time_utc_s - utc_s).abs() < 1.0,
            "{}",
            record.time_utc_s
        );
    }
}

#[test]
fn accelerated_stamps_are_marked_stamp_clock() {
    let mut harness = Harness::new(tensioned());
    // Time stamps run at three times real time.
    for frame in seconds(60, 160) {
        harness.now = harness.now.after_s(1.0 / (3.0 * HZ as f64));
        harness.frame(frame);
    }
    let rates = harness.store.events(|event| match event {
        Event::StampsNotTime { rate } => Some(*rate),
        _ => None,
    });
    assert!(
        rates.len() == 1 && (rates[0] - 3.0).abs() < 0.1,
        "{rates:?}"
    );
    harness.pass(70.0);
    assert!(is_right(&harness));
    assert_eq!(harness.last("elbow").clock, Clock::Stamp);

    let config = MonitorConfig {
        clock: ClockChoice::Stamp,
        ..tensioned()
    };
    let mut harness = Harness::new(config);
    harness.play(seconds(60, 100));
    harness.pass(70.0);
    assert_eq!(harness.last("elbow").clock, Clock::Stamp);
}

#[test]
fn pause_of_30_s_keeps_session_60_s_ends_it() {
    let mut harness = Harness::new(tensioned());
    harness.play(seconds(60, 90));
    harness.pass(30.0);
    let Freshness::Stale { for_s } = harness.snapshot().freshness else {
        panic!("stale");
    };
    assert!((for_s - 30.0).abs() < 0.2, "{for_s}");
    assert_eq!(
        harness.alarm(None, Condition::NoData),
        Some(AlarmState::Active)
    );
    harness.play(seconds(90, 120));
    assert_eq!(harness.snapshot().freshness, Freshness::Fresh);
    assert_eq!(harness.alarm(None, Condition::NoData), None);
    assert!(ends(&harness).is_empty());
    harness.pass(70.0);
    assert_eq!(ends(&harness), [SessionEnd::Lost]);
    assert!(is_right(&harness));
    let record = harness.last("elbow");
    assert!(record.duration_s > 25.0, "{}", record.duration_s);
}

#[test]
fn robot_at_rest_ends_session_without_new_one() {
    let mut harness = Harness::new(config(&biorob_like()));
    let moving = seconds(60, 90);
    harness.play(moving);
    let mut rest_frames = vec![moving[moving.len() - 1].clone(); 200 * HZ];
    for (k, frame) in rest_frames.iter_mut().enumerate() {
        frame.time_ns += (k as i64 + 1) * 4_000_000;
    }
    harness.play(&rest_frames);
    assert_eq!(ends(&harness), [SessionEnd::Stood]);
    assert!(harness.snapshot().session.is_none());
    let records = harness.store.records.len();
    harness.pass(70.0);
    assert_eq!(harness.store.records.len(), records);
}
