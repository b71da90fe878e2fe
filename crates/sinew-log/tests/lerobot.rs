//! LeRobot data sets: list columns, names in `meta/info.json`, episodes.

use std::path::Path;
use std::sync::Arc;

use crate::support::*;
use parquet::data_type::{FloatType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use sinew_log::{Format, Mapping, OpenOptions, open};

const ROWS: i64 = 60;

/// Joint and motor positions of two joints in one list of four, in several pages; one value of row 7 is null.
fn episode(number: i64) -> Vec<u8> {
    let schema = parse_message_type(
        "message schema {
            optional group observation.state (LIST) {
                repeated group list { optional float element; }
            }
            optional float timestamp;
            optional int64 episode_index;
        }",
    )
    .unwrap();
    let properties = WriterProperties::builder()
        .set_data_page_row_count_limit(20)
        .set_write_batch_size(16)
        .build();
    let mut bytes = Vec::new();
    let mut writer =
        SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties)).unwrap();
    let mut out = writer.next_row_group().unwrap();
    let mut column = 0;
    while let Some(mut cells) = out.next_column().unwrap() {
        let present = vec![1; ROWS as usize];
        match column {
            0 => {
                let (mut values, mut def, mut rep) = (Vec::new(), Vec::new(), Vec::new());
                for row in 0..ROWS {
                    for element in 0..4 {
                        let null = (row, element) == (7, 2);
                        rep.push(i16::from(element > 0));
                        def.push(if null { 2 } else { 3 });
                        if !null {
                            values.push((100 * number + row) as f32 + 0.25 * element as f32);
                        }
                    }
                }
                let typed = cells.typed::<FloatType>();
                typed.write_batch(&values, Some(&def), Some(&rep)).unwrap();
            }
            1 => {
                let values: Vec<f32> = (0..ROWS).map(|row| row as f32 / 50.0).collect();
                let typed = cells.typed::<FloatType>();
                typed.write_batch(&values, Some(&present), None).unwrap();
            }
            _ => {
                let values = vec![number; ROWS as usize];
                let typed = cells.typed::<Int64Type>();
                typed.write_batch(&values, Some(&present), None).unwrap();
            }
        }
        cells.close().unwrap();
        column += 1;
    }
    out.close().unwrap();
    writer.close().unwrap();
    bytes
}

fn data_set(folder: &Path, names: &str) {
    std::fs::create_dir_all(folder.join("meta")).unwrap();
    std::fs::create_dir_all(folder.join("data/chunk-000")).unwrap();
    let info = format!(
        r#"{{"codebase_version": "v2.1", "fps": 50, "features": {{
            "observation.state": {{"dtype": "float32", "shape": [4], "names": {names}}},
            "timestamp": {{"dtype": "float32", "shape": [1], "names": null}}}}}}"#
    );
    std::fs::write(folder.join("meta/info.json"), info).unwrap();
    for number in 0..2 {
        let path = folder.join(format!("data/chunk-000/episode_00000{number}.parquet"));
        std::fs::write(path, episode(number)).unwrap();
    }
}

fn mapped(columns: [&str; 4]) -> OpenOptions {
    let [qa, qb, ta, tb] = columns.map(|c| format!("\"observation.state.{c}\""));
    let text = format!(
        "[joints.a]\nq = {{ column = {qa}, wrap = false }}\ntheta = {{ column = {ta}, wrap = false }}\n[joints.b]\nq = {{ column = {qb}, wrap = false }}\ntheta = {{ column = {tb}, wrap = false }}\n"
    );
    OpenOptions {
        mapping: Some(Mapping::from_toml(&text, "map.toml").unwrap()),
        ..OpenOptions::default()
    }
}

#[test]
fn elements_of_a_list_are_columns_by_their_number() {
    let bytes = episode(0);
    let error = error_of(&bytes, "a.parquet", &OpenOptions::default());
    assert!(error.contains("'observation.state.3'"), "{error}");
    let recording = open_bytes(&bytes, "a.parquet", &mapped(["0", "1", "2", "3"])).unwrap();
    assert_eq!(recording.unused_columns(), ["episode_index"]);
    let (frames, health) = read_all(recording);
    assert_eq!(frames.len(), ROWS as usize);
    for (row, frame) in frames.iter().enumerate() {
        // A float of 32 bits: half a unit of its last place, 2^-24 of the time, and a rounding.
        let time_ns = 20 * MS * row as i64;
        let off = (frame.time_ns - time_ns).abs();
        assert!(off <= (time_ns >> 24) + 1, "{off} ns at {time_ns} ns");
        let row = row as f64;
        assert_eq!(frame.q, [row, row + 0.25]);
        assert_eq!(frame.theta[1], row + 0.75);
        assert_eq!(frame.theta[0].is_nan(), row == 7.0);
        assert!(row == 7.0 || frame.theta[0] == row + 0.5);
    }
    assert!(!health.is_lossy(), "{health:?}");
}

#[test]
fn data_set_names_elements_and_joins_episodes() {
    for names in [
        r#"["a.pos", "b.pos", "a.motor", "b.motor"]"#,
        r#"{"motors": ["a.pos", "b.pos", "a.motor", "b.motor"]}"#,
    ] {
        let folder = tempfile::tempdir().unwrap();
        data_set(folder.path(), names);
        let options = mapped(["a.pos", "b.pos", "a.motor", "b.motor"]);
        let one = folder.path().join("data/chunk-000/episode_000001.parquet");
        let (frames, _) = read_all(open(&one, &options).unwrap());
        assert_eq!((frames.len(), frames[0].q[1]), (ROWS as usize, 100.25));
        let all = open(folder.path(), &options).unwrap();
        assert_eq!(all.format(), Format::Parquet);
        let (frames, health) = read_all(all);
        assert_eq!(frames.len(), 2 * ROWS as usize, "{health:?}");
        // Each episode begins its own clock, so filters are re-initialised.
        assert_eq!((frames[0].segment, frames[ROWS as usize].segment), (0, 1));
        assert_eq!(frames[ROWS as usize].q[0], 100.0);
        assert!(!health.is_lossy(), "{health:?}");
    }
    // Without names in the metadata the elements are numbered.
    let folder = tempfile::tempdir().unwrap();
    data_set(folder.path(), "null");
    open(folder.path(), &mapped(["0", "1", "2", "3"])).unwrap();
}
