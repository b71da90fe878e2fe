//! Growing recordings: incomplete chunks are waited for, and files follow each other.

use crate::support::{Bag, Came, MS, START_NS, recording};
use sinew_log::live::LiveOptions;
use sinew_transport::tail::{From, TailOptions, open};
use sinew_transport::{
    Clock, Inbox, QueueLimits, RobotId, Route, Routes, Transport, TransportFault,
};
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::Path;

fn watch(path: &Path, from: From) -> (Inbox, RobotId, Transport) {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let live = LiveOptions::of_joints(&["a".to_owned()]);
    let routes = Routes::new(vec![Route::new(sender, &live)]);
    let options = TailOptions {
        from,
        look_every_s: 0.002,
        ..TailOptions::of(path.to_owned())
    };
    let transport = open(&options, &routes, Clock::start()).unwrap();
    (inbox, robot, transport)
}

fn stamps(steps: std::ops::Range<i64>) -> Vec<i64> {
    steps.map(|step| START_NS + step * MS).collect()
}

#[test]
fn tail_incomplete_records_are_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let bytes = recording(0..300);
    let (inbox, robot, _transport) = watch(&path, From::Start);
    let mut came = Came::default();
    let mut file = File::create(&path).unwrap();
    // Pieces of various lengths, so that magic, records and chunks are truncated at every position.
    let mut rest = bytes.as_slice();
    for length in (1..=97).cycle() {
        let (piece, left) = rest.split_at(length.min(rest.len()));
        file.write_all(piece).unwrap();
        rest = left;
        if length % 13 == 0 {
            std::thread::sleep(std::time::Duration::from_micros(300));
        }
        if rest.is_empty() {
            break;
        }
    }
    came.until(&inbox, robot, |came| came.stamps.len() == 300);
    assert_eq!(came.stamps, stamps(0..300));
    assert!(
        came.faults
            .iter()
            .all(|t| matches!(t, TransportFault::Connected { .. }))
    );
}

#[test]
fn tail_from_now_follows_recorder_and_skips_past() {
    for compression in [
        None,
        Some(mcap::Compression::Zstd),
        Some(mcap::Compression::Lz4),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        let options = mcap::WriteOptions::new()
            .compression(compression)
            .chunk_size(Some(2_048));
        let mut bag = Bag::new(File::create(&path).unwrap(), options);
        (0..100).for_each(|step| bag.state(step));
        bag.writer.flush().unwrap();
        let (inbox, robot, transport) = watch(&path, From::Now);
        let mut came = Came::default();
        came.until(&inbox, robot, |came| !came.faults.is_empty());
        for step in 100..400 {
            bag.state(step);
            if step % 10 == 9 {
                bag.writer.flush().unwrap();
                came.until(&inbox, robot, |came| {
                    // Every message was counted before it arrived.
                    assert!(transport.status().messages >= came.stamps.len() as u64);
                    came.stamps.last() == stamps(step..step + 1).last()
                });
            }
        }
        bag.writer.finish().unwrap();
        came.until(&inbox, robot, |came| {
            came.stamps.last() == stamps(399..400).last()
        });
        assert_eq!(came.stamps, stamps(100..400), "{compression:?}");
        assert_eq!(transport.status().messages, 300);
    }
}

#[test]
fn tail_folder_files_follow_in_natural_order() {
    let folder = tempfile::tempdir().unwrap();
    let file = |index: i64| folder.path().join(format!("run_{index}.mcap"));
    let (inbox, robot, _transport) = watch(folder.path(), From::Start);
    let mut came = Came::default();
    for index in 8..12 {
        let bytes = recording(100 * index..100 * (index + 1));
        // The tenth file is not closed, as after a killed recorder; the next one is read nevertheless.
        let length = match index {
            10 => bytes.len() - 200,
            _ => bytes.len(),
        };
        std::fs::write(file(index), &bytes[..length]).unwrap();
        let last = START_NS + (100 * index + 90) * MS;
        came.until(&inbox, robot, |came| came.stamps.iter().any(|s| *s >= last));
    }
    came.until(&inbox, robot, |came| {
        came.stamps.last() == stamps(1_199..1_200).last()
    });
    assert!(came.stamps.is_sorted());
    assert!(came.stamps.len() > 390, "{}", came.stamps.len());
    let next = came
        .faults
        .iter()
        .filter(|t| matches!(t, TransportFault::NextFile { .. }));
    assert_eq!(next.count(), 3);
}

#[test]
fn tail_replaced_file_is_read_from_start() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, recording(0..50)).unwrap();
    let (inbox, robot, _transport) = watch(&path, From::Start);
    let mut came = Came::default();
    came.until(&inbox, robot, |came| came.stamps.len() == 50);
    // Another file takes its name.
    let beside = folder.path().join("new");
    std::fs::write(&beside, recording(100..150)).unwrap();
    std::fs::rename(&beside, &path).unwrap();
    came.until(&inbox, robot, |came| came.stamps.len() == 100);
    // The same file is rewritten, shorter.
    let mut file = OpenOptions::new()
        .write(true)
        .truncate(true)
        .open(&path)
        .unwrap();
    file.write_all(&recording(200..210)).unwrap();
    came.until(&inbox, robot, |came| came.stamps.len() == 110);
    assert_eq!(came.stamps[50..100], stamps(100..150));
    assert_eq!(came.stamps[100..], stamps(200..210));
    let replaced = came
        .faults
        .iter()
        .filter(|t| matches!(t, TransportFault::Replaced { .. }));
    assert_eq!(replaced.count(), 2);
}

#[test]
fn tail_invalid_file_reports_fault_and_waits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (inbox, robot, transport) = watch(&path, From::Now);
    let mut came = Came::default();
    let begun = std::time::Instant::now();
    while transport.status().disconnected.is_none() {
        assert!(begun.elapsed() < crate::support::PATIENCE);
        std::thread::yield_now();
    }
    // A file that appears after the start of the transport is read from its start.
    std::fs::write(&path, recording(0..20)).unwrap();
    came.until(&inbox, robot, |came| came.stamps.len() == 20);
    assert_eq!(transport.status().disconnected, None);

    std::fs::write(
        folder.path().join("text.mcap"),
        "time_s,q.a_rad\n0,1\n0,1\n",
    )
    .unwrap();
    let (inbox, robot, _transport) = watch(&folder.path().join("text.mcap"), From::Start);
    let mut came = Came::default();
    came.until(&inbox, robot, |came| {
        came.faults
            .iter()
            .any(|t| matches!(t, TransportFault::Damaged { .. }))
    });
    let error = |every_s: f64| {
        let options = TailOptions {
            look_every_s: every_s,
            ..TailOptions::of(path.clone())
        };
        open(&options, &Routes::default(), Clock::start()).is_err()
    };
    assert!(error(0.0) && error(f64::NAN) && error(100.0) && !error(1.0));
}
