//! Parquet tables: types, nulls, row groups, damage.

use std::sync::Arc;

use crate::support::*;
use parquet::basic::{Compression, ZstdLevel};
use parquet::data_type::{DoubleType, FloatType, Int32Type, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use sinew_log::{Format, LogError, OpenOptions};

const GROUPS: i64 = 3;
const ROWS: i64 = 1500;

/// `theta` is null in every third row; q in single precision, a count, a time in microseconds.
fn table() -> Vec<u8> {
    let schema = parse_message_type(
        "message schema {
            required int64 time_us;
            required float q.a_rad;
            optional double theta.a_rad;
            optional int32 tau_m.a_nm;
            optional binary note (UTF8);
        }",
    )
    .unwrap();
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_data_page_row_count_limit(200)
        .set_write_batch_size(100)
        .build();
    let mut bytes = Vec::new();
    let mut writer =
        SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties)).unwrap();
    for group in 0..GROUPS {
        let rows = || group * ROWS..(group + 1) * ROWS;
        let mut out = writer.next_row_group().unwrap();
        let mut column = 0;
        while let Some(mut cells) = out.next_column().unwrap() {
            match column {
                0 => {
                    let values: Vec<i64> = rows().map(|row| START_NS / 1000 + 4000 * row).collect();
                    let typed = cells.typed::<Int64Type>();
                    typed.write_batch(&values, None, None).unwrap();
                }
                1 => {
                    let values: Vec<f32> = rows().map(|row| (row as f32 * 0.01).sin()).collect();
                    let typed = cells.typed::<FloatType>();
                    typed.write_batch(&values, None, None).unwrap();
                }
                2 => {
                    let levels: Vec<i16> = rows().map(|row| i16::from(row % 3 != 0)).collect();
                    let values: Vec<f64> = rows()
                        .filter(|row| row % 3 != 0)
                        .map(|row| (row as f64 * 0.01).cos())
                        .collect();
                    let typed = cells.typed::<DoubleType>();
                    typed.write_batch(&values, Some(&levels), None).unwrap();
                }
                3 => {
                    let levels: Vec<i16> = rows().map(|_| 1).collect();
                    let values: Vec<i32> = rows().map(|row| row as i32 % 7 - 3).collect();
                    let typed = cells.typed::<Int32Type>();
                    typed.write_batch(&values, Some(&levels), None).unwrap();
                }
                _ => {
                    let levels: Vec<i16> = rows().map(|_| 0).collect();
                    let typed = cells.typed::<parquet::data_type::ByteArrayType>();
                    typed.write_batch(&[], Some(&levels), None).unwrap();
                }
            }
            cells.close().unwrap();
            column += 1;
        }
        out.close().unwrap();
    }
    writer.close().unwrap();
    bytes
}

#[test]
fn types_nulls_and_row_groups() {
    let recording = open_bytes(&table(), "a", &OpenOptions::default()).unwrap();
    assert_eq!(recording.format(), Format::Parquet);
    let (frames, health) = read_all(recording);
    assert_eq!(frames.len(), (GROUPS * ROWS) as usize);
    for (row, frame) in frames.iter().enumerate() {
        assert_eq!(frame.time_ns, START_NS + 4 * MS * row as i64);
        assert_eq!(frame.q[0], f64::from((row as f32 * 0.01).sin()));
        if row % 3 == 0 {
            assert!(frame.theta[0].is_nan());
        } else {
            assert_eq!(frame.theta[0], (row as f64 * 0.01).cos());
        }
        assert_eq!(frame.tau_m[0], f64::from(row as i32 % 7 - 3));
    }
    assert!(
        health.non_finite.is_empty() && !health.is_lossy(),
        "{health:?}"
    );
}

#[test]
fn truncated_file_is_error_and_wrong_bytes_never_panic() {
    let bytes = table();
    for length in (4..bytes.len()).step_by(97) {
        let error = error_of(&bytes[..length], "a.parquet", &OpenOptions::default());
        assert!(error.contains("Parquet"), "{error}");
    }
    let (mut read, mut damaged) = (0, 0);
    for at in (0..bytes.len()).step_by(53) {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0x3c;
        let mut recording = match open_bytes(&bytes, "a.parquet", &OpenOptions::default()) {
            Ok(recording) => recording,
            Err(LogError::NotARecording { .. } | LogError::File(_)) => continue,
            Err(error) => panic!("{error}"),
        };
        while recording.next_frame().unwrap().is_some() {}
        read += 1;
        damaged += usize::from(recording.health().is_damaged());
    }
    println!("{read} files with a wrong byte were read, {damaged} of them as damaged");
    assert!(damaged > 10);
}
