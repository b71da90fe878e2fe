//! ROS 2 bags as SQLite files, compared with MCAP files of the same messages.

use crate::support::*;
use rusqlite::{Connection, params};
use sinew_log::{Format, Frame, OpenOptions, Recording, TopicUse, open};
use std::path::Path;

const STEPS: i64 = 700;
const URDF: &str = "<robot name=\"arm\"/>";

/// Messages of the recording: topic, log time, payload.
fn messages() -> Vec<(&'static str, i64, Vec<u8>)> {
    let mut all = vec![("/robot_description", START_NS, little(&URDF.to_owned()))];
    for step in 0..STEPS {
        let time = START_NS + 10 * step * MS;
        let (q, theta) = (1e-3 * step as f64, 0.5 + 1e-3 * step as f64);
        all.push((JOINT, time, little(&joint_state(time, &[("a", q)]))));
        all.push((MOTOR, time, little(&motor_state(time, &[("a", theta)]))));
    }
    all
}

/// A bag as rosbag2 writes it, its rows not in the order of their times.
fn bag(path: &Path, packed: bool) {
    let bag = Connection::open(path).unwrap();
    bag.execute_batch(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
            serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
         CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,
            timestamp INTEGER NOT NULL, data BLOB NOT NULL);
         CREATE INDEX timestamp_idx ON messages (timestamp ASC);
         INSERT INTO topics VALUES (1, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr', '');
         INSERT INTO topics VALUES (2, '/dynamic_joint_states', 'control_msgs/msg/DynamicJointState', 'cdr', '');
         INSERT INTO topics VALUES (7, '/robot_description', 'std_msgs/msg/String', 'cdr', '');
         BEGIN;",
    )
    .unwrap();
    let (early, late): (Vec<_>, Vec<_>) = messages()
        .into_iter()
        .enumerate()
        .partition(|(k, _)| k % 5 == 0);
    for (_, (topic, time_ns, data)) in late.into_iter().chain(early) {
        let id = match topic {
            JOINT => 1,
            MOTOR => 2,
            _ => 7,
        };
        let data = if packed {
            zstd::encode_all(&data[..], 1).unwrap()
        } else {
            data
        };
        let text = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)";
        bag.execute(text, params![id, time_ns, data]).unwrap();
    }
    bag.execute_batch("COMMIT;").unwrap();
}

fn of_mcap() -> Vec<Frame> {
    let mut mcap = Bag::new();
    for (topic, time_ns, data) in messages().iter().skip(1) {
        mcap.log_at(*time_ns as u64).raw(topic, data);
    }
    read_bytes(&mcap.bytes(), "a.mcap").0
}

#[test]
fn sqlite_bag_equals_mcap_bag() {
    let folder = tempfile::tempdir().unwrap();
    let expected = of_mcap();
    assert_eq!(expected.len(), STEPS as usize);
    for packed in [false, true] {
        let path = folder.path().join(format!("packed_{packed}.db3"));
        bag(&path, packed);
        let mut recording = open(&path, &OpenOptions::default()).unwrap();
        assert_eq!(recording.format(), Format::Db3);
        let mut frames = Vec::new();
        while let Some(frame) = recording.next_frame().unwrap() {
            frames.push(frame.clone());
        }
        let told = |f: &Frame| (f.time_ns, f.segment, f.q[0], f.theta[0]);
        assert!(frames.iter().map(told).eq(expected.iter().map(told)));
        assert!(!recording.health().is_lossy(), "{:?}", recording.health());
        if !packed {
            assert_eq!(recording.robot_description(), Some(URDF));
        }
        let topics = recording.topics();
        assert_eq!(topics[1].role, Some(TopicUse::JointSide));
        assert_eq!(topics[1].messages, STEPS as u64);
        let progress = recording.progress();
        assert_eq!(progress.bytes_done, progress.bytes_total);
    }
}

