//! Recordings by writers that are not Sinew's: `data/make_rosbags.py`.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use sinew_log::{Format, OpenOptions, Quantity, Recording, open};

const JOINTS: [&str; 3] = ["shoulder", "elbow", "wrist"];

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

/// Time and values of one row.
type Row = (i64, Vec<Option<f64>>);

/// Header and rows that the generator has written.
fn truth() -> (Vec<String>, Vec<Row>) {
    let text = std::fs::read_to_string(data("rosbags.csv")).unwrap();
    let mut lines = text.lines();
    let header = lines
        .next()
        .unwrap()
        .split(',')
        .map(str::to_owned)
        .collect();
    let rows = lines
        .map(|line| {
            let mut cells = line.split(',');
            let time = cells.next().unwrap().parse().unwrap();
            (time, cells.map(|cell| cell.parse().ok()).collect())
        })
        .collect();
    (header, rows)
}

/// Compares every frame with the truth bitwise; returns the number of frames.
fn compare(mut recording: Recording, missing_motor: bool) -> usize {
    let (header, rows) = truth();
    let column: HashMap<&str, usize> = header
        .iter()
        .enumerate()
        .skip(1)
        .map(|(index, name)| (name.as_str(), index - 1))
        .collect();
    let joints = recording.joints().to_vec();
    let mut count = 0;
    while let Some(frame) = recording.next_frame().unwrap() {
        let (time, row) = &rows[count];
        assert_eq!(frame.time_ns, *time);
        for (place, joint) in joints.iter().enumerate() {
            for quantity in Quantity::PER_JOINT {
                let found = frame.get(quantity)[place];
                let name = format!("{joint}.{}", quantity.symbol());
                let expected = column.get(name.as_str()).and_then(|column| row[*column]);
                match expected {
                    Some(_) if missing_motor && quantity == Quantity::Theta => {
                        assert!(found.is_nan());
                    }
                    Some(value) => assert_eq!(found.to_bits(), value.to_bits(), "{name} at {time}"),
                    None => assert!(found.is_nan(), "{name} at {time}: {found}"),
                }
            }
        }
        assert_eq!(Some(frame.temperature_c), row[column["temperature"]]);
        count += 1;
    }
    assert!(!recording.health().is_damaged(), "{:?}", recording.health());
    count
}

#[test]
fn rosbags_compressed_and_indexed() {
    let recording = open(&data("rosbags.mcap"), &OpenOptions::default()).unwrap();
    assert_eq!(recording.format(), Format::Mcap);
    // The gripper has no motor position and no joint position: it is not a joint of ours.
    assert_eq!(recording.joints(), JOINTS);
    assert_eq!(
        recording.robot_description(),
        Some("<robot name=\"fixture\"><link name=\"base\"/></robot>")
    );
    assert_eq!(compare(recording, false), 200);
}

#[test]
fn mcap_writer_without_chunks_index_and_summary_and_big_endian() {
    let recording = open(&data("rosbags_bare.mcap"), &OpenOptions::default()).unwrap();
    assert_eq!(recording.joints(), JOINTS);
    assert_eq!(recording.robot_description(), None);
    assert_eq!(compare(recording, false), 50);
}

#[test]
fn another_interface_name_is_another_quantity() {
    let with = |interface: &str| OpenOptions {
        motor_interface: interface.to_owned(),
        ..OpenOptions::default()
    };
    // The gripper has no motor_position, and the other joints no position.
    let mut recording = open(&data("rosbags.mcap"), &with("position")).unwrap();
    assert!(recording.channels().any_has(Quantity::Theta));
    let (mut frames, mut positions) = (0, 0);
    while let Some(frame) = recording.next_frame().unwrap() {
        frames += 1;
        positions += frame.theta.iter().filter(|theta| theta.is_finite()).count();
    }
    assert_eq!((frames, positions), (200, 200));
    // An interface that is not recorded is an error with the recorded ones.
    let error = open(&data("rosbags.mcap"), &with("no_such_interface")).unwrap_err();
    assert!(error.to_string().contains("'motor_position'"), "{error}");
}

#[test]
fn selected_joints_keep_requested_order() {
    let mut recording = open(&data("rosbags.mcap"), &OpenOptions::default()).unwrap();
    recording.select(&["wrist", "shoulder"]).unwrap();
    assert_eq!(recording.joints(), ["wrist", "shoulder"]);
    assert_eq!(compare(recording, false), 200);
}
