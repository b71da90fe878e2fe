//! Arrays of NumPy, built byte by byte as `numpy.save`, `savez` and `savez_compressed` write them.

use crate::support::*;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use sinew_log::{Format, Frame, Mapping, MappingProposal, OpenOptions, ProposedSource, Quantity};
use std::io::Write as _;

const ROWS: usize = 3000;

/// An array with a header of version 1.
fn array(description: &str, is_fortran: bool, shape: &[usize], values: &[u8]) -> Vec<u8> {
    let order = if is_fortran { "True" } else { "False" };
    let shape: Vec<String> = shape.iter().map(|size| format!("{size},")).collect();
    let (quote, shape) = (
        "'".repeat(usize::from(!description.starts_with('['))),
        shape.join(" "),
    );
    let head = format!(
        "{{'descr': {quote}{description}{quote}, 'fortran_order': {order}, 'shape': ({shape}), }}\n"
    );
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((head.len() as u16).to_le_bytes());
    bytes.extend(head.as_bytes());
    bytes.extend(values);
    bytes
}

fn doubles(values: impl Iterator<Item = f64>) -> Vec<u8> {
    values.flat_map(f64::to_le_bytes).collect()
}

/// An archive; with `is_wide` the sizes are 64-bit fields.
fn archive(entries: &[(&str, Vec<u8>)], is_packed: bool, is_wide: bool) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in entries {
        let packed = match is_packed {
            true => {
                let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
                encoder.write_all(content).unwrap();
                encoder.finish().unwrap()
            }
            false => content.clone(),
        };
        let start = bytes.len();
        let sizes = [content.len(), packed.len()];
        let method = if is_packed { 8_u16 } else { 0 };
        let wide: Vec<u8> = match is_wide {
            true => [1_u16, 24]
                .into_iter()
                .flat_map(u16::to_le_bytes)
                .chain(
                    [sizes[0], sizes[1], start]
                        .into_iter()
                        .flat_map(|size| (size as u64).to_le_bytes()),
                )
                .collect(),
            false => Vec::new(),
        };
        let narrow = |size: usize| if is_wide { u32::MAX } else { size as u32 };
        let mut common = Vec::new();
        common.extend(method.to_le_bytes());
        common.extend([0; 4]);
        common.extend(crc32fast::hash(content).to_le_bytes());
        common.extend(narrow(sizes[1]).to_le_bytes());
        common.extend(narrow(sizes[0]).to_le_bytes());
        common.extend((name.len() as u16).to_le_bytes());
        bytes.extend(b"PK\x03\x04\x2d\x00\x00\x00");
        bytes.extend(&common);
        bytes.extend((wide.len() as u16).to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.extend(&wide);
        bytes.extend(packed);
        directory.extend(b"PK\x01\x02\x2d\x03\x2d\x00\x00\x00");
        directory.extend(&common);
        directory.extend((wide.len() as u16).to_le_bytes());
        directory.extend([0; 10]);
        directory.extend(narrow(start).to_le_bytes());
        directory.extend(name.as_bytes());
        directory.extend(&wide);
    }
    let (start, count) = (bytes.len(), entries.len());
    bytes.extend(&directory);
    if is_wide {
        let end = bytes.len() as u64;
        bytes.extend(b"PK\x06\x06");
        bytes.extend(44_u64.to_le_bytes());
        bytes.extend([0; 12]);
        for size in [count, count, directory.len(), start] {
            bytes.extend((size as u64).to_le_bytes());
        }
        bytes.extend(b"PK\x06\x07\x00\x00\x00\x00");
        bytes.extend(end.to_le_bytes());
        bytes.extend(1_u32.to_le_bytes());
    }
    bytes.extend(b"PK\x05\x06\x00\x00\x00\x00");
    bytes.extend((count as u16).to_le_bytes());
    bytes.extend((count as u16).to_le_bytes());
    bytes.extend((directory.len() as u32).to_le_bytes());
    bytes.extend((start as u32).to_le_bytes());
    bytes.extend([0; 2]);
    bytes
}

fn q(row: usize) -> f64 {
    (0.01 * row as f64).sin()
}

