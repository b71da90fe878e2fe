//! Fleets and files for tests.

pub(crate) mod tendons;

use sinew_fleet::args::{Simulate, Source};
use sinew_fleet::engine::Engine;
use sinew_fleet::simulate::{Made, simulate};
use sinew_log::TableWriter;
use sinew_watch_core::Record;
use sinew_watch_core::record::Clock;
use sinew_watch_core::table::{columns, row};
use std::path::{Path, PathBuf};

/// A folder of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// What a small fleet is asked for.
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
    }
}

/// A small fleet.
pub(crate) fn fleet(out: &Path, robots: u32, days: u32) -> Made {
    simulate(&small(out, robots, days)).unwrap()
}

/// How a folder is read.
pub(crate) fn source(folder: &Path) -> Source {
    Source {
        folder: folder.into(),
        memory_mb: 256,
    }
}

/// A folder, opened.
pub(crate) fn open(folder: &Path) -> Engine {
    Engine::open(&source(folder)).unwrap()
}

/// A session of a joint on a day.
pub(crate) fn session(robot: &str, joint: &str, day: u32) -> Record {
    Record {
        robot: robot.into(),
        robot_type: "arm".into(),
        joint: joint.into(),
        time_utc_s: 1.75e9 + 86_400.0 * f64::from(day),
        duration_s: 120.0,
        offset_rad: Some(1e-3 * f64::from(day)),
        offset_deviation_rad: Some(0.4e-3),
        elongation_m: None,
        elongation_deviation_m: None,
        strain_ratio: None,
        strain_deviation_ratio: None,
        temperature_c: Some(21.0),
        stiffness_ratio: None,
        stiffness_deviation_ratio: None,
        baseline: None,
        source: "test".into(),
        clock: Clock::Utc,
        in_doubt: false,
        reason: None,
        poses: 8,
        frames: 1000,
        frames_lost: 0,
        sinew_version: "0.9.0".into(),
    }
}

/// Writes records as a monitor does.
pub(crate) fn write(path: &Path, records: &[Record]) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mut writer = TableWriter::create(path, &columns()).unwrap();
    for record in records {
        writer.row(&row(record)).unwrap();
    }
    writer.finish().unwrap();
}

/// The cells of an answer, row by row.
pub(crate) fn cells(engine: &mut Engine, sql: &str) -> Vec<Vec<String>> {
    use datafusion::arrow::util::display::{ArrayFormatter, FormatOptions};
    let answer = engine.ask(sql).unwrap();
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