#[test]
fn compressed_bag_in_folder_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run_0.db3");
    bag(&path, false);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(
        folder.path().join("run_0.db3.zstd"),
        zstd::encode_all(&bytes[..], 1).unwrap(),
    )
    .unwrap();
    std::fs::remove_file(&path).unwrap();
    let metadata = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - run_0.db3.zstd\n";
    std::fs::write(folder.path().join("metadata.yaml"), metadata).unwrap();
    let recording = open(folder.path(), &OpenOptions::default()).unwrap();
    assert_eq!(read_all(recording).0.len(), STEPS as usize);
    // From memory, too.
    let recording = open_bytes(&bytes, "a.db3", &OpenOptions::default()).unwrap();
    assert_eq!(read_all(recording).0.len(), STEPS as usize);
}

/// Replaces the messages of a bag by what a statement makes of them; reader of the bag.
fn reopened(change: &str, options: &OpenOptions) -> Result<Recording, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.db3");
    bag(&path, false);
    let text = format!("ALTER TABLE messages RENAME TO kept; DROP INDEX timestamp_idx; {change}");
    let changed = Connection::open(&path).unwrap().execute_batch(&text);
    changed.unwrap();
    let bytes = std::fs::read(&path).unwrap();
    open_bytes(&bytes, "a.db3", options).map_err(|error| error.to_string())
}

#[test]
fn tables_that_sqlite_computes_are_errors() {
    let endless = "WITH RECURSIVE n(k) AS (SELECT 1 UNION ALL SELECT k + 1 FROM n)";
    for change in [
        format!(
            "CREATE VIEW Messages AS {endless} SELECT k AS id, 1 AS topic_id, k AS timestamp, \
             zeroblob(1000000000) AS data FROM n;"
        ),
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, \
         data BLOB GENERATED ALWAYS AS (zeroblob(1000000000)) VIRTUAL); \
         INSERT INTO messages SELECT id, topic_id, timestamp FROM kept;"
            .to_owned(),
    ] {
        let error = reopened(&change, &OpenOptions::default()).unwrap_err();
        assert!(error.contains("plain tables"), "{error}");
    }
}

#[test]
fn message_beyond_limit_costs_only_itself() {
    let change = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, \
                  timestamp INTEGER, data BLOB); INSERT INTO messages SELECT * FROM kept; \
                  UPDATE messages SET data = zeroblob(1000000) WHERE id = 8;";
    let options = OpenOptions {
        budget: sinew_log::Budget::RECORDING.with_memory(100_000),
        ..OpenOptions::default()
    };
    let (frames, health) = read_all(reopened(change, &options).unwrap());
    assert!(frames.len() >= STEPS as usize - 1, "{}", frames.len());
    assert!(health.is_lossy(), "{health:?}");
}

#[test]
fn non_bag_is_error_and_damaged_bag_is_read_to_damage() {
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("photos.db3");
    Connection::open(&other)
        .unwrap()
        .execute_batch("CREATE TABLE photos(id);")
        .unwrap();
    let error = open(&other, &OpenOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("not a ROS 2 bag") && error.contains("topics"),
        "{error}"
    );
    let path = folder.path().join("run.db3");
    bag(&path, false);
    let mut bytes = std::fs::read(&path).unwrap();
    let (mut refused, mut damaged) = (0, 0);
    for at in (4096..bytes.len()).step_by(4096) {
        let page = bytes[at..(at + 4096)].to_vec();
        bytes[at..at + 4096].fill(0x5a);
        match open_bytes(&bytes, "a.db3", &OpenOptions::default()) {
            Err(_) => refused += 1,
            Ok(mut recording) => {
                while recording.next_frame().unwrap().is_some() {}
                damaged += usize::from(recording.health().is_lossy());
            }
        }
        bytes[at..at + 4096].copy_from_slice(&page);
    }
    println!("{refused} bags with a spoiled page refused, {damaged} read up to it");
    assert!(damaged > 10, "{refused} {damaged}");
}
