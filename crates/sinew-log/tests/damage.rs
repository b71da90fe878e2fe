//! Files that are cut off, corrupted or lie about their lengths: read up to the damage.

use crate::support::*;
use mcap::Compression;
use sinew_log::{Health, LogError, OpenOptions};

const STEPS: i64 = 400;

fn bag(compression: Option<Compression>, chunked: bool) -> Vec<u8> {
    let options = mcap::WriteOptions::new()
        .compression(compression)
        .use_chunks(chunked)
        .chunk_size(Some(8 << 10));
    let mut bag = Bag::with(options);
    for step in 0..STEPS {
        let time = START_NS + 4 * step * MS;
        // Different in every bit, so that compressed chunks are not tiny.
        let value = (step as f64 * 0.37).sin();
        bag.joint(time, &[("a", value), ("b", value * value)]);
        bag.motor(time, &[("a", value + 0.1), ("b", value.exp())]);
    }
    bag.bytes()
}

fn all_kinds() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("zstd", bag(Some(Compression::Zstd), true)),
        ("lz4", bag(Some(Compression::Lz4), true)),
        ("none", bag(None, true)),
        ("no chunks", bag(None, false)),
    ]
}

/// Reads up to the damage; `None` for an error.
fn read_any(bytes: &[u8]) -> Option<(usize, Health)> {
    let mut recording = match open_bytes(bytes, "a.mcap", &OpenOptions::default()) {
        Ok(recording) => recording,
        Err(LogError::NotARecording { .. } | LogError::Request { .. }) => return None,
        Err(error) => panic!("{error}"),
    };
    let mut frames = 0;
    let mut last = None;
    while let Some(frame) = recording.next_frame().unwrap() {
        assert!(last.is_none_or(|last| (frame.segment, frame.time_ns) > last));
        last = Some((frame.segment, frame.time_ns));
        frames += 1;
    }
    Some((frames, recording.health().clone()))
}

#[test]
fn prefix_of_recording_is_read_to_its_end_or_error() {
    for (name, bytes) in all_kinds() {
        let (whole, health) = read_any(&bytes).unwrap();
        assert_eq!(whole, STEPS as usize);
        assert!(!health.is_damaged(), "{name}: {health:?}");
        let mut best = 0;
        let mut refused = 0;
        // Every length near both ends, every 23rd between.
        let near =
            |length: usize| length < 700 || length + 700 > bytes.len() || length.is_multiple_of(23);
        for length in (0..bytes.len()).filter(|length| near(*length)) {
            match read_any(&bytes[..length]) {
                None => refused = length,
                Some((frames, health)) => {
                    assert!(
                        frames >= best,
                        "{name}: {frames} frames from {length} bytes"
                    );
                    best = frames;
                    // Cut behind the end of the data nothing is lost.
                    if frames < whole {
                        assert!(health.is_damaged(), "{name}: {length}");
                        assert!(health.bytes_lost <= length as u64);
                    }
                }
            }
        }
        assert_eq!(best, whole, "{name}");
        // No prefix is readable before the first message, and of a chunk that fits into one compressed block
        // before the end of that chunk (8 KiB unpacked).
        assert!(refused < 8 << 10, "{name}: refused {refused}");
    }
}

#[test]
fn truncated_chunk_gives_first_messages() {
    for (name, bytes) in all_kinds() {
        let cut = bytes.len() / 2;
        let (frames, health) = read_any(&bytes[..cut]).unwrap();
        let share = frames as f64 / STEPS as f64;
        println!(
            "{name}: {frames} of {STEPS} frames from half the file; {}",
            health.damage[0].reason
        );
        // The index at the end takes its part of the file; a chunk is 3 % of the messages.
        assert!(share > 0.4 && share < 0.75, "{name}: {frames}");
        let damage = &health.damage[0];
        assert_eq!(
            damage.offset + damage.bytes,
            cut as u64,
            "{name}: {damage:?}"
        );
    }
}

#[test]
fn chunk_with_wrong_checksum_is_skipped() {
    for (name, bytes) in all_kinds().into_iter().take(3) {
        let mut bytes = bytes;
        // In the middle of the data: inside a chunk's packed records.
        let at = bytes.len() / 3;
        bytes[at] ^= 0x55;
        let (frames, health) = read_any(&bytes).unwrap();
        println!("{name}: {frames} frames; {}", health.damage[0].reason);
        assert!(health.is_damaged());
        let lost = STEPS as usize - frames;
        // A chunk of 8 KiB holds about 20 steps.
        assert!((10..40).contains(&lost), "{name}: {lost}");
        assert!(health.damage[0].bytes < 10_000, "{:?}", health.damage);
    }
}

