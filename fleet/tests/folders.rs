//! Late, repeated, damaged and mixed files.

use crate::support::{cells, fleet, open, session, source, write, write_version_1};
use datafusion::arrow::array::{ArrayRef, Float32Array, Int32Array, RecordBatch, StringArray};
use datafusion::parquet::arrow::ArrowWriter;
use sinew_fleet::FleetError;
use sinew_fleet::engine::Engine;
use sinew_fleet::folder::{FileError, Folder};
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// Ten days of two robots.
fn ten_days() -> Vec<sinew_watch_core::Record> {
    let robots = ["arm-1", "arm-2"].into_iter();
    robots
        .flat_map(|robot| (0..10).map(move |day| session(robot, "elbow", day)))
        .collect()
}

#[test]
fn copied_file_counts_once() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("a/host-1.parquet"), &ten_days());
    write(&folder.path().join("b/host-1.parquet"), &ten_days());
    let mut engine = open(folder.path());
    assert_eq!(engine.count("records").unwrap(), 20);
    assert_eq!(engine.count("every_version").unwrap(), 20);
    assert_eq!(
        (engine.folder.clean.len(), engine.folder.ambiguous.len()),
        (0, 2)
    );
}

#[test]
fn file_of_records_states_units_and_meaning() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("host-1.parquet"), &ten_days());
    let found = Folder::open(folder.path()).unwrap();
    let metadata = found.clean[0].schema.metadata();
    assert_eq!(metadata["sinew_schema"], "sinew-record/2");
    let about: serde_json::Value = serde_json::from_str(&metadata["sinew_columns"]).unwrap();
    assert_eq!(about["offset_std_rad"]["unit"], "rad");
    assert_eq!(about["elongation_m"]["unit"], "m");
    assert_eq!(
        about["offset_std_rad"]["meaning"],
        "Standard deviation of the offset"
    );
}

#[test]
fn folder_name_is_not_a_pattern() {
    let folder = tempfile::tempdir().unwrap();
    write(
        &folder.path().join("a [1] * 50%/b=c/x y.parquet"),
        &ten_days(),
    );
    assert_eq!(open(folder.path()).count("records").unwrap(), 20);
}

#[test]
fn duplicate_session_in_file_counts_once() {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = ten_days();
    rows.insert(3, rows[3].clone());
    write(&folder.path().join("host-1.parquet"), &rows);
    assert_eq!(open(folder.path()).count("records").unwrap(), 20);
}

#[test]
fn late_files_in_any_order_add_their_sessions() {
    let folder = tempfile::tempdir().unwrap();
    let rows = ten_days();
    let late: Vec<_> = rows
        .iter()
        .filter(|r| r.time_utc_s > 1.7505e9)
        .cloned()
        .collect();
    let early: Vec<_> = rows
        .iter()
        .filter(|r| r.time_utc_s <= 1.7506e9)
        .cloned()
        .collect();
    write(&folder.path().join("1.parquet"), &late);
    write(&folder.path().join("2.parquet"), &early);
    let mut engine = open(folder.path());
    let found = cells(
        &mut engine,
        "SELECT robot, count(*), count(DISTINCT time_utc_s) FROM records GROUP BY robot ORDER BY robot",
    );
    assert_eq!(found, [["arm-1", "10", "10"], ["arm-2", "10", "10"]]);
}

#[test]
fn newer_version_supersedes_session() {
    let folder = tempfile::tempdir().unwrap();
    let rows = ten_days();
    let again: Vec<_> = (rows.iter().cloned())
        .map(|mut record| {
            record.offset_rad = Some(7.0);
            record.sinew_version = "0.10.0".into();
            record
        })
        .collect();
    write(&folder.path().join("new/1.parquet"), &again[..5]);
    write(&folder.path().join("old/1.parquet"), &rows);
    let mut engine = open(folder.path());
    assert_eq!(engine.count("records").unwrap(), 20);
    assert_eq!(engine.count("every_version").unwrap(), 25);
    let sql = "SELECT count(*) FROM records WHERE offset_rad = 7.0 AND sinew_version = '0.10.0'";
    assert_eq!(cells(&mut engine, sql), [["5"]]);
}

