//! Three clocks: stamps give steps, the one that never steps gives staleness, the civil one dates.

use crate::support::{HZ, Watched, biorob_like, config, later, seconds, tensioned};
use sinew_log::Frame;
use sinew_watch_core::alarm::{AlarmState, Condition};
use sinew_watch_core::journal::{Event, SessionEnd};
use sinew_watch_core::record::Clock;
use sinew_watch_core::snapshot::Freshness;
use sinew_watch_core::{ClockChoice, Instant, MonitorConfig};

fn steps(watched: &Watched) -> Vec<f64> {
    watched.store.events(|event| match event {
        Event::ClockStep { by_s } => Some(*by_s),
        _ => None,
    })
}

fn ends(watched: &Watched) -> Vec<SessionEnd> {
    watched.store.events(|event| match event {
        Event::Session { end, .. } => Some(*end),
        _ => None,
    })
}

/// Whether every record's offset is zero within four deviations, as it is in truth.
fn is_right(watched: &Watched) -> bool {
    let records = &watched.store.records;
    let right = records.iter().all(|record| {
        let offset = record.offset().expect("an offset");
        offset.mean.abs() < 4.0 * offset.deviation
    });
    right && !records.is_empty()
}

/// Plays frames whose stamps are wrong, each a sample after the last.
fn play_anyhow(watched: &mut Watched, frames: &[Frame]) {
    for frame in frames {
        watched.now = watched.now.after_s(1.0 / HZ as f64);
        watched.frame(frame);
    }
}

#[test]
fn stamps_that_jump_an_hour_begin_the_filters_anew_and_nothing_else() {
    for by_s in [3600.0, -3600.0] {
        for told in [true, false] {
            let mut watched = Watched::new(tensioned());
            watched.play(seconds(60, 90));
            let mut jumped = later(seconds(90, 130), by_s);
            if told {
                // As the assembler has it: another segment.
                jumped.iter_mut().for_each(|frame| frame.segment += 1);
            }
            play_anyhow(&mut watched, &jumped);
            watched.pass(70.0);
            assert_eq!(steps(&watched), [0.0; 0], "{by_s}");
            assert_eq!(ends(&watched), [SessionEnd::Lost]);
            assert!(is_right(&watched), "{by_s} s: {:?}", watched.store.records);
            let record = watched.last("elbow");
            assert_eq!(record.clock, Clock::Utc);
            assert!(record.duration_s > 30.0 && record.duration_s < 70.0);
            let lost = record.frames_lost;
            assert!(lost <= 8, "{lost} frames of {by_s} s lost");
        }
    }
}

#[test]
fn a_civil_clock_that_steps_ends_the_session_and_marks_it() {
    for by_s in [3600.0, -3600.0] {
        let mut watched = Watched::new(tensioned());
        watched.play(seconds(60, 100));
        watched.now.utc_ns += (by_s * 1e9) as i64;
        watched.play(seconds(100, 140));
        watched.pass(70.0);
        let steps = steps(&watched);
        assert!(
            steps.len() == 1 && (steps[0] - by_s).abs() < 0.1,
            "{steps:?}"
        );
        assert_eq!(ends(&watched), [SessionEnd::ClockStep, SessionEnd::Lost]);
        let clocks: Vec<Clock> = (watched.store.records.iter())
            .filter(|r| r.joint == "wrist")
            .map(|r| r.clock)
            .collect();
        assert_eq!(clocks, [Clock::Stepped, Clock::Utc]);
        assert!(is_right(&watched), "{by_s}");
    }
}

#[test]
fn stamps_and_civil_clock_may_jump_together() {
    for by_s in [3600.0, -3600.0] {
        let mut watched = Watched::new(tensioned());
        watched.play(seconds(60, 100));
        watched.now.utc_ns += (by_s * 1e9) as i64;
        play_anyhow(&mut watched, &later(seconds(100, 140), by_s));
        watched.pass(70.0);
        assert_eq!(ends(&watched), [SessionEnd::ClockStep, SessionEnd::Lost]);
        assert!(is_right(&watched), "{by_s}");
    }
}

#[test]
fn a_slewed_civil_clock_is_followed() {
    let mut watched = Watched::new(tensioned());
    for frame in seconds(60, 90) {
        watched.now = watched.now.after_s(1.0 / HZ as f64);
        // A hundred seconds in thirty.
        watched.now.utc_ns += 13_000_000;
        watched.frame(frame);
    }
    assert!(steps(&watched).is_empty() && watched.snapshot().session.is_some());
}

