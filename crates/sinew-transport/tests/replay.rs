//! A replayed recording passes the queue as it was recorded.

use crate::support::{Came, MS, START_NS, frames, recording};
use sinew_log::live::LiveOptions;
use sinew_log::{Frame, OpenOptions, Quantity, Recording};
use sinew_transport::replay::{Alter, Played, ReplayOptions, open};
use sinew_transport::{Clock, FrameAssembler, Inbox, QueueLimits, Route, Routes, TransportFault};
use std::cell::Cell;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

fn options(bytes: Vec<u8>) -> ReplayOptions {
    ReplayOptions {
        recording: Played::Bytes(Arc::from(bytes)),
        name: "mcap:made".to_owned(),
        speed: f64::INFINITY,
        ..ReplayOptions::of("made".into())
    }
}

fn live() -> LiveOptions {
    LiveOptions::of_joints(&["a".to_owned()])
}

#[test]
fn replay_unlimited_speed_loses_no_message() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let bytes = std::fs::read(root.join("examples/01-stretched-arm/stretched-arm.mcap")).unwrap();
    let read = |bytes: &[u8]| {
        let reader = Box::new(Cursor::new(bytes.to_vec()));
        Recording::from_reader(reader, "a.mcap", &OpenOptions::default()).unwrap()
    };
    let mut recording = read(&bytes);
    let joints = recording.joints().to_vec();
    let mut expected: Vec<Frame> = Vec::new();
    while let Some(frame) = recording.next_frame().unwrap() {
        expected.push(frame.clone());
    }
    let inbox = Inbox::new();
    // Queue far smaller than the recording: a file waits for room.
    let limits = QueueLimits {
        messages: 64,
        bytes: 64 << 10,
    };
    let (robot, sender) = inbox.robot(limits);
    let live = LiveOptions::of_joints(&joints);
    let routes = Routes::new(vec![Route::new(sender, &live)]);
    let transport = open(&options(bytes), &routes, Clock::start(), None).unwrap();
    let mut intake = FrameAssembler::new(&live).unwrap();
    // Ends when nothing has arrived since the reader ended: the queue may contain the last messages.
    let ended = Cell::new(None);
    let mut came = frames(&inbox, robot, &mut intake, |frames| {
        let now = transport.status().ended.then_some(frames.len());
        ended.replace(now).is_some_and(|before| now == Some(before))
    });
    intake.silence(Default::default(), |taken| {
        if let sinew_transport::BatchContent::Frame { frame, .. } = taken {
            came.push(frame.clone());
        }
    });
    assert_eq!(came.len(), expected.len());
    for (came, expected) in came.iter().zip(&expected) {
        assert_eq!(came.time_ns, expected.time_ns);
        for quantity in Quantity::PER_JOINT {
            let bits =
                |frame: &Frame| Vec::from_iter(frame.get(quantity).iter().map(|v| v.to_bits()));
            assert_eq!(bits(came), bits(expected));
        }
    }
    assert_eq!(intake.dropped(), 0);
}

#[test]
fn replay_keeps_speed() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let routes = Routes::new(vec![Route::new(sender, &live())]);
    let options = ReplayOptions {
        speed: 4.0,
        ..options(recording(0..800))
    };
    let begun = Instant::now();
    let _transport = open(&options, &routes, Clock::start(), None).unwrap();
    let mut came = Came::default();
    came.until(&inbox, robot, |came| came.stamps.len() == 800);
    // 799 ms at four times the speed; the upper bound depends on the load of the host and is not tested.
    assert!(begun.elapsed().as_secs_f64() >= 0.799 / 4.0);
    assert_eq!(came.stamps[0], START_NS);
    assert_eq!(came.stamps[799], START_NS + 799 * MS);
    assert_eq!(came.topics, ["/joint_states"]);
}

struct Twice;