#[test]
fn records_are_independent_of_file_names() {
    let rows = ten_days();
    let other: Vec<_> = (rows.iter().cloned())
        .map(|mut record| {
            record.offset_rad = record.offset_rad.map(|x| x + 1.0);
            record
        })
        .collect();
    let sum = |names: [&str; 2]| {
        let folder = tempfile::tempdir().unwrap();
        write(&folder.path().join(names[0]), &rows);
        write(&folder.path().join(names[1]), &other);
        cells(
            &mut open(folder.path()),
            "SELECT sum(offset_rad), count(*) FROM records",
        )
    };
    assert_eq!(
        sum(["a.parquet", "b.parquet"]),
        sum(["b.parquet", "a.parquet"])
    );
}

#[test]
fn damaged_file_is_rejected_alone() {
    let folder = tempfile::tempdir().unwrap();
    let [good, cut, text] =
        ["good.parquet", "cut.parquet", "text.parquet"].map(|n| folder.path().join(n));
    write(&good, &ten_days());
    write(&cut, &[session("arm-3", "elbow", 1)]);
    let bytes = std::fs::read(&cut).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() - 20]).unwrap();
    std::fs::write(&text, "no parquet").unwrap();
    let mut engine = open(folder.path());
    assert_eq!(engine.count("records").unwrap(), 20);
    let rejected: Vec<&Path> = engine
        .folder
        .rejected
        .iter()
        .map(|r| r.path.as_path())
        .collect();
    assert_eq!(rejected, [&cut, &text]);
}

#[test]
fn version_1_columns_are_read_under_present_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut newer = session("arm-2", "elbow", 1);
    newer.provisional = true;
    write(&path("new.parquet"), &[newer]);
    write_version_1(&path("old.parquet"), &[session("arm-1", "elbow", 1)]);
    // The same session twice: the one with the smaller standard deviation counts, whatever the version.
    let mut wide = session("arm-3", "elbow", 1);
    wide.offset_std_rad = Some(0.8e-3);
    write(&path("wide.parquet"), &[wide]);
    write_version_1(&path("narrow.parquet"), &[session("arm-3", "elbow", 1)]);
    let mut engine = open(folder.path());
    let sql = "SELECT robot, CAST(round(1e6 * offset_std_rad) AS BIGINT), provisional FROM records ORDER BY robot";
    let expected = [
        ["arm-1", "400", "false"],
        ["arm-2", "400", "true"],
        ["arm-3", "400", "false"],
    ];
    assert_eq!(cells(&mut engine, sql), expected);
    assert!(engine.query("SELECT in_doubt FROM records").is_err());
}

#[test]
fn damage_outside_keys_rejects_file_alone() {
    let folder = tempfile::tempdir().unwrap();
    let [good, bad] = ["good.parquet", "bad.parquet"].map(|n| folder.path().join(n));
    write(&good, &ten_days());
    let rows: Vec<_> = (0..500).map(|day| session("arm-3", "elbow", day)).collect();
    write(&bad, &rows);
    // In the pages of the offsets, behind the keys that are looked at first.
    let reader =
        datafusion::parquet::file::reader::SerializedFileReader::try_from(bad.as_path()).unwrap();
    let metadata = datafusion::parquet::file::reader::FileReader::metadata(&reader);
    let (start, length) = metadata.row_group(0).column(5).byte_range();
    let mut bytes = std::fs::read(&bad).unwrap();
    bytes[start as usize..(start + length) as usize].fill(0xa5);
    std::fs::write(&bad, bytes).unwrap();
    let mut engine = open(folder.path());
    assert!(engine.folder.rejected.is_empty(), "the keys are whole");
    let found = cells(
        &mut engine,
        "SELECT count(offset_rad) FROM records WHERE offset_rad >= 0",
    );
    assert_eq!(found, [["20"]]);
    assert_eq!(engine.folder.rejected[0].path, bad);
    assert_eq!(Folder::verified(folder.path()).unwrap().rejected.len(), 1);
}