#[test]
fn stamps_of_zero_are_a_trouble_and_no_session() {
    let mut watched = Watched::new(tensioned());
    let mut frames = seconds(60, 100).to_vec();
    frames.iter_mut().for_each(|frame| frame.time_ns = 0);
    play_anyhow(&mut watched, &frames);
    assert_eq!(
        watched.alarm(None, Condition::Data),
        Some(AlarmState::Active)
    );
    assert!(watched.store.records.is_empty() && watched.snapshot().session.is_none());
    // Stamps that rise again are all it takes.
    play_anyhow(&mut watched, seconds(100, 200));
    assert_eq!(
        watched.alarm(None, Condition::Data),
        Some(AlarmState::Cleared)
    );
    watched.pass(70.0);
    assert!(is_right(&watched));
}

#[test]
fn stamps_may_count_from_a_boot_or_beyond_2038() {
    let first = seconds(60, 61)[0].time_ns as f64 * 1e-9;
    for at_s in [0.0, 2_147_483_640.0, 5e9] {
        let mut watched = Watched::new(tensioned());
        watched.play(&later(seconds(60, 100), at_s - first));
        watched.pass(70.0);
        assert!(is_right(&watched), "{at_s}");
        assert_eq!(watched.last("elbow").clock, Clock::Utc);
    }
}

#[test]
fn a_session_is_dated_across_2038_but_not_by_a_clock_that_was_never_set() {
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
        let mut watched = Watched::restored(config, Default::default(), now);
        watched.play(seconds(60, 100));
        watched.pass(70.0);
        let record = watched.last("elbow");
        assert_eq!(record.clock, clock, "{utc_s}");
        assert!(
            (record.time_utc_s - utc_s).abs() < 1.0,
            "{}",
            record.time_utc_s
        );
    }
}

#[test]
fn stamps_that_run_otherwise_are_no_time() {
    let mut watched = Watched::new(tensioned());
    // Three seconds of stamps in one.
    for frame in seconds(60, 160) {
        watched.now = watched.now.after_s(1.0 / (3.0 * HZ as f64));
        watched.frame(frame);
    }
    let rates = watched.store.events(|event| match event {
        Event::StampsNotTime { rate } => Some(*rate),
        _ => None,
    });
    assert!(
        rates.len() == 1 && (rates[0] - 3.0).abs() < 0.1,
        "{rates:?}"
    );
    watched.pass(70.0);
    assert!(is_right(&watched));
    assert_eq!(watched.last("elbow").clock, Clock::Stamp);

    let config = MonitorConfig {
        clock: ClockChoice::Stamp,
        ..tensioned()
    };
    let mut watched = Watched::new(config);
    watched.play(seconds(60, 100));
    watched.pass(70.0);
    assert_eq!(watched.last("elbow").clock, Clock::Stamp);
}

#[test]
fn a_pause_of_half_a_minute_is_within_a_session_one_of_a_minute_ends_it() {
    let mut watched = Watched::new(tensioned());
    watched.play(seconds(60, 90));
    watched.pass(30.0);
    let Freshness::Stale { for_s } = watched.snapshot().freshness else {
        panic!("stale");
    };
    assert!((for_s - 30.0).abs() < 0.2, "{for_s}");
    assert_eq!(
        watched.alarm(None, Condition::NoData),
        Some(AlarmState::Active)
    );
    watched.play(seconds(90, 120));
    assert_eq!(watched.snapshot().freshness, Freshness::Fresh);
    assert_eq!(watched.alarm(None, Condition::NoData), None);
    assert!(ends(&watched).is_empty());
    watched.pass(70.0);
    assert_eq!(ends(&watched), [SessionEnd::Lost]);
    assert!(is_right(&watched));
    let record = watched.last("elbow");
    assert!(record.duration_s > 25.0, "{}", record.duration_s);
}

#[test]
fn a_robot_that_stands_ends_its_session_and_begins_none() {
    let mut watched = Watched::new(config(&biorob_like()));
    let moving = seconds(60, 90);
    watched.play(moving);
    let mut stands = vec![moving[moving.len() - 1].clone(); 200 * HZ];
    for (k, frame) in stands.iter_mut().enumerate() {
        frame.time_ns += (k as i64 + 1) * 4_000_000;
    }
    watched.play(&stands);
    assert_eq!(ends(&watched), [SessionEnd::Stood]);
    assert!(watched.snapshot().session.is_none());
    let records = watched.store.records.len();
    watched.pass(70.0);
    assert_eq!(watched.store.records.len(), records);
}
