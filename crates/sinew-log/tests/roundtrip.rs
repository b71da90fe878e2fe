//! Round trip of recordings, bitwise identical in every format, compression and layout.

use std::path::Path;

use proptest::prelude::*;
use sinew_log::{
    Axis, Compression, Frame, FrameWriter, McapOptions, McapWriter, OpenOptions, Quantities,
    Quantity, RecordedNames, RowWriter, open,
};

fn all_quantities() -> Quantities {
    Quantities {
        q: true,
        theta: true,
        dq: true,
        tau_el: true,
        tau_m: true,
        tau_ext: true,
        temperature: true,
        tension: false,
    }
}

fn names(n: usize) -> Vec<String> {
    (0..n).map(|joint| format!("joint_{joint}")).collect()
}

/// Frames at about 250 Hz with positions that never jump by half a turn.
fn frames(n: usize, count: usize, seed: u64) -> Vec<Frame> {
    let mut state = seed | 1;
    let mut random = move || {
        // xorshift64*, Vigna 2016: enough for test values.
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..count)
        .map(|index| {
            let mut frame = Frame::new(n);
            frame.time_ns = 1_700_000_000_123_456_789 + 4_000_000 * index as i64;
            for quantity in Quantity::PER_JOINT {
                for value in frame.get_mut(quantity) {
                    *value = random();
                }
            }
            frame.temperature_c = 22.0 + random();
            // Some values are not recorded.
            if index % 7 == 3 {
                frame.theta[0] = f64::NAN;
                frame.tau_el[n - 1] = f64::NAN;
            }
            frame
        })
        .collect()
}

fn write_mcap(path: &Path, options: &McapOptions, frames: &[Frame]) {
    let mut writer: Box<dyn FrameWriter> = Box::new(McapWriter::create(path, options).unwrap());
    for frame in frames {
        writer.write(frame).unwrap();
    }
    writer.finish().unwrap();
}

fn read_back(path: &Path) -> Vec<Frame> {
    let mut recording = open(path, &OpenOptions::default()).unwrap();
    let mut frames = Vec::new();
    while let Some(frame) = recording.next_frame().unwrap() {
        frames.push(frame.clone());
    }
    assert!(!recording.health().is_damaged(), "{:?}", recording.health());
    assert_eq!(recording.health().frames, frames.len() as u64);
    assert_eq!(
        recording.progress().bytes_done,
        recording.progress().bytes_total
    );
    frames
}

/// Bitwise identical, except that any NaN equals any NaN.
fn assert_same(a: &[Frame], b: &[Frame]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert_eq!(a.time_ns, b.time_ns);
        for quantity in Quantity::PER_JOINT
            .into_iter()
            .chain([Quantity::Temperature])
        {
            for (x, y) in a.get(quantity).iter().zip(b.get(quantity)) {
                assert!(
                    x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan()),
                    "{quantity:?} at {}: {x} and {y}",
                    a.time_ns
                );
            }
        }
    }
}

#[test]
fn compressions_and_layouts_are_deterministic() {
    let folder = tempfile::tempdir().unwrap();
    let frames = frames(4, 3000, 7);
    for compression in [Compression::None, Compression::Zstd, Compression::Lz4] {
        for chunked in [true, false] {
            for indexed in [true, false] {
                let options = McapOptions {
                    joints: names(4),
                    quantities: all_quantities(),
                    compression,
                    chunked,
                    indexed,
                    chunk_size: 64 << 10,
                    robot_description: Some("<robot name=\"arm\"/>".to_owned()),
                    ..McapOptions::default()
                };
                let path = folder.path().join("a.mcap");
                write_mcap(&path, &options, &frames);
                assert_same(&frames, &read_back(&path));
                let recording = open(&path, &OpenOptions::default()).unwrap();
                assert_eq!(recording.robot_description(), Some("<robot name=\"arm\"/>"));
                assert_eq!(recording.joints(), names(4));
                assert_eq!(recording.channels().union(), all_quantities());

                let again = folder.path().join("b.mcap");
                write_mcap(&again, &options, &frames);
                assert_eq!(
                    std::fs::read(&path).unwrap(),
                    std::fs::read(&again).unwrap()
                );
            }
        }
    }
}

#[test]
fn unfinished_writer_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let options = McapOptions {
        joints: names(1),
        ..McapOptions::default()
    };
    let mut writer = McapWriter::create(&path, &options).unwrap();
    writer.write(&Frame::new(1)).unwrap();
    let beside = || std::fs::read_dir(folder.path()).unwrap();
    // During writing its name marks it as temporary, or it has none.
    for file in beside() {
        let name = file.unwrap().file_name();
        let name = name.to_string_lossy();
        assert!(
            name.starts_with(".a.mcap.sinew-") && name.ends_with(".tmp"),
            "{name}"
        );
    }
    drop(writer);
    let path = folder.path().join("a.csv");
    drop(RowWriter::create(&path, &names(1), Quantities::positions()).unwrap());
    assert_eq!(beside().count(), 0);
}

