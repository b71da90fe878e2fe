//! Support for the tests: fleets and files.

pub(crate) mod tendons;

use datafusion::arrow::array::{AsArray as _, BooleanArray, Float64Array, RecordBatch};
use datafusion::arrow::compute::filter_record_batch;
use datafusion::arrow::datatypes::Float64Type;
use datafusion::parquet::arrow::ArrowWriter;
use datafusion::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use sinew_fleet::args::{Simulate, Source};
use sinew_fleet::engine::Engine;
use sinew_fleet::simulate::{Made, simulate};
use sinew_log::TableWriter;
use sinew_watch_core::Record;
use sinew_watch_core::record::Clock;
use sinew_watch_core::table::{SCHEMA, columns, row};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Path of a folder of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// Arguments of a small simulated fleet.
pub(crate) fn small(out: &Path, robots: u32, days: u32) -> Simulate {
    Simulate {
        robot: repository("robots/biorob-like"),
        out: out.into(),
        robots,
        days,
        seed: 1,
        batch_spread: 0.08,
        bad_batch: 1.7,
        ropes: vec!["tasline-pe8".into()],
        recordings: 0,
    }
}

/// Simulates a small fleet.
pub(crate) fn fleet(out: &Path, robots: u32, days: u32) -> Made {
    simulate(&small(out, robots, days)).unwrap()
}

/// Source of a folder.
pub(crate) fn source(folder: &Path) -> Source {
    Source {
        folder: folder.into(),
        memory_mb: 256,
    }
}

/// Opens a folder of records.
pub(crate) fn open(folder: &Path) -> Engine {
    Engine::open(&source(folder)).unwrap()
}

/// Record of a session of a joint on a day.
pub(crate) fn session(robot: &str, joint: &str, day: u32) -> Record {
    Record {
        robot: robot.into(),
        robot_type: "arm".into(),
        joint: joint.into(),
        time_utc_s: 1.75e9 + 86_400.0 * f64::from(day),
        duration_s: 120.0,
        offset_rad: Some(1e-3 * f64::from(day)),
        offset_std_rad: Some(0.4e-3),
        elongation_m: None,
        elongation_std_m: None,
        strain_ratio: None,
        strain_std_ratio: None,
        temperature_c: Some(21.0),
        stiffness_ratio: None,
        stiffness_std_ratio: None,
        baseline: None,
        source: "test".into(),
        clock: Clock::Utc,
        provisional: false,
        reason: None,
        poses: 8,
        frames: 1000,
        frames_lost: 0,
        sinew_version: "0.9.0".into(),
    }
}

/// Writes records with the columns of version 1 of the schema.
pub(crate) fn write_version_1(path: &Path, records: &[Record]) {
    let mut columns = columns();
    for (name, _) in &mut columns {
        *name = match name.as_str() {
            "provisional" => "in_doubt".into(),
            name => name.replace("_std_", "_deviation_"),
        };
    }
    let mut writer = TableWriter::create(path, &columns).unwrap();
    for record in records {
        writer.row(&row(record)).unwrap();
    }
    writer.finish().unwrap();
}

/// Writes records as a monitor does.
pub(crate) fn write(path: &Path, records: &[Record]) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mut writer = TableWriter::of_schema(path, &SCHEMA).unwrap();
    for record in records {
        writer.row(&row(record)).unwrap();
    }
    writer.finish().unwrap();
}

/// Cells of a result, row by row.
pub(crate) fn cells(engine: &mut Engine, sql: &str) -> Vec<Vec<String>> {
    use datafusion::arrow::util::display::{ArrayFormatter, FormatOptions};
    let answer = engine.query(sql).unwrap();
    let mut out = Vec::new();
    for batch in &answer.batches {
        let format = FormatOptions::default();
        for i in 0..batch.num_rows() {
            let text = |column| {
                ArrayFormatter::try_new(column, &format)
                    .unwrap()
                    .value(i)
                    .to_string()
            };
            out.push(batch.columns().iter().map(|c| text(c)).collect());
        }
    }
    out
}

/// Finds the files of records of a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut out = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => out.extend(files(&path)),
            false if path.extension().is_some_and(|e| e == "parquet") => out.push(path),
            false => {}
        }
    }
    out
}

/// Changes the rows of every file of records.
pub(crate) fn change(folder: &Path, of: impl Fn(RecordBatch) -> RecordBatch) {
    for path in files(folder) {
        let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(&path).unwrap()).unwrap();
        let schema = reader.schema().clone();
        let batches: Vec<RecordBatch> = reader.build().unwrap().map(|b| of(b.unwrap())).collect();
        let mut writer = ArrowWriter::try_new(File::create(&path).unwrap(), schema, None).unwrap();
        batches.iter().for_each(|b| writer.write(b).unwrap());
        writer.close().unwrap();
    }
}

pub(crate) fn numbers<'b>(batch: &'b RecordBatch, column: &str) -> &'b Float64Array {
    batch
        .column_by_name(column)
        .unwrap()
        .as_primitive::<Float64Type>()
}

/// Removes the records of the last days before the last session.
pub(crate) fn cut(folder: &Path, days: f64) {
    let mut last_utc_s = f64::NEG_INFINITY;
    for path in files(folder) {
        let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(&path).unwrap()).unwrap();
        for batch in reader.build().unwrap() {
            let batch = batch.unwrap();
            last_utc_s = numbers(&batch, "time_utc_s")
                .iter()
                .flatten()
                .fold(last_utc_s, f64::max);
        }
    }
    change(folder, |batch| {
        let times = numbers(&batch, "time_utc_s").iter();
        let kept: BooleanArray = times
            .map(|t| Some(t? < last_utc_s - days * 86_400.0))
            .collect();
        filter_record_batch(&batch, &kept).unwrap()
    });
}
