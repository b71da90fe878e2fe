//! Several files, a folder, a pattern, packed files: one recording.

use crate::support::{Bag, MS, START_NS, open_bytes, read_all};
use sinew_log::{OpenOptions, Recording, open, open_parts};
use std::path::{Path, PathBuf};

/// Frames 0 to 299 at 100 Hz; `part` of three holds a hundred.
fn part(part: i64) -> Vec<u8> {
    let mut bag = Bag::new();
    for step in 100 * part..100 * (part + 1) {
        let time = START_NS + 10 * step * MS;
        bag.log_at(time as u64);
        bag.joint(time, &[("a", 1e-3 * step as f64)]);
        bag.motor(time, &[("a", 0.5 + 1e-3 * step as f64)]);
    }
    bag.bytes()
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Files `run_0.mcap` to `run_2.mcap`, whose order by name differs from that by time.
fn three(folder: &Path) -> Vec<PathBuf> {
    (0..3)
        .map(|k| {
            let path = folder.join(format!("run_{}.mcap", (k + 1) % 3));
            std::fs::write(&path, part(k)).unwrap();
            path
        })
        .collect()
}

fn is_whole(recording: Recording) {
    let total = recording.progress().bytes_total;
    let (frames, health) = read_all(recording);
    assert_eq!(frames.len(), 300);
    for (step, frame) in frames.iter().enumerate() {
        assert_eq!(frame.time_ns, START_NS + 10 * step as i64 * MS);
        assert_eq!(frame.segment, 0);
        assert!((frame.theta[0] - frame.q[0] - 0.5).abs() < 1e-12);
    }
    assert!(!health.is_lossy() && health.gaps == 0, "{health:?}");
    assert!(total > 0);
}

/// A named pipe, such as a shell's `<(zstd -dc run.mcap.zst)`, has the frames of the file.
#[cfg(unix)]
#[test]
fn named_pipe_is_read() {
    let folder = folder();
    let path = folder.path().join("pipe.mcap");
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    assert!(made.unwrap().success());
    let to = path.clone();
    let writer = std::thread::spawn(move || std::fs::write(to, part(0)).unwrap());
    let (frames, _) = read_all(open(&path, &OpenOptions::default()).unwrap());
    writer.join().unwrap();
    assert_eq!(frames.len(), 100);
}

#[test]
fn files_of_one_recording_are_read_in_the_order_of_their_times() {
    let folder = folder();
    let files = three(folder.path());
    let options = OpenOptions::default();
    let shuffled = [files[2].clone(), files[0].clone(), files[1].clone()];
    is_whole(open_parts(&shuffled, &options).unwrap());
    is_whole(open(folder.path(), &options).unwrap());
    is_whole(open(&folder.path().join("run_*.mcap"), &options).unwrap());
    is_whole(open(&folder.path().join("run_?.mcap"), &options).unwrap());
    let mut recording = open(folder.path(), &options).unwrap();
    recording.select(&["a"]).unwrap();
    is_whole(recording);
    let mut recording = open(folder.path(), &options).unwrap();
    while recording.next_frame().unwrap().is_some() {}
    let progress = recording.progress();
    assert_eq!(progress.bytes_done, progress.bytes_total);
    let joint = &recording.topics()[1];
    assert_eq!(
        (joint.name.as_str(), joint.messages),
        ("/joint_states", 300)
    );
    assert!((joint.rate_hz.unwrap() - 100.0).abs() < 2.0, "{joint:?}");
}

#[test]
fn rosbag2_folder_contains_files_of_metadata() {
    let folder = folder();
    three(folder.path());
    std::fs::write(folder.path().join("older.mcap"), part(7)).unwrap();
    let metadata = "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  relative_file_paths:\n    - run_1.mcap\n    - \"run_2.mcap\"\n    - run_0.mcap\n  message_count: 600\n";
    std::fs::write(folder.path().join("metadata.yaml"), metadata).unwrap();
    is_whole(open(folder.path(), &OpenOptions::default()).unwrap());
    std::fs::remove_file(folder.path().join("run_2.mcap")).unwrap();
    let error = open(folder.path(), &OpenOptions::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("run_2.mcap"), "{error}");
}

#[test]
fn rosbag2_paths_of_old_metadata_start_above_folder() {
    let above = folder();
    let bag = above.path().join("renamed");
    std::fs::create_dir(&bag).unwrap();
    three(&bag);
    let metadata = "rosbag2_bagfile_information:\n  version: 3\n  relative_file_paths:\n    - old/run_1.mcap\n    - old/run_2.mcap\n    - old/run_0.mcap\n";
    std::fs::write(bag.join("metadata.yaml"), metadata).unwrap();
    is_whole(open(&bag, &OpenOptions::default()).unwrap());
    // Another bag of the former name is not read instead.
    let other = above.path().join("old");
    std::fs::create_dir(&other).unwrap();
    std::fs::write(other.join("run_1.mcap"), part(7)).unwrap();
    is_whole(open(&bag, &OpenOptions::default()).unwrap());
}

#[test]
fn rosbag2_renamed_file_error_names_present_file() {
    let bag = folder();
    std::fs::write(bag.path().join("monday.mcap"), part(0)).unwrap();
    let metadata =
        "rosbag2_bagfile_information:\n  version: 9\n  relative_file_paths:\n    - rec_0.mcap\n";
    std::fs::write(bag.path().join("metadata.yaml"), metadata).unwrap();
    let error = open(bag.path(), &OpenOptions::default()).unwrap_err();
    let error = error.to_string();
    for words in ["metadata.yaml", "'rec_0.mcap'", "monday.mcap instead"] {
        assert!(error.contains(words), "{words}: {error}");
    }
    // Packed afterwards, it is the same file.
    let packed = zstd::encode_all(&part(0)[..], 3).unwrap();
    std::fs::write(bag.path().join("rec_0.mcap.zstd"), packed).unwrap();
    let recording = open(bag.path(), &OpenOptions::default()).unwrap();
    assert_eq!(read_all(recording).0.len(), 100);
}

#[test]
fn packed_files_are_unpacked() {
    let folder = folder();
    for (k, path) in three(folder.path()).into_iter().enumerate() {
        let packed = zstd::encode_all(&std::fs::read(&path).unwrap()[..], 3).unwrap();
        let ending = ["mcap.zst", "mcap.zstd", "mcap.zst"][k];
        std::fs::write(path.with_extension(ending), packed).unwrap();
        std::fs::remove_file(path).unwrap();
    }
    is_whole(open(folder.path(), &OpenOptions::default()).unwrap());
    let table = zstd::encode_all(&b"time_s,q.a_rad,theta.a_rad\n0,1,2\n0.01,1,2\n"[..], 3).unwrap();
    let recording = open_bytes(&table, "a.csv.zst", &OpenOptions::default()).unwrap();
    assert_eq!(read_all(recording).0.len(), 2);
    let error = open_bytes(&table[..20], "a.csv.zst", &OpenOptions::default()).unwrap_err();
    assert!(error.to_string().contains("zstd"), "{error}");
}

#[test]
fn tables_follow_each_other_too() {
    let folder = folder();
    let write = |name: &str, from: i32| {
        let rows = (from..from + 10).map(|k| format!("{},{k},{k}\n", 0.01 * f64::from(k)));
        let text = String::from("time_s,q.a_rad,theta.a_rad\n") + &rows.collect::<String>();
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    // By number, not by letter; the times are what counts.
    write("t10.csv", 0);
    write("t9.csv", 10);
    let recording = open(&folder.path().join("t*.csv"), &OpenOptions::default()).unwrap();
    let (frames, health) = read_all(recording);
    assert_eq!((frames.len(), health.clock_steps), (20, 0));
}

#[test]
fn mixed_or_missing_parts_are_errors() {
    let folder = folder();
    let files = three(folder.path());
    let table = folder.path().join("a.csv");
    std::fs::write(&table, "time_s,q.a_rad\n0,1\n").unwrap();
    let options = OpenOptions::default();
    let error = |paths: &[PathBuf]| open_parts(paths, &options).unwrap_err().to_string();
    let mixed = error(&[files[0].clone(), table]);
    assert!(
        mixed.contains("a.csv") && mixed.contains("run_1.mcap"),
        "{mixed}"
    );
    let twice = error(&[files[0].clone(), files[0].clone()]);
    assert!(twice.contains("twice"), "{twice}");
    let none = open(&folder.path().join("*.bag"), &options)
        .unwrap_err()
        .to_string();
    assert!(none.contains("no file"), "{none}");
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let empty = open(&folder.path().join("empty"), &options)
        .unwrap_err()
        .to_string();
    assert!(
        empty.contains("no recording") && empty.contains("mcap"),
        "{empty}"
    );
    // Damage names its file.
    let bytes = std::fs::read(&files[1]).unwrap();
    std::fs::write(&files[1], &bytes[..bytes.len() / 2]).unwrap();
    let (frames, health) = read_all(open_parts(&files, &options).unwrap());
    assert!(frames.len() > 200 && frames.len() < 300);
    assert!(health.damage[0].reason.contains("run_2.mcap"), "{health:?}");
}