#[test]
fn frame_of_wrong_length_is_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let mut writer = RowWriter::create(&path, &names(2), Quantities::positions()).unwrap();
    let error = writer.write(&Frame::new(3)).unwrap_err().to_string();
    assert!(error.contains("3 values of q for 2 joints"), "{error}");
}

/// Position and torque of a motor are recorded under its name, everything else under that of the joint.
#[test]
fn motors_are_recorded_under_their_own_names() {
    let folder = tempfile::tempdir().unwrap();
    let (joints, motors) = (names(2), ["left".to_owned(), "right".to_owned()]);
    let names = RecordedNames {
        joints: &joints,
        motors: &motors,
    };
    let written = frames(2, 20, 5);
    for name in ["a.csv", "a.mcap"] {
        let path = folder.path().join(name);
        let mut writer: Box<dyn FrameWriter> = match name {
            "a.csv" => Box::new(RowWriter::create(&path, names, all_quantities()).unwrap()),
            _ => {
                let options = McapOptions {
                    joints: joints.clone(),
                    motors: motors.to_vec(),
                    quantities: all_quantities(),
                    ..McapOptions::default()
                };
                Box::new(McapWriter::create(&path, &options).unwrap())
            }
        };
        written.iter().for_each(|f| writer.write(f).unwrap());
        writer.finish().unwrap();
        let mut recording = open(&path, &OpenOptions::default()).unwrap();
        // The other way round than they were written.
        recording
            .select_axes(
                &[("joint_1", "right"), ("joint_0", "left")].map(|(joint, motor)| Axis {
                    motor: Some(motor),
                    ..Axis::of_joint(joint)
                }),
            )
            .unwrap();
        for want in &written {
            let frame = recording.next_frame().unwrap().unwrap();
            for quantity in Quantity::PER_JOINT {
                let swapped = want.get(quantity).iter().rev();
                for (found, want) in frame.get(quantity).iter().zip(swapped) {
                    let same = found == want || (found.is_nan() && want.is_nan());
                    assert!(same, "{name} {quantity:?}: {found} for {want}");
                }
            }
        }
    }
    let header = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
    let header = header.lines().next().unwrap();
    for column in [
        "q.joint_0_rad",
        "theta.left_rad",
        "tau_el.joint_1_nm",
        "tau_m.right_nm",
    ] {
        assert!(header.split(',').any(|name| name == column), "{header}");
    }
}

#[test]
fn motor_count_must_match_joint_count() {
    let folder = tempfile::tempdir().unwrap();
    let (joints, motors) = (names(2), vec!["left".to_owned()]);
    let names = RecordedNames {
        joints: &joints,
        motors: &motors,
    };
    let csv = RowWriter::create(&folder.path().join("a.csv"), names, Quantities::positions());
    let mcap = |motors: &[&str]| {
        let options = McapOptions {
            joints: joints.clone(),
            motors: motors.iter().map(|m| (*m).to_owned()).collect(),
            ..McapOptions::default()
        };
        McapWriter::create(&folder.path().join("a.mcap"), &options)
    };
    let said = [
        csv.err(),
        mcap(&["left"]).err(),
        mcap(&["left", "left"]).err(),
    ];
    let said = said.map(|error| error.unwrap().to_string());
    assert!(said[0].contains("2 joints and 1 motors"), "{}", said[0]);
    assert!(said[1].contains("2 joints and 1 motors"), "{}", said[1]);
    assert!(said[2].contains("motor name 'left'"), "{}", said[2]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn mcap_and_csv_round_trip(
        n in 1_usize..9,
        count in 1_usize..400,
        seed in any::<u64>(),
        compression in prop_oneof![
            Just(Compression::None), Just(Compression::Zstd), Just(Compression::Lz4)
        ],
        chunk_size in 1_u64..100_000,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let frames = frames(n, count, seed);
        let path = folder.path().join("a.mcap");
        let options = McapOptions {
            joints: names(n),
            quantities: all_quantities(),
            compression,
            chunk_size,
            ..McapOptions::default()
        };
        write_mcap(&path, &options, &frames);
        assert_same(&frames, &read_back(&path));

        let path = folder.path().join("a.csv");
        let mut writer: Box<dyn FrameWriter> =
            Box::new(RowWriter::create(&path, &names(n), all_quantities()).unwrap());
        for frame in &frames {
            writer.write(frame).unwrap();
        }
        writer.finish().unwrap();
        assert_same(&frames, &read_back(&path));
    }
}