/// Times, both sides of two joints, and arrays that are no signals.
fn signals() -> Vec<(&'static str, Vec<u8>)> {
    let times = (0..ROWS as i64).flat_map(|row| (START_NS + 4 * MS * row).to_le_bytes());
    let by_row = (0..ROWS).flat_map(|row| [q(row), 2.0 * q(row)]);
    let single =
        (0..2).flat_map(|joint| (0..ROWS).map(move |row| (joint + 1) as f32 * q(row) as f32));
    vec![
        (
            "time_ns.npy",
            array("<i8", false, &[ROWS], &times.collect::<Vec<_>>()),
        ),
        ("q.npy", array("<f8", false, &[ROWS, 2], &doubles(by_row))),
        // Single precision with the most significant byte first, a row per joint.
        (
            "theta.npy",
            array(
                ">f4",
                false,
                &[2, ROWS],
                &single.flat_map(f32::to_be_bytes).collect::<Vec<_>>(),
            ),
        ),
        (
            "gains.npy",
            array("<f8", false, &[3], &doubles([1.0, 2.0, 3.0].into_iter())),
        ),
        ("names.npy", array("<U5", false, &[2], &[0; 40])),
        ("settings.npy", array("|O", false, &[], b"pickled")),
        ("readme.txt", b"not an array".to_vec()),
    ]
}

fn options(mapping: &str) -> OpenOptions {
    OpenOptions {
        mapping: Some(Mapping::from_toml(mapping, "mapping.toml").expect("a mapping")),
        ..OpenOptions::default()
    }
}

const MAPPED: &str = "[joints.a]\nq = { column = \"q[0]\" }\ntheta = { column = \"theta[0]\" }\n[joints.b]\nq = { column = \"q[1]\" }\ntheta = { column = \"theta[1]\" }\n";

#[track_caller]
fn assert_signals(frames: &[Frame]) {
    assert_eq!(frames.len(), ROWS);
    for (row, frame) in frames.iter().enumerate() {
        assert_eq!(frame.time_ns, START_NS + 4 * MS * row as i64);
        assert_eq!(frame.q, [q(row), 2.0 * q(row)]);
        for joint in 0..2 {
            let theta = f64::from((joint + 1) as f32 * q(row) as f32);
            assert_eq!(frame.theta[joint], theta);
        }
    }
}

#[test]
fn archive_has_a_column_for_each_value_of_a_row() {
    for (is_packed, is_wide) in [(false, false), (true, false), (false, true), (true, true)] {
        let bytes = archive(&signals(), is_packed, is_wide);
        let recording = open_bytes(&bytes, "a.npz", &options(MAPPED)).expect("opened");
        assert_eq!(recording.format(), Format::Numpy);
        let (frames, health) = read_all(recording);
        assert_signals(&frames);
        assert!(!health.is_lossy(), "{health:?}");
    }
}

#[test]
fn elements_of_arrays_are_proposed_by_their_index() {
    let file = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(file.path(), archive(&signals(), true, false)).expect("written");
    let found = MappingProposal::of_file(file.path());
    let time = found.time.expect("rises");
    assert_eq!(found.columns[time.column].name, "time_ns");
    let names: Vec<&str> = found.joints.iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["joint0", "joint1"]);
    for joint in &found.joints {
        let quantities: Vec<Quantity> = joint.sources.iter().map(|s| s.quantity).collect();
        assert_eq!(quantities, [Quantity::Q, Quantity::Theta]);
        // The index is no unit.
        let is_assumed = |source: &ProposedSource| source.unit == "rad" && !source.is_unit_stated;
        assert!(joint.sources.iter().all(is_assumed), "{joint:?}");
    }
}

#[test]
fn columns_with_usual_names_need_no_mapping() {
    let times = doubles((0..ROWS).map(|row| 0.004 * row as f64));
    let entries = vec![
        ("time_s.npy", array("<f8", false, &[ROWS], &times)),
        (
            "q.a_rad.npy",
            array("<f8", false, &[ROWS], &doubles((0..ROWS).map(q))),
        ),
        (
            "theta.a_rad.npy",
            array("<f8", false, &[ROWS], &doubles((0..ROWS).map(q))),
        ),
    ];
    let (frames, _) = read_bytes(&archive(&entries, true, false), "a.npz");
    assert_eq!(
        (frames.len(), frames[1].time_ns, frames[1].q[0]),
        (ROWS, 4 * MS, q(1))
    );
    // Dates state their unit.
    let dates: Vec<u8> = (0..ROWS as i64)
        .flat_map(|row| (START_NS / 1000 + 4000 * row).to_le_bytes())
        .collect();
    let mut entries = entries;
    entries[0] = ("timestamp.npy", array("<M8[us]", false, &[ROWS], &dates));
    let mapped = options("[time]\ncolumn = \"timestamp\"\nunit = \"us\"\n");
    let recording = open_bytes(&archive(&entries, true, false), "a.npz", &mapped);
    let (frames, _) = read_all(recording.expect("opened"));
    assert_eq!(frames[2].time_ns, START_NS + 8 * MS);
}

