//! Scan of one file of records: robots, order of the rows, readability.

use datafusion::arrow::array::{Array, AsArray as _, RecordBatch};
use datafusion::arrow::compute::cast;
use datafusion::arrow::datatypes::{DataType, Float64Type, SchemaRef};
use datafusion::parquet::arrow::ProjectionMask;
use datafusion::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::collections::BTreeSet;
use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Required columns of a record.
const KEYS: [&str; 3] = ["robot", "joint", "time_utc_s"];
const VERSION: &str = "sinew_version";

/// Readable file of records.
#[derive(Debug, Clone)]
pub struct RecordFile {
    /// Path of the file.
    pub path: PathBuf,
    /// Number of rows.
    pub rows: u64,
    /// Whether robot, joint and time ascend strictly, which excludes duplicate sessions.
    pub ascends: bool,
    /// Names of the robots.
    pub robots: BTreeSet<String>,
    /// First and last time stamp, s since 1970.
    pub times_utc_s: [f64; 2],
    /// Versions of the program that wrote the records.
    pub versions: BTreeSet<String>,
    /// Schema of the file.
    pub schema: SchemaRef,
}

/// Rejected file of records.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RejectedFile {
    /// Path of the file.
    pub path: PathBuf,
    /// Reason of the rejection.
    pub error: FileError,
}

/// Reason for the rejection of a file of records.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FileError {
    /// Not Parquet, truncated or damaged, with the message of the reader.
    Damaged(String),
    /// Missing column.
    NoColumn(&'static str),
    /// Column of an incompatible type.
    WrongType(String),
    /// Row without robot, joint or time.
    NoKey,
}

impl std::fmt::Display for FileError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Damaged(reason) => write!(f, "damaged: {reason}"),
            Self::NoColumn(name) => write!(f, "not a file of records: column '{name}' missing"),
            Self::WrongType(reason) => write!(f, "column {reason}"),
            Self::NoKey => write!(f, "a row has no robot, joint or time"),
        }
    }
}

/// Scans a file: its keys, or all columns.
pub(super) fn scan(path: &Path, whole: bool) -> Result<RecordFile, RejectedFile> {
    // A damaged file may cause a panic in the reader, which must not affect other files.
    let scanned = catch_unwind(AssertUnwindSafe(|| read(path, whole)));
    let damaged = || Err(FileError::Damaged("internal error of the reader".into()));
    scanned
        .unwrap_or_else(|_| damaged())
        .map_err(|error| RejectedFile {
            path: path.into(),
            error,
        })
}

fn damaged(error: impl std::fmt::Display) -> FileError {
    FileError::Damaged(error.to_string())
}

fn read(path: &Path, whole: bool) -> Result<RecordFile, FileError> {
    let file = File::open(path).map_err(damaged)?;
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(damaged)?;
    let schema = builder.schema().clone();
    if let Some(missing) = KEYS.iter().find(|k| schema.index_of(k).is_err()) {
        return Err(FileError::NoColumn(missing));
    }
    crate::columns::check_types(&schema).map_err(FileError::WrongType)?;
    let mask = match whole {
        true => ProjectionMask::all(),
        false => {
            let names = KEYS.iter().copied().chain([VERSION]);
            ProjectionMask::columns(builder.parquet_schema(), names)
        }
    };
    let rows = builder.with_projection(mask).build().map_err(damaged)?;
    let mut out = RecordFile {
        path: path.into(),
        rows: 0,
        ascends: true,
        robots: BTreeSet::new(),
        times_utc_s: [f64::INFINITY, f64::NEG_INFINITY],
        versions: BTreeSet::new(),
        schema,
    };
    let mut last: Option<(String, String, f64)> = None;
    for batch in rows {
        scan_batch(&batch.map_err(damaged)?, &mut out, &mut last)?;
    }
    Ok(out)
}

/// Evaluates the keys of a batch of rows.
fn scan_batch(
    batch: &RecordBatch,
    out: &mut RecordFile,
    last: &mut Option<(String, String, f64)>,
) -> Result<(), FileError> {
    let column = |name: &str, to: &DataType| {
        let column = batch.column_by_name(name);
        column.map(|c| cast(c, to).map_err(damaged)).transpose()
    };
    let need =
        |name: &'static str, to: &DataType| column(name, to)?.ok_or(FileError::NoColumn(name));
    let robots = need("robot", &DataType::Utf8)?;
    let joints = need("joint", &DataType::Utf8)?;
    let times = need("time_utc_s", &DataType::Float64)?;
    let versions = column(VERSION, &DataType::Utf8)?;
    if robots.null_count() + joints.null_count() + times.null_count() > 0 {
        return Err(FileError::NoKey);
    }
    let (robots, joints) = (robots.as_string::<i32>(), joints.as_string::<i32>());
    let times = times.as_primitive::<Float64Type>();
    let mut before = last.as_ref().map(|(r, j, t)| (r.as_str(), j.as_str(), *t));
    for i in 0..batch.num_rows() {
        let key = (robots.value(i), joints.value(i), times.value(i));
        if !key.2.is_finite() {
            return Err(FileError::NoKey);
        }
        if before.is_none_or(|b| b.0 != key.0) && !out.robots.contains(key.0) {
            out.robots.insert(key.0.to_owned());
        }
        // The comparison is false for NaN, which ends the order too.
        let ascends = before.is_none_or(|b| {
            (b.0, b.1) < (key.0, key.1) || (b.0, b.1) == (key.0, key.1) && b.2 < key.2
        });
        out.ascends &= ascends;
        let [first, end] = &mut out.times_utc_s;
        (*first, *end) = (first.min(key.2), end.max(key.2));
        before = Some(key);
    }
    if let Some(versions) = versions {
        let mut seen: Option<&str> = None;
        for version in versions.as_string::<i32>().iter().flatten() {
            if seen != Some(version) {
                out.versions.insert(version.to_owned());
                seen = Some(version);
            }
        }
    }
    out.rows += batch.num_rows() as u64;
    let kept = before.map(|(r, j, t)| (r.to_owned(), j.to_owned(), t));
    *last = kept;
    Ok(())
}