#[test]
fn any_single_wrong_byte_is_survived() {
    for (name, bytes) in all_kinds() {
        let mut read = 0;
        for at in (0..bytes.len()).step_by(41) {
            let mut bytes = bytes.clone();
            bytes[at] = bytes[at].wrapping_add(0x81);
            read += usize::from(read_any(&bytes).is_some());
        }
        println!(
            "{name}: {read} of {} files with a wrong byte were read",
            bytes.len() / 41
        );
        assert!(read > bytes.len() / 41 / 2, "{name}");
    }
}

/// A record of any length claims any size: nothing may be allocated for it.
#[test]
fn wrong_length_fields_are_errors_or_reported() {
    let sound = bag(Some(Compression::Zstd), true);
    let magic = &sound[..8];
    let header_length = u64::from_le_bytes(sound[9..17].try_into().unwrap()) as usize;
    let header = &sound[8..17 + header_length];
    let start = [magic, header].concat();
    for opcode in 1..=0x10_u8 {
        for length in [u64::MAX, 1 << 62, 1 << 40, 1 << 31] {
            let mut bytes = start.clone();
            bytes.push(opcode);
            bytes.extend(length.to_le_bytes());
            bytes.extend([0; 100]);
            assert!(read_any(&bytes).is_none_or(|(frames, _)| frames == 0));
        }
    }
    // The first chunk claims to unpack to far more than it can.
    let chunk = start.len();
    assert_eq!(sound[chunk], 6);
    for size in [u64::MAX, 1 << 60, 1 << 40, 1 << 29] {
        let mut bytes = sound.clone();
        bytes[chunk + 25..chunk + 33].copy_from_slice(&size.to_le_bytes());
        let (frames, health) = read_any(&bytes).unwrap();
        assert!(frames > STEPS as usize / 2, "{frames}");
        assert!(
            health.damage[0].reason.contains("bytes"),
            "{:?}",
            health.damage
        );
    }
}

/// An "endless" chunk: its length reaches beyond the file, its content does not end.
#[test]
fn chunk_longer_than_file_gives_present_messages() {
    let mut bytes = bag(Some(Compression::Zstd), true);
    let header_length = u64::from_le_bytes(bytes[9..17].try_into().unwrap()) as usize;
    let chunk = 17 + header_length;
    bytes[chunk + 1..chunk + 9].copy_from_slice(&(1_u64 << 50).to_le_bytes());
    let (frames, health) = read_any(&bytes).unwrap();
    // The packed records themselves are intact, so the chunk's own steps are there.
    assert!((10..40).contains(&frames), "{frames}");
    assert!(health.is_damaged());
}

#[test]
fn unclosed_recording_is_reported() {
    let bytes = bag(None, false);
    let data_end = {
        // The record before the summary: find it by walking the records.
        let mut at = 8;
        while bytes[at] != 0x0f {
            at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        }
        at
    };
    let (frames, health) = read_any(&bytes[..data_end]).unwrap();
    assert_eq!(frames, STEPS as usize);
    assert_eq!(health.bytes_lost, 0);
    assert!(
        health.damage[0].reason.contains("without a footer"),
        "{health:?}"
    );
}

#[test]
fn after_damage_a_new_segment_starts() {
    let mut bytes = bag(None, true);
    let at = bytes.len() / 3;
    bytes[at] ^= 0x55;
    let recording = open_bytes(&bytes, "a.mcap", &OpenOptions::default()).unwrap();
    let (frames, health) = read_all(recording);
    assert_eq!(frames.last().unwrap().segment, 1);
    // The hole is shorter than the gap limit, so only the damage can have done it.
    assert_eq!(health.gaps, 0);
}

#[test]
fn non_recording_error_names_cause() {
    let options = OpenOptions::default();
    let error = |bytes: &[u8], name: &str| error_of(bytes, name, &options);
    assert!(error(b"", "a.mcap").contains("empty"));
    assert!(error(b"hello", "a.mcap").contains("does not start as an MCAP"));
    assert!(error(&[0x89, b'M', b'C'], "a").contains("does not start as an MCAP"));
    assert!(error(b"PAR1", "a").contains("Parquet"));
    assert!(error(b"PAR1....PAR1", "a.parquet").contains("Parquet footer"));
    assert!(error(b"\x1f\x8b\x08\0\0\0\0\0\0", "a.csv").contains("gzip"));
    assert!(error(&[1, 2, 0, 0, 3, 4, 0, 9, 9], "a.bin").contains("zero bytes"));
    let empty = Bag::new().bytes();
    assert!(error(&empty, "a.mcap").contains("no sensor_msgs/msg/JointState topic"));
    let missing = sinew_log::open(std::path::Path::new("/no/such/file.mcap"), &options);
    assert!(missing.unwrap_err().to_string().contains("cannot open"));
}