#[test]
fn single_array_needs_numbers_of_columns() {
    let rows = (0..ROWS).flat_map(|row| [0.004 * row as f64, q(row), q(row) + 0.5]);
    let columns = (0..3).flat_map(|column| {
        (0..ROWS).map(move |row| [0.004 * row as f64, q(row), q(row) + 0.5][column])
    });
    let mapping = "[time]\ncolumn = 1\n[joints.a]\nq = { column = 2 }\ntheta = { column = 3 }\n";
    let by_row = array("<f8", false, &[ROWS, 3], &doubles(rows));
    let by_column = array("<f8", true, &[ROWS, 3], &doubles(columns));
    for bytes in [&by_row, &by_column] {
        let message = error_of(bytes, "a.npy", &OpenOptions::default());
        for words in ["no names", "column = 2", "rate_hz", "column 3"] {
            assert!(message.contains(words), "{words}: {message}");
        }
        let recording = open_bytes(bytes, "a.npy", &options(mapping)).expect("opened");
        let (frames, health) = read_all(recording);
        assert_eq!(frames.len(), ROWS);
        for (row, frame) in frames.iter().enumerate() {
            assert_eq!(frame.time_ns, 4 * MS * row as i64);
            assert_eq!((frame.q[0], frame.theta[0]), (q(row), q(row) + 0.5));
        }
        assert!(!health.is_lossy(), "{health:?}");
    }
    // The rows before the cut are read.
    let cut = &by_row[..by_row.len() - 30];
    let (frames, health) = read_all(open_bytes(cut, "a.npy", &options(mapping)).expect("opened"));
    assert_eq!(frames.len(), ROWS - 2);
    assert!(
        health.is_damaged() && health.damage[0].reason.contains("row 2999 of 3000"),
        "{health:?}"
    );
    let cut = &by_column[..by_column.len() - 30];
    let error = error_of(cut, "a.npy", &options(mapping));
    assert!(error.contains("cut off"), "{error}");
    // The proposal counts the columns.
    let file = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(file.path(), &by_row).expect("written");
    let found = MappingProposal::of_file(file.path());
    assert_eq!(found.columns[2].number, Some(3));
    assert_eq!(found.time.expect("rises").unit.as_deref(), Some("s"));
}

#[test]
fn damaged_archives_and_other_arrays_are_rejected() {
    let whole = archive(&signals(), true, false);
    let mapped = options(MAPPED);
    let error = error_of(&whole[..whole.len() - 40], "a.npz", &mapped);
    assert!(error.contains("zip"), "{error}");
    // A wrong bit in the compressed values.
    let mut damaged = whole.clone();
    damaged[whole.len() / 4] ^= 0x10;
    let reading = open_bytes(&damaged, "a.npz", &mapped);
    let error = match reading {
        Ok(mut recording) => loop {
            match recording.next_frame() {
                Ok(Some(_)) => {}
                Ok(None) => panic!("damage is not detected"),
                Err(error) => break error.to_string(),
            }
        },
        Err(error) => error.to_string(),
    };
    assert!(error.contains("array"), "{error}");
    // A shape of terabytes is compared with the file, not allocated.
    let huge = array("<f8", true, &[1 << 40, 3], &[0; 48]);
    assert!(error_of(&huge, "a.npy", &mapped).contains("cut off"));
    let wide = array("<f8", false, &[2, 70_000], &[0; 48]);
    assert!(error_of(&wide, "a.npy", &mapped).contains("65536 columns"));
    let fields = array("[('t', '<f8'), ('q', '<f8')]", false, &[2], &[0; 32]);
    let error = error_of(&fields, "a.npy", &mapped);
    assert!(
        error.contains("fields") && error.contains("np.load('a.npy')"),
        "{error}"
    );
    let text = array("<U5", false, &[2], &[0; 40]);
    assert!(error_of(&text, "a.npy", &mapped).contains("<U5"));
    for length in 0..whole.len().min(400) {
        let _no_panic = open_bytes(&whole[..length], "a.npz", &mapped);
    }
    let small = archive(&signals()[3..4], false, true);
    for (at, _) in small.iter().enumerate() {
        for bits in [0x01, 0x80, 0xff] {
            let mut damaged = small.clone();
            damaged[at] ^= bits;
            let _no_panic = open_bytes(&damaged, "a.npz", &mapped).map(read_all);
        }
    }
}