/// A file with columns of its own.
fn other_file(path: &Path, columns: Vec<(&str, ArrayRef)>) {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let mut writer =
        ArrowWriter::try_new(File::create(path).unwrap(), batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
}

#[test]
fn columns_may_be_missing_added_or_of_a_narrower_type() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("a.parquet"), &ten_days());
    let text = |t: &str| Arc::new(StringArray::from(vec![t])) as ArrayRef;
    other_file(
        &folder.path().join("b.parquet"),
        vec![
            ("joint", text("elbow")),
            ("robot", text("arm-9")),
            (
                "time_utc_s",
                Arc::new(Int32Array::from(vec![1_750_000_000])),
            ),
            ("offset_rad", Arc::new(Float32Array::from(vec![0.5]))),
            ("humidity_ratio", Arc::new(Float32Array::from(vec![0.25]))),
        ],
    );
    let mut engine = open(folder.path());
    let found = cells(
        &mut engine,
        "SELECT robot, offset_rad, humidity_ratio, clock IS NULL FROM records WHERE humidity_ratio IS NOT NULL",
    );
    assert_eq!(found, [["arm-9", "0.5", "0.25", "true"]]);
    assert_eq!(engine.count("records").unwrap(), 21);
}

#[test]
fn file_without_key_column_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("a.parquet"), &ten_days());
    let robot = Arc::new(StringArray::from(vec!["arm-9"])) as ArrayRef;
    other_file(&folder.path().join("b.parquet"), vec![("robot", robot)]);
    let engine = open(folder.path());
    assert_eq!(
        engine.folder.rejected[0].error,
        FileError::NoColumn("joint")
    );
}

#[test]
fn folder_without_records_error_has_fix() {
    let folder = tempfile::tempdir().unwrap();
    let rejected = Engine::open(&source(folder.path())).err();
    assert!(
        matches!(rejected, Some(FleetError::NoRecords(_))),
        "{rejected:?}"
    );
    let nowhere = Engine::open(&source(&folder.path().join("nothere")))
        .err()
        .unwrap()
        .to_string();
    assert!(nowhere.contains("specify the folder"), "{nowhere}");
}

#[test]
fn query_unknown_name_lists_available() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("a.parquet"), &ten_days());
    let mut engine = open(folder.path());
    let column = engine.query("SELECT ofset_rad FROM records").unwrap_err();
    let FleetError::NoColumn { name, available } = &column else {
        panic!("{column:?}");
    };
    assert_eq!(name, "ofset_rad");
    assert!(
        available.contains(&"offset_rad".into())
            && !available.contains(&"records.offset_rad".into())
    );
    let message = column.to_string();
    assert!(message.contains("did you mean 'offset_rad'?"), "{message}");
    let table = engine
        .query("SELECT joint FROM (SELECT * FROM record)")
        .unwrap_err();
    assert!(
        matches!(&table, FleetError::NoTable { name, available } if name == "record" && available.len() == 2),
        "{table:?}"
    );
}

#[test]
fn sort_beyond_memory_limit_spills_to_disk() {
    let folder = tempfile::tempdir().unwrap();
    fleet(folder.path(), 60, 200);
    let sql = "SELECT sum(n * offset_rad) FROM (SELECT offset_rad, row_number() OVER \
               (ORDER BY duration_s, source DESC, sinew_version, baseline, time_utc_s, joint) AS n FROM records)";
    let mut narrow = source(folder.path());
    narrow.memory_mb = 64;
    let narrow = cells(&mut Engine::open(&narrow).unwrap(), sql);
    assert_eq!(narrow, cells(&mut open(folder.path()), sql));
}

#[test]
fn join_keeps_robots_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    fleet(folder.path(), 8, 60);
    let sql = "EXPLAIN SELECT site, count(*) FROM records JOIN robots USING (robot) GROUP BY site";
    let plan = cells(&mut open(folder.path()), sql).concat().concat();
    // A join's first part is the one that is kept.
    let (_, join) = plan.split_once("HashJoinExec").unwrap();
    let [few, many] = ["partition_sizes", ".parquet"].map(|sign| join.find(sign).unwrap());
    assert!(few < many, "{plan}");
}

#[test]
fn invalid_side_table_fails_own_queries_only() {
    let folder = tempfile::tempdir().unwrap();
    fleet(folder.path(), 4, 60);
    // So many rows are looked at to find out that a number is one.
    let numbers: String = (0..10_000).map(|i| format!("arm-{i},{i}\n")).collect();
    let text = format!("robot,shelf\n{numbers}arm-x,none\n");
    std::fs::write(folder.path().join("robots.csv"), text).unwrap();
    let mut engine = open(folder.path());
    assert!(engine.count("records").unwrap() > 100);
    let rejected = engine.query("SELECT sum(shelf) FROM robots").unwrap_err();
    assert!(rejected.to_string().contains("none"), "{rejected}");
}
