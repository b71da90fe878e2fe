//! Tables that are written: the same columns and numbers as CSV and as Parquet.

use ::parquet::file::reader::{FileReader as _, SerializedFileReader};
use ::parquet::record::Field;
use sinew_log::{Cell, CellKind, Frame, FrameWriter as _, OpenOptions, Quantities, Table};
use sinew_log::{RowWriter, SchemaColumn, TableSchema, TableWriter};
use std::fs::File;

/// Numbers that are hard to write: tiny, huge, no finite decimal.
fn table(rows: usize) -> Table {
    let columns = [
        ("time_s", CellKind::Number),
        ("strain_ratio", CellKind::Number),
        ("time_utc_ns", CellKind::Integer),
        ("rope", CellKind::Text),
        ("off", CellKind::Flag),
    ];
    let mut table = Table::new(&columns);
    for row in 0..rows {
        let strain = match row % 4 {
            0 => Some(1e-17 / 3.0 + row as f64 * 1e-9),
            1 => Some(0.1 + 0.2),
            2 => None,
            _ => Some(f64::NAN),
        };
        table.push(vec![
            (row as f64 / 3.0).into(),
            strain.into(),
            (1_790_000_000_123_456_789_i64 + row as i64).into(),
            if row % 2 == 0 { "a,b \"c\"\nµ" } else { "" }.into(),
            (row % 3 == 0).into(),
        ]);
    }
    table
}

/// Value of a cell after reading.
fn read_back(cell: &Cell) -> Field {
    match cell {
        Cell::Number(x) if x.is_finite() => Field::Double(*x),
        Cell::Integer(x) => Field::Long(*x),
        Cell::Text(x) => Field::Str(x.clone()),
        Cell::Flag(x) => Field::Bool(*x),
        _ => Field::Null,
    }
}

#[test]
fn parquet_holds_every_cell_exactly_over_several_groups() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.PARQUET");
    // One row more than a group holds.
    let table = table((1 << 16) + 1);
    table.write(&path).unwrap();
    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    assert_eq!(reader.metadata().num_row_groups(), 2);
    let mut rows = reader.get_row_iter(None).unwrap();
    for row in &table.rows {
        let found = rows.next().unwrap().unwrap();
        let names = table.columns.iter().map(|(name, _)| name);
        let wanted: Vec<_> = names.zip(row.iter().map(read_back)).collect();
        let found: Vec<_> = found
            .get_column_iter()
            .map(|(n, f)| (n, f.clone()))
            .collect();
        assert_eq!(found, wanted);
    }
    assert!(rows.next().is_none());
}

#[test]
fn parquet_states_schema_units_and_meaning() {
    let folder = tempfile::tempdir().unwrap();
    let columns = [
        SchemaColumn::plain("joint", CellKind::Text, "Name of the \"joint\""),
        SchemaColumn::number("temperature_c", "°C", "Mean temperature"),
    ];
    let schema = TableSchema {
        name: "trial/3",
        columns: &columns,
    };
    let path = folder.path().join("a.parquet");
    let mut writer = TableWriter::of_schema(&path, &schema).unwrap();
    writer.row(&["elbow".into(), 21.5.into()]).unwrap();
    writer.finish().unwrap();
    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    let pairs = reader.metadata().file_metadata().key_value_metadata();
    let value = |key: &str| {
        let mut pairs = pairs.unwrap().iter();
        pairs.find(|p| p.key == key).unwrap().value.clone().unwrap()
    };
    assert_eq!(value("sinew_schema"), "trial/3");
    assert_eq!(value("sinew_version"), env!("CARGO_PKG_VERSION"));
    let about: serde_json::Value = serde_json::from_str(&value("sinew_columns")).unwrap();
    assert_eq!(about["joint"]["meaning"], "Name of the \"joint\"");
    assert_eq!(about["temperature_c"]["unit"], "°C");
    // CSV has the same header as without a schema.
    let csv = folder.path().join("a.csv");
    TableWriter::of_schema(&csv, &schema)
        .unwrap()
        .finish()
        .unwrap();
    let text = std::fs::read_to_string(csv).unwrap();
    assert_eq!(text.trim_end(), "joint,temperature_c");
}

#[test]
fn wrong_row_width_and_duplicate_column_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.csv", "a.parquet"] {
        let path = folder.path().join(name);
        let columns = [("x".to_owned(), CellKind::Number)];
        let mut writer = TableWriter::create(&path, &columns).unwrap();
        let error = writer.row(&[1.0.into(), 2.0.into()]).unwrap_err();
        assert!(
            error.to_string().contains("a row has 2 cells, expected 1"),
            "{error}"
        );
        let twice = [columns[0].clone(), columns[0].clone()];
        let error = TableWriter::create(&path, &twice).err().unwrap();
        assert!(error.to_string().contains("two columns 'x'"), "{error}");
    }
}

#[test]
fn parquet_recording_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.parquet");
    let joints = ["shoulder".to_owned(), "elbow".to_owned()];
    let quantities = Quantities {
        tau_m: true,
        temperature: true,
        ..Quantities::positions()
    };
    let frames: Vec<Frame> = (0..200)
        .map(|k| {
            let x = f64::from(k) * 0.01;
            let mut frame = Frame::new(2);
            frame.time_ns = 1_790_000_000_000_000_001 + i64::from(k) * 5_000_000;
            frame.q = vec![x.sin(), x.cos()];
            frame.theta = vec![x.sin() + 0.01 * x, x.cos() / 3.0];
            frame.tau_m = vec![f64::NAN, 2.0 * x];
            frame.temperature_c = 20.0 + x;
            frame
        })
        .collect();
    let mut writer = RowWriter::create_parquet(&path, &joints, quantities).unwrap();
    for frame in &frames {
        writer.write(frame).unwrap();
    }
    Box::new(writer).finish().unwrap();
    let mut recording = sinew_log::open(&path, &OpenOptions::default()).unwrap();
    assert_eq!(recording.joints(), joints);
    for frame in &frames {
        let found = recording.next_frame().unwrap().unwrap();
        assert_eq!((found.time_ns, &found.q), (frame.time_ns, &frame.q));
        assert_eq!(
            (&found.theta, found.tau_m[1]),
            (&frame.theta, frame.tau_m[1])
        );
        assert!(found.tau_m[0].is_nan());
        assert_eq!(found.temperature_c, frame.temperature_c);
    }
    assert!(recording.next_frame().unwrap().is_none());
}