impl Alter for Twice {
    fn alter(&mut self, topic: &str, schema: &str, since_start_s: f64, cdr: &mut [u8]) {
        assert_eq!(topic, "/joint_states");
        let kind = sinew_log::decode::MessageKind::of_schema(schema).unwrap();
        sinew_log::decode::rewrite(kind, cdr, |entry, value| {
            assert_eq!(entry.joint, b"a");
            value + 10.0 * since_start_s.floor()
        })
        .unwrap();
    }
}

struct Panics;

impl Alter for Panics {
    fn alter(&mut self, _topic: &str, _schema: &str, _since_start_s: f64, _cdr: &mut [u8]) {
        panic!("this panic belongs to the test");
    }
}

#[test]
fn panic_of_reader_is_failure_of_its_transport() {
    let inbox = Inbox::new();
    let (_robot, sender) = inbox.robot(QueueLimits::default());
    let routes = Routes::new(vec![Route::new(sender, &live())]);
    let made = options(recording(0..4));
    let transport = open(&made, &routes, Clock::start(), Some(Box::new(Panics))).unwrap();
    let begun = Instant::now();
    while !transport.status().failed {
        assert!(begun.elapsed().as_secs() < 60, "never");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let reason = transport.status().disconnected.unwrap();
    assert!(reason.contains("internal error"), "{reason}");
}

#[test]
fn replay_looped_restamped_repetitions_are_segments() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let routes = Routes::new(vec![Route::new(sender, &live())]);
    let options = ReplayOptions {
        is_looped: true,
        is_restamped: true,
        ..options(recording(0..400))
    };
    let clock = Clock::start();
    let alter = Some(Box::new(Twice) as Box<dyn Alter>);
    let transport = open(&options, &routes, clock, alter).unwrap();
    let mut intake = FrameAssembler::new(&live()).unwrap();
    let came = frames(&inbox, robot, &mut intake, |frames| frames.len() >= 1_000);
    drop(transport);
    // Repetitions of 399 ms and a pause of 1 s: the third begins after 2.798 s.
    for (index, frame) in came.iter().enumerate() {
        let (turn, step) = (index / 400, index % 400);
        assert_eq!(frame.segment as usize, turn);
        let since_ns = turn as i64 * (399 + 1_000) * MS + step as i64 * MS;
        let begun = frame.time_ns - since_ns;
        assert!(
            (begun - clock.now().utc_ns).abs() < 60_000_000_000,
            "{begun}"
        );
        let expected = 1e-3 * step as f64 + 10.0 * (since_ns as f64 * 1e-9).floor();
        assert!(
            (frame.q[0] - expected).abs() < 1e-9,
            "{index}: {}",
            frame.q[0]
        );
    }
    assert_eq!(intake.live().health().clock_steps, 0);
}

#[test]
fn replay_invalid_input_reports_reason() {
    let routes = Routes::default();
    let refused = |options: &ReplayOptions| {
        let opened = open(options, &routes, Clock::start(), None);
        opened
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default()
    };
    let missing = ReplayOptions::of("nowhere.mcap".into());
    assert!(refused(&missing).starts_with("mcap:nowhere.mcap: cannot be opened"));
    let still = ReplayOptions {
        speed: 0.0,
        ..options(recording(0..1))
    };
    assert_eq!(refused(&still), "speed = 0: expected more than 0");

    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let routes = Routes::new(vec![Route::new(sender, &live())]);
    let mut damaged = recording(0..400);
    let middle = damaged.len() / 2;
    damaged[middle..middle + 64].fill(0xff);
    let transport = open(&options(damaged), &routes, Clock::start(), None).unwrap();
    let mut came = Came::default();
    came.until(&inbox, robot, |came| !came.faults.is_empty());
    assert!(
        matches!(&came.faults[0], TransportFault::Disconnected { reason, .. } if reason.contains("damaged"))
    );
    assert!(came.stamps.len() > 10 && came.stamps.len() < 400);
    assert!(transport.status().disconnected.is_some());
}
